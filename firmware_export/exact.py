"""Exact channels at many postures, each with directions of its own.

Owns the kernel that encoders and certificates compare with: `lutgen.evaluate` crosses every
posture with every direction, here each posture has its own.  It also continues the stability
factor beyond the standing region, because a table's nodes there must hold something smooth.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.boundary import find_region
from lutgen.channels import measure
from lutgen.jit import njit, prange
from lutgen.region import (
    FACETS,
    FIRST_AXIS,
    HEIGHT,
    PLANE,
    SECOND_AXIS,
    Limit,
    empty_region,
    supporting_facet,
    vector_at,
)
from lutgen.rounds import find_facets
from lutgen.support import facet_table, robot_size
from lutgen.vector import Bools, Floats, Ints, dot, row

# Rows of the result.
SDG, BARE_HEIGHT, TIP_ANGLE, ALONG, ASIDE, HEIGHT_BEYOND = 0, 1, 2, 3, 4, 5
ROWS = 6


@njit()
def _measure_posture(
    shapes: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools, out: Floats
) -> int:
    """Fill `out` (6, d) for one posture; return 1 where its facet table was too small."""
    n = shapes.shape[0]
    table, region = facet_table(n), empty_region(n)
    values = np.empty(6)
    find_facets(table, shapes, limit[2])
    find_region(region, table, limit, robot_size(shapes))
    for d in range(gravity_dir.shape[0]):
        g = row(gravity_dir, d)
        measure(region, g, wanted, values)
        out[SDG, d], out[BARE_HEIGHT, d], out[TIP_ANGLE, d] = values[0], values[1], values[2]
        out[ALONG, d] = out[ASIDE, d] = out[HEIGHT_BEYOND, d] = math.nan
        k = supporting_facet(region.plate, region.tally[FACETS], g)
        if k >= 0:
            reach = 1.0 / dot(vector_at(region.plate, k, PLANE), g)
            out[ALONG, d] = dot(vector_at(region.plate, k, FIRST_AXIS), g) * reach
            out[ASIDE, d] = dot(vector_at(region.plate, k, SECOND_AXIS), g) * reach
            out[HEIGHT_BEYOND, d] = region.plate[k, HEIGHT]
    return int(table.tally[1])


@njit(parallel=True)
def measure_each(
    shapes: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools
) -> tuple[NDArray[np.float64], Ints]:
    """Measure m postures under d directions each.

    Parameters
    ----------
    shapes : (m, n, 8) float64
        As `primitive.pack` makes them.
    gravity_dir : (m, d, 3) float64
        Unit directions, pointing down.
    limit : tuple
        See `region.limits`.
    wanted : (6,) bool
        Which of `lutgen.channels.CHANNELS` to compute beyond sdg and height.

    Returns
    -------
    (m, 6, d) float64
        Rows SDG to HEIGHT_BEYOND.
    (m,) int64
        1 where a facet table was too small.
    """
    m = shapes.shape[0]
    out = np.empty((m, ROWS, gravity_dir.shape[1]))
    overflow = np.zeros(m, np.int64)
    for posture in prange(m):
        overflow[posture] = _measure_posture(
            shapes[posture], gravity_dir[posture], limit, wanted, out[posture]
        )
    return out, overflow
