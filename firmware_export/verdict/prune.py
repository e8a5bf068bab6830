"""Which nodes of a grown tree are worth their bytes.

Owns what a node costs, and the choice of the tree that gives up least in so many bytes: for a price
of a byte each node is a leaf or is halved, whichever is cheaper, from the smallest boxes up.
"""

import numpy as np
from numpy.typing import NDArray

from firmware_export.verdict.directory import above_cells, directory_bytes, most_bytes
from firmware_export.verdict.grow import Nodes
from lutgen.jit import njit
from lutgen.vector import Floats

# What a node is.
UNSAFE, SAFE, HALF, INNER = 0, 1, 2, 3
# Bytes of an inner node, of the way to its second half where both are inner and the first is short;
# bits of a leaf's coefficients and of its limit.
HEAD, SKIP, COEFFICIENT, LIMIT = 1, 1, 7, 12
# So often a price is halved.
HALVINGS = 40


def leaf_bytes(dimensions: int) -> int:
    """Return the bytes of a leaf with a plane."""
    return -(-(COEFFICIENT * dimensions + LIMIT) // 8)


@njit()
def _kinds(
    nodes: Nodes, above: NDArray[np.bool_], roots: int, price: float, leaf: int
) -> tuple[NDArray[np.int8], Floats]:
    """Return what each node is at a price of a byte, and the bytes of the trees (roots,).

    Those `above` (n,) the cells of a directory have no bytes of their own, and no plane.
    """
    n = len(nodes.axis)
    cost, size, kind = np.zeros(n), np.zeros(n), np.zeros(n, np.int8)
    for i in range(n - 1, -1, -1):
        if nodes.tips[i] == 0.0:
            kind[i] = SAFE
            continue
        cost[i] = nodes.stands[i]
        if not above[i] and nodes.lost[i] + leaf * price < cost[i]:
            kind[i], cost[i], size[i] = HALF, nodes.lost[i] + leaf * price, leaf
        if nodes.axis[i] >= 0:
            a, b = nodes.child[i], nodes.child[i] + 1
            own = 0 if above[i] else HEAD + (SKIP if kind[a] == INNER and kind[b] == INNER else 0)
            whole = cost[a] + cost[b] + own * price
            if whole < cost[i]:
                kind[i], cost[i], size[i] = INNER, whole, size[a] + size[b] + own
    return kind, size[:roots]


def prune(nodes: Nodes, bits: int, roots: int, most: float) -> tuple[Nodes, NDArray[np.int8]]:
    """Return the trees that give up least, and what each of their nodes is.

    They have at most so many bytes together, directories of so many bits among them; their `roots`
    are the first nodes.
    """
    leaf = leaf_bytes(nodes.low.shape[1])
    above = above_cells(nodes, bits)
    each = most_bytes(bits) - directory_bytes(bits)
    most -= directory_bytes(bits) * roots
    low, high = 0.0, float(max(nodes.stands[:roots].sum(), 1.0))
    kind, size = _kinds(nodes, above, roots, low, leaf)
    if size.sum() > most or size.max() > each:
        kind, _ = _kinds(nodes, above, roots, high, leaf)
        for _ in range(HALVINGS):
            middle = np.sqrt(high * max(low, high * 1e-9))
            tried, size = _kinds(nodes, above, roots, middle, leaf)
            if size.sum() <= most and size.max() <= each:
                kind, high = tried, middle
            else:
                low = middle
    return _kept(nodes, kind, roots)


def _kept(nodes: Nodes, kind: NDArray[np.int8], roots: int) -> tuple[Nodes, NDArray[np.int8]]:
    """Return trees without what is below its leaves."""
    held = np.zeros(len(kind), np.bool_)
    held[:roots] = True
    for i in np.flatnonzero(kind == INNER):
        if held[i]:  # children lie behind their parents
            held[nodes.child[i] : nodes.child[i] + 2] = True
    at = np.cumsum(held) - 1
    fewer = nodes.part(held)
    fewer = fewer._replace(child=at[fewer.child], parent=at[fewer.parent])
    return fewer, kind[held]
