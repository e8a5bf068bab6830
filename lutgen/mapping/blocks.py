"""How a map is cut into blocks: the chunks of its file, and the rows of nodes each one holds.

Owns the arithmetic of shapes and offsets only.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe

# Nodes of a block per channel: 4 MiB of float32, large enough that HDF5's cost per chunk vanishes
# and small enough to stay in the last-level cache between computing and writing.
BLOCK_NODES = 1 << 20
# Postures of a block, where each has few directions: their contacts must fit in the cache too.
BLOCK_POSTURES = 1 << 14


@dataclass(frozen=True)
class Block:
    """One block: chunk `number` (C order) at `offset`, holding rows [first_row, last_row).

    Rows are numbered through the whole map: posture * (faces * nodes) + face * nodes + v.
    """

    number: int
    offset: tuple[int, ...]
    first_row: int
    last_row: int


@dataclass(frozen=True)
class Plan:
    """The blocks of one map.

    `shape` and `chunk` are those of a channel's variable: parameters, face, v, u.  Every chunk is
    a contiguous run of rows: its last axes are whole, one axis is cut, those before it are 1.
    """

    shape: tuple[int, ...]
    chunk: tuple[int, ...]

    @property
    def nodes(self) -> int:
        """Nodes of the map, per channel."""
        return math.prod(self.shape)

    @property
    def chunk_nodes(self) -> int:
        """Nodes of one chunk; the last chunk along the cut axis may be partly empty."""
        return math.prod(self.chunk)

    def chunk_bytes(self, channel: str) -> int:
        """Bytes of one chunk of a channel in the file, with its checksum."""
        return np.dtype(QUANTITIES[channel].stored_type).itemsize * self.chunk_nodes + 4

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of chunks along each axis."""
        return tuple(-(-size // part) for size, part in zip(self.shape, self.chunk, strict=True))

    @property
    def count(self) -> int:
        """Number of blocks."""
        return math.prod(self.counts)

    def block(self, number: int) -> Block:
        """Return a block by its number, 0 <= number < count."""
        width = self.shape[-1]
        offset: list[int] = []
        rest, stride, flat, held = number, 1, 0, 1
        axes = zip(self.shape, self.chunk, self.counts, strict=True)
        for size, part, count in reversed(tuple(axes)):
            rest, place = divmod(rest, count)
            start = place * part
            offset.append(start)
            flat += start * stride
            held *= min(part, size - start)
            stride *= size
        return Block(number, tuple(reversed(offset)), flat // width, (flat + held) // width)

    def blocks(self) -> Iterator[Block]:
        """Yield every block in the order of its number."""
        return map(self.block, range(self.count))


def plan(recipe: Recipe, block_nodes: int = BLOCK_NODES) -> Plan:
    """Return the plan of a recipe's map; a row along u is never cut."""
    shape = (*recipe.grid.shape, *recipe.chart.shape)
    chunk = [1] * len(shape)
    room = block_nodes
    for axis in range(len(shape) - 1, -1, -1):
        if axis == len(recipe.grid.shape) - 1:
            room = min(room, BLOCK_POSTURES)
        most = shape[axis] if axis == len(shape) - 1 else max(1, min(shape[axis], room))
        # As few chunks as that allows, all of nearly one size: what the last one lacks is padding.
        chunk[axis] = -(-shape[axis] // -(-shape[axis] // most))
        room //= chunk[axis]
        if chunk[axis] < shape[axis] or room == 0:
            break
    return Plan(shape, tuple(chunk))
