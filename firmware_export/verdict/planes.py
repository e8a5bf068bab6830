"""The planes of a tree's nodes, as a leaf holds them: coefficients of 7 bits, moved to be safe.

Owns the descent by which a plane is turned until it gives up least of the points of its box.
"""

import numpy as np

from firmware_export.verdict.grow import Forest, Nodes
from firmware_export.verdict.points import Points
from lutgen.jit import in_threads, njit
from lutgen.vector import Floats

# A coefficient of 1 in a leaf; by how much one is changed at a time, in turn; rounds at most.
WHOLE, ROUNDS = 63, 2
STEPS = np.rint(np.array([0.6, 0.3, 0.15, 0.08, 0.04, 0.02]) * WHOLE) / WHOLE
# Points of a box up to which its plane is turned on all of them; of a larger one on so many.
MOST_POINTS, FEW_POINTS = 50_000, 5_000
# By how much of the box, for each unit of the coefficients, the proof is expected to move a plane
# of a robot that has parameters: one that would give up much then is not chosen.
AWAY = 0.01


@njit()
def _turn(
    x: Floats,
    worth: Floats,
    tipping: int,
    height: Floats,
    moved: Floats,
    a: Floats,
    expected: float,
) -> tuple[float, float]:
    """Turn `a` (d,); return its limit and what it gives up.  Points (d, m), the tipping first.

    `expected` is how far the proof may move it, for each unit of its coefficients.  `height` and
    `moved` (m,) are room for a . x now and after a change.
    """
    d, m = x.shape
    limit, least, fresh = 0.0, 1e300, True
    for _ in range(ROUNDS):
        better = False
        for step in STEPS:
            for k in range(d):
                for way in range(-1, 2):
                    if way == 0 and not fresh:
                        continue
                    fresh = False
                    change = way * step
                    if abs(a[k] + change) > 1.0001:
                        continue
                    length = abs(a[k] + change) - abs(a[k])
                    for other in range(d):
                        length += abs(a[other])
                    top = -1e300
                    for i in range(tipping):
                        moved[i] = height[i] + change * x[k, i]
                        top = max(top, moved[i])
                    away = top + expected * length
                    lost = 0.0
                    for i in range(tipping, m):
                        moved[i] = height[i] + change * x[k, i]
                        if moved[i] <= away:
                            lost += worth[i]
                    if lost < least:
                        least, limit, better = lost, top, True
                        a[k] += change
                        height[:m] = moved[:m]
        if not better:
            break
    return limit, least


@njit()
def _measure(
    points: Points, nodes: Nodes, n: int, a: Floats, expected: float
) -> tuple[float, float]:
    """Return the limit of a plane in a node, and what it gives up, as `_turn`: of all points."""
    d = len(a)
    limit, lost = -1e300, 0.0
    for stands in range(2):
        away = limit + expected * np.abs(a).sum()
        for p in range(nodes.first[n], nodes.last[n]):
            if (points.worth[p] > 0.0) != (stands == 1):
                continue
            height = 0.0
            for k in range(d):
                height += a[k] * (points.x[p, k] - nodes.low[n, k]) / nodes.size[n, k]
            if not stands:
                limit = max(limit, height)
            elif height <= away:
                lost += points.worth[p]
    return limit, lost


@njit()
def _refine_some(begin: int, end: int, points: Points, nodes: Nodes) -> int:
    d = nodes.low.shape[1]
    expected = AWAY if d > 2 else 0.0
    a = np.empty(d)
    for n in range(begin, end):
        m = nodes.last[n] - nodes.first[n]
        if nodes.tips[n] == 0.0:
            continue
        if nodes.stands[n] == 0.0:
            nodes.lost[n] = 0.0
            continue
        stride = 1 if m <= MOST_POINTS else m // FEW_POINTS
        most = 0.0
        for k in range(d):
            # Fitted in the box of its parent.
            a[k] = nodes.plane[n, k] * nodes.size[n, k] / nodes.size[nodes.parent[n], k]
            most = max(most, abs(a[k]))
        if most == 0.0:
            a[0] = most = 1.0
        for k in range(d):
            a[k] = np.rint(a[k] / most * WHOLE) / WHOLE
        seen = (m + stride - 1) // stride
        x, worth = np.empty((d, seen)), np.empty(seen)
        height, moved = np.zeros(seen), np.empty(seen)
        at = 0
        tipping = 0
        for stands in range(2):
            for p in range(nodes.first[n], nodes.last[n], stride):
                if (points.worth[p] > 0.0) != (stands == 1):
                    continue
                for k in range(d):
                    x[k, at] = (points.x[p, k] - nodes.low[n, k]) / nodes.size[n, k]
                    height[at] += a[k] * x[k, at]
                worth[at] = points.worth[p]
                at += 1
            if stands == 0:
                tipping = at
        limit, lost = _turn(x, worth, tipping, height, moved, a, expected)
        if stride > 1:
            limit, lost = _measure(points, nodes, n, a, expected)
        nodes.plane[n, :d] = a
        nodes.plane[n, d], nodes.lost[n] = limit, lost
    return 0


@njit()
def _sum_some(begin: int, end: int, forest: Forest, limit: Floats, kept: Floats) -> int:
    nodes = forest.nodes
    d = nodes.low.shape[1]
    for n in range(begin, end):
        for p in range(nodes.first[n], nodes.last[n]):
            height = 0.0
            for k in range(d):
                height += nodes.plane[n, k] * (forest.x[p, k] - nodes.low[n, k]) / nodes.size[n, k]
            if height > limit[n]:
                kept[n] += forest.worth[p]
    return 0


def kept_by(forest: Forest, limit: Floats) -> Floats:
    """Return what the points are worth (n,) that each node's plane calls safe at a limit (n,)."""
    kept = np.zeros(len(limit))
    in_threads(_sum_some, len(limit), forest, limit, kept)
    return kept


def refine(points: Points, nodes: Nodes) -> None:
    """Turn the planes of all nodes, and tell anew what each gives up."""
    in_threads(_refine_some, len(nodes.axis), points, nodes)
