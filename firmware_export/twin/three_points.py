"""Twin of the runtime's reading of three contact points, which two codecs share."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.twin.strict import arcsine, njit, root
from firmware_export.twin.vector32 import Vector, at, cross, dot

THIRD = np.float32(0.333333333)


@njit()
def read_three(
    p: NDArray[np.float32],
    lowest: np.float32,
    steepest: np.float32,
    d: Vector,
    out: NDArray[np.float32],
) -> None:
    """Read three contact points: there is one facet, and the standing region is their cone.

    `p` (9,) are the points, d the direction; sdg, tip_angle and height go to `out` (3,), which is
    left as it is (but for the height) where the facet is none.
    """
    e0, e1, e2 = cross(at(p, 0), at(p, 3)), cross(at(p, 3), at(p, 6)), cross(at(p, 6), at(p, 0))
    along0 = dot(e0, d) / root(dot(e0, e0))
    along1 = dot(e1, d) / root(dot(e1, e1))
    along2 = dot(e2, d) / root(dot(e2, e2))
    normal = (e0[0] + e1[0] + e2[0], e0[1] + e1[1] + e2[1], e0[2] + e1[2] + e2[2])
    det = dot(e0, at(p, 6))
    steep = -normal[2]
    size = root(dot(normal, normal))
    out[2] = det / size
    if not out[2] > lowest:
        out[2], steep = -out[2], -steep
        along0, along1, along2 = -along0, -along1, -along2
    if not out[2] > lowest or not steep > steepest * size:
        return
    nearest = along1 if along1 < along0 else along0
    nearest = along2 if along2 < nearest else nearest
    out[1] = arcsine(nearest / root(dot(d, d)))
    det = det / dot(normal, d)
    pierced = (
        det * d[0] - (p[0] + p[3] + p[6]) * THIRD,
        det * d[1] - (p[1] + p[4] + p[7]) * THIRD,
        det * d[2] - (p[2] + p[5] + p[8]) * THIRD,
    )
    out[0] = root(dot(pierced, pierced))
