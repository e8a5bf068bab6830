"""Many contacts, or round ones: which rails they stand on, and the thresholds.

The runtime's facets are exact but for rounding; every threshold is on the side on which rounding
cannot make an unsafe answer safe, and GUARD is taken off every distance from the boundary.

Of a robot given by code contacts are `off` by more.  For distances that is no worse than a com
anywhere in a ball of that radius (`three` has the argument), and every threshold is moved by what
it can alter of it: a width by twice that, the normal of a facet as wide as a rest by 2 off / width.
"""

import math
from typing import NamedTuple

import numpy as np

from firmware_export.contacts.closed import Sum, closed_form
from firmware_export.contacts.shown import shown_contacts
from firmware_export.protocol import CArray
from firmware_export.truth import Model
from lutgen.channels import acceptance_of
from lutgen.recipe import robot_size_of
from lutgen.support import SPHERE
from lutgen.vector import Floats

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
# postures and directions tell.
LOWEST, POSTURES, DIRECTIONS, SEED = 0.001, 500, 50, 7
# Of a robot given by code: postures that tell whether a point moves along y; how many times what
# contacts are off alters a distance from an edge's line, and where a roll ends; as which part of
# the size rests are at least taken to be wide, and of those heights the least that is kept.
LOOKED, ROLLS, NARROWEST, LOW = 20_000, 4.0, 1e-3, 0.5


class Many(NamedTuple):
    """What the tables of many contacts need beside positions.

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

    def guarded(self, guard: float, text: str) -> "Many":
        """Return the same with another guard (sine), and a sentence about it."""
        return self._replace(guard=guard, text=text, numbers=(*self.numbers[:-1], guard))

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
    if model.recipe.axles and model.recipe.com_uncertainty > 0.0:
        return "it knows no uncertain com of a robot whose axles swing; use --arithmetic integer"
    if not set(_carried(model)) <= set(shown):
        return "an axle that swings has a contact within another one; use --arithmetic integer"
    return None


def _carried(model: Model) -> list[int]:
    """Return the recipe's numbers of the contacts of axles that swing, two of each."""
    names = model.recipe.contact_names
    return [names.index(name) for axle in model.recipe.axles for name in axle.contacts]


def _axis(model: Model) -> tuple[float, float] | None:
    """Return the axis (x, y) of all discs, None where they have none in common."""
    found = None
    if model.recipe.python is not None:
        return (0.0, 1.0)  # points have none
    axes = closed_form(model.recipe).axes
    for axis in (axes[at] for at in shown_contacts(model)):
        if axis is None:
            continue
        if len(axis.terms) > 1 or abs(axis.terms[()][2]) > SAME:
            return None
        x, y = (float(value) for value in axis.terms[()][:2])
        # Either way along the axle; that next to y needs no turn there and back.
        size = math.hypot(x, y) * (-1.0 if (y, x) < (0.0, 0.0) else 1.0)
        if found is None:
            found = (x / size + 0.0, y / size + 0.0)
        elif abs(found[0] * y - found[1] * x) > SAME * abs(size):
            return None
    return found or (0.0, 1.0)


def _places(model: Model) -> Floats | None:
    """Return where each shown contact is along the common axis.

    None where there is no such axis, or one moves along it.
    """
    axis = _axis(model)
    if axis is None:
        return None
    size = robot_size_of(model.recipe)
    row = np.array([[axis[0], axis[1], 0.0]])
    places = []
    if model.recipe.python is not None:
        return _seen_places(model, SAME * size)
    centres = closed_form(model.recipe).centres
    for centre in (centres[at] for at in shown_contacts(model)):
        along = Sum.constant(row) @ centre
        if any(m and float(np.abs(v).max()) > SAME * size for m, v in along.terms.items()):
            return None
        places.append(float(along.terms.get((), np.zeros(1))[0]))
    return np.array(places)


def _seen_places(model: Model, same: float) -> Floats | None:
    """Return where points of a robot given by code are along y, None where one moves."""
    t = np.random.default_rng(SEED).random((LOOKED, model.k))
    t[: LOOKED // 2] = np.random.default_rng(SEED).integers(0, 2, (LOOKED // 2, model.k))
    y = model.postures(model.at(t)).centres[:, :, 1]
    return np.asarray(y.mean(axis=0)) if np.ptp(y, axis=0).max() <= same else None


def _lowest(model: Model, rho: float) -> float:
    """Return the least height (length) of a facet that is kept, with the com anywhere in a ball.

    The wall of an axis turns by asin(radius of the ball / distance of the axis), and no axis of a
    facet is nearer to the com than the facet's plane: so facets lower than most postures have are
    given up.
    """
    if rho == 0.0:
        return 0.0
    rng = np.random.default_rng(SEED)
    params = model.at(rng.random((POSTURES, model.k)))
    limit = model.chart_limit
    uv = rng.uniform(-limit, limit, (2, DIRECTIONS))
    gravity = model.uv_to_gravity(np.arange(DIRECTIONS) % model.faces, *uv)
    exact = model.exact(params, np.broadcast_to(gravity, (POSTURES, DIRECTIONS, 3)))
    heights = exact.height[exact.tip_angle >= 0.0]
    least = float(np.quantile(heights, LOWEST)) if len(heights) else 0.0
    if model.recipe.com_uncertainty == 0.0:
        least *= LOW  # what series are off is little: no more need be given up
    return max(least, rho * (1.0 + HAIR) + HAIR * robot_size_of(model.recipe))


def order_of(model: Model) -> tuple[tuple[int, ...], bool]:
    """Return the order of a robot's shown contacts, and whether axes of its discs turn.

    Those of axles that swing come first, and at the end two points of each, see `closed.Closed`.
    """
    places, shown, carried = _rails(model), shown_contacts(model), _carried(model)
    if places is None:
        points = range(len(model.kind), len(model.kind) + len(carried))
        return (*carried, *(at for at in shown if at not in carried), *points), True
    return tuple(shown[at] for at in np.argsort(-places, kind="stable")), False


def _rails(model: Model) -> Floats | None:
    """Return where each shown contact's rail is, None where the runtime searches."""
    spheres = model.kind[list(shown_contacts(model))] == SPHERE
    flat = model.recipe.upright <= MOST_PITCH and not model.recipe.axles
    places = _places(model) if flat and not spheres.any() else None
    if places is None or np.ptp(places) <= SAME * robot_size_of(model.recipe):
        return None
    return places


def many_of(model: Model, off: float = 0.0) -> Many:
    """Return what the tables need of a robot that is not refused.

    `off`, above 0 for a robot given by code, is how far (length) its contacts are off.
    """
    accept, size = acceptance_of(model.recipe), robot_size_of(model.recipe)
    places, (order, _) = _rails(model), order_of(model)
    first, axis = [len(model.recipe.axles)], (0.0, 1.0)
    if places is not None:
        axis, places = _axis(model) or axis, -np.sort(-places)
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
