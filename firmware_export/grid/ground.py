"""Where a posture and a direction are in a trained table: places, mirror symmetry, knots.

A place on an axis is 0 to 65535: over the box of a parameter and what sensors may say beyond it,
over the chart's side for v and for u.  A robot whose left is as its right is looked up with gravity
to its left only (g_y >= 0): for the other side its parameters are mirrored.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import permutations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.model import Model, sensor_tolerance, uniform_directions
from firmware_export.protocol import turns
from lutgen.arrays import Floats, Singles

# The last place of an axis, and where u or v is 0.
WHOLE, MIDDLE = 65535.0, 32768.0
# Postures and directions by which a mirror image is judged, and how alike they have to be (rad).
LOOKED, DIRECTIONS, ALIKE = 60, 40, 1e-6
# Lines of exact answers by which an axis is judged, and points of each.
LINES, ALONG = 320, 49
# Knots are as dense as this power of the bend of exact answers, and so much of it everywhere.
POWER, EVERYWHERE = 0.4, 0.3
# Tip angles (rad) that matter for it.
LOW, HIGH = math.radians(-5.0), math.radians(20.0)
SEED = 61


class Place(NamedTuple):
    """How a parameter becomes a place: `low` (rad or length), places for 1; the same of steps.

    A step's share `rate` is in 1/2^14.
    """

    low: float
    inverse: float
    first: int
    rate: int


class Fold(NamedTuple):
    """The mirror image of a posture: its parameter i is `partner[i]`, turned over if `over[i]`."""

    partner: tuple[int, ...]
    over: tuple[bool, ...]


@dataclass(frozen=True, eq=False)
class Ground:
    """A robot as its tables see it: over its box, and over what sensors may say beyond it.

    An axis that `rounds` comes round, and so has no beyond; `fold` is there where left is as right.
    """

    narrow: Model
    model: Model
    places: tuple[Place, ...]
    rounds: tuple[bool, ...]
    fold: Fold | None

    def params(self, x: Floats) -> Floats:
        """Return the parameters at places (..., k)."""
        return np.array([p.low for p in self.places]) + x / [p.inverse for p in self.places]

    def places_of(self, params: Floats) -> Floats:
        """Return the places (m, k) of postures (m, k)."""
        x = (params - [p.low for p in self.places]) * [p.inverse for p in self.places]
        return np.clip(x, 0.0, WHOLE)

    def mirrored(self, x: Floats, fold: Fold) -> Floats:
        """Return the places (m, k) of the mirror images of postures at places (m, k)."""
        other = x[:, list(fold.partner)]
        return np.where(fold.over, WHOLE + np.array(self.rounds) - other, other)

    @property
    def chart_places(self) -> float:
        """Places for u or v of 1, as the runtime rounds the chart's limit."""
        return MIDDLE * 8192.0 / math.ceil(self.model.chart_limit * 8193.0)

    def enter(self, x: Floats, gravity: Floats) -> tuple[Singles, NDArray[np.int8]]:
        """Return places (m, d, k + 2) and faces (m, d) of postures at places (m, k).

        `gravity`: directions (m, d, 3) of each, or (1, d, 3) of all.
        """
        k, chart = self.model.k, self.model.recipe.chart
        left = ((gravity[..., 1] < 0.0) & (self.fold is not None))[..., None]
        right = np.where(left, gravity * [1.0, -1.0, 1.0], gravity)
        face, u, v, _ = chart.locate(right.reshape(-1, 3))
        shape = gravity.shape[:2]
        places = np.empty((len(x), shape[1], k + 2), np.float32)
        places[..., :k] = x[:, None]
        if self.fold is not None:
            places[..., :k] = np.where(left, self.mirrored(x, self.fold)[:, None], x[:, None])
        for at, coordinate in ((k, v), (k + 1, u)):
            place = MIDDLE + coordinate.reshape(shape) * self.chart_places
            places[..., at] = np.clip(place, 0.0, WHOLE)
        return places, np.broadcast_to(face.astype(np.int8).reshape(shape), places.shape[:2])


