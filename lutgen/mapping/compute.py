"""Compute blocks of one recipe, estimate how long a sweep takes, and look for a standing node."""

import math
import time
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.channels import Scanner
from lutgen.chart import Chart
from lutgen.errors import RecipeError
from lutgen.mapping.head import Block, Layout, plan
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
    """Computes blocks of one recipe, one at a time, in memory that it keeps."""

    def __init__(self, layout: Layout) -> None:
        self._recipe = recipe = layout.recipe
        self._scanner = Scanner(recipe, recipe.chart, recipe.channels)
        self._out = np.empty((len(CHANNELS), layout.rows * layout.shape[-1]), np.float32)

    def compute(self, block: Block) -> list[NDArray[Any]]:
        """Return the values (nodes,) of each channel; the next block overwrites them."""
        posture = self._scanner.rows
        some = np.arange(block.first // posture, block.last // posture)
        self._scanner.fill(self._recipe.grid.params(some), self._out)
        nodes = (block.last - block.first) * self._recipe.chart.nodes
        return [
            self._out[CHANNELS.index(name), :nodes].astype(QUANTITIES[name].stored_type, copy=False)
            for name in self._recipe.channels
        ]


def expected_seconds(recipe: Recipe) -> float:
    """Return how long the computing of a recipe's map takes here, from pieces spread over it.

    One thread is timed, because two wait for each other on a busy machine; the file comes on top.
    """
    threads: int = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        pieces = plan(recipe, PIECE)
        computer = Computer(pieces)
        chosen = sorted({(2 * k + 1) * pieces.count // (2 * PIECES) for k in range(PIECES)})
        # Not timed: what is not compiled yet is compiled here.
        computer.compute(pieces.block(chosen[0]))
        taken, nodes = 0.0, 0
        for block in map(pieces.block, chosen):
            start = time.perf_counter()
            computer.compute(block)
            taken += time.perf_counter() - start
            nodes += (block.last - block.first) * recipe.chart.nodes
            if taken > ENOUGH:
                break
    finally:
        numba.set_num_threads(threads)
    return taken * recipe.nodes / nodes / threads


def require_standing(recipe: Recipe) -> None:
    """Refuse a recipe whose robot stands in none of its postures, in no direction of its chart.

    Few directions are looked at first, and if it stands in none, all up to `AT_MOST` readings.
    """
    size, chart = recipe.grid.size, recipe.chart
    few = Chart(chart.kind, min(chart.nodes, COARSE_NODES), chart.max_tilt)
    for looked in (few, chart):
        directions, scanner = math.prod(looked.shape), Scanner(recipe, looked, ("sdg",))
        # Each time postures from everywhere.
        times = min(size, -(-size * directions // AT_ONCE))
        for first in range(min(times, AT_MOST // max(directions, AT_ONCE))):
            params = recipe.grid.params(np.arange(first, size, times))
            out = np.full((len(CHANNELS), len(params) * directions), np.nan, np.float32)
            scanner.fill(params, out)
            if np.isfinite(out[CHANNELS.index("sdg")]).any():
                return
    if size * directions > AT_MOST:
        return
    raise RecipeError(
        f"{recipe.source}: key `robot.contact`: the robot stands in none of its {size} "
        f"postures under any of the {directions} gravity directions of its chart (got contacts "
        f"{', '.join(recipe.contact_names)}); {TO_STAND}"
    )
