"""The tree as bytes, in the order in which the runtime walks it.

Owns the layout.  It begins with a directory, see there.  An inner node: axis (4 bits), what its
halves are (2 bits each, lower first), then the bytes of the lower half (u8, or 255 and u16) if both
halves are inner, then the halves: lower first, a half that is a leaf before one that is inner.  A
leaf that is all safe or all unsafe has no bytes.  Any other: a limit of 12 bits, then a coefficient
of 7 bits for each axis, of 63.  It is safe where the coefficients times the places within the leaf,
of 65536, come to more than (limit - 2048) 2016 d.
"""

import numpy as np
from numpy.typing import NDArray

from firmware_export.verdict.directory import above_cells, cells_of, directory_bytes, entry
from firmware_export.verdict.grow import Forest, Nodes
from firmware_export.verdict.planes import WHOLE, kept_by
from firmware_export.verdict.prune import COEFFICIENT, HALF, INNER, LIMIT, SAFE, UNSAFE, leaf_bytes
from lutgen.vector import Floats

MIDDLE = 1 << (LIMIT - 1)
# Instead of the bytes of a half: they are so many or more, and follow in 16 bits.
LONG = 255
# Beyond what a plane needs: places and products are rounded.
SPARE = 1e-4


def _skip(count: int) -> bytes:
    """Return the bytes of a lower half as they stand before it."""
    return bytes([count]) if count < LONG else bytes([LONG]) + count.to_bytes(2, "little")


def whole(limit: Floats, d: int) -> Floats:
    """Return limits as a leaf of d axes holds them, no lower; +inf for what none can hold."""
    with np.errstate(invalid="ignore"):
        code = np.ceil((limit + SPARE) * MIDDLE / d)
    return np.where(code < MIDDLE, np.maximum(code, -MIDDLE) * d / MIDDLE, np.inf)


def packed(
    nodes: Nodes, kind: NDArray[np.int8], limit: Floats, bits: int, roots: int
) -> tuple[tuple[bytes, ...], int]:
    """Return trees as bytes, and their levels below a directory of so many bits of u and of v.

    Their `roots` are the first nodes.
    `limit` (n,) is that of each leaf, as `whole` has it; +inf: nothing of it is safe.
    """
    d = nodes.low.shape[1]
    a = np.rint(nodes.plane[:, :d] * WHOLE).astype(np.int64)
    kind = kind.copy()
    most = np.maximum(a, 0).sum(axis=1) / WHOLE
    lost = (kind == HALF) & (limit >= most)
    kind[lost | ((kind == SAFE) & (limit == np.inf))] = UNSAFE
    code = np.rint(np.where(kind == HALF, limit, 0.0) * MIDDLE / d)
    code = np.clip(code, -MIDDLE, MIDDLE - 1).astype(np.int64) + MIDDLE
    for i in range(len(kind) - 1, -1, -1):
        if kind[i] == INNER:
            left = kind[nodes.child[i]]
            if left == kind[nodes.child[i] + 1] and left in (UNSAFE, SAFE):
                kind[i] = left
    size = leaf_bytes(d)

    def leaf(i: int) -> bytes:
        word = int(code[i])
        for k in range(d):
            word |= (int(a[i, k]) & 127) << (LIMIT + COEFFICIENT * k)
        return word.to_bytes(size, "little")

    # Children lie behind their parents: from the last node on each is put together of what is done.
    done: dict[int, bytes] = {}
    levels = np.ones(len(kind), np.int64)
    above = above_cells(nodes, bits)
    for i in range(len(kind) - 1, -1, -1):
        if kind[i] != INNER or above[i]:
            continue
        low, high = int(nodes.child[i]), int(nodes.child[i]) + 1
        levels[i] = 1 + max(levels[n] if kind[n] == INNER else 0 for n in (low, high))
        head = bytes([int(nodes.axis[i]) | int(kind[low]) << 4 | int(kind[high]) << 6])
        halves = [leaf(n) if kind[n] == HALF else done.pop(n, b"") for n in (low, high)]
        if kind[low] == INNER and kind[high] == INNER:
            head += _skip(len(halves[0]))
        if kind[low] == INNER and kind[high] == HALF:
            halves.reverse()
        done[i] = head + halves[0] + halves[1]

    def tree(root: int) -> bytes:
        """Return a tree behind its directory."""
        entries, body = b"", b""
        for n in map(int, cells_of(nodes, above & (kind == INNER), bits, root)):
            more = leaf(n) if kind[n] == HALF else done.get(n, b"")
            entries += entry(int(kind[n]), directory_bytes(bits) + len(body) if more else 0)
            body += more
            deepest.append(int(levels[n]))
        return entries + body

    deepest: list[int] = []
    trees = tuple(map(tree, range(roots)))
    return trees, max(deepest)


def fitting(
    forest: Forest,
    kind: NDArray[np.int8],
    limit: Floats,
    bits: int,
    roots: int,
    most: int,
) -> tuple[tuple[bytes, ...], int]:
    """Return `packed` trees of at most so many bytes: leaves that keep least are unsafe.

    That takes no proof, as what is unsafe is never wrong.
    """
    nodes = forest.nodes
    leaves = np.flatnonzero(kind == HALF)
    leaves = leaves[np.argsort(kept_by(forest, limit)[leaves], kind="stable")]

    def without(count: int) -> tuple[tuple[bytes, ...], int]:
        fewer = limit.copy()
        fewer[leaves[:count]] = np.inf
        return packed(nodes, kind, fewer, bits, roots)

    low, high, best = 0, len(leaves), without(0)
    if sum(map(len, best[0])) <= most:
        return best
    while low < high:
        middle = (low + high) // 2
        tried = without(middle)
        if sum(map(len, tried[0])) <= most:
            high, best = middle, tried
        else:
            low = middle + 1
    return best if high < len(leaves) else without(high)
