"""Cut a map into blocks: runs of rows of nodes that are computed and written together."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from lutgen.recipe import Recipe

# Nodes of a block per channel: 4 MiB of float32, large enough that the cost of a block vanishes and
# small enough to stay in the last-level cache between computing and writing.
BLOCK_NODES = 1 << 20
# Postures of a block, where each has few directions: their contacts must fit in the cache too.
BLOCK_POSTURES = 1 << 14


class Block(NamedTuple):
    """Rows [first, last) of a map; row = posture * (faces * nodes) + face * nodes + v."""

    number: int
    first: int
    last: int


@dataclass(frozen=True)
class Plan:
    """The blocks of one map.

    `shape` is that of a channel's variable (parameters..., face, v, u).  A block has `rows` rows,
    whole postures or a part of one; the last block of the map or of a posture may have fewer.
    """

    shape: tuple[int, ...]
    rows: int

    @property
    def nodes(self) -> int:
        """Nodes of the map, per channel."""
        return math.prod(self.shape)

    @property
    def _uncut(self) -> int:
        """Rows of which blocks are cut: those of the whole map, or of one posture."""
        posture = math.prod(self.shape[-3:-1])
        return posture if self.rows % posture else self.nodes // self.shape[-1]

    @property
    def count(self) -> int:
        """Number of blocks."""
        return self.nodes // self.shape[-1] // self._uncut * -(-self._uncut // self.rows)

    def block(self, number: int) -> Block:
        """Return a block by its number, 0 <= number < count."""
        uncut = self._uncut
        whole, part = divmod(number, -(-uncut // self.rows))
        first = whole * uncut + part * self.rows
        return Block(number, first, min(first + self.rows, (whole + 1) * uncut))


def plan(recipe: Recipe, block_nodes: int = BLOCK_NODES) -> Plan:
    """Return the plan of a recipe's map, with blocks of at most `block_nodes` nodes or one row."""
    faces, side, width = recipe.chart.shape
    posture = faces * side
    most = min(block_nodes // (posture * width), BLOCK_POSTURES)
    if most:
        rows = posture * _even(recipe.grid.size, most)
    else:
        rows = _even(posture, max(1, block_nodes // width))
    return Plan((*recipe.grid.shape, *recipe.chart.shape), rows)


def _even(count: int, most: int) -> int:
    """Return the size of the fewest parts of nearly equal size, each at most `most`."""
    return -(-count // -(-count // most))
