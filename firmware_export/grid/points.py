"""Tables of three contact points over the parameters.

Nodes are evenly spaced and shifted by half of the distance between chord and arc, so that errors
lie on both sides alike.  A table has the axes on which its point depends.

The true contacts P_i span a cone; M is the stored normal of edge i.  Where gravity is inside the
cone and edge i the nearest, the foot of gravity on it lies on the arc from P_i to P_(i+1), so the
tip angle is too large by at most the largest angle of that arc above the stored plane.  Errors
along the legs lie in that plane and turn nothing.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from firmware_export.model import Model, combinations, widened
from lutgen.mapping.stability_map import interpolate, locate
from lutgen.vector import Floats

# Units from the com to the furthest contact: products of two of them stay in 31 bits.
UNITS = 16000
MOST_AXES = 4
LINES, PROBES = 12, 9
NEGLIGIBLE = 1e-9


@dataclass(frozen=True, eq=False)
class Point:
    """The table of one contact over the parameters on which it depends.

    `codes` (nodes..., 3) are x, y, z in units, or of 8 bits in 128 units.
    """

    axes: tuple[int, ...]
    codes: NDArray[np.int16] | NDArray[np.int8]


@lru_cache(maxsize=16)
def _lines(model: Model, axis: int) -> Floats:
    """Return the contacts (LINES, PROBES, 3, 3) along some lines that follow an axis."""
    t = np.repeat(np.random.default_rng(6).random((LINES, 1, model.k)), PROBES, axis=1)
    t[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
    return model.postures(model.at(t.reshape(-1, model.k))).centres.reshape(LINES, PROBES, 3, 3)


def depends_on(model: Model, contact: int) -> tuple[int, ...]:
    """Return the parameters on which a contact's position relative to the com depends."""
    lines = [_lines(model, axis)[:, :, contact] for axis in range(model.k)]
    moves = [np.abs(p - p[:, :1]).max() > NEGLIGIBLE * np.abs(p).max() for p in lines]
    return tuple(np.flatnonzero(moves).tolist())


def curvature(model: Model, axis: int) -> float:
    """Return how far (length) any contact's arc along an axis is from its chord at most."""
    second = np.diff(_lines(model, axis), 2, axis=1)
    return float(np.abs(second).max()) * (PROBES - 1) ** 2 / 8.0


def reach_of(model: Model) -> float:
    """Return how far (length) a contact is from the com at most, in many postures."""
    t = np.random.default_rng(7).random((4000, model.k))
    t[:1000] = np.rint(t[:1000])
    return 1.02 * float(np.sqrt((model.postures(model.at(t)).centres ** 2).sum(axis=2)).max())


def fit_point(model: Model, contact: int, nodes: tuple[int, ...], bits: int, unit: float) -> Point:
    """Return the table of one contact, in units, of so many nodes along each of its axes."""
    axes = depends_on(model, contact)

    def exact(places: list[Floats]) -> Floats:
        grid = combinations(places)
        t = np.full((len(grid), model.k), 0.5)
        t[:, list(axes)] = grid
        shape = (*(len(one) for one in places), 3)
        return model.postures(model.at(t)).centres[:, contact].reshape(shape)

    knots = [np.linspace(0.0, 1.0, n) for n in nodes]
    values = exact(knots)
    shift = np.zeros_like(values)
    for axis, knot in enumerate(knots):
        middles = [*knots]
        middles[axis] = (knot[1:] + knot[:-1]) / 2.0
        before = np.moveaxis(values, axis, 0)
        sag = np.moveaxis(exact(middles), axis, 0) - (before[1:] + before[:-1]) / 2.0
        both = np.concatenate([sag[:1], (sag[1:] + sag[:-1]) / 2.0, sag[-1:]])
        shift += np.moveaxis(both, 0, axis) / 2.0
    step = unit * (128 if bits == 8 else 1)
    most = 127 if bits == 8 else 16383
    codes = np.clip(np.rint((values + shift) / step), -most, most)
    return Point(axes, codes.astype(np.int8) if bits == 8 else codes.astype(np.int16))


def bounds(model: Model) -> tuple[Model, float]:
    """Return the model over what sensors may say, and the length of a unit."""
    wide = widened(model)
    return wide, reach_of(wide) / UNITS


# Places between two nodes at which errors are looked at, by the number of parameters; what may lie
# between.
BETWEEN = {0: 1, 1: 16, 2: 8, 3: 4, 4: 3}
MORE = 1.05
# Postures that are looked at, of more some at random; and at once.
MOST, AT_ONCE = 200_000, 20_000


def turned(model: Model, order: tuple[int, int, int], points: tuple[Point, ...]) -> float:
    """Return how far (rad) an arc is above its stored plane at most; pi where there is no plane."""
    nodes = np.ones(model.k, np.intp)
    for one in points:
        for axis, count in zip(one.axes, one.codes.shape, strict=False):
            nodes[axis] = max(nodes[axis], count)
    between = BETWEEN.get(model.k, 2)
    fine = [np.linspace(0.0, 1.0, (n - 1) * between + 1) for n in nodes]
    count = int(np.prod([float(len(one)) for one in fine]))
    few = count <= MOST
    t = combinations(fine) if few else np.random.default_rng(8).random((MOST, model.k))
    most = 0.0
    for first in range(0, len(t), AT_ONCE):
        here = t[first : first + AT_ONCE]
        true = model.postures(model.at(here)).centres[:, list(order)]
        stored = np.stack([_read(one, here) for one in points], axis=1)
        most = max(most, _above(true, stored))
    return MORE * most


def _read(point: Point, t: Floats) -> Floats:
    """Return what is looked up (m, 3), in units of its codes, at places t (m, k) of the box."""
    codes = point.codes.astype(np.float64)
    if not point.axes:
        return np.broadcast_to(codes, (len(t), 3))
    sizes = zip(point.axes, codes.shape, strict=False)
    places = [locate(np.linspace(0.0, 1.0, n), t[:, axis]) for axis, n in sizes]
    return np.stack([interpolate(codes[..., i], places)[0] for i in range(3)], axis=1)


def _above(true: Floats, stored: Floats) -> float:
    """Return the largest angle (rad) of an arc (m, 3, 3) above the plane of stored points."""
    most = 0.0
    for i in range(3):
        normal = np.cross(stored[:, i - 1], stored[:, i])
        ends = [true[:, j] / np.linalg.norm(true[:, j], axis=1, keepdims=True) for j in (i - 1, i)]
        size = np.linalg.norm(normal, axis=1)
        a, b = ((normal * end).sum(axis=1) / size for end in ends)
        # Between the ends the greatest is where the arc's plane is steepest, if that is on the arc.
        c = (ends[0] * ends[1]).sum(axis=1)
        inner = np.sqrt((a * a + b * b - 2.0 * a * b * c) / np.maximum(1.0 - c * c, 1e-300))
        on_arc = (b > a * c) & (a > b * c)
        above = np.where(on_arc, inner, np.maximum(a, b))
        if not np.isfinite(above).all():
            return np.pi
        most = max(most, float(np.arcsin(np.clip(above, 0.0, 1.0)).max()))
    return most
