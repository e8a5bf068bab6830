"""Blocks of one recipe, computed into buffers that are kept.

Owns the memory of a sweep: one chunk per channel, whatever the size of the map.
"""

import time

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.channels import CHANNELS, Scanner
from lutgen.errors import SweepError
from lutgen.mapping.blocks import Block, Plan, plan
from lutgen.mapping.checksum import fletcher32
from lutgen.recipe import Recipe

# For an estimate: how many pieces of how many nodes, and after how many seconds it is enough.
PIECES, PIECE, ENOUGH = 24, 1 << 15, 2.0


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
