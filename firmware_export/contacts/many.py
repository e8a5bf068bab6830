"""Many contacts, or round ones: which are shown, the rails they stand on, and the thresholds.

All contacts are in the tables but those that another one hides in every posture: the corners of a
track's box lie on the rims of its wheels, and the first wheel of a flipper is that of the track on
one axle with it.  Where both keep their distance a contact within another one never touches first,
and would only cost bytes and time, and slivers of facets that rounding makes.

The runtime's facets are exact but for rounding; every threshold is on the side on which rounding
cannot make an unsafe answer safe, and GUARD is taken off every distance from the boundary.

For a robot given by code contacts are `off` by more.  For distances that is no worse than a com
anywhere in a ball of that radius (`three` has the argument), and every threshold is moved by what
it can alter of it: a width by twice that, the normal of a facet as wide as a rest by 2 off / width.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.model import Model
from firmware_export.protocol import CArray
from lutgen.channels import (
    acceptance_of,
    empty_axes,
    find_axes,
    measure_recipe,
    primitives_of,
    region_of,
)
from lutgen.recipe import Postures, robot_size_of
from lutgen.support import ACCEPTED, DISC, SPHERE, STICKS_OUT, lies_within, pack, robot_size
from lutgen.vector import Floats

# Postures of a test: sums of products of sines that are equal in so many are the same.
TOLD, TOLD_SEED = 40, 11
# Part of the size by which a distance may change, by rounding.
KEPT = 1e-12


def _keeps(primitives: Floats, i: int, j: int, size: float) -> bool:
    """Return True if contacts i and j are placed to each other alike in all postures (m, n, 8)."""
    arm = primitives[:, i, :3] - primitives[:, j, :3]
    ways = primitives[:, i, 3:6], primitives[:, j, 3:6]
    alike = [
        (arm**2).sum(axis=1) / size,
        *((arm * axis).sum(axis=1) for axis in ways),
        (ways[0] * ways[1]).sum(axis=1) * size,
    ]
    return all(float(np.ptp(one)) <= KEPT * size for one in alike)


@lru_cache(maxsize=16)
def shown_contacts(model: Model) -> tuple[int, ...]:
    """Return the contacts that no other one hides in every posture, ascending.

    If two are always one, the first is shown.  A robot given by code shows all: its postures
    may be alike here and differ elsewhere.
    """
    every = range(len(model.kind))
    if model.recipe.python is not None:
        return tuple(every)
    params = model.at(np.random.default_rng(TOLD_SEED).random((TOLD, model.k)))
    where, size = model.postures(params), robot_size_of(model.recipe)
    primitives = pack(where.centres, where.axes, model.radius, model.kind)
    least = min(robot_size(one) for one in primitives)  # of which the definition takes its parts
    hides = np.zeros((len(every), len(every)), dtype=bool)
    for i in every:
        for j in every:
            hides[i, j] = (
                i != j
                and lies_within(primitives[0], i, j, STICKS_OUT, least)
                and _keeps(primitives, i, j, size)
            )
    return tuple(i for i in every if not (hides[i] & ~(hides[:, i] & (np.array(every) > i))).any())


# Sine that is taken off every distance.
GUARD = 1e-4
# Parts of the size by which thresholds are kept, and within which contacts are on one rail; sines
# within which axes are parallel, and level.
HAIR, SAME = 1e-5, 4e-6
# No further does a robot roll from rest to rest (rad): a point mass that falls from balance leaves
# its pivot at 48.2 deg.
FURTHEST = math.radians(45.0)
MOST_CONTACTS = 62
# Steeper than this (rad) the history of tracks does not go.
MOST_PITCH = math.radians(85.0)
# With a com anywhere in its ball: facets lower than this share of heights are given up; how many
# postures and directions are tried.
LOWEST, POSTURES, DIRECTIONS, SEED = 0.001, 500, 50, 7
# Postures that decide if a contact moves along an axis.  For a robot given by code: how many
# times what contacts are off alters a distance from an edge's line, and where a roll ends; as which
# part of the size rests are at least taken to be wide, and of those heights the least that is kept.
LOOKED, ROLLS, NARROWEST, LOW = 20_000, 4.0, 1e-3, 0.5


class Many(NamedTuple):
    """Extras of the tables of many contacts, beside positions.

    `order` of the shown contacts: rail by rail; `first` contact of each rail, and how many there
    are, or how many axles swing; `axis`, level, of all discs; `numbers` in the order of the
    runtime's struct, behind the axis; `more`, what series alter there; `guard`, the sine that is
    taken off every distance, and a sentence about it.
    """

    order: tuple[int, ...]
    first: tuple[int, ...]
    axis: tuple[float, float]
    numbers: tuple[float, ...]
    more: tuple[float, ...]
    guard: float
    text: str

    def arrays(self, room: tuple[int, ...]) -> tuple[CArray, ...]:
        """Return what the codec adds to positions, in the order of runtime/smap_pose.h."""
        singles = [*self.axis, *self.numbers, *self.more]
        tracks = [len(self.first) - 1, *self.first]
        return (
            CArray("axis and limits", "float", singles, "see smap_limits_t", False),
            CArray("tracks", "uint8_t", tracks, "tracks, first contact of each", False),
            CArray("names", "uint8_t", self.order, "the recipe's number of each contact", False),
            CArray("room", "uint8_t", room, "the most of each: see smap_region.h", False),
        )


def refusal(model: Model) -> str | None:
    """Return why the runtime cannot find this robot's facets, or None."""
    shown = shown_contacts(model)
    contacts = len(shown) + 2 * len(model.recipe.axles)
    if contacts > MOST_CONTACTS:
        return f"the runtime knows {MOST_CONTACTS} contacts and points of axles (got {contacts})"
    if not set(_carried(model)) <= set(shown):
        return "an axle that swings has a contact within another one; use --arithmetic integer"
    return None


