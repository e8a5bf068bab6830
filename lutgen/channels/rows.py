"""Channels over rows of nodes of a gnomonic face, in float32: the speed of a sweep.

On such a face a plane through the com is a straight line, and along a row every product with g is
an affine function of u.  So a cone covers one interval of each row, found by division; nodes that
are too near to its ends for that are computed as in `region.cone_of`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Bools, Floats, Singles, Vector
from lutgen.channels.exact import (
    FACET,
    HEIGHT,
    JUST_OUTSIDE,
    SDG,
    STATUS,
    TIP,
    angle_of,
    arc_nearness,
)
from lutgen.chart import Chart
from lutgen.jit import njit
from lutgen.support import ON_AXIS, TIPS, Region
from lutgen.vector import dot, read3, row, write3

# A wall whose slope along a row is less than this runs along it; rows nearer to it than WITHIN are
# computed node by node.
PARALLEL, WITHIN = 1e-5, 1e-3
# A wall that passes a node within this part of a step is decided by its sign there.
DOUBT = 1e-6
# Nodes of padding, so that loops along a row run over whole vectors.
PAD = 8
# Rows and columns of a tile, for which near arcs are told from far ones.
TALL, WIDE = 16, 16


class Nodes(NamedTuple):
    """The nodes of a chart, as kernels read them.

    `basis` (faces, 3, 3): per face its middle, its u axis and its v axis (see `chart.Chart.basis`);
    `coords` (nodes + PAD,): u and v of the nodes, then the last one again; `inverse` (nodes,
    nodes): 1 / |(u, v, 1)| by v and u.
    """

    basis: NDArray[np.float64]
    coords: NDArray[np.float64]
    inverse: NDArray[np.float64]


class Rows(NamedTuple):
    """Rows `first` to `first` + `size` - 1 of one face, and where their nodes begin in a block."""

    face: int
    first: int
    size: int
    at: int


class Scratch(NamedTuple):
    """Scratch memory: functions on a face, arcs near a tile, intervals and numbers of rows."""

    line: NDArray[np.float64]
    near: NDArray[np.int64]
    span: NDArray[np.float64]
    low: NDArray[np.float64]


def nodes_of(chart: Chart) -> Nodes:
    """Return the nodes of a chart."""
    coords = np.concatenate([chart.coords, np.full(PAD, chart.coords[-1])])
    v, u = np.meshgrid(chart.coords, chart.coords, indexing="ij")
    return Nodes(chart.basis(), coords, 1.0 / np.sqrt(1.0 + u * u + v * v))


@njit(inline=True, bare=True)
def _on_face(nodes: Nodes, face: int, vector: Vector) -> Vector:
    """Return level, slope along v and slope along u of the function vector . g on a face."""
    basis = nodes.basis[face]
    return dot(vector, row(basis, 0)), dot(vector, row(basis, 2)), dot(vector, row(basis, 1))


@njit(inline=True, bare=True)
def _passes(line: Floats, w: int, u: float, v: float) -> bool:
    """Return True if a node is on the inner side of wall w."""
    level = line[w, 0] + line[w, 1] * v + line[w, 2] * u
    return bool(level >= -ON_AXIS * math.sqrt(1.0 + u * u + v * v))


@njit(bare=True)
def _find_spans(line: Floats, walls: int, nodes: Nodes, rows: Rows, span: Floats) -> None:
    """Fill `span` (3, size): first node inside all walls, the one after the last, and doubt.

    Doubt is below DOUBT where an end is too near to a node.
    """
    coords, count = nodes.coords, nodes.inverse.shape[0]
    begin, end, doubt = span[0], span[1], span[2]
    for r in range(rows.size):
        begin[r], end[r], doubt[r] = 0.0, count, 1.0
    per_step = 1.0 / (coords[1] - coords[0]) if count > 1 else 1.0
    for w in range(walls):
        level, tilt, slope = line[w, 0], line[w, 1], line[w, 2]
        if abs(slope) < PARALLEL or count == 1:
            for r in range(rows.size):
                value = level + tilt * coords[rows.first + r]
                end[r] = end[r] if value > -WITHIN or count == 1 else 0.0
                doubt[r] = doubt[r] if abs(value) > WITHIN and count > 1 else -1.0
            continue
        origin, tilt = (-level / slope - coords[0]) * per_step, -tilt / slope * per_step
        for r in range(rows.size):
            # Cut to what is near to the face before it is rounded, and cast only after that.
            place = min(max(origin + tilt * coords[rows.first + r], -1.0), count + 0.5)
            node = math.ceil(place)
            begin[r] = max(begin[r], node) if slope > 0.0 else begin[r]
            end[r] = end[r] if slope > 0.0 else min(end[r], math.floor(place) + 1.0)
            doubt[r] = min(doubt[r], min(node - place, place - node + 1.0))


@njit(bare=True)
def _asked_span(
    line: Floats, walls: int, nodes: Nodes, v: float, span: tuple[int, int]
) -> tuple[int, int]:
    """Return a span of which there is doubt: one node wider, then shrunk by the signs."""
    begin, end = max(span[0] - 1, 0), min(span[1] + 1, nodes.inverse.shape[0])
    for w in range(walls):
        while begin < end and not _passes(line, w, nodes.coords[begin], v):
            begin += 1
        while begin < end and not _passes(line, w, nodes.coords[end - 1], v):
            end -= 1
    return begin, end


@njit(bare=True)
def draw(
    region: Region, nodes: Nodes, rows: Rows, scratch: Scratch, wanted: Bools, out: Singles
) -> None:
    """Fill |SD_g| of rows, NaN where the robot tips, and height, facet and status if wanted."""
    coords, count, line, span = nodes.coords, nodes.inverse.shape[0], scratch.line, scratch.span
    sdg = out[SDG]
    for channel, none in ((SDG, math.nan), (HEIGHT, math.nan), (FACET, -1.0), (STATUS, 1.0 * TIPS)):
        if channel == SDG or wanted[channel]:
            marks, empty = out[channel], np.float32(none)
            for i in range(rows.at, rows.at + rows.size * count):
                marks[i] = empty
    for k in range(region.counts.cones - 1, -1, -1):  # The first cone has the last word.
        first, walls, place = region.cone[k].first, region.cone[k].count, region.cone[k].seat
        for w in range(walls):
            write3(line[w], _on_face(nodes, rows.face, row(region.wall, first + w)))
        _find_spans(line, walls, nodes, rows, span)
        seat = region.seat[place]
        c0, b0, a0 = _on_face(nodes, rows.face, read3(seat.plane))
        c1, b1, a1 = _on_face(nodes, rows.face, read3(seat.axes[0]))
        c2, b2, a2 = _on_face(nodes, rows.face, read3(seat.axes[1]))
        told = (HEIGHT, seat.height), (FACET, float(place)), (STATUS, float(region.cone[k].status))
        for r in range(rows.size):
            begin, end = int(min(span[0, r], count)), int(span[1, r])
            v = coords[rows.first + r]
            if span[2, r] < DOUBT:
                begin, end = _asked_span(line, walls, nodes, v, (begin, end))
            d0, d1, d2 = c0 + b0 * v, c1 + b1 * v, c2 + b2 * v
            at = rows.at + r * count
            for i in range(np.uint64(begin), np.uint64(max(begin, end))):
                u = coords[i]
                x, y = d1 + a1 * u, d2 + a2 * u
                sdg[at + i] = np.float32(math.sqrt(x * x + y * y) / (d0 + a0 * u))
            for channel, value in told:
                if wanted[channel]:
                    marks, mark = out[channel], np.float32(value)
                    for i in range(at + begin, at + end):
                        marks[i] = mark


@njit(inline=True, bare=True)
def node_direction(nodes: Nodes, face: int, i: int, r: int) -> Vector:
    """Return the unit direction at column i and row r of a face."""
    basis, u, v = nodes.basis[face], nodes.coords[i], nodes.coords[r]
    size = 1.0 / math.sqrt(1.0 + u * u + v * v)
    return (
        (basis[0, 0] + u * basis[1, 0] + v * basis[2, 0]) * size,
        (basis[0, 1] + u * basis[1, 1] + v * basis[2, 1]) * size,
        (basis[0, 2] + u * basis[1, 2] + v * basis[2, 2]) * size,
    )


@njit(bare=True)
def _lowest_in_row(line: Floats, arcs: int, v: float, coords: Floats, low: Floats) -> None:
    """Fill `low` with the least wall . g of (u, v, 1) over the arcs of a convex region."""
    for i in range(np.uint64(low.shape[0])):
        low[i] = math.inf
    for b in range(arcs):
        w0, w1 = line[4 * b, 0] + line[4 * b, 1] * v, line[4 * b, 2]
        for i in range(np.uint64(low.shape[0])):
            low[i] = min(low[i], w0 + w1 * coords[i])


@njit(bare=True)
def _near_arcs(
    region: Region, nodes: Nodes, tile: Rows, span: tuple[int, int], scratch: Scratch
) -> int:
    """Find the arcs that can be nearest to a node of a tile; return how many.

    A direction that turns by an angle comes nearer to an arc by at most that angle.
    """
    line, near = scratch.line, scratch.near
    left, right, top = span[0], span[1] - 1, tile.first + tile.size - 1
    middle = node_direction(nodes, tile.face, (left + right) // 2, (tile.first + top) // 2)
    cosine, nearest, count = 1.0, 2.0, 0
    for i in (left, right):
        for r in (tile.first, top):
            cosine = min(cosine, dot(middle, node_direction(nodes, tile.face, i, r)))
    for b in range(region.counts.arcs):
        line[4 * b + 3, 1] = arc_nearness(region, b, middle)
        nearest = min(nearest, line[4 * b + 3, 1])
    reach = min(angle_of(nearest) + 2.0 * math.acos(cosine) + DOUBT, math.pi)
    square = math.sin(reach) ** 2
    for b in range(region.counts.arcs):
        if line[4 * b + 3, 1] <= (square if reach < 0.5 * math.pi else 2.0 - square):
            near[count] = b
            count += 1
    return count


@njit(bare=True)
def _squares_in_tile(
    scratch: Scratch, arcs: int, nodes: Nodes, tile: Rows, span: tuple[int, int]
) -> None:
    """Fill `low` of a tile with the least squared sine of the angle to an arc.

    They are of (u, v, 1), which is longer than 1.  Where no arc is within 90 deg they are negative.
    """
    line, low, coords = scratch.line, scratch.low, nodes.coords
    begin, end = np.uint64(span[0]), np.uint64(-(-span[1] // PAD) * PAD)
    for r in range(np.uint64(tile.size)):
        for i in range(begin, end):
            low[r, i] = math.inf
    for n in range(arcs):
        b = scratch.near[n]
        wall, along, amid = row(line, 4 * b), row(line, 4 * b + 1), row(line, 4 * b + 2)
        spread = line[4 * b + 3, 0]
        for r in range(np.uint64(tile.size)):
            v = coords[tile.first + r]
            w0, k0, d0 = wall[0] + wall[1] * v, along[0] + along[1] * v, amid[0] + amid[1] * v
            whole = 1.0 + v * v
            for i in range(begin, end):
                u = coords[i]
                reach, ahead, off = abs(k0 + along[2] * u), d0 + amid[2] * u, w0 + wall[2] * u
                beyond = max(reach - ahead, 0.0)
                square = off * off + beyond * beyond
                far = 2.0 * (whole + u * u) - square
                low[r, i] = min(low[r, i], square if ahead * spread + reach >= 0.0 else far)
    for r in range(np.uint64(tile.size)):
        whole = 1.0 + coords[tile.first + r] ** 2
        for i in range(begin, end):
            size = whole + coords[i] * coords[i]
            low[r, i] = low[r, i] if low[r, i] <= size else low[r, i] - 2.0 * size


@njit(inline=True)
def _arcsine(x: float) -> np.float32:
    """Return asin(x) to 3e-7 of the result, without a branch, so that loops become vectors.

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
    angle = np.float32(0.5 * math.pi) - np.float32(2.0) * angle if steep else angle
    return np.float32(math.copysign(angle, np.float32(x)))


