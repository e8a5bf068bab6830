"""The halves of a box along every axis, and the halves of those: what each gives up as a leaf.

Owns how a plane is fitted to points: least squares of the tip angle, moved to where no point that
tips is on the safe side.
"""

from typing import NamedTuple

import numpy as np

from firmware_export.verdict.points import Points
from lutgen.jit import njit
from lutgen.vector import Floats, Ints

# Points of a box that are looked at, and of those the ones that planes are fitted to.
LOOKED_AT, FITTED = 8_000, 3_000
# How much the halves' own planes count beside being halved once more.
OWN = 0.1
RIDGE = 0.001


class Desk(NamedTuple):
    """Room for one node: what is summed for its halves, and for the halves of those.

    2 d rows of halves (axis, side), then (2 d)^2 of halves of halves.
    """

    moments: Floats
    right: Floats
    plane: Floats
    limit: Floats
    lost: Floats
    tips: Floats
    square: Floats


@njit()
def empty_desk(d: int) -> Desk:
    """Return room for nodes of d axes."""
    cells = 2 * d + 4 * d * d
    return Desk(
        np.empty((cells, d + 1, d + 1)),
        np.empty((cells, d + 1)),
        np.empty((cells, d + 1)),
        np.empty(cells),
        np.empty(cells),
        np.empty(cells),
        np.empty((d + 1, d + 2)),
    )


@njit()
def _solve(moments: Floats, right: Floats, work: Floats, out: Floats) -> None:
    """Fill `out` (e,) with the weighted fit: a little ridge, elimination with pivots."""
    e = len(out)
    for i in range(e):
        for j in range(e):
            work[i, j] = moments[min(i, j), max(i, j)]
        work[i, e] = right[i]
        ridge = 1.0 if i < e - 1 else 1e-6
        work[i, i] += RIDGE * ridge * (moments[e - 1, e - 1] + 1e-9)
    for i in range(e):
        p = i
        for k in range(i + 1, e):
            if abs(work[k, i]) > abs(work[p, i]):
                p = k
        if abs(work[p, i]) < 1e-12:
            out[:] = 0.0
            return
        for j in range(e + 1):
            work[i, j], work[p, j] = work[p, j], work[i, j]
        for k in range(i + 1, e):
            f = work[k, i] / work[i, i]
            for j in range(i, e + 1):
                work[k, j] -= f * work[i, j]
    for i in range(e - 1, -1, -1):
        total = work[i, e]
        for j in range(i + 1, e):
            total -= work[i, j] * out[j]
        out[i] = total / work[i, i]


@njit(inline=True)
def _locate(points: Points, p: int, low: Floats, size: Floats, x: Floats, side: Ints) -> None:
    """Fill the place `x` in a box, and per axis its half, and which half of that."""
    d = len(low)
    for k in range(d):
        x[k] = (points.x[p, k] - low[k]) / size[k]
        half = 1 if x[k] >= 0.5 else 0
        side[k] = half
        side[d + k] = 1 if 2.0 * x[k] - half >= 0.5 else 0


@njit(inline=True)
def _pair(d: int, c: int, k2: int, s2: int) -> int:
    """Return the row of half s2 along k2 of half c."""
    return 2 * d + c * 2 * d + 2 * k2 + s2


@njit(inline=True)
def _cell(d: int, k: int, k2: int, side: Ints) -> int:
    """Return the row of the half along k2, where a place is, of that along k."""
    return int(_pair(d, 2 * k + side[k], k2, side[d + k] if k2 == k else side[k2]))


