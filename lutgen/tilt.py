"""Tip angles along the rows of a face, for convex standing regions.

Owns the fast path to `tip_angle`: along a row the sine of the angle to each tip-over plane is an
affine function of u over the length of (u, v, 1), so the smallest of a few lines and one arcsine
per node are all there is to compute.
"""

import math

import numpy as np

from lutgen.channels import JUST_OUTSIDE
from lutgen.jit import njit
from lutgen.raster import VECTOR
from lutgen.region import SEGMENTS, TIP_PLANE, Region, vector_at
from lutgen.vector import Floats, Ints, Singles, dot, row

HALF_PI = math.pi / 2.0


@njit(inline=True)
def _lowest_of_four(
    lowest: Floats, offset: int, coords: Floats, width: int, planes: Floats, b: int, v: float
) -> None:
    """Set `lowest` to the smallest of four affine functions c + b v + a u, rows b.. of `planes`.

    From the second four on (b > 0) what is there already counts too.
    """
    c0, a0 = planes[b, 0] + planes[b, 1] * v, planes[b, 2]
    c1, a1 = planes[b + 1, 0] + planes[b + 1, 1] * v, planes[b + 1, 2]
    c2, a2 = planes[b + 2, 0] + planes[b + 2, 1] * v, planes[b + 2, 2]
    c3, a3 = planes[b + 3, 0] + planes[b + 3, 1] * v, planes[b + 3, 2]
    if b == 0:
        for i in range(np.uint64(width)):
            u = coords[i]
            p = min(c0 + a0 * u, c1 + a1 * u)
            q = min(c2 + a2 * u, c3 + a3 * u)
            lowest[np.uint64(offset) + i] = min(p, q)
    else:
        for i in range(np.uint64(width)):
            u = coords[i]
            p = min(c0 + a0 * u, c1 + a1 * u)
            q = min(c2 + a2 * u, c3 + a3 * u)
            at = np.uint64(offset) + i
            lowest[at] = min(lowest[at], min(p, q))


@njit()
def _arcsine(lowest: Floats, inverse_length: Floats, out: Singles) -> None:
    """Last pass: out = asin(lowest * inverse_length), to 3e-7 of the result.

    The polynomial is that of Cephes' asinf; above 1/2 the argument is halved first, in float64,
    because 1 - x loses its digits in float32.
    """
    for i in range(out.shape[0]):
        x = lowest[i] * inverse_length[i]
        size = abs(x)
        steep = size > 0.5
        z = np.float32(0.5 * (1.0 - size) if steep else size * size)
        z = max(z, np.float32(0.0))
        s = math.sqrt(z) if steep else np.float32(size)
        p = np.float32(4.2163199048e-2)
        p = p * z + np.float32(2.4181311049e-2)
        p = p * z + np.float32(4.5470025998e-2)
        p = p * z + np.float32(7.4953002686e-2)
        p = p * z + np.float32(1.6666752422e-1)
        angle = p * z * s + s
        angle = np.float32(HALF_PI) - np.float32(2.0) * angle if steep else angle
        out[i] = math.copysign(angle, np.float32(x))


@njit()
def tip_rows(
    region: Region,
    basis: Floats,
    coords: Floats,
    nodes: int,
    first_row: int,
    rows: int,
    planes: Floats,
    lowest: Floats,
    inverse: Floats,
    out: Singles,
) -> None:
    """Fill `out` with the tip angle of a convex region on rows of one face."""
    corner, along, aside = row(basis, 0), row(basis, 1), row(basis, 2)
    segment, count = region.segment, region.tally[SEGMENTS]
    padded = (count + 3) // 4 * 4
    for b in range(padded):
        # The last plane is repeated to make up whole fours.
        plane = vector_at(segment, min(b, count - 1), TIP_PLANE)
        planes[b, 0], planes[b, 1] = dot(plane, corner), dot(plane, aside)
        planes[b, 2] = dot(plane, along)
    width = (nodes + VECTOR - 1) // VECTOR * VECTOR
    for r in range(rows):
        # The last vector of a row runs into the next one, which is set after it.
        for b in range(0, padded, 4):
            _lowest_of_four(lowest, r * nodes, coords, width, planes, b, coords[first_row + r])
    _arcsine(lowest[: rows * nodes], inverse, out)


@njit()
def agree_in_sign(out: Singles, span: Ints, nodes: int, rows: int) -> None:
    """Give the tip angle the sign that the drawn interval of each row says.

    Both come from the same planes, but a node within rounding of a boundary may fall on either
    side; the verdict and the NaN of |SD_g| must be one.
    """
    outside = np.float32(JUST_OUTSIDE)
    for r in range(rows):
        begin, end = span[r, 0], span[r, 1]
        line = out[r * nodes : (r + 1) * nodes]
        if begin >= end:
            for i in range(nodes):
                line[i] = min(line[i], outside)
            continue
        for i in range(max(begin - 1, 0), min(end + 1, nodes)):
            if begin <= i < end:
                line[i] = max(line[i], np.float32(0.0))
            else:
                line[i] = min(line[i], outside)
