"""Facet planes of many postures as plain arrays: what the references are given for nothing.

Owns the copy out of lutgen's region.  NumPy and C then need not search for facets, which our
sweep has to do within its time.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.region import (
    EDGE_KIND,
    EDGE_PLANE,
    FACETS,
    FIRST_AXIS,
    PLANE,
    SEGMENTS,
    SHARED,
    TIP_PLANE,
    Acceptance,
    empty_region,
)
from lutgen.support.search import stand
from lutgen.support.table import FIRST, facet_table
from lutgen.vector import Floats, Ints


class Planes(NamedTuple):
    """Planes of m postures, padded.

    `facets` (m, F, 9): n/h, and the two axes w with |SD_g| = hypot(w1.g, w2.g) / ((n/h).g).
    `walls` (m, W, 3): inward normals of the edges beyond which the robot tips, facet by facet;
    those of facet k are `first[k]` to `first[k + 1]` of `first` (m, F + 1).
    `tips` (m, T, 3): inward normals of the tip-over planes.  `counts` (m, 2): F and T used.
    """

    facets: Floats
    walls: Floats
    first: Ints
    tips: Floats
    counts: Ints


@njit()
def _copy(
    primitives: Floats,
    accept: Acceptance,
    facets: Floats,
    walls: Floats,
    first: Ints,
    tips: Floats,
    counts: Ints,
) -> None:
    table, region = facet_table(primitives.shape[1]), empty_region(primitives.shape[1])
    for m in range(primitives.shape[0]):
        stand(table, region, primitives[m], accept)
        counts[m, 0] = region.tally[FACETS]
        counts[m, 1] = region.tally[SEGMENTS]
        wall = 0
        for k in range(region.tally[FACETS]):
            facets[m, k, 0:3] = region.facet[k, PLANE : PLANE + 3]
            facets[m, k, 3:9] = region.facet[k, FIRST_AXIS : FIRST_AXIS + 6]
            first[m, k] = wall
            for e in range(region.span[k, FIRST], region.span[k + 1, FIRST]):
                if region.link[e, EDGE_KIND] != SHARED:
                    walls[m, wall] = region.edge[e, EDGE_PLANE : EDGE_PLANE + 3]
                    wall += 1
        first[m, region.tally[FACETS]] = wall
        for b in range(region.tally[SEGMENTS]):
            tips[m, b] = region.segment[b, TIP_PLANE : TIP_PLANE + 3]


def planes(primitives: NDArray[np.float64], accept: Acceptance) -> Planes:
    """Return the planes of postures (m, n, 8) of points under the limits of `region.acceptance`."""
    m, n = primitives.shape[:2]
    result = Planes(
        np.zeros((m, 2 * n, 9)),
        np.zeros((m, 6 * n, 3)),
        np.zeros((m, 2 * n + 1), np.int64),
        np.zeros((m, 12 * n, 3)),
        np.zeros((m, 2), np.int64),
    )
    _copy(primitives, accept, *result)
    return result
