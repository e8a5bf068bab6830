"""Rows of a map: the channels of one posture along lines of constant v, in float32.

Owns the fast path of a sweep.  On a gnomonic face the cone of a facet is a polygon with straight
edges, and along a row of constant v every quantity a . g is A + B u.  So the facets are drawn onto
the face one after the other, as a graphics card draws triangles, and what is left are loops
without a branch.  `channels.measure` defines the numbers; this file only computes them quickly,
in float64 up to the last square root and division.
"""

import math

import numpy as np

from lutgen.jit import njit, prange
from lutgen.region import (
    ACROSS,
    CONVEX,
    EDGE_KIND,
    FACETS,
    FIRST_AXIS,
    GAPS,
    HEIGHT,
    PLANE,
    POINT,
    SECOND_AXIS,
    SEGMENTS,
    TIP,
    TIP_PLANE,
    WALL,
    empty_region,
    find_region,
    vector_at,
)
from lutgen.channels import JUST_OUTSIDE, measure, tip_angle
from lutgen.rounds import find_facets
from lutgen.support import FIRST, facet_table, robot_size
from lutgen.vector import dot, row

# Rows are gathered into a band of about this many nodes, which stays in the first-level cache
# between its passes.
BAND = 4096
# Loops over an interval run over whole vectors of this many nodes; a mask keeps the rest.
VECTOR = 16
# Below this many directions, setting up a face costs more than it saves.
FEW_DIRECTIONS = 16
HALF_PI = math.pi / 2.0
# Ties of two facets go to the lower index, see `region.supporting_facet`.
TIE = 1.0 + 1e-12


@njit()
def _edge_lines(plate, first, edge, link, k, corner, aside, along, origin, per_step, lines) -> int:
    """Fill a row of `lines` for every edge of facet k on one face; return their number.

    Columns: c, b, a of the affine function c + b v + a u that is >= 0 on the facet's side; the
    place of its root counted in nodes, as constant and factor of v; 1 where the root itself
    belongs to the facet beyond.  `corner`, `aside`, `along` are the middle of the face and its v
    and u axes.  A tip-over axis counts with its plane; towards a facet beyond, the edge is where
    the two planes are pierced at once, so two neighbours never leave a node between them.
    """
    count = 0
    for e in range(first[k, FIRST], first[k + 1, FIRST]):
        beyond_wins = 0.0
        if link[e, EDGE_KIND] == TIP:
            plane = vector_at(edge, e, WALL)
        else:
            other = link[e, ACROSS]
            mine, theirs = (TIE, 1.0) if k < other else (1.0, TIE)
            beyond_wins = 1.0 if other < k else 0.0
            plane = (
                mine * plate[k, PLANE + 0] - theirs * plate[other, PLANE + 0],
                mine * plate[k, PLANE + 1] - theirs * plate[other, PLANE + 1],
                mine * plate[k, PLANE + 2] - theirs * plate[other, PLANE + 2],
            )
        level, tilt, slope = dot(plane, corner), dot(plane, aside), dot(plane, along)
        scaled = -per_step / slope if slope != 0.0 else 0.0
        lines[count, 0], lines[count, 1], lines[count, 2] = level, tilt, slope
        lines[count, 3] = level * scaled - origin * per_step
        lines[count, 4] = tilt * scaled
        lines[count, 5] = beyond_wins
        count += 1
    return count


@njit(inline=True)
def _interval(lines, count, coords, nodes, v):
    """Return the nodes [begin, end) of the row at v that pass every edge."""
    begin, end = 0.0, float(nodes)
    for e in range(count):
        slope = lines[e, 2]
        place = lines[e, 3] + lines[e, 4] * v
        nearest = math.floor(place + 0.5)
        node = nearest if place <= nearest else nearest + 1.0
        if abs(place - nearest) < 1e-6 or slope == 0.0:
            # The root is at a node but for rounding, or there is none: the sign decides.
            at = int(min(max(nearest, 0.0), nodes - 1.0))
            value = lines[e, 0] + lines[e, 1] * v + slope * coords[at]
            passed = value > 0.0 or (value == 0.0 and lines[e, 5] == 0.0)
            if slope == 0.0:
                if not passed:
                    end = 0.0
                continue
            if 0.0 <= nearest < nodes:
                node = nearest if passed == (slope > 0.0) else nearest + 1.0
        if slope > 0.0:
            begin = max(begin, node)
        else:
            end = min(end, node)
    return int(min(begin, nodes)), int(max(end, 0.0))