@lru_cache(maxsize=4)
def ground_of(model: Model) -> Ground:
    """Return a robot as its tables see it."""
    wider, places, rounds = [], [], []
    for i, p in enumerate(model.recipe.parameters):
        span = p.maximum - p.minimum
        comes = turns(model, i) and abs(span - 2.0 * math.pi) < 1e-6
        room = 0.0 if comes else sensor_tolerance(p)
        per = (WHOLE + comes) / (span + 2.0 * room)
        rate = round(span * per / 32767.0 * 2.0**14)
        wider.append(replace(p, minimum=p.minimum - room, maximum=p.maximum + room))
        places.append(Place(p.minimum - room, per, round(room * per), rate))
        rounds.append(comes)
    wide = Model(replace(model.recipe, parameters=tuple(wider)))
    plain = Ground(model, wide, tuple(places), tuple(rounds), None)
    return replace(plain, fold=_fold_of(plain))


def _fold_of(plain: Ground) -> Fold | None:
    """Return how a robot is mirrored in the plane of x and z, or None where it is not.

    Every way to pair the parameters is tried: first if each contact has one at its image.
    """
    model, rng = plain.model, np.random.default_rng(SEED)
    k = model.k
    x = rng.random((LOOKED, k)) * WHOLE
    here = model.postures(plain.params(x))
    image = here.centres * [1.0, -1.0, 1.0]
    gravity = uniform_directions(model, rng, (LOOKED, DIRECTIONS))
    tip = model.tip_angle(here, gravity)
    for partner in permutations(range(k)):
        if any(partner[partner[i]] != i for i in range(k)):
            continue
        for over in product((False, True), repeat=k):
            if any(over[partner[i]] != over[i] for i in range(k)):
                continue
            there = model.postures(plain.params(plain.mirrored(x, Fold(partner, over))))
            apart = np.abs(there.centres[:3, :, None] - image[:3, None]).max(axis=3).min(axis=2)
            if apart.max(initial=0.0) > ALIKE * np.abs(image).max():
                continue
            mirrored = model.tip_angle(there, gravity * [1.0, -1.0, 1.0])
            if np.quantile(np.abs(mirrored - tip), 0.99) < ALIKE:
                return Fold(partner, over)
    return None


def bends(ground: Ground, lowest: Sequence[float], highest: Sequence[float]) -> Floats:
    """Return how much exact answers bend along each axis (k + 2, ALONG), from place to place.

    `lowest` and `highest` (2,) are the box of v and u; a row has the power with which knots go.
    """
    model, rng = ground.model, np.random.default_rng([SEED, 1])
    k = model.k
    low = np.array([0.0] * k + list(lowest))
    high = np.array([WHOLE] * k + list(highest))
    result = np.empty((k + 2, ALONG))
    for axis in range(k + 2):
        x = np.repeat(low + (high - low) * rng.random((LINES, 1, k + 2)), ALONG, axis=1)
        x[:, :, axis] = np.linspace(low[axis], high[axis], ALONG)
        u, v = ((x[..., at] - MIDDLE) / ground.chart_places for at in (-1, -2))
        face = rng.integers(0, model.faces, (LINES, 1))
        gravity = model.uv_to_gravity(face, u, v).reshape(-1, 1, 3)
        params = ground.params(x[..., :k].reshape(LINES * ALONG, k))
        tip = model.tip_angle(model.postures(params), gravity).reshape(LINES, ALONG)
        tip = np.clip(tip, LOW, HIGH)
        bend = np.abs(tip[:, 2:] - 2.0 * tip[:, 1:-1] + tip[:, :-2]).mean(axis=0) ** POWER
        result[axis] = np.concatenate([bend[:1], bend, bend[-1:]])
    return result


def spread_knots(bend: Floats, low: float, high: float, count: int) -> NDArray[np.uint16]:
    """Return so many knots from `low` to `high`, in equal shares of the bend."""
    dense = EVERYWHERE + (1.0 - EVERYWHERE) * bend / max(float(bend.mean()), 1e-300)
    share = np.concatenate([[0.0], np.cumsum((dense[1:] + dense[:-1]) / 2.0)])
    at = np.interp(np.linspace(0.0, share[-1], count), share, np.linspace(low, high, len(bend)))
    return np.asarray(np.rint(at), np.uint16)
