"""The proof of trees: how far each leaf's plane must be moved for nothing that tips to be safe.

Owns the pass over all middles.  Each speaks for a box of parameters around it, over which a leaf's
plane is as bad as at one corner of that box.  There what the leaf calls safe is a half-plane
within a rectangle of the chart, which is convex: if no piece of the middle's outline meets it, it
stands as a whole or tips as a whole, and its farthest corner tells which.
"""

import math
from threading import Lock
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import Fold
from firmware_export.verdict.fold import sides_of
from firmware_export.verdict.grow import Nodes
from firmware_export.verdict.middles import Middles, each
from firmware_export.verdict.outline import (
    Sheet,
    Slab,
    View,
    draw,
    empty_sheet,
    may_tip,
    too_many_pieces,
)
from firmware_export.verdict.prune import HALF, INNER, SAFE, UNSAFE
from lutgen.jit import njit
from lutgen.vector import Floats, Ints

# Nodes that wait at once: a level has two at most.
WAITING = 64
# Pieces belong to both boxes of a border that is nearer than this.
BORDER = 1e-6

# A box of parameters, low and high (k,), and a straight piece by places of u and v.
Box = tuple[Floats, Floats]
Piece = tuple[float, float, float, float]


class _Tree(NamedTuple):
    """Pruned trees; `kind` (n,): see `prune`, the others as in `grow.Nodes`."""

    kind: NDArray[np.int8]
    axis: NDArray[np.int8]
    child: Ints
    low: Floats
    size: Floats
    plane: Floats


class _Walk(NamedTuple):
    """Room for a walk: nodes that wait, and the part of a piece in each.

    `leaf` (c,), `corner` (c, 3): leaves and their farthest corners: value, and x, y on the chart.
    Apart from what is drawn, as to hand over many arrays takes longer than a walk.
    """

    node: Ints
    part: Floats
    leaf: Ints
    corner: Floats


@njit(inline=True)
def _floor(tree: _Tree, n: int, box: Box) -> float:
    """Return the most that the parameters of a box add to the plane of a leaf."""
    low, high = box
    total = 0.0
    for k in range(len(low)):
        a = tree.plane[n, k]
        end = tree.low[n, k] + tree.size[n, k]
        x = min(high[k], end) if a > 0.0 else max(low[k], tree.low[n, k])
        total += a * (x - tree.low[n, k]) / tree.size[n, k]
    return total


@njit(inline=True)
def _push(tree: _Tree, walk: _Walk, n: int, box: Box, waiting: int) -> int:
    """Push those halves of a node that meet a box of parameters; return how many nodes wait."""
    k = tree.axis[n]
    middle = tree.low[n, k] + 0.5 * tree.size[n, k]
    begin, end = walk.part[waiting, 0], walk.part[waiting, 1]
    for s in range(2):
        if box[0][k] < middle if s == 0 else box[1][k] > middle:
            walk.node[waiting] = tree.child[n] + s
            walk.part[waiting, 0], walk.part[waiting, 1] = begin, end
            waiting += 1
    return waiting


@njit(inline=True)
def _push_parts(tree: _Tree, walk: _Walk, n: int, at: float, way: float, waiting: int) -> int:
    """Push those halves of a node that a piece meets; it runs from `at` by `way` along its axis."""
    k = tree.axis[n]
    middle = tree.low[n, k] + 0.5 * tree.size[n, k]
    begin, end = walk.part[waiting, 0], walk.part[waiting, 1]
    for s in range(2):
        sign = 1.0 - 2.0 * s
        # How far beyond the middle both ends are, on the wrong side.
        f = sign * (at + begin * way - middle) - BORDER
        g = sign * (at + end * way - middle) - BORDER
        if f > 0.0 and g > 0.0:
            continue
        here, there = begin, end
        if f > 0.0:
            here = begin + (end - begin) * f / (f - g)
        elif g > 0.0:
            there = begin + (end - begin) * f / (f - g)
        walk.node[waiting] = tree.child[n] + s
        walk.part[waiting, 0], walk.part[waiting, 1] = here, there
        waiting += 1
    return waiting