@njit()
def _rows_of_facet(first, edge, k, corner, aside, along, limit):
    """Return the span of v that facet k can have on a face, empty (1, 0) if it has none."""
    lowest, highest = math.inf, -math.inf
    beyond = np.int64(15)
    behind = False
    for e in range(first[k, FIRST], first[k + 1, FIRST]):
        point = vector_at(edge, e, POINT)
        depth = dot(point, corner)
        v = dot(point, aside)
        u = dot(point, along)
        sides = np.int64(0)
        if u < -limit * depth:
            sides |= 1
        if u > limit * depth:
            sides |= 2
        if v < -limit * depth:
            sides |= 4
        if v > limit * depth:
            sides |= 8
        # A corner outside one side of the face's pyramid; if all are outside the same, no row.
        beyond &= sides
        if depth <= 1e-9 * (abs(u) + abs(v)):
            behind = True
        else:
            lowest, highest = min(lowest, v / depth), max(highest, v / depth)
    if beyond != 0:
        return 1.0, 0.0
    if behind:
        return -limit, limit
    return lowest, highest


@njit(inline=True)
def _factor_terms(
    squared, rate, offset, coords, start, stop, u_from, u_to, a1, b1, a2, b2, a0, b0
) -> None:
    """Set the terms of |SD_g| between two values of u, and leave the rest of the vectors alone.

    Unsigned indices: numba does not look for negative ones, and the loop becomes vectors.
    """
    for i in range(np.uint64(start), np.uint64(stop)):
        u = coords[i]
        along = a1 + b1 * u
        aside = a2 + b2 * u
        inside = (u >= u_from) & (u <= u_to)
        at = np.uint64(offset) + i
        squared[at] = np.float32(along * along + aside * aside) if inside else squared[at]
        rate[at] = np.float32(a0 + b0 * u) if inside else rate[at]


@njit()
def _stability_factor(squared, rate, out) -> None:
    """Last pass: |SD_g| = sqrt((w1.g)^2 + (w2.g)^2) / (a.g)."""
    for i in range(out.shape[0]):
        out[i] = math.sqrt(squared[i]) / rate[i]