@njit(bare=True)
def _signed_angles(
    low: Floats, inverse: Floats, convex: bool, stands: Singles, tip: Singles
) -> None:
    """Fill `tip` with the angles (rad) of a row; `stands` is NaN where the robot tips."""
    if convex:
        for i in range(tip.shape[0]):
            tip[i] = _arcsine(low[i] * inverse[i])
    else:
        for i in range(tip.shape[0]):
            angle = _arcsine(math.sqrt(abs(low[i])) * inverse[i])
            tip[i] = angle if low[i] >= 0.0 else np.float32(math.pi) - angle
    zero, outside = np.float32(0.0), np.float32(JUST_OUTSIDE)
    for i in range(tip.shape[0]):
        # Verdict and sign are one, though both round by themselves near a wall.
        angle = tip[i]
        beyond = min(angle if convex else -angle, outside)
        tip[i] = max(angle, zero) if stands[i] == stands[i] else beyond


@njit(bare=True)
def fill_tip_angles(
    region: Region, nodes: Nodes, rows: Rows, scratch: Scratch, out: Singles
) -> None:
    """Fill the tip angles (rad) of rows; `draw` has left NaN in |SD_g| where the robot tips."""
    coords, count, line, low = nodes.coords, nodes.inverse.shape[0], scratch.line, scratch.low
    arcs, convex, sdg, tip = region.counts.arcs, region.counts.convex == 1, out[SDG], out[TIP]
    if region.counts.accepted == 0 or arcs == 0:
        for i in range(rows.at, rows.at + rows.size * count):
            tip[i] = np.float32(math.pi if sdg[i] == sdg[i] else -math.pi)
        return
    for b in range(arcs):
        arc = region.arc[b]
        write3(line[4 * b], _on_face(nodes, rows.face, read3(arc.wall)))
        write3(line[4 * b + 1], _on_face(nodes, rows.face, read3(arc.along)))
        write3(line[4 * b + 2], _on_face(nodes, rows.face, read3(arc.amid)))
        line[4 * b + 3, 0] = arc.spread
    for skipped in range(0, rows.size, TALL):
        tile = Rows(rows.face, rows.first + skipped, min(TALL, rows.size - skipped), 0)
        for begin in range(0, 0 if convex else max(count - WIDE + 1, 1), WIDE):
            span = begin, count if begin + 2 * WIDE > count else begin + WIDE
            some = _near_arcs(region, nodes, tile, span, scratch)
            _squares_in_tile(scratch, some, nodes, tile, span)
        for r in range(tile.size):
            if convex:
                _lowest_in_row(line, arcs, coords[tile.first + r], coords, low[r])
            at = rows.at + (skipped + r) * count
            row_of, inverse = slice(at, at + count), nodes.inverse[tile.first + r]
            _signed_angles(low[r], inverse, convex, sdg[row_of], tip[row_of])
