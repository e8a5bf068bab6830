"""Blocks of one recipe, computed into buffers that are kept.

Owns the memory of a sweep: one chunk per channel, whatever the size of the map.
"""

import time

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.blocks import Block, Plan, plan
from lutgen.channels import CHANNELS
from lutgen.checksum import fletcher32
from lutgen.errors import SweepError
from lutgen.recipe import Recipe
from lutgen.scanner import Scanner

# Parts per thread: a block's rows are not all equally dear, and small parts even that out.
PARTS_PER_THREAD = 8


class Computer:
    """Computes blocks of one recipe into buffers that it keeps."""

    def __init__(self, recipe: Recipe, layout: Plan) -> None:
        self.recipe = recipe
        self.nodes = recipe.chart.nodes
        self._scanner = Scanner(recipe, recipe.chart, recipe.channels)
        # One item more than the chunk, for its checksum.
        self._out = np.empty((len(CHANNELS), layout.chunk_nodes + 1), np.float32)

    def compute(self, block: Block) -> dict[str, NDArray[np.float32]]:
        """Return a chunk of each channel, (chunk nodes + 1,) with its checksum in the last item.

        The arrays are overwritten by the next call.  Past the end of the map a chunk is NaN.
        """
        first, last = block.first_row, block.last_row
        per_posture = self._scanner.rows
        begin, end = first // per_posture, -(-last // per_posture)
        held = (last - first) * self.nodes
        rows = first - begin * per_posture
        overflow = self._scanner.fill(
            self.recipe.grid.params(np.arange(begin, end)),
            rows,
            rows + last - first if end - begin == 1 else per_posture,
            numba.get_num_threads() * PARTS_PER_THREAD,
            self._out,
        )
        if overflow:
            raise SweepError(
                f"{self.recipe.source}: a posture of block {block.number} has more support facets "
                f"than {len(self.recipe.contact_names)} contacts can have (got {overflow} such "
                "postures); check the radii for overlapping spheres"
            )
        chunks = {}
        for name in self.recipe.channels:
            chunk = self._out[CHANNELS.index(name)]
            chunk[held:-1] = np.nan
            chunk[-1:].view(np.uint32)[0] = fletcher32(chunk[:-1].view(np.uint16))
            chunks[name] = chunk
        return chunks


def expected_seconds(recipe: Recipe) -> float:
    """Return how long the computing of a recipe's map takes here, from a piece of it."""
    piece = plan(recipe, 1 << 16)
    computer = Computer(recipe, piece)
    middle = next(b for b in piece.blocks() if b.number >= piece.count // 2)
    computer.compute(middle)
    start = time.perf_counter()
    computer.compute(middle)
    part = (middle.last_row - middle.first_row) * recipe.chart.nodes / piece.nodes
    return (time.perf_counter() - start) / part
