"""Lowering of a table until no outline lies above zero, and raising it as far as that allows.

Owns the exact check on the outlines of `outline`; works on codes, above `zero` is safe.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit, prange
from lutgen.vector import Bools, Floats, Ints

# Pieces of the work, each with its own result: the same for any number of threads.
PARTS = 8


class Places(NamedTuple):
    """Where a table must not be above zero.

    `nodes`, `weight` (P, 2^k): nodes of the table around each posture, and their shares.
    `counts` (k,): postures along each axis, the last one fastest.  `pieces`, `first`: see
    `outline.Outlines`; at a posture those of all that are next to it count.  `tips` (P, J): what
    tips at any of these.  `u`, `v` (n,) float64: knots, 0 to 1.
    """

    nodes: NDArray[np.int32]
    weight: Floats
    counts: Ints
    pieces: NDArray[np.float32]
    first: Ints
    tips: Bools
    u: Floats
    v: Floats


@njit(inline=True)
def _cell(knots: Floats, x: float) -> int:
    low, high = 0, len(knots) - 1
    while high - low > 1:
        mid = (low + high) >> 1
        if x >= knots[mid]:
            low = mid
        else:
            high = mid
    return low


@njit()
def _next(knots: Floats, x0: float, dx: float, s: float) -> float:
    """Return the smallest place > s of a piece at which it crosses a knot, at most 1."""
    if dx == 0.0:
        return 1.0
    way = 1 if dx > 0.0 else 0
    edge = _cell(knots, x0 + s * dx) + way
    while 0 < edge < len(knots) - 1:
        at = (knots[edge] - x0) / dx
        if at > s:
            return float(min(at, 1.0))
        edge += 2 * way - 1
    return 1.0


@njit(inline=True)
def _bilinear(
    piece: NDArray[np.float32], u: Floats, v: Floats, plane: Floats, i: int, j: int, at: float
) -> float:
    """Return the value of cell (i, j) at a place of a piece."""
    f = (piece[0] + at * (float(piece[2]) - piece[0]) - u[j]) / (u[j + 1] - u[j])
    g = (piece[1] + at * (float(piece[3]) - piece[1]) - v[i]) / (v[i + 1] - v[i])
    lower = (1.0 - f) * plane[i, j] + f * plane[i, j + 1]
    return float((1.0 - g) * lower + g * ((1.0 - f) * plane[i + 1, j] + f * plane[i + 1, j + 1]))


@njit()
def _piece(
    piece: NDArray[np.float32], u: Floats, v: Floats, plane: Floats, gentle: bool, drop: Floats
) -> None:
    """Enter in `drop` (nv, nu) by how much nodes must fall for a piece not to lie above zero.

    `gentle`: just so far that the worst place comes to zero, by the least sum of squares.
    """
    u0, v0 = float(piece[0]), float(piece[1])
    du, dv = float(piece[2]) - u0, float(piece[3]) - v0
    s = 0.0
    for _ in range(len(u) + len(v)):
        if s >= 1.0:
            return
        after = min(_next(u, u0, du, s + 1e-9), _next(v, v0, dv, s + 1e-9))
        mid = 0.5 * (s + after)
        i, j = _cell(v, v0 + mid * dv), _cell(u, u0 + mid * du)
        if max(plane[i, j], plane[i, j + 1], plane[i + 1, j], plane[i + 1, j + 1]) <= 0.0:
            s = after
            continue
        low = _bilinear(piece, u, v, plane, i, j, s)
        middle = _bilinear(piece, u, v, plane, i, j, mid)
        high = _bilinear(piece, u, v, plane, i, j, after)
        place, worst = (s, low) if low > high else (after, high)
        # The quadratic through the three: its top, if it is in between.
        bend = low - 2.0 * middle + high
        if bend < 0.0 and abs(high - low) < -2.0 * bend:
            place = mid + 0.5 * (after - s) * -0.5 * (high - low) / bend
            worst = middle - (high - low) ** 2 / (8.0 * bend)
        if worst > 0.0:
            f = min(max((u0 + place * du - u[j]) / (u[j + 1] - u[j]), 0.0), 1.0)
            g = min(max((v0 + place * dv - v[i]) / (v[i + 1] - v[i]), 0.0), 1.0)
            squares = (f * f + (1.0 - f) ** 2) * (g * g + (1.0 - g) ** 2)
            for n in range(4):
                share = 1.0
                if gentle:
                    share = (f if n & 1 else 1.0 - f) * (g if n >> 1 else 1.0 - g) / squares
                at = drop[i + (n >> 1), j + (n & 1)]
                drop[i + (n >> 1), j + (n & 1)] = max(at, worst * share)
        s = after


@njit(bare=True)
def beside(p: int, counts: Ints, turn: int) -> int:
    """Return the posture next to p by one of 3^k turns, -1 where the lattice has none."""
    there, stride = 0, 1
    for a in range(len(counts) - 1, -1, -1):
        at = p % counts[a] + turn % 3 - 1
        if at < 0 or at >= counts[a]:
            return -1
        there += at * stride
        stride *= counts[a]
        p //= counts[a]
        turn //= 3
    return there


@njit(parallel=True)
def _excess(
    node: Floats, places: Places, how: tuple[bool, bool], which: Ints, drops: Floats, above: Bools
) -> None:
    index, weight, counts, pieces, first, tips, u, v = places
    parts, faces, rows, columns = len(drops), node.shape[1], node.shape[2], node.shape[3]
    gentle, around = how
    turns = 3 ** len(counts)
    begin, end = (0, turns) if around else (turns // 2, turns // 2 + 1)
    for part in prange(parts):
        plane = np.empty((faces, rows, columns))
        drop = np.empty((faces, rows, columns))
        for at in range(part, len(which), parts):
            p = which[at]
            plane[:] = 0.0
            squares = 0.0
            for c in range(index.shape[1]):
                share = weight[p, c]
                squares += share * share
                if share > 0.0:
                    _add(plane, share, node[index[p, c]])
            drop[:] = 0.0
            flat = 0
            for face in range(faces):
                for i in range(rows):
                    for j in range(columns):
                        if tips[p, flat]:
                            drop[face, i, j] = max(plane[face, i, j], 0.0)
                        flat += 1
                for turn in range(begin, end):
                    q = beside(p, counts, turn)
                    if q >= 0:
                        for n in range(first[q * faces + face], first[q * faces + face + 1]):
                            _piece(pieces[n], u, v, plane[face], gentle, drop[face])
            if not drop.any():
                continue
            above[at] = True
            for c in range(index.shape[1]):
                if weight[p, c] > 0.0:
                    share = weight[p, c] / squares if gentle else 1.0
                    _raise(drops[part, index[p, c]], share, drop)


@njit()
def _add(total: Floats, share: float, values: Floats) -> None:
    for face in range(total.shape[0]):
        for i in range(total.shape[1]):
            for j in range(total.shape[2]):
                total[face, i, j] += share * values[face, i, j]


@njit()
def _raise(most: Floats, share: float, values: Floats) -> None:
    for face in range(most.shape[0]):
        for i in range(most.shape[1]):
            for j in range(most.shape[2]):
                most[face, i, j] = max(most[face, i, j], share * values[face, i, j])


def excess(
    node: Floats,
    places: Places,
    gentle: bool,
    which: Ints | None = None,
    around: bool = True,
) -> tuple[Floats, Ints]:
    """Return by how much each node must be lowered for the table to be nowhere above zero.

    Parameters
    ----------
    node : (Q, faces, nv, nu) float64
        Values less the limit that must not be reached.
    places : Places
        Where; of its postures those of `which` (S,), all by default.
    gentle : bool
        Whether to lower nodes only by their shares, which has to be repeated; otherwise the
        lowered table is certain to be below zero.
    around : bool
        Whether outlines of the postures next to each count there, or only its own.

    Returns
    -------
    (Q, faces, nv, nu) float64, (n,) int64
        By how much, 0 or more; the postures where the table is above zero somewhere.
    """
    which = np.arange(len(places.nodes)) if which is None else which
    drops = np.zeros((PARTS, *node.shape))
    above = np.zeros(len(which), np.bool_)
    _excess(node, places, (gentle, around), which, drops, above)
    return np.asarray(drops.max(axis=0)), which[above]
