"""Blocks of a map: the channels of many postures over rows of directions, in float32.

Margins, shares of load and a robot under a wrench are computed as `evaluate` does; all else by
`rows`.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from lutgen.arrays import Floats, Singles
from lutgen.channels.evaluation import acceptance_of, measure_recipe, primitives_of
from lutgen.channels.exact import TIP, Setting
from lutgen.channels.measuring import Memory, own_memory
from lutgen.channels.rows import PAD, TALL, Nodes, Rows, Scratch, draw, fill_tip_angles, nodes_of
from lutgen.chart import Chart
from lutgen.jit import in_threads, njit
from lutgen.quantities import CHANNELS, wanted
from lutgen.recipe import Recipe, forward
from lutgen.support import stand

# Rows are computed in bands of about this many nodes, which stay in the cache between passes.
BAND = 4096
# Channels that follow from whole rows.
BY_ROWS = {"sdg", "height", "tip_angle", "facet", "status"}
# Readings that are held in float64 at once, or those of one posture.
AT_ONCE = 1 << 17


def scratch_for(nodes: Nodes) -> tuple[Memory, Scratch]:
    """Return what `scan_part` writes."""
    memory, count = own_memory(), nodes.inverse.shape[0]
    arcs, span = memory.region.arc.shape[0], np.empty((3, max(BAND // count, 1)))
    low = np.empty((TALL, -(-count // PAD) * PAD))
    return memory, Scratch(np.empty((4 * arcs, 3)), np.empty(arcs, np.int64), span, low)


@njit(bare=True)
def scan_part(
    span: tuple[int, int],
    memory: tuple[Memory, Scratch],
    primitives: Floats,
    setting: Setting,
    nodes: Nodes,
    out: Singles,
) -> None:
    """Fill a span of rows of a block, counted through its postures; see `scan`."""
    ((region, _, _), scratch), accept, wanted = memory, setting.acceptance, setting.wanted
    count = nodes.inverse.shape[0]
    per_posture = nodes.basis.shape[0] * count
    band, current, (line, end) = scratch.span.shape[1], -1, span
    while line < end:
        posture = line // per_posture
        if posture != current:
            current = posture
            stand(region, primitives[posture], accept)
        place = line - posture * per_posture
        face, first_row = place // count, place % count
        size = min(band, count - first_row, end - line, (posture + 1) * per_posture - line)
        rows = Rows(face, first_row, size, line * count)
        line += size
        draw(region, nodes, rows, scratch, wanted, out)
        if wanted[TIP]:
            fill_tip_angles(region, nodes, rows, scratch, out)


def scan(primitives: Floats, setting: Setting, nodes: Nodes, out: Singles) -> None:
    """Fill the channels of a block of postures (m, n, 8).

    `out` (channels, at least m * faces * nodes * nodes) is filled from the left where `BY_ROWS` are
    wanted; |SD_g| always.  C-contiguous: of a strided array the compiler makes loops three times as
    slow.
    """
    rows = len(primitives) * len(nodes.basis) * len(nodes.inverse)
    in_threads(scan_part, rows, partial(scratch_for, nodes), primitives, setting, nodes, out)


class Scanner:
    """Fills channels of any postures of a recipe over a chart.

    `rows` is the number of rows of a posture: faces * nodes.
    """

    def __init__(self, recipe: Recipe, chart: Chart, channels: Sequence[str]) -> None:
        self._recipe, self._channels = recipe, channels
        self.rows = chart.faces * chart.nodes
        self._nodes = nodes_of(chart)
        self._setting = Setting(acceptance_of(recipe), np.array(wanted(channels)))
        by_node = recipe.loaded or not BY_ROWS.issuperset(channels)
        self._directions = chart.directions().reshape(1, -1, 3) if by_node else None

    def fill(self, params: Floats, out: Singles) -> None:
        """Fill `out` for postures (m, k); see `scan`."""
        if self._directions is None:
            primitives = primitives_of(self._recipe, forward(self._recipe, params))
            scan(primitives, self._setting, self._nodes, out)
            return
        count = self._directions.shape[1]
        few = max(1, AT_ONCE // count)
        for begin in range(0, len(params), few):
            some = forward(self._recipe, params[begin : begin + few])
            values = measure_recipe(self._recipe, some, self._directions, self._channels)
            for name, found in values.items():
                place = slice(begin * count, begin * count + found.size)
                out[CHANNELS.index(name), place] = found.ravel()
