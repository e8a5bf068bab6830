"""Facet planes of many postures as plain arrays: what the references are given for nothing.

Owns the copy out of lutgen's region.  NumPy and C then need not search for facets, which our
sweep has to do within its time.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support import (
    edge_plane_at,
    edges_at,
    facets_in,
    first_axis_at,
    is_shared,
    plane_at,
    put,
    second_axis_at,
    segments_in,
    tip_plane_at,
)
from lutgen.support.region import (
    Acceptance,
    empty_region,
)
from lutgen.support.search import stand
from lutgen.support.table import facet_table
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
        counts[m, 0] = facets_in(region.tally)
        counts[m, 1] = segments_in(region.tally)
        wall = 0
        for k in range(facets_in(region.tally)):
            put(facets[m], k, 0, plane_at(region.facet, k))
            put(facets[m], k, 3, first_axis_at(region.facet, k))
            put(facets[m], k, 6, second_axis_at(region.facet, k))
            first[m, k] = wall
            for e in range(*edges_at(region.span, k)):
                if not is_shared(region.link, e):
                    put(walls[m], wall, 0, edge_plane_at(region.edge, e))
                    wall += 1
        first[m, facets_in(region.tally)] = wall
        for b in range(segments_in(region.tally)):
            put(tips[m], b, 0, tip_plane_at(region.segment, b))


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
