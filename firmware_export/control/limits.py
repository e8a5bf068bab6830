"""Bound what a robot's joints alter: how far contacts move, walls bend and the body leans.

The C looks at a few postures of a way and must know of all the others.  Each bound is the largest
over a lattice of postures, with a margin for what is between its nodes.
"""

from typing import NamedTuple

import numpy as np

from firmware_export.model import Model, combinations
from lutgen.analysis import Posture
from lutgen.channels import body_gravity
from lutgen.recipe import robot_size_of
from lutgen.vector import Floats

# Postures of the lattice at most, random ones beside it, seed; steps of differences, as a part
# of an axis; the margin on what was seen; directions of each posture on axles that swing.
LATTICE, RANDOM, SEED, STEP, MARGIN, DIRECTIONS = 6000, 3000, 17, 1e-4, 1.1, 40
# As fast as this share of postures turns a robot turns on a plane; faster it rolls on over what
# is next to no facet.
LEANS = 0.995
# Nor does it turn on a facet narrower than this part of the size: there it rolls on.
NARROW = 0.5
# The curvature of a circle counts where gravity is as far outside (rad) of what is still looked at.
OUTSIDE = 0.02
# Postures in which planes under axles are looked at.
PLANES = 2000


class Limits(NamedTuple):
    """For each parameter (k,), per rad or length: see `protocol.Joint`."""

    reach: Floats
    bend: Floats
    lean: Floats


def limits_of(model: Model) -> Limits:
    """Return what the joints of a robot alter at most."""
    places = max(3, int(LATTICE ** (1.0 / max(model.k, 1))))
    lattice = combinations([np.linspace(0.0, 1.0, places)] * model.k)
    random = np.random.default_rng(SEED).random((RANDOM, model.k))
    t = np.clip(np.concatenate([lattice, random]), STEP, 1.0 - STEP)
    moved = np.zeros((model.k, len(model.kind) + 1))  # contacts, and walls
    bend, lean = np.zeros(model.k), np.zeros(model.k)
    for axis in range(model.k):
        step = np.zeros(model.k)
        step[axis] = STEP
        width = STEP * (model.upper[axis] - model.lower[axis])
        there = [model.at(t + sign * step) for sign in (-1.0, 0.0, 1.0)]
        moved[axis, :-1] = MARGIN * _moved(model, there[0], there[2], 2.0 * width)
        if model.recipe.axles:
            moved[axis, -1] = MARGIN * _turned(model, there[0], there[2], 2.0 * width)
        lean[axis] = MARGIN * _lean(model, there[0], there[2], 2.0 * width, moved[axis].max())
        if model.is_tripod:
            bend[axis] = MARGIN * _bend(model, there, width)
    if model.is_tripod:
        return Limits(moved.max(axis=1), bend, lean)
    return Limits(*_shared(moved), lean)


def _moved(model: Model, a: Floats, b: Floats, apart: float) -> Floats:
    """Return how far each contact (n,) moves, seen from the com; a disc's rim with its axis."""
    first, second = model.postures(a), model.postures(b)
    moved = np.sqrt(((second.centres - first.centres) ** 2).sum(axis=2))
    turned = np.sqrt(((second.axes - first.axes) ** 2).sum(axis=2)) * model.radius
    return np.asarray((moved + turned).max(axis=0) / apart)


def _turned(model: Model, a: Floats, b: Floats, apart: float) -> float:
    """Return how fast the tip angle changes, times the com's height above the plane (length).

    On an axle that swings a wall turns otherwise than its contacts move: where the axle carries
    depends on both, and the robot's own masses count.
    """
    limit = min(model.chart_limit, 1.0)
    uv = np.random.default_rng(SEED + 2).uniform(-limit, limit, (2, DIRECTIONS))
    down = np.broadcast_to(model.uv_to_gravity(0, *uv), (len(a), DIRECTIONS, 3))
    first, second = model.exact(a, down), model.exact(b, down)
    stands = np.minimum(first.tip_angle, second.tip_angle) >= 0.0
    rates = np.abs(second.tip_angle - first.tip_angle)[stands] / apart
    return float((rates * first.height[stands]).max(initial=0.0))