@njit()
def _enter_piece(tree: _Tree, walk: _Walk, need: Floats, root: int, box: Box, piece: Piece) -> None:
    """Raise what leaves need for a straight piece."""
    u = len(box[0])
    x0, y0, x1, y1 = piece
    walk.node[0], walk.part[0, 0], walk.part[0, 1] = root, 0.0, 1.0
    waiting = 1
    while waiting > 0:
        waiting -= 1
        n, begin, end = walk.node[waiting], walk.part[waiting, 0], walk.part[waiting, 1]
        kind = tree.kind[n]
        if kind == UNSAFE:
            continue
        if kind == SAFE:
            need[n] = math.inf
        elif kind == HALF:
            across, upward = tree.size[n, u], tree.size[n, u + 1]
            u0 = (x0 + begin * (x1 - x0) - tree.low[n, u]) / across
            u1 = (x0 + end * (x1 - x0) - tree.low[n, u]) / across
            v0 = (y0 + begin * (y1 - y0) - tree.low[n, u + 1]) / upward
            v1 = (y0 + end * (y1 - y0) - tree.low[n, u + 1]) / upward
            a, b = tree.plane[n, u], tree.plane[n, u + 1]
            most = max(a * u0 + b * v0, a * u1 + b * v1) + _floor(tree, n, box)
            need[n] = max(need[n], most)
        elif tree.axis[n] < u:
            waiting = _push(tree, walk, n, box, waiting)
        elif tree.axis[n] == u:
            waiting = _push_parts(tree, walk, n, x0, x1 - x0, waiting)
        else:
            waiting = _push_parts(tree, walk, n, y0, y1 - y0, waiting)


@njit()
def _enter_pieces(
    tree: _Tree, walk: _Walk, need: Floats, sheet: Sheet, sides: Floats, box: Box
) -> None:
    """Raise what leaves need for the outline of a posture; cut where v is folded."""
    first = 0
    folded = len(sides) == 2
    for face in range(len(sheet.counts)):
        for n in range(first, first + sheet.counts[face]):
            p = sheet.pieces[n]
            crosses = folded and (p[1] < 0.0) != (p[3] < 0.0)
            cut = p[1] / (p[1] - p[3]) if crosses else 1.0
            for part in range(2 if crosses else 1):
                begin, end = (0.0, cut) if part == 0 else (cut, 1.0)
                v0, v1 = p[1] + begin * (p[3] - p[1]), p[1] + end * (p[3] - p[1])
                side = 1 if folded and 0.5 * (v0 + v1) < 0.0 else 0
                zero, rate = sides[side, 0], sides[side, 1]
                u0, u1 = p[0] + begin * (p[2] - p[0]), p[0] + end * (p[2] - p[0])
                straight = 0.5 + 0.5 * u0, zero + rate * v0, 0.5 + 0.5 * u1, zero + rate * v1
                _enter_piece(tree, walk, need, face, box, straight)
        first += sheet.counts[face]


