"""Tip angles along the rows of a face.

Owns the fast path to `tip_angle`: along a row the sine of the angle to each tip-over plane, or the
cosine of that to the end of an arc, is an affine function of u over the length of (u, v, 1), so a
few lines and one or two arcsines per node are all there is to compute.
"""

import math

import numpy as np

from lutgen.channels.angles import JUST_OUTSIDE
from lutgen.channels.raster import VECTOR, Rows
from lutgen.jit import njit
from lutgen.support import Region, segments_in, start_at, stop_at, tip_plane_at
from lutgen.vector import Floats, Ints, Singles, cross, dot, row, unit

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


@njit(inline=True)
def _arcsine(x: float) -> np.float32:
    """Return asin(x) to 3e-7 of the result, without a branch.

    The polynomial is that of Cephes' asinf; above 1/2 the argument is halved first, in float64,
    because 1 - x loses its digits in float32.
    """
    size = abs(x)
    steep = size > 0.5
    z = np.float32(max(0.5 * (1.0 - size), 0.0) if steep else size * size)
    s = math.sqrt(z) if steep else np.float32(size)
    p = np.float32(4.2163199048e-2)
    p = p * z + np.float32(2.4181311049e-2)
    p = p * z + np.float32(4.5470025998e-2)
    p = p * z + np.float32(7.4953002686e-2)
    p = p * z + np.float32(1.6666752422e-1)
    angle = p * z * s + s
    angle = np.float32(HALF_PI) - np.float32(2.0) * angle if steep else angle
    return np.float32(math.copysign(angle, np.float32(x)))


@njit()
def _arcsines(sine: Floats, inverse_length: Floats, out: Singles) -> None:
    """Last pass of a convex region: out = asin(sine * inverse_length)."""
    for i in range(out.shape[0]):
        out[i] = _arcsine(sine[i] * inverse_length[i])


@njit()
def tip_rows(region: Region, rows: Rows, planes: Floats, lowest: Floats, out: Singles) -> None:
    """Fill `out` with the tip angle of a convex region on rows of one face."""
    coords, nodes = rows.coords, rows.nodes
    corner, along, aside = row(rows.basis, 0), row(rows.basis, 1), row(rows.basis, 2)
    segment, count = region.segment, segments_in(region.tally)
    padded = (count + 3) // 4 * 4
    for b in range(padded):
        # The last plane is repeated to make up whole fours.
        plane = tip_plane_at(segment, min(b, count - 1))
        planes[b, 0], planes[b, 1] = dot(plane, corner), dot(plane, aside)
        planes[b, 2] = dot(plane, along)
    width = (nodes + VECTOR - 1) // VECTOR * VECTOR
    for r in range(rows.held):
        # The last vector of a row runs into the next one, which is set after it.
        for b in range(0, padded, 4):
            _lowest_of_four(lowest, r * nodes, coords, width, planes, b, coords[rows.first + r])
    _arcsines(lowest[: rows.held * nodes], rows.inverse, out)


@njit(inline=True)
def _nearest_arc(
    sine: Floats, cosine: Floats, offset: int, rows: Rows, arc: Floats, v: float
) -> None:
    """Lower `sine` and raise `cosine` by one boundary arc, along a row.

    `arc` (5, 3) holds c, b, a of five affine functions: the arc's plane, the two planes that bound
    the directions nearest to the arc's inside, and its two ends.  Where a direction is nearest to
    the inside, the sine of its distance counts; elsewhere the cosine of that to the nearer end.
    """
    s0, s1 = arc[0, 0] + arc[0, 1] * v, arc[0, 2]
    f0, f1 = arc[1, 0] + arc[1, 1] * v, arc[1, 2]
    t0, t1 = arc[2, 0] + arc[2, 1] * v, arc[2, 2]
    p0, p1 = arc[3, 0] + arc[3, 1] * v, arc[3, 2]
    q0, q1 = arc[4, 0] + arc[4, 1] * v, arc[4, 2]
    coords, inverse = rows.coords, rows.inverse
    for i in range(np.uint64(rows.nodes)):
        u = coords[i]
        at = np.uint64(offset) + i
        within = (f0 + f1 * u >= 0.0) & (t0 + t1 * u >= 0.0)
        beside = abs(s0 + s1 * u) * inverse[at]
        end = max(p0 + p1 * u, q0 + q1 * u) * inverse[at]
        sine[at] = min(sine[at], beside) if within else sine[at]
        cosine[at] = cosine[at] if within else max(cosine[at], end)


@njit()
def arc_rows(
    region: Region, rows: Rows, squared: Singles, sine: Floats, cosine: Floats, out: Singles
) -> None:
    """Fill `out` with the tip angle of a region that is not convex, on rows of one face.

    `sine` and `cosine` (rows * nodes,) are room to work in, and `squared` is NaN where the robot
    does not stand.
    """
    segment = region.segment
    corner, along, aside = row(rows.basis, 0), row(rows.basis, 1), row(rows.basis, 2)
    count = rows.held * rows.nodes
    # No arc has been near yet: larger than any sine.
    sine[:count] = 2.0
    cosine[:count] = -1.0
    arc = np.empty((5, 3))
    for b in range(segments_in(region.tally)):
        plane = tip_plane_at(segment, b)
        start, stop = unit(start_at(segment, b)), unit(stop_at(segment, b))
        for place, vector in enumerate(
            (plane, cross(plane, start), cross(stop, plane), start, stop)
        ):
            arc[place, 0], arc[place, 1] = dot(vector, corner), dot(vector, aside)
            arc[place, 2] = dot(vector, along)
        for r in range(rows.held):
            _nearest_arc(sine, cosine, r * rows.nodes, rows, arc, rows.coords[rows.first + r])
    outside = np.float32(JUST_OUTSIDE)
    for i in range(count):
        beside = _arcsine(sine[i]) if sine[i] <= 1.0 else np.float32(math.pi)
        # Half the chord to an end is the sine of half the angle.
        half = math.sqrt(max(0.5 - 0.5 * cosine[i], 0.0))
        angle = min(beside, np.float32(2.0) * _arcsine(half))
        standing = squared[i] == squared[i]
        out[i] = angle if standing else min(-angle, outside)


@njit()
def agree_in_sign(out: Singles, span: Ints, nodes: int, rows: int) -> None:
    """Give the tip angle the sign that the drawn interval of each row says.

    Both come from the same planes, but a node within rounding of a boundary may fall on either
    side; the verdict and the NaN of |SD_g| must be one.
    """
    outside, boundary = np.float32(JUST_OUTSIDE), np.float32(0.0)
    for r in range(rows):
        begin, end = span[r, 0], max(span[r, 0], span[r, 1])
        line = out[r * nodes : (r + 1) * nodes]
        # The whole row: a boundary may run along it, within rounding of every node.
        for i in range(begin):
            line[i] = min(line[i], outside)
        for i in range(begin, end):
            line[i] = max(line[i], boundary)
        for i in range(end, nodes):
            line[i] = min(line[i], outside)
