"""Twin of the runtime's reading of three contact points, which two codecs share."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.strict import F0, F1, arcsine, njit, root
from firmware_export.vector32 import Vector, cross, dot

LARGEST = np.float32(3.402823466e38)
THIRD = np.float32(0.333333333)


@njit()
def read_three(
    p: NDArray[np.float32],
    tolerance: np.float32,
    steepest: np.float32,
    d: Vector,
    out: NDArray[np.float32],
) -> None:
    """Read three contact points: there is one facet, and the standing region is their cone.

    `p` (9,) are the points, d the direction; sdg, tip_angle and height go to `out` (3,), which is
    left as it is (but for the height) where the facet is none.
    """
    lowest, highest = LARGEST, -LARGEST
    n0 = n1 = n2 = s0 = s1 = s2 = det = F0
    for i in range(3):
        j = 0 if i == 2 else i + 1
        a = (p[3 * i], p[3 * i + 1], p[3 * i + 2])
        b = (p[3 * j], p[3 * j + 1], p[3 * j + 2])
        edge = cross(a, b)
        along = dot(edge, d) / root(dot(edge, edge))
        lowest = along if along < lowest else lowest
        highest = along if along > highest else highest
        n0, n1, n2 = n0 + edge[0], n1 + edge[1], n2 + edge[2]
        s0, s1, s2 = s0 + a[0], s1 + a[1], s2 + a[2]
        if i == 0:
            det = dot(edge, (p[6], p[7], p[8]))
    normal = (n0, n1, n2)
    size = F1 / root(dot(normal, normal))
    if det < F0:
        lowest = -highest
        size = -size
    out[2] = det * size
    if not out[2] > tolerance or not -n2 * size > steepest:
        return
    out[1] = arcsine(lowest / root(dot(d, d)))
    det = det / dot(normal, d)
    pierced = (det * d[0] - s0 * THIRD, det * d[1] - s1 * THIRD, det * d[2] - s2 * THIRD)
    out[0] = root(dot(pierced, pierced))
