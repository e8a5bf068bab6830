"""Which contacts are in the tables: all but those that another one hides in every posture.

The corners of a track's box lie on the rims of its wheels, and the first wheel of a flipper is that
of the track on one axle with it.  Where both keep their distance a contact within another one never
touches first, and would only cost bytes and time, and slivers of facets that rounding makes.
"""

from functools import lru_cache

import numpy as np

from firmware_export.truth import Model
from lutgen.recipe import robot_size_of
from lutgen.support import STICKS_OUT, lies_within, pack, robot_size
from lutgen.vector import Floats

# Postures that tell: where sums of products of sines are equal in so many they are the same.
POSTURES, SEED = 40, 11
# Part of the size by which a distance may change, by rounding.
SAME = 1e-12


def _keeps(primitives: Floats, i: int, j: int, size: float) -> bool:
    """Tell whether contacts i and j are placed to each other alike in all postures (m, n, 8)."""
    arm = primitives[:, i, :3] - primitives[:, j, :3]
    ways = primitives[:, i, 3:6], primitives[:, j, 3:6]
    alike = [
        (arm**2).sum(axis=1) / size,
        *((arm * axis).sum(axis=1) for axis in ways),
        (ways[0] * ways[1]).sum(axis=1) * size,
    ]
    return all(float(np.ptp(one)) <= SAME * size for one in alike)


@lru_cache(maxsize=16)
def shown_contacts(model: Model) -> tuple[int, ...]:
    """Return the contacts that no other one hides in every posture, ascending.

    Of two that are always one the first is shown.  Of a robot given by code all are: its postures
    may be alike here and differ elsewhere.
    """
    every = range(len(model.kind))
    if model.recipe.python is not None:
        return tuple(every)
    params = model.at(np.random.default_rng(SEED).random((POSTURES, model.k)))
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