@njit(inline=True)
def _lowest_of_four(lowest, offset, coords, width, planes, b, v) -> None:
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
def _arcsine(lowest, inverse_length, out) -> None:
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
def _draw_facets(region, basis, coords, nodes, first_row, rows, lines, span, squared, rate, out_k):
    """Draw all facets onto rows of one face: fill the |SD_g| terms and, if asked, the facet index.

    `squared` and `rate` receive the terms, NaN where no facet is; `span` (rows, 2) the first and
    last standing node of each row; `out_k` (rows * nodes,) the facet or is empty.
    """
    plate, first, edge, link = region.plate, region.span, region.edge, region.link
    corner, along, aside = row(basis, 0), row(basis, 1), row(basis, 2)
    squared[: rows * nodes] = np.float32(np.nan)
    for r in range(rows):
        span[r, 0] = nodes
        span[r, 1] = 0
    drawn = False
    limit = coords[nodes - 1]
    step = coords[1] - coords[0]
    # Descending, so that the lower index has the last word wherever two overlap.
    for k in range(region.count[FACETS] - 1, -1, -1):
        lowest, highest = _rows_of_facet(first, edge, k, corner, aside, along, limit)
        if lowest > highest:
            continue
        begin_row = max(int(math.floor((max(lowest, -limit) - coords[0]) / step)) - first_row, 0)
        end_row = min(int(math.ceil((min(highest, limit) - coords[0]) / step)) + 1 - first_row, rows)
        if begin_row >= end_row:
            continue
        edges = _edge_lines(
            plate, first, edge, link, k, corner, aside, along, coords[0], 1.0 / step, lines
        )
        plane = vector_at(plate, k, PLANE)
        w1, w2 = vector_at(plate, k, FIRST_AXIS), vector_at(plate, k, SECOND_AXIS)
        c0, b0, a0 = dot(plane, corner), dot(plane, aside), dot(plane, along)
        c1, b1, a1 = dot(w1, corner), dot(w1, aside), dot(w1, along)
        c2, b2, a2 = dot(w2, corner), dot(w2, aside), dot(w2, along)
        for r in range(begin_row, end_row):
            v = coords[first_row + r]
            begin, end = _interval(lines, edges, coords, nodes, v)
            if begin >= end:
                continue
            drawn = True
            span[r, 0] = min(span[r, 0], begin)
            span[r, 1] = max(span[r, 1], end)
            start = begin // VECTOR * VECTOR
            stop = (end + VECTOR - 1) // VECTOR * VECTOR
            _factor_terms(
                *(squared, rate, r * nodes, coords, start, stop, coords[begin], coords[end - 1]),
                *(c1 + b1 * v, a1, c2 + b2 * v, a2, c0 + b0 * v, a0),
            )
            if out_k.shape[0] > 0:
                for i in range(r * nodes + begin, r * nodes + end):
                    out_k[i] = k
    return drawn


@njit()
def _tip_rows(region, basis, coords, nodes, first_row, rows, planes, lowest, inverse, out) -> None:
    """Fill `out` with the tip angle of a convex region on rows of one face."""
    corner, along, aside = row(basis, 0), row(basis, 1), row(basis, 2)
    segment, count = region.segment, region.count[SEGMENTS]
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
def _agree_in_sign(out, span, nodes, rows) -> None:
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


@njit()
def _node_direction(basis, u, v):
    size = 1.0 / math.sqrt(1.0 + u * u + v * v)
    return (
        (basis[0, 0] + u * basis[1, 0] + v * basis[2, 0]) * size,
        (basis[0, 1] + u * basis[1, 1] + v * basis[2, 1]) * size,
        (basis[0, 2] + u * basis[1, 2] + v * basis[2, 2]) * size,
    )


@njit()
def _each_node(region, basis, coords, nodes, first_row, rows, wanted, values, out) -> None:
    """Fill the wanted channels of rows of one face node by node, for any region."""
    for r in range(rows):
        v = coords[first_row + r]
        for i in range(nodes):
            measure(region, _node_direction(basis, coords[i], v), wanted, values)
            for c in range(6):
                if wanted[c]:
                    out[c, r * nodes + i] = np.float32(values[c])


@njit()
def _tip_each_node(region, basis, coords, nodes, first_row, rows, squared, out) -> None:
    """Fill the tip angle node by node; the drawn terms tell which nodes stand."""
    count, segment = region.count, region.segment
    for r in range(rows):
        v = coords[first_row + r]
        for i in range(nodes):
            standing = squared[r * nodes + i] == squared[r * nodes + i]
            g = _node_direction(basis, coords[i], v)
            out[r * nodes + i] = np.float32(tip_angle(count, segment, standing, g))