@njit()
def _sum(points: Points, steps: tuple[int, int], low: Floats, size: Floats, desk: Desk) -> None:
    """Sum what planes are fitted with over every so manieth of a node's points."""
    d = len(low)
    x, side = np.ones(d + 1), np.zeros(2 * d, np.int64)
    stride, sparse = steps
    desk.moments[:] = 0.0
    desk.right[:] = 0.0
    desk.tips[:] = 0.0
    seen = 0
    for p in range(0, len(points.worth), stride):
        _locate(points, p, low, size, x, side)
        tips = points.worth[p] == 0.0
        fitted = seen % sparse == 0
        seen += 1
        if not (tips or fitted):
            continue
        w, aim = points.weight[p], points.weight[p] * points.aim[p]
        for k in range(d):
            for k2 in range(k, d):
                g = _cell(d, k, k2, side)
                if tips:
                    desk.tips[g] += 1.0
                if fitted:
                    for i in range(d + 1):
                        desk.right[g, i] += aim * x[i]
                        wx = w * x[i]
                        for j in range(i, d + 1):
                            desk.moments[g, i, j] += wx * x[j]
    for c in range(2 * d):
        for s in range(2):
            g = _pair(d, c, c // 2, s)
            desk.tips[c] += desk.tips[g]
            desk.right[c] += desk.right[g]
            desk.moments[c] += desk.moments[g]


@njit()
def _fit(d: int, desk: Desk) -> None:
    """Fill the planes of all halves, and of those of halves that `_sum` has filled."""
    for c in range(2 * d):
        _solve(desk.moments[c], desk.right[c], desk.square, desk.plane[c])
        for g in range(_pair(d, c, c // 2, 0), _pair(d, c, d, 0)):
            _solve(desk.moments[g], desk.right[g], desk.square, desk.plane[g])


@njit()
def _weigh(points: Points, stride: int, low: Floats, size: Floats, desk: Desk) -> None:
    """Fill how far each plane must be moved for what tips, and what it gives up then."""
    d = len(low)
    x, side = np.ones(d + 1), np.zeros(2 * d, np.int64)
    desk.limit[:] = -1e300
    desk.lost[:] = 0.0
    for stands in range(2):
        for p in range(0, len(points.worth), stride):
            if (points.worth[p] > 0.0) != (stands == 1):
                continue
            _locate(points, p, low, size, x, side)
            for k in range(d):
                for k2 in range(k, d + 1):
                    g = 2 * k + side[k] if k2 == d else _cell(d, k, k2, side)
                    if stands and desk.tips[g] == 0.0:
                        continue
                    f = 0.0
                    for i in range(d):
                        f += desk.plane[g, i] * x[i]
                    if not stands:
                        desk.limit[g] = max(desk.limit[g], f)
                    elif f <= desk.limit[g]:
                        desk.lost[g] += points.worth[p]
    for c in range(2 * d):
        for k2 in range(c // 2):  # which half is taken first makes no difference
            for s in range(2):
                desk.lost[_pair(d, c, k2, s)] = desk.lost[_pair(d, 2 * k2 + s, c // 2, c % 2)]


@njit()
def best_axis(size: Floats, shortest: Floats, desk: Desk) -> int:
    """Return the axis along which halves give up least, -1 where all sides are short."""
    d = len(size)
    best, least = -1, 1e300
    for k in range(d):
        if size[k] < 1.5 * shortest[k]:
            continue
        total = 0.0
        for s in range(2):
            c = 2 * k + s
            again = 1e300
            for k2 in range(d):
                pair = 2 * d + c * 2 * d + 2 * k2
                again = min(again, desk.lost[pair] + desk.lost[pair + 1])
            total += OWN * desk.lost[c] + (1.0 - OWN) * min(desk.lost[c], again)
        if total < least:
            best, least = k, total
    return int(best)


@njit()
def weigh_halves(points: Points, low: Floats, size: Floats, desk: Desk) -> int:
    """Fill what each half of a box, and each half of that, would give up; of its points alone.

    Returns one in how many points was looked at.
    """
    count = len(points.worth)
    stride = max(1, count // LOOKED_AT)
    _sum(points, (stride, max(1, count // stride // FITTED)), low, size, desk)
    _fit(len(low), desk)
    _weigh(points, stride, low, size, desk)
    return stride
