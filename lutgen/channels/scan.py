"""Blocks of a map: the channels of many postures over rows of directions, in float32.

Owns the loop of a sweep.  Robots without gaps go the fast way through `raster` and `tilt_rows`;
whatever those do not cover is computed node by node with `plain.measure`, and robots under a wrench
with `batch.measure_postures`.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.batch import measure_postures
from lutgen.channels.plain import (
    Setting,
    find_wanted_ridges,
    measure,
    room_for_ridges,
    wanted_channels,
)
from lutgen.channels.raster import VECTOR, Drawing, Rows, draw_facets, stability_factor
from lutgen.channels.tilt_rows import agree_in_sign, arc_rows, tip_rows
from lutgen.channels.wrench import acceptance_of, wrenches
from lutgen.chart import Chart
from lutgen.jit import in_threads, njit
from lutgen.quantities import CHANNELS
from lutgen.recipe import Recipe, forward, radii_and_kinds
from lutgen.support import (
    STANDS,
    TIPS,
    Region,
    Ridges,
    blurred_in,
    empty_region,
    facet_table,
    facets_in,
    gaps_in,
    height_at,
    is_convex,
    pack,
    segments_in,
    stand,
)
from lutgen.vector import Bools, Floats, Singles, Vector

# Rows are gathered into a band of about this many nodes, which stays in the cache between
# its passes.
BAND = 4096
# Below this many directions, setting up a face costs more than it saves.
FEW_DIRECTIONS = 16
# Readings of a loaded robot that are held in float64 at once, 48 bytes each.
AT_ONCE = 1 << 17


class Nodes(NamedTuple):
    """The nodes of a chart, as the kernel reads them.

    `basis` (faces, 3, 3): per face its middle, its u axis and its v axis (see
    `chart.Chart.basis`); `coords` (nodes + VECTOR,): values of u and v at the nodes, and infinity
    for padding (never inside an interval); `inverse` (nodes * nodes,): 1 / |(u, v, 1)| of the
    nodes of a face.
    """

    basis: NDArray[np.float64]
    coords: NDArray[np.float64]
    inverse: NDArray[np.float64]


def nodes_of(chart: Chart) -> Nodes:
    """Return the nodes of a chart."""
    coords = np.concatenate([chart.coords, np.full(VECTOR, np.inf)])
    return Nodes(chart.basis(), coords, chart.inverse_length().ravel())


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
    region: Region, ridges: Ridges, rows: Rows, wanted: Bools, values: Floats, out: Singles
) -> None:
    """Fill the wanted channels of rows of one face node by node, for any region."""
    for r in range(rows.held):
        v = rows.coords[rows.first + r]
        for i in range(rows.nodes):
            g = _node_direction(rows.basis, rows.coords[i], v)
            measure(region, ridges, g, wanted, values)
            for c in range(len(CHANNELS)):
                if wanted[c]:
                    out[c, r * rows.nodes + i] = np.float32(values[c])


@njit()
def scan_part(
    begin: int,
    end: int,
    primitives: Floats,
    setting: Setting,
    chart: Nodes,
    span: tuple[int, int],
    out: Singles,
) -> int:
    """Fill rows [begin, end) of a block, counted through its postures; see `scan`."""
    acceptance, wanted = setting
    first, per_posture = span[0], span[1] - span[0]
    coords = chart.coords
    nodes = coords.shape[0] - VECTOR
    n = primitives.shape[1]
    overflow = 0
    table, region, ridges = facet_table(n), empty_region(n), room_for_ridges(n, wanted)
    # The margins are not drawn in rows.
    in_rows = not (wanted[3] or wanted[4])
    values = np.empty(len(CHANNELS))
    planes = np.empty((region.segment.shape[0] + 4, 3))
    band_rows = max(BAND // nodes, 1)
    drawing = Drawing(
        np.empty(band_rows * nodes + VECTOR, np.float32),
        np.empty(band_rows * nodes + VECTOR, np.float32),
        np.empty((band_rows, 2), np.int64),
        np.empty(band_rows * nodes if wanted[1] or wanted[5] else 0, np.int64),
        np.empty((table.hull.link.shape[0], 6)),
        np.empty((3, band_rows)),
    )
    squared = drawing.squared
    lowest = np.empty(band_rows * nodes + VECTOR)
    cosine = np.empty(band_rows * nodes)
    current = -1
    at = begin
    while at < end:
        posture = at // per_posture
        if posture != current:
            current = posture
            overflow += stand(table, region, primitives[posture], acceptance)
            find_wanted_ridges(ridges, table, region, primitives[posture], wanted)
        line = first + at - posture * per_posture
        face, first_row = line // nodes, line % nodes
        held = min(band_rows, nodes - first_row, end - at, (posture + 1) * per_posture - at)
        place = slice(at * nodes, (at + held) * nodes)
        at += held
        inverse = chart.inverse[first_row * nodes : (first_row + held) * nodes]
        rows = Rows(chart.basis[face], coords, nodes, first_row, held, inverse)
        simple = in_rows and gaps_in(region.tally) + blurred_in(region.tally) == 0
        if not simple or chart.basis.shape[0] * nodes * nodes < FEW_DIRECTIONS:
            _each_node(region, ridges, rows, wanted, values, out[:, place])
            continue
        drawn = draw_facets(region, rows, drawing)
        count = held * nodes
        if wanted[0]:
            target = out[0, place]
            if drawn:
                stability_factor(squared[:count], drawing.rate[:count], target)
            else:
                target[:] = np.float32(np.nan)
        if wanted[1] or wanted[5]:
            for i in range(count):
                standing = squared[i] == squared[i]
                k = drawing.facet[i] if standing else 0
                if wanted[1]:
                    high = (
                        np.float32(height_at(region.facet, k)) if standing else np.float32(np.nan)
                    )
                    out[1, place.start + i] = high
                if wanted[5]:
                    out[5, place.start + i] = np.float32(k) if standing else np.float32(-1)
        if wanted[6]:
            # Without gaps and stages the robot stands wherever a facet is.
            for i in range(count):
                standing = squared[i] == squared[i]
                out[6, place.start + i] = np.float32(STANDS if standing else TIPS)
        if wanted[2]:
            target = out[2, place]
            if facets_in(region.tally) == 0:
                target[:] = np.float32(-math.pi)
            elif segments_in(region.tally) == 0:
                target[:] = np.float32(math.pi)
            elif is_convex(region.tally):
                tip_rows(region, rows, planes, lowest, target)
                agree_in_sign(target, drawing.span, nodes, held)
            else:
                arc_rows(region, rows, squared, lowest, cosine, target)
    return overflow


def scan(
    primitives: Floats, setting: Setting, chart: Nodes, span: tuple[int, int], out: Singles
) -> int:
    """Fill the channels of a block of postures over a range of rows.

    Parameters
    ----------
    primitives : (m, n, 8) float64
        Primitives of every posture, relative to the com, rows of `primitive.pack`.
    setting : Setting
        Which facets count, and the channels to fill.
    chart : Nodes
        The directions.
    span : tuple of int
        First row and the one after the last, of the faces * nodes rows of a posture.
    out : (channels, at least m * rows * nodes) float32
        Filled from the left where wanted.  C-contiguous: of a strided array the compiler makes
        loops three times as slow.

    Returns
    -------
    int
        Number of postures with more facets than a table holds; 0 unless spheres overlap oddly.
    """
    lines = len(primitives) * (span[1] - span[0])
    return in_threads(scan_part, lines, primitives, setting, chart, span, out)


class Scanner:
    """Fills channels of any postures of a recipe over rows of a chart.

    `rows` is the number of rows of a posture: faces * nodes.  Loaded robots are measured node by
    node.
    """

    def __init__(self, recipe: Recipe, chart: Chart, channels: Sequence[str]) -> None:
        self._recipe = recipe
        self.rows = chart.faces * chart.nodes
        self._nodes = nodes_of(chart)
        self._setting = Setting(acceptance_of(recipe), wanted_channels(channels))
        self._radius, self._kind = radii_and_kinds(recipe)
        # Of loaded robots alone: of the others the kernel makes the directions itself.
        self._directions = chart.directions().reshape(self.rows, -1, 3) if recipe.loaded else None

    def fill(self, params: Floats, first: int, last: int, out: Singles) -> int:
        """Fill `out` for postures (m, k) over rows [first, last) of each; see `scan`."""
        postures = forward(self._recipe, params)
        primitives = pack(postures.centres, postures.axes, self._radius, self._kind)
        if self._directions is None:
            return scan(primitives, self._setting, self._nodes, (first, last), out)
        directions = self._directions[first:last].reshape(1, -1, 3)
        return self._fill_loaded(primitives, wrenches(self._recipe, postures), directions, out)

    def _fill_loaded(
        self, primitives: Floats, wrench: Floats, directions: Floats, out: Singles
    ) -> int:
        """Fill `out` for a loaded robot, some postures and directions at a time."""
        count = directions.shape[1]
        few = max(1, AT_ONCE // count)
        overflow = 0
        for begin in range(0, len(primitives), few):
            some = slice(begin, begin + few)
            for at in range(0, count, AT_ONCE):
                part = directions[:, at : at + AT_ONCE]
                values, over = measure_postures(primitives[some], wrench[some], part, self._setting)
                overflow += over
                held = part.shape[1]
                for channel, rows in values.items():
                    for i, value in enumerate(rows):
                        place = (begin + i) * count + at
                        out[channel, place : place + held] = value
        return overflow