@njit(parallel=True)
def scan(
    shapes, limit, basis, coords, inverse_length, first, last, wanted, parts, out
):
    """Fill the channels of a block of postures over a range of rows.

    Parameters
    ----------
    shapes : (m, n, 8) float64
        Primitives of every posture, relative to the com, rows of `primitive.pack`.
    limit : tuple
        See `region.limits`.
    basis : (faces, 3, 3) float64
        Per face its middle, its u axis and its v axis (see `sphere.Chart.basis`).
    coords : (nodes + VECTOR,) float64
        Values of u and v at the nodes, and infinity for padding (never inside an interval).
    inverse_length : (nodes * nodes,) float64
        1 / sqrt(1 + u^2 + v^2) of the nodes of a face.
    first, last : int
        Rows [first, last) of the faces * nodes rows of a posture.
    wanted : (6,) bool
        Channels to fill, in the order of `channels.CHANNELS`.
    parts : int
        How many parts the work is cut into; the values do not depend on it.
    out : (6, m * (last - first) * nodes) float32
        Filled where wanted.

    Returns
    -------
    int
        Number of postures with more facets than a table holds; 0 unless spheres overlap oddly.
    """
    nodes = coords.shape[0] - VECTOR
    per_posture = last - first
    total = shapes.shape[0] * per_posture
    n = shapes.shape[1]
    overflow = np.zeros(parts, np.int64)
    for part in prange(parts):
        begin, end = part * total // parts, (part + 1) * total // parts
        table, region = facet_table(n), empty_region(n)
        values = np.empty(6)
        lines = np.empty((table.link.shape[0], 6))
        planes = np.empty((region.segment.shape[0] + 4, 3))
        band_rows = max(BAND // nodes, 1)
        squared = np.empty(band_rows * nodes + VECTOR, np.float32)
        rate = np.empty(band_rows * nodes + VECTOR, np.float32)
        lowest = np.empty(band_rows * nodes + VECTOR)
        span = np.empty((band_rows, 2), np.int64)
        facet_band = np.empty(band_rows * nodes if wanted[1] or wanted[5] else 0, np.int64)
        current = -1
        at = begin
        while at < end:
            posture = at // per_posture
            if posture != current:
                current = posture
                find_facets(table, shapes[posture], limit[2])
                find_region(region, table, limit, robot_size(shapes[posture]))
                overflow[part] += table.count[1]
            line = first + at - posture * per_posture
            face, first_row = line // nodes, line % nodes
            rows = min(band_rows, nodes - first_row, end - at, (posture + 1) * per_posture - at)
            span_out = slice(at * nodes, (at + rows) * nodes)
            at += rows
            frame = basis[face]
            simple = not (wanted[3] or wanted[4]) and region.count[GAPS] == 0
            if not simple or per_posture * nodes < FEW_DIRECTIONS:
                _each_node(
                    region, frame, coords, nodes, first_row, rows, wanted, values, out[:, span_out]
                )
                continue
            drawn = _draw_facets(
                region,
                frame,
                coords,
                nodes,
                first_row,
                rows,
                lines,
                span,
                squared,
                rate,
                facet_band,
            )
            count = rows * nodes
            if wanted[0]:
                target = out[0, span_out]
                if drawn:
                    _stability_factor(squared[:count], rate[:count], target)
                else:
                    target[:] = np.float32(np.nan)
            if wanted[1] or wanted[5]:
                for i in range(count):
                    standing = squared[i] == squared[i]
                    k = facet_band[i] if standing else 0
                    if wanted[1]:
                        high = np.float32(region.plate[k, HEIGHT]) if standing else np.float32(np.nan)
                        out[1, span_out.start + i] = high
                    if wanted[5]:
                        out[5, span_out.start + i] = np.float32(k) if standing else np.float32(-1)
            if wanted[2]:
                target = out[2, span_out]
                if region.count[FACETS] == 0:
                    target[:] = np.float32(-math.pi)
                elif region.count[SEGMENTS] == 0:
                    target[:] = np.float32(math.pi)
                elif region.count[CONVEX] == 1:
                    inverse = inverse_length[first_row * nodes : (first_row + rows) * nodes]
                    _tip_rows(
                        region, frame, coords, nodes, first_row, rows, planes, lowest, inverse, target
                    )
                    _agree_in_sign(target, span, nodes, rows)
                else:
                    _tip_each_node(
                        region, frame, coords, nodes, first_row, rows, squared, target
                    )
    return overflow.sum()
