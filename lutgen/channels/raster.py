"""Facets drawn onto a face of the gravity chart, row by row.

Owns the fast path to |SD_g|.  On a gnomonic face the cone of a facet is a polygon with straight
edges, and along a row of constant v every quantity a . g is A + B u.  So the facets are drawn one
after the other, as a graphics card draws triangles, and what is left are loops without a branch.
`plain.measure` defines the numbers; this file only computes them quickly, in float64 up to the
last square root and division.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support import (
    ON_AXIS,
    Region,
    across,
    edge_plane_at,
    edges_at,
    facets_in,
    first_axis_at,
    is_shared,
    plane_at,
    point_at,
    second_axis_at,
)
from lutgen.vector import Floats, Singles, Vector, dot, row

# Loops over an interval run over whole vectors of this many nodes; a mask keeps the rest.
VECTOR = 16
# Within this part of a step from a node, rounding could say either side of an edge.
IN_DOUBT = 1e-6
# Below this part of its terms a slope is rounding: the edge is parallel to the rows.  So the place
# of a root is at most 1e14 times the inverse of a step, which an int64 holds.
PARALLEL = 1e-14
# Ties of two facets go to the lower index, see `region.supporting_facet`.
TIE = 1.0 + 1e-12
LEAST_POSITIVE = 1e-300


class Rows(NamedTuple):
    """Some rows of one face.

    `basis` (3, 3): middle of the face, its u axis and its v axis; `coords` (nodes + VECTOR,):
    values of u and v at the nodes, then infinity; `nodes` in a row; the `first` row, and how many
    are `held`; `inverse` (held * nodes,): 1 / |(u, v, 1)|.
    """

    basis: NDArray[np.float64]
    coords: NDArray[np.float64]
    nodes: int
    first: int
    held: int
    inverse: NDArray[np.float64]


class Drawing(NamedTuple):
    """What `draw_facets` fills, for as many rows as it has room for.

    `squared` and `rate` (rows * nodes + VECTOR,): the terms of |SD_g|, NaN where no facet is;
    `span` (rows, 2): first and last standing node of each row; `facet` (rows * nodes,): the facet,
    or empty where nobody asks.  `lines` (e, 6) and `room` (3, rows) are room to work in.
    """

    squared: NDArray[np.float32]
    rate: NDArray[np.float32]
    span: NDArray[np.int64]
    facet: NDArray[np.int64]
    lines: NDArray[np.float64]
    room: NDArray[np.float64]


@njit(inline=True)
def _edge_lines(region: Region, rows: Rows, k: int, lines: Floats) -> int:
    """Fill a row of `lines` for every edge of facet k on one face; return their number.

    Columns: c, b, a of the affine function c + b v + a u that is >= 0 on the facet's side; the
    place of its root counted in nodes, as constant and factor of v; from which value on a node at
    the root belongs to the facet.  A tip-over axis counts with its plane; towards a facet beyond,
    the edge is where the two planes are pierced at once, so two neighbours never leave a node
    between them.
    """
    facet, first, edge, link = region.facet, region.span, region.edge, region.link
    corner, along, aside = row(rows.basis, 0), row(rows.basis, 1), row(rows.basis, 2)
    origin, per_step = rows.coords[0], 1.0 / (rows.coords[1] - rows.coords[0])
    count = 0
    for e in range(*edges_at(first, k)):
        least = 0.0
        if not is_shared(link, e):
            plane = edge_plane_at(edge, e)
            least = -ON_AXIS
        else:
            other = across(link, e)
            mine, theirs = (TIE, 1.0) if k < other else (1.0, TIE)
            least = LEAST_POSITIVE if other < k else 0.0
            here, there = plane_at(facet, k), plane_at(facet, other)
            plane = (
                mine * here[0] - theirs * there[0],
                mine * here[1] - theirs * there[1],
                mine * here[2] - theirs * there[2],
            )
        level, tilt, slope = dot(plane, corner), dot(plane, aside), dot(plane, along)
        if abs(slope) < PARALLEL * (abs(level) + abs(tilt)):
            slope = 0.0
        scaled = -per_step / slope if slope != 0.0 else 0.0
        lines[count, 0], lines[count, 1], lines[count, 2] = level, tilt, slope
        lines[count, 3] = level * scaled - origin * per_step
        lines[count, 4] = tilt * scaled
        lines[count, 5] = least
        count += 1
    return count


@njit(inline=True)
def _interval(lines: Floats, count: int, coords: Floats, nodes: int, v: float) -> tuple[int, int]:
    """Return the nodes [begin, end) of the row at v that pass every edge."""
    begin, end = 0.0, float(nodes)
    for e in range(count):
        slope = lines[e, 2]
        place = lines[e, 3] + lines[e, 4] * v
        nearest = math.floor(place + 0.5)
        node = nearest if place <= nearest else nearest + 1.0
        if abs(place - nearest) < IN_DOUBT or slope == 0.0:
            # The root is at a node but for rounding, or there is none: the sign decides.
            at = int(min(max(nearest, 0.0), nodes - 1.0))
            value = lines[e, 0] + lines[e, 1] * v + slope * coords[at]
            passed = value >= lines[e, 5]
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


@njit(inline=True)
def _rows_of_facet(region: Region, rows: Rows, k: int) -> tuple[float, float]:
    """Return the span of v that facet k can have on a face, empty (1, 0) if it has none."""
    first, edge = region.span, region.edge
    corner, along, aside = row(rows.basis, 0), row(rows.basis, 1), row(rows.basis, 2)
    limit = rows.coords[rows.nodes - 1]
    lowest, highest = math.inf, -math.inf
    beyond = np.int64(15)
    behind = False
    for e in range(*edges_at(first, k)):
        point = point_at(edge, e)
        depth = dot(point, corner)
        v = dot(point, aside)
        u = dot(point, along)
        sides = np.int64(0)
        # The last row may belong to this facet by the tie rule though it lies just beyond it.
        slack = 1e-9 * (abs(depth) + abs(u) + abs(v))
        if u < -limit * depth - slack:
            sides |= 1
        if u > limit * depth + slack:
            sides |= 2
        if v < -limit * depth - slack:
            sides |= 4
        if v > limit * depth + slack:
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
    squared: Singles,
    rate: Singles,
    offset: int,
    coords: Floats,
    interval: tuple[int, int],
    level: Vector,
    slope: Vector,
) -> None:
    """Set the terms of |SD_g| on nodes [begin, end) of a row, and leave the rest of vectors alone.

    `level` and `slope` give w1.g, w2.g and a.g as functions of u.
    Unsigned indices: numba does not look for negative ones, and the loop becomes vectors.
    """
    begin, end = interval
    start, stop = begin // VECTOR * VECTOR, (end + VECTOR - 1) // VECTOR * VECTOR
    u_from, u_to = coords[begin], coords[end - 1]
    a1, a2, a0 = level
    b1, b2, b0 = slope
    for i in range(np.uint64(start), np.uint64(stop)):
        u = coords[i]
        along = a1 + b1 * u
        aside = a2 + b2 * u
        inside = (u >= u_from) & (u <= u_to)
        at = np.uint64(offset) + i
        squared[at] = np.float32(along * along + aside * aside) if inside else squared[at]
        rate[at] = np.float32(a0 + b0 * u) if inside else rate[at]


@njit()
def stability_factor(squared: Singles, rate: Singles, out: Singles) -> None:
    """Last pass: |SD_g| = sqrt((w1.g)^2 + (w2.g)^2) / (a.g)."""
    for i in range(out.shape[0]):
        out[i] = math.sqrt(squared[i]) / rate[i]


@njit(inline=True)
def _all_intervals(
    lines: Floats, count: int, rows: Rows, begin_row: int, end_row: int, room: Floats
) -> None:
    """Fill the first node and the one after the last for rows of one facet, many rows at a time.

    The third row of `room` receives the least distance of a root from a node, counted in nodes:
    where it is below `IN_DOUBT` the row must be asked for with `_interval`.
    """
    begins, ends, doubt = room[0], room[1], room[2]
    coords, first_row = rows.coords, rows.first
    for r in range(np.uint64(begin_row), np.uint64(end_row)):
        begins[r] = 0.0
        ends[r] = rows.nodes
        doubt[r] = 1.0
    for e in range(count):
        slope, origin, tilt = lines[e, 2], lines[e, 3], lines[e, 4]
        for r in range(np.uint64(begin_row), np.uint64(end_row)):
            place = origin + tilt * coords[np.uint64(first_row) + r]
            nearest = math.floor(place + 0.5)
            node = nearest if place <= nearest else nearest + 1.0
            begins[r] = max(begins[r], node) if slope > 0.0 else begins[r]
            ends[r] = min(ends[r], node) if slope < 0.0 else ends[r]
            doubt[r] = min(doubt[r], abs(place - nearest)) if slope != 0.0 else 0.0


@njit(inline=True)
def draw_facets(region: Region, rows: Rows, drawing: Drawing) -> bool:
    """Draw all facets onto rows of one face; tell whether there were any."""
    squared, rate, span, lines = drawing.squared, drawing.rate, drawing.span, drawing.lines
    basis, coords, nodes = rows.basis, rows.coords, rows.nodes
    facet = region.facet
    corner, along, aside = row(basis, 0), row(basis, 1), row(basis, 2)
    begins, ends, doubt = drawing.room[0], drawing.room[1], drawing.room[2]
    squared[: rows.held * nodes] = np.float32(np.nan)
    for r in range(rows.held):
        span[r, 0] = nodes
        span[r, 1] = 0
    drawn = False
    limit = coords[nodes - 1]
    step = coords[1] - coords[0]
    # Descending, so that the lower index has the last word wherever two overlap.
    for k in range(facets_in(region.tally) - 1, -1, -1):
        lowest, highest = _rows_of_facet(region, rows, k)
        if lowest > highest:
            continue
        begin_row = max(math.floor((max(lowest, -limit) - coords[0]) / step) - rows.first, 0)
        end_row = math.ceil((min(highest, limit) - coords[0]) / step) + 1 - rows.first
        end_row = min(end_row, rows.held)
        if begin_row >= end_row:
            continue
        edges = _edge_lines(region, rows, k, lines)
        plane = plane_at(facet, k)
        w1, w2 = first_axis_at(facet, k), second_axis_at(facet, k)
        c0, b0, a0 = dot(plane, corner), dot(plane, aside), dot(plane, along)
        c1, b1, a1 = dot(w1, corner), dot(w1, aside), dot(w1, along)
        c2, b2, a2 = dot(w2, corner), dot(w2, aside), dot(w2, along)
        _all_intervals(lines, edges, rows, begin_row, end_row, drawing.room)
        for r in range(begin_row, end_row):
            v = coords[rows.first + r]
            if doubt[r] < IN_DOUBT:
                begin, end = _interval(lines, edges, coords, nodes, v)
            else:
                begin, end = int(min(begins[r], nodes)), int(max(ends[r], 0.0))
            if begin >= end:
                continue
            drawn = True
            span[r, 0] = min(span[r, 0], begin)
            span[r, 1] = max(span[r, 1], end)
            level = (c1 + b1 * v, c2 + b2 * v, c0 + b0 * v)
            _factor_terms(
                *(squared, rate, r * nodes, coords, (begin, end), level, (a1, a2, a0)),
            )
            if drawing.facet.shape[0] > 0:
                for i in range(r * nodes + begin, r * nodes + end):
                    drawing.facet[i] = k
    return drawn
