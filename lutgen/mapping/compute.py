"""Blocks of one recipe, computed into buffers that are kept.

Owns the memory of a sweep: one chunk per channel, whatever the size of the map.  With the same
kernel, since a second one would have to be compiled first, it looks for one standing node before a
sweep.
"""

import math
import time
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.channels import Scanner
from lutgen.chart import Chart
from lutgen.errors import RecipeError
from lutgen.mapping.blocks import Block, Plan, plan
from lutgen.quantities import CHANNELS, QUANTITIES
from lutgen.recipe import Recipe

# For an estimate: how many pieces of how many nodes, and after how many seconds it is enough.
PIECES, PIECE, ENOUGH = 24, 1 << 15, 2.0
# For the check that the robot stands at all: directions a side, and readings at once.
COARSE_NODES, AT_ONCE = 9, 200_000
AT_MOST = 100_000_000
# The way out for a robot that never stands.
TO_STAND = (
    "check that the contacts lie below the centre of mass (z up) and are not collinear, or raise "
    "`robot.upright`"
)


class Computer:
    """Computes blocks of one recipe, one at a time, into a buffer that it keeps."""

    def __init__(self, recipe: Recipe, layout: Plan) -> None:
        self.recipe = recipe
        self.nodes = recipe.chart.nodes
        self._scanner = Scanner(recipe, recipe.chart, recipe.channels)
        # One item more than the chunk, for its checksum.  Of channels of words a byte for each
        # node, and four for the checksum.
        self._out = np.empty((len(CHANNELS), layout.chunk_nodes + 1), np.float32)
        self._own = {
            name: np.empty(layout.chunk_bytes(name), np.uint8)
            for name in recipe.channels
            if QUANTITIES[name].words
        }

    def compute(self, block: Block) -> dict[str, NDArray[Any]]:
        """Return a chunk of each channel, with zeros for the checksum in the last four bytes.

        They are float32 (chunk nodes + 1,), or uint8 (chunk nodes + 4,) of channels of words.  The
        arrays are overwritten by the next block.  Past the end of the map a chunk is NaN, or the
        worst word.
        """
        out, own = self._out, self._own
        first, last = block.first_row, block.last_row
        per_posture = self._scanner.rows
        begin, end = first // per_posture, -(-last // per_posture)
        held = (last - first) * self.nodes
        rows = first - begin * per_posture
        self._scanner.fill(
            self.recipe.grid.params(np.arange(begin, end)),
            rows,
            rows + last - first if end - begin == 1 else per_posture,
            out,
        )
        chunks: dict[str, NDArray[Any]] = {}
        for name in self.recipe.channels:
            chunk = out[CHANNELS.index(name)]
            words = QUANTITIES[name].words
            if words:
                chunk, values = own[name], chunk
                chunk[:held] = values[:held]
                chunk[held:-4] = len(words) - 1
            else:
                chunk[held:-1] = np.nan
            chunk.view(np.uint8)[-4:] = 0
            chunks[name] = chunk
        return chunks


def expected_seconds(recipe: Recipe) -> float:
    """Return how long the computing of a recipe's map takes here, from pieces spread over it.

    Postures are not equally dear: with the flippers up a robot has more facets than with them
    level.  One thread is timed, because two wait for each other on a busy machine, and the time
    divided by the threads.  The writing of the file comes on top, see docs/measured/scaling.md.
    """
    threads: int = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        return _seconds_of_one_thread(recipe) / threads
    finally:
        numba.set_num_threads(threads)


def _seconds_of_one_thread(recipe: Recipe) -> float:
    """Return how long one thread computes a map."""
    pieces = plan(recipe, PIECE)
    computer = Computer(recipe, pieces)
    chosen = sorted({(2 * k + 1) * pieces.count // (2 * PIECES) for k in range(PIECES)})
    computer.compute(pieces.block(chosen[0]))
    taken, held = 0.0, 0
    for number in chosen:
        block = pieces.block(number)
        start = time.perf_counter()
        computer.compute(block)
        taken += time.perf_counter() - start
        held += (block.last_row - block.first_row) * recipe.chart.nodes
        if taken > ENOUGH:
            break
    return taken * pieces.nodes / held


def require_standing(recipe: Recipe) -> None:
    """Refuse a recipe whose robot stands in none of its postures, in no direction of its chart.

    Looks at 3 knots of every parameter (at most 729 postures) and 9 x 9 directions of each face;
    only where that finds nothing does it look at every node.  Of a map so large that this would
    take its sweep's hours, at the first `AT_MOST` readings: what stands beyond is not refused.
    """
    grid, chart = recipe.grid, recipe.chart
    coarse = [np.unique([0, axis.size // 2, axis.size - 1]) for axis in grid.axes[:6]]
    coarse += [np.array([axis.size // 2]) for axis in grid.axes[6:]]
    some = np.zeros(1, np.intp)
    if grid.axes:
        index = [part.ravel() for part in np.meshgrid(*coarse, indexing="ij")]
        some = np.ravel_multi_index(tuple(index), grid.shape)
    few = Chart(chart.kind, min(chart.nodes, COARSE_NODES), chart.max_tilt)
    if _any_stands(recipe, grid.params(np.atleast_1d(some)), few):
        return
    step = max(1, AT_ONCE // math.prod(chart.shape))
    for begin in range(0, grid.size, step):
        if begin * math.prod(chart.shape) > AT_MOST:
            return
        nodes = np.arange(begin, min(begin + step, grid.size))
        if _any_stands(recipe, grid.params(nodes), chart):
            return
    raise RecipeError(
        f"{recipe.source}: key `robot.contact`: the robot stands in none of its {grid.size} "
        f"postures under any of the {math.prod(chart.shape)} gravity directions of its chart (got "
        f"contacts {', '.join(recipe.contact_names)}); {TO_STAND}"
    )


def _any_stands(recipe: Recipe, params: NDArray[np.float64], chart: Chart) -> bool:
    scanner = Scanner(recipe, chart, ("sdg",))
    out = np.full((len(CHANNELS), len(params) * scanner.rows * chart.nodes), np.nan, np.float32)
    scanner.fill(params, 0, scanner.rows, out)
    return bool(np.isfinite(out[CHANNELS.index("sdg")]).any())