@njit()
def _add_corners(tree: _Tree, walk: _Walk, need: Floats, sides: Floats, root: int, box: Box) -> int:
    """Fill corners with the farthest of what each leaf calls safe in a posture; return how many."""
    node, u, v = walk.node, len(box[0]), len(box[0]) + 1
    node[0], waiting, corners = root, 1, 0
    while waiting > 0:
        waiting -= 1
        n = node[waiting]
        kind = tree.kind[n]
        if kind == INNER and tree.axis[n] < u:
            waiting = _push(tree, walk, n, box, waiting)
        elif kind == INNER:
            node[waiting], node[waiting + 1] = tree.child[n], tree.child[n] + 1
            waiting += 2
        elif kind != UNSAFE and need[n] < math.inf:
            floor = _floor(tree, n, box) if kind == HALF else 0.0
            for side in range(len(sides)):
                x, y = tree.low[n, u], tree.low[n, v]
                top = min(y + tree.size[n, v], sides[side, 2])
                if top <= y:
                    continue
                value = math.inf
                if kind == HALF:
                    a, b = tree.plane[n, u], tree.plane[n, v]
                    value = floor + max(a, 0.0) + max(b, 0.0) * (top - y) / tree.size[n, v]
                    x += tree.size[n, u] if a > 0.0 else 0.0
                    y = top if b > 0.0 else y
                    if value <= max(tree.plane[n, v + 1], need[n]):
                        continue
                walk.leaf[corners], walk.corner[corners, 0] = n, value
                walk.corner[corners, 1] = 2.0 * x - 1.0
                walk.corner[corners, 2] = (y - sides[side, 0]) / sides[side, 1]
                corners += 1
    return corners


@njit()
def _enter_corners(
    walk: _Walk, need: Floats, sheet: Sheet, view: View, face: int, corners: int
) -> None:
    """Raise what leaves need where their farthest corners may tip."""
    basis = view.basis[face]
    for at in range(corners):
        x, y = walk.corner[at, 1] * view.reach, walk.corner[at, 2] * view.reach
        size = 1.0 / math.sqrt(1.0 + x * x + y * y)
        g = (
            size * (basis[0, 0] + x * basis[1, 0] + y * basis[2, 0]),
            size * (basis[0, 1] + x * basis[1, 1] + y * basis[2, 1]),
            size * (basis[0, 2] + x * basis[1, 2] + y * basis[2, 2]),
        )
        if may_tip(sheet, g):
            n = walk.leaf[at]
            need[n] = max(need[n], walk.corner[at, 0])


@njit()
def _prove_slab(tree: _Tree, slab: Slab, view: View, sides: Floats, need: Floats) -> int:
    """Raise what leaves need for some middles; 1: an outline has too many pieces."""
    sheet = empty_sheet(slab.primitives.shape[1], len(view.basis))
    corners = 2 * len(tree.kind)
    node, part = np.empty(WAITING, np.int64), np.empty((WAITING, 2))
    walk = _Walk(node, part, np.empty(corners, np.int64), np.empty((corners, 3)))
    for p in range(len(slab.low)):
        if draw(sheet, slab, p, view) < 0:
            return 1
        box = slab.low[p], slab.high[p]
        _enter_pieces(tree, walk, need, sheet, sides, box)
        for face in range(len(view.basis)):
            corners = _add_corners(tree, walk, need, sides, face, box)
            _enter_corners(walk, need, sheet, view, face, corners)
    return 0


class Proof(NamedTuple):
    """What a proof has found.

    `limit` (n,): the least of each leaf at which nothing in it that tips is safe.  `postures` that
    were looked at, and by how much (rad) limits were tightened at most.
    """

    limit: Floats
    postures: int
    tighter: float


def prove(nodes: Nodes, kind: NDArray[np.int8], middles: Middles, view: View, fold: Fold) -> Proof:
    """Return what the leaves of pruned trees need, whose roots are the first nodes."""
    tree = _Tree(kind, nodes.axis, nodes.child, nodes.low, nodes.size, nodes.plane)
    sides = sides_of(fold)
    most = np.full(len(kind), -math.inf)
    lock = Lock()

    def work(job: tuple[Ints, Ints]) -> tuple[int, float]:
        need = np.full_like(most, -math.inf)
        slab = middles.slab(*job)
        if _prove_slab(tree, slab, view, sides, need):
            raise too_many_pieces(middles.model)
        with lock:
            np.maximum(most, need, out=most)
        return len(slab.low), slab.tighter

    counts, tighter = zip(*each(work, middles.slabs()), strict=True)
    # Corners were asked where a plane reaches beyond its own limit.
    return Proof(np.maximum(most, nodes.plane[:, -1]), sum(counts), max(tighter))