def stands_alike(model: Model) -> bool:
    """Return True if the same contacts carry the robot with an axle in all of many postures.

    Between postures in which an axle has both of its contacts on the ground there may else be one
    that has not, and nothing stands there.
    """
    t = np.random.default_rng(SEED + 3).random((PLANES, model.k))
    t[: PLANES // 4] = t[: PLANES // 4].round()
    found = {
        tuple(sorted(facet.touching for facet in Posture(model.recipe, row).facets if facet.axle))
        for row in model.at(t)
    }
    return len(found) == 1 and () not in found


def _shared(moved: Floats) -> tuple[Floats, Floats]:
    """Return what each joint moves its own contacts beyond others, and what it moves others.

    A contact is the joint's own that moves it most.  No contact then moves further than what all
    joints move others, together, and the most that one joint moves its own beyond that.
    """
    own = moved.argmax(axis=0)
    others = np.array([row[own != i].max(initial=0.0) for i, row in enumerate(moved)])
    most = np.array([row[own == i].max(initial=0.0) for i, row in enumerate(moved)])
    return np.maximum(most - others, 0.0), others


def _lean(model: Model, a: Floats, b: Floats, apart: float, moved: float) -> float:
    """Return how fast the body turns on a plane while it stands on one facet."""
    rng = np.random.default_rng(SEED + 1)
    limit = 0.5 * min(model.chart_limit, 1.0)
    slope = np.concatenate([rng.uniform(-limit, limit, (len(a), 2)), -np.ones((len(a), 1))], axis=1)
    most, fastest = 2.0 * moved / (NARROW * robot_size_of(model.recipe)), 0.0
    for downs in (np.tile([0.0, 0.0, -1.0], (len(a), 1)), slope):
        first = body_gravity(model.recipe, a, downs, "plane")
        second = body_gravity(model.recipe, b, downs, "plane")
        rates = np.sqrt(((second - first) ** 2).sum(axis=1)) / apart
        fastest = max(fastest, float(np.quantile(np.minimum(rates, most), LEANS)))
    return fastest


def _walls(model: Model, params: Floats) -> Floats:
    """Return the inward normals (m, 3, 3) of a tripod's tip-over planes, in the ground's frame."""
    p = model.postures(params).centres
    edges = np.cross(p, np.roll(p, -1, axis=1))
    plane = edges.sum(axis=1)
    side = np.sign((plane * p[:, 0]).sum(axis=1))
    walls = side[:, None, None] * edges / np.linalg.norm(edges, axis=2, keepdims=True)
    up = -side[:, None] * plane / np.linalg.norm(plane, axis=1, keepdims=True)
    w = np.stack([up[:, 1], -up[:, 0], np.zeros(len(up))], axis=1)[:, None, :]
    first = np.cross(w, walls)
    share = 1.0 / (1.0 + up[:, 2])
    return np.asarray(walls + first + share[:, None, None] * np.cross(w, first))


def _bend(model: Model, there: list[Floats], apart: float) -> float:
    """Return the largest second derivative of a tripod's tip angles in the ground's frame.

    A wall's unit normal m(q) that moved on a great circle would make the tip angle concave, for
    directions inside it; what bends it the other way is m's acceleration across that, and for
    directions just outside a little of the circle's.
    """
    a, b, c = (_walls(model, params) for params in there)
    speed, bow = (c - a) / (2.0 * apart), (a - 2.0 * b + c) / apart**2
    across = bow - (bow * b).sum(axis=2, keepdims=True) * b
    square = (speed**2).sum(axis=2)
    return float((np.sqrt((across**2).sum(axis=2)) + OUTSIDE * square).max())