def _carried(model: Model) -> list[int]:
    """Return the recipe's numbers of the contacts of axles that swing, two of each."""
    names = model.recipe.contact_names
    return [names.index(name) for axle in model.recipe.axles for name in axle.contacts]


@lru_cache(maxsize=8)
def _tracks(model: Model) -> tuple[tuple[float, float], Floats] | None:
    """Return the level axis (x, y) of all discs, and where (n,) shown contacts are along it.

    In length; None where the runtime searches.  Measured in postures.
    """
    shown, size = list(shown_contacts(model)), robot_size_of(model.recipe)
    kinds = model.kind[shown]
    if (kinds == SPHERE).any() or model.recipe.upright > MOST_PITCH or model.recipe.axles:
        return None
    t = np.random.default_rng(SEED).random((LOOKED, model.k))
    t[: LOOKED // 2] = t[: LOOKED // 2].round()
    where, axis = model.postures(model.at(t)), np.array([0.0, 1.0, 0.0])
    axes = where.axes[:, shown][:, kinds == DISC]
    if np.abs(axes[..., 2]).max(initial=0.0) > SAME:
        return None
    if axes.size:
        # Either way along the axle; that next to y needs no turn there and back.
        axis = axes[0, 0].round(12) * (-1.0 if tuple(axes[0, 0, 1::-1]) < (0.0, 0.0) else 1.0) + 0.0
        axis[2] = 0.0
        axis /= math.hypot(*axis)
        if np.abs(np.cross(axes, axis)).max() > SAME:
            return None
    along = (where.centres[:, shown] + where.com[:, None]) @ axis
    # Places next to each other are one, so that contacts of a track keep their order.
    places = along.mean(axis=0).round(9 - math.floor(math.log10(size)))
    if np.ptp(along, axis=0).max() > SAME * size or np.ptp(places) <= SAME * size:
        return None
    return (float(axis[0]), float(axis[1])), places


def _nearest_axes(model: Model, where: Postures, facet: NDArray[np.int64]) -> Floats:
    """Return how near the com an axis of each of some facets (m, d) of postures is."""
    accept, axes, found = acceptance_of(model.recipe), empty_axes(), np.zeros(facet.shape)
    for at, primitives in enumerate(primitives_of(model.recipe, where)):
        region = region_of(primitives, accept)
        find_axes(region, np.zeros(7), axes)
        rows = region.facet[region.seat["facet"][: region.counts[ACCEPTED]]]
        edges = (axes.edge["distance"][f["first"] : f["first"] + f["count"]] for f in rows)
        found[at] = np.array([*(edge.min() for edge in edges), 0.0])[facet[at]]
    return found


def _lowest(model: Model, rho: float) -> float:
    """Return the least height (length) of a facet that is kept, with the com anywhere in a ball.

    The wall of an axis turns by asin(radius of the ball / distance of the axis), and no axis of a
    facet is nearer to the com than the facet's plane: so facets lower than most postures have are
    given up.  A line over which the robot turns on an axle that swings may be nearer: where it is
    nearer than this height the facet is given up, too.
    """
    if rho == 0.0:
        return 0.0
    rng = np.random.default_rng(SEED)
    places = rng.random((POSTURES, model.k))
    if model.recipe.axles:  # without its only rest such a robot would stand nowhere
        places[: POSTURES // 4] = places[: POSTURES // 4].round()
    params = model.at(places)
    limit = model.chart_limit
    uv = rng.uniform(-limit, limit, (2, DIRECTIONS))
    gravity = model.uv_to_gravity(np.arange(DIRECTIONS) % model.faces, *uv)
    where, down = model.postures(params), np.broadcast_to(gravity, (POSTURES, DIRECTIONS, 3))
    found = measure_recipe(model.recipe, where, down, ("height", "facet"))
    heights = found["height"]
    if model.recipe.axles:
        heights = np.minimum(heights, _nearest_axes(model, where, found["facet"].astype(int)))
    heights = heights[found["facet"] >= 0.0]
    least = float(np.quantile(heights, LOWEST)) if len(heights) else 0.0
    # What series are off is little: no more need be given up.
    least *= LOW if model.recipe.com_uncertainty == 0.0 else 1.0 - HAIR
    return max(least, rho * (1.0 + HAIR) + HAIR * robot_size_of(model.recipe))


def order_of(model: Model) -> tuple[tuple[int, ...], bool]:
    """Return the order of a robot's shown contacts, and True if axes of its discs turn.

    Those of axles that swing come first, and at the end two points of each, see `closed.Closed`.
    """
    tracks, shown, carried = _tracks(model), shown_contacts(model), _carried(model)
    if tracks is None:
        points = range(len(model.kind), len(model.kind) + len(carried))
        return (*carried, *(at for at in shown if at not in carried), *points), True
    return tuple(shown[at] for at in np.argsort(-tracks[1], kind="stable")), False


def many_of(model: Model, off: float = 0.0) -> Many:
    """Return what the tables need of a robot that is not refused.

    `off`, above 0 for a robot given by code, is how far (length) its contacts are off.
    """
    accept, size = acceptance_of(model.recipe), robot_size_of(model.recipe)
    tracks, (order, _) = _tracks(model), order_of(model)
    first, axis = [len(model.recipe.axles)], (0.0, 1.0)
    if tracks is not None:
        axis, places = tracks[0], -np.sort(-tracks[1])
        for at in range(1, len(order)):
            if places[first[-1]] - places[at] > SAME * size:
                first.append(at)
        first.append(len(order))
    rho = model.recipe.com_uncertainty + off
    lowest = _lowest(model, rho)
    guard, text = GUARD, "a sine that is taken off every distance from the boundary"
    if rho > 0.0:
        guard += min(rho / (lowest - off), 1.0)
    if model.recipe.com_uncertainty > 0.0:
        text += ", with a com anywhere in its ball"
    if off > 0.0:
        text += f", with contacts off by up to {off:.2g}"
    turn = 2.0 * off / max(accept.rest_width, NARROWEST * size)
    numbers = (
        size,
        accept.steepest + HAIR + turn if model.recipe.upright < math.pi else -2.0,
        max(HAIR * size, accept.least_height * (1.0 + HAIR), lowest) + off,
        accept.rest_width * (1.0 + HAIR) + HAIR * size + 2.0 * off,
        max(accept.contact_tolerance - 0.1 * HAIR * size - ROLLS * off, 0.0),
        2.0 * math.sin(0.5 * min(accept.rock_angle, FURTHEST)) - HAIR - 2.0 * turn,
        guard,
    )
    more = (ROLLS * off / size, 2.0 * turn)
    return Many(order, tuple(first), axis, numbers, more, guard, text)
