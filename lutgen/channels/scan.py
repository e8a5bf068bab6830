"""Blocks of a map: the channels of many postures over rows of directions, in float32.

Owns the one parallel loop of a sweep.  Robots without gaps go the fast way through `raster` and
`tilt`; whatever those do not cover is computed node by node with `plain.measure`.
"""

import math

import numpy as np

from lutgen.channels.plain import measure
from lutgen.channels.raster import VECTOR, draw_facets, stability_factor
from lutgen.channels.tilt_rows import agree_in_sign, arc_rows, tip_rows
from lutgen.jit import njit, prange
from lutgen.support import (
    CONVEX,
    FACETS,
    GAPS,
    HEIGHT,
    SEGMENTS,
    Limit,
    Region,
    empty_region,
    facet_table,
    find_facets,
    find_region,
    robot_size,
)
from lutgen.vector import Bools, Floats, Singles, Vector

# Rows are gathered into a band of about this many nodes, which stays in the cache between
# its passes.
BAND = 4096
# Below this many directions, setting up a face costs more than it saves.
FEW_DIRECTIONS = 16


@njit()
def _node_direction(basis: Floats, u: float, v: float) -> Vector:
    size = 1.0 / math.sqrt(1.0 + u * u + v * v)
    return (
        (basis[0, 0] + u * basis[1, 0] + v * basis[2, 0]) * size,
        (basis[0, 1] + u * basis[1, 1] + v * basis[2, 1]) * size,
        (basis[0, 2] + u * basis[1, 2] + v * basis[2, 2]) * size,
    )


@njit()
def _each_node(
    region: Region,
    basis: Floats,
    coords: Floats,
    nodes: int,
    first_row: int,
    rows: int,
    wanted: Bools,
    values: Floats,
    out: Singles,
) -> None:
    """Fill the wanted channels of rows of one face node by node, for any region."""
    for r in range(rows):
        v = coords[first_row + r]
        for i in range(nodes):
            measure(region, _node_direction(basis, coords[i], v), wanted, values)
            for c in range(6):
                if wanted[c]:
                    out[c, r * nodes + i] = np.float32(values[c])


@njit()
def _scan_part(
    primitives: Floats,
    limit: Limit,
    basis: Floats,
    coords: Floats,
    inverse_length: Floats,
    first: int,
    per_posture: int,
    wanted: Bools,
    begin: int,
    end: int,
    out: Singles,
) -> int:
    """Fill rows [begin, end) of a block, counted through its postures; see `scan`."""
    nodes = coords.shape[0] - VECTOR
    n = primitives.shape[1]
    overflow = 0
    table, region = facet_table(n), empty_region(n)
    values = np.empty(6)
    lines = np.empty((table.link.shape[0], 6))
    planes = np.empty((region.segment.shape[0] + 4, 3))
    band_rows = max(BAND // nodes, 1)
    squared = np.empty(band_rows * nodes + VECTOR, np.float32)
    rate = np.empty(band_rows * nodes + VECTOR, np.float32)
    lowest = np.empty(band_rows * nodes + VECTOR)
    cosine = np.empty(band_rows * nodes)
    span = np.empty((band_rows, 2), np.int64)
    room = np.empty((3, band_rows))
    facet_band = np.empty(band_rows * nodes if wanted[1] or wanted[5] else 0, np.int64)
    current = -1
    at = begin
    while at < end:
        posture = at // per_posture
        if posture != current:
            current = posture
            find_facets(table, primitives[posture], limit[2])
            find_region(region, table, limit, robot_size(primitives[posture]))
            overflow += table.tally[1]
        line = first + at - posture * per_posture
        face, first_row = line // nodes, line % nodes
        rows = min(band_rows, nodes - first_row, end - at, (posture + 1) * per_posture - at)
        span_out = slice(at * nodes, (at + rows) * nodes)
        at += rows
        frame = basis[face]
        simple = not (wanted[3] or wanted[4]) and region.tally[GAPS] == 0
        if not simple or basis.shape[0] * nodes * nodes < FEW_DIRECTIONS:
            _each_node(
                region, frame, coords, nodes, first_row, rows, wanted, values, out[:, span_out]
            )
            continue
        drawn = draw_facets(
            region,
            frame,
            coords,
            nodes,
            first_row,
            rows,
            lines,
            span,
            room,
            squared,
            rate,
            facet_band,
        )
        count = rows * nodes
        if wanted[0]:
            target = out[0, span_out]
            if drawn:
                stability_factor(squared[:count], rate[:count], target)
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
            inverse = inverse_length[first_row * nodes : (first_row + rows) * nodes]
            if region.tally[FACETS] == 0:
                target[:] = np.float32(-math.pi)
            elif region.tally[SEGMENTS] == 0:
                target[:] = np.float32(math.pi)
            elif region.tally[CONVEX] == 1:
                tip_rows(
                    region,
                    frame,
                    coords,
                    nodes,
                    first_row,
                    rows,
                    planes,
                    lowest,
                    inverse,
                    target,
                )
                agree_in_sign(target, span, nodes, rows)
            else:
                arc_rows(
                    *(region, frame, coords, nodes, first_row, rows, lowest, cosine),
                    *(inverse, squared, target),
                )
    return overflow


@njit(parallel=True)
def scan(
    primitives: Floats,
    limit: Limit,
    basis: Floats,
    coords: Floats,
    inverse_length: Floats,
    first: int,
    last: int,
    wanted: Bools,
    parts: int,
    out: Singles,
) -> int:
    """Fill the channels of a block of postures over a range of rows.

    Parameters
    ----------
    primitives : (m, n, 8) float64
        Primitives of every posture, relative to the com, rows of `primitive.pack`.
    limit : tuple
        See `region.limits`.
    basis : (faces, 3, 3) float64
        Per face its middle, its u axis and its v axis (see `chart.Chart.basis`).
    coords : (nodes + VECTOR,) float64
        Values of u and v at the nodes, and infinity for padding (never inside an interval).
    inverse_length : (nodes * nodes,) float64
        1 / sqrt(1 + u^2 + v^2) of the nodes of a face.
    first, last : int
        Rows [first, last) of the faces * nodes rows of a posture.
    wanted : (6,) bool
        Channels to fill, in the order of `plain.CHANNELS`.
    parts : int
        How many parts the work is cut into; the values do not depend on it.
    out : (6, at least m * (last - first) * nodes) float32
        Filled from the left where wanted.  C-contiguous: of a strided array the compiler makes
        loops three times as slow.

    Returns
    -------
    int
        Number of postures with more facets than a table holds; 0 unless spheres overlap oddly.
    """
    per_posture = last - first
    total = primitives.shape[0] * per_posture
    overflow = np.zeros(parts, np.int64)
    # The loop holds nothing but a call: numba takes long over large parallel bodies.
    for part in prange(parts):
        begin, end = part * total // parts, (part + 1) * total // parts
        overflow[part] = _scan_part(
            *(primitives, limit, basis, coords, inverse_length, first, per_posture, wanted),
            *(begin, end, out),
        )
    return int(overflow.sum())
