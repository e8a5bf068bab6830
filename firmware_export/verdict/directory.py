"""The directory with which a tree begins: what each cell of u and v is, and where it goes on.

Owns which robots have one, and its bytes.  Each of its bits saves a level of the walk for u and one
for v.  Where parameters count as much as gravity those levels are worth more as nodes, so there it
is one entry: the root.
"""

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import MOST_TREE
from firmware_export.verdict.grow import Nodes
from lutgen.vector import Ints

# Bits of u and of v at most, and the share of a tree's bytes that entries may take.
MOST_BITS, SHARE = 3, 1 / 3
# Bytes of an entry; its upper bits are what a cell is, the others, below REACH, where.
ENTRY, REACH = 2, 1 << 14


def directory_bytes(bits: int) -> int:
    """Return the bytes of a directory of so many bits of u and of v."""
    return ENTRY << 2 * bits


def bits_of(parameters: int, each: float) -> int:
    """Return the bits of u and of v that are worth it in a tree of so many bytes."""
    bits = 0 if parameters else MOST_BITS
    while bits > 0 and directory_bytes(bits) > SHARE * each:
        bits -= 1
    return bits


def most_bytes(bits: int) -> int:
    """Return the bytes of a tree with a directory at most."""
    return REACH if bits else MOST_TREE


def above_cells(nodes: Nodes, bits: int) -> NDArray[np.bool_]:
    """Tell which nodes (n,) are larger than a cell: they are no part of the bytes."""
    return np.asarray((nodes.size[:, -2:] > 0.5**bits).any(axis=1))


def cells_of(nodes: Nodes, halved: NDArray[np.bool_], bits: int, root: int) -> Ints:
    """Return the nodes (4^bits,) that the cells of a tree lie in, u outermost.

    `halved` (n,): which nodes above the cells are.
    """
    d, count = nodes.low.shape[1], 1 << bits
    place = (np.arange(count) + 0.5) / count
    middle = np.zeros((count * count, d))
    middle[:, d - 2], middle[:, d - 1] = np.repeat(place, count), np.tile(place, count)
    at = np.full(len(middle), root)
    rows = np.arange(len(at))
    for _ in range(2 * bits):
        axis = np.maximum(nodes.axis[at], 0)
        half = nodes.low[at, axis] + 0.5 * nodes.size[at, axis]
        upper = middle[rows, axis] >= half
        at = np.where(halved[at], nodes.child[at] + upper, at)
    return at


def entry(kind: int, at: int) -> bytes:
    """Return the entry of a cell that goes on so many bytes from the tree's beginning."""
    return (kind * REACH + at).to_bytes(ENTRY, "little")
