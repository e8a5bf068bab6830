"""The tree as it grows: boxes that are halved, each with a half-space of its own.

Owns where boxes are halved.  A node is a box of places; a leaf says that all of it is safe, that
none is, or that the side of a plane is.  Level by level every box that would give up much as a leaf
is halved along the axis after which its halves would give up least, each with the better of a plane
of its own and of being halved once more.  Planes are least-squares fits of the tip angle, moved to
where no point that tips is on the safe side.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.verdict.points import Points
from lutgen.jit import in_threads, njit
from lutgen.vector import Floats, Ints, Singles

# Nodes and levels at most, and the share of all that stands for which no box is halved.
MOST_NODES, LEVELS, WORTHWHILE = 400_000, 26, 2.5e-6
# Points of a box that are looked at, and of those the ones that planes are fitted to.
LOOKED_AT, FITTED = 8_000, 3_000
# How much the halves' own planes count beside being halved once more.
OWN = 0.1
RIDGE = 0.001


class Nodes(NamedTuple):
    """Nodes of a tree, children behind their parents, the two of a node one after the other.

    `axis` (n,) along which a node is halved, -1: it is not; `child` (n,) the lower half; `parent`.
    `low`, `size` (n, d): its box.  `plane` (n, d + 1): what is safe is where the first d, times
    the place in the box, 0 to 1, come to more than the last.  `stands` (n,): how many
    configurations of its box stand, `lost` how many of them the plane gives up; `tips`: how many
    points must not be safe.  `first`, `last` (n,): its points in `order` of `Grown`.
    """

    axis: NDArray[np.int8]
    child: NDArray[np.int64]
    parent: NDArray[np.int64]
    low: Floats
    size: Floats
    plane: Floats
    stands: Floats
    lost: Floats
    tips: Floats
    first: Ints
    last: Ints

    def part(self, which: Any) -> "Nodes":
        """Return some of the nodes: indices, a slice or a mask."""
        columns: Any = (column[which] for column in self)
        return Nodes(*columns)


class Grown(NamedTuple):
    """A tree, and the order in which it holds its points: those of a node side by side.

    `shortest` (d,): no side of a box is shorter.
    """

    nodes: Nodes
    order: Ints
    shortest: Floats


class Forest(NamedTuple):
    """The trees of all faces, whose roots are the first nodes.

    `nodes`: `first` and `last` tell the points of each among all that stand, `x` (m, d) with
    `worth` (m,).
    """

    nodes: Nodes
    x: Singles
    worth: Singles


class _Desk(NamedTuple):
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
def _empty_desk(d: int) -> _Desk:
    cells = 2 * d + 4 * d * d
    return _Desk(
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
def _cell(d: int, c: int, k: int, k2: int, side: Ints) -> int:
    """Return the row of the half along k2 of half c, which is one along k."""
    half = side[d + k] if k2 == k else side[k2]
    return int(2 * d + c * 2 * d + 2 * k2 + half)


@njit()
def _sum(
    points: Points, order: Ints, steps: tuple[int, int], low: Floats, size: Floats, desk: _Desk
) -> None:
    """Sum what planes are fitted with over every so manieth of a node's points."""
    d = len(low)
    x, side = np.ones(d + 1), np.zeros(2 * d, np.int64)
    stride, sparse = steps
    desk.moments[:] = 0.0
    desk.right[:] = 0.0
    desk.tips[:] = 0.0
    seen = 0
    for q in range(0, len(order), stride):
        p = order[q]
        _locate(points, p, low, size, x, side)
        tips = points.worth[p] == 0.0
        fitted = seen % sparse == 0
        seen += 1
        if not (tips or fitted):
            continue
        w, aim = points.weight[p], points.weight[p] * points.aim[p]
        for k in range(d):
            c = 2 * k + side[k]
            for also in range(d + 1):
                g = c if also == d else _cell(d, c, k, also, side)
                if tips:
                    desk.tips[g] += 1.0
                if fitted:
                    for i in range(d + 1):
                        desk.right[g, i] += aim * x[i]
                        wx = w * x[i]
                        for j in range(i, d + 1):
                            desk.moments[g, i, j] += wx * x[j]


@njit()
def _weigh(
    points: Points, order: Ints, stride: int, low: Floats, size: Floats, desk: _Desk
) -> None:
    """Fill how far each plane must be moved for what tips, and what it gives up then."""
    d = len(low)
    x, side = np.ones(d + 1), np.zeros(2 * d, np.int64)
    desk.limit[:] = -1e300
    desk.lost[:] = 0.0
    for stands in range(2):
        for q in range(0, len(order), stride):
            p = order[q]
            if (points.worth[p] > 0.0) != (stands == 1):
                continue
            _locate(points, p, low, size, x, side)
            for k in range(d):
                c = 2 * k + side[k]
                for also in range(d + 1):
                    g = c if also == d else _cell(d, c, k, also, side)
                    if stands and desk.tips[g] == 0.0:
                        continue
                    f = 0.0
                    for i in range(d):
                        f += desk.plane[g, i] * x[i]
                    if not stands:
                        desk.limit[g] = max(desk.limit[g], f)
                    elif f <= desk.limit[g]:
                        desk.lost[g] += points.worth[p]


@njit()
def _best_axis(size: Floats, shortest: Floats, desk: _Desk) -> int:
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
def _halve_some(
    begin: int, end: int, level: int, points: Points, grown: Grown, split: Ints, halves: Floats
) -> int:
    """Choose the axes of nodes level + [begin, end), and sort their points.

    `split` (m,) receives where the upper half's points begin.  `halves` (m, 2, d + 4): of each half
    its plane, `stands`, `tips` and an estimate of `lost`.
    """
    nodes, order = grown.nodes, grown.order
    d = nodes.low.shape[1]
    desk = _empty_desk(d)
    for at in range(begin, end):
        n = level + at
        first, last = nodes.first[n], nodes.last[n]
        if nodes.axis[n] != 0:
            continue
        nodes.axis[n] = -1
        low, size = nodes.low[n], nodes.size[n]
        mine = order[first:last]
        stride = max(1, len(mine) // LOOKED_AT)
        _sum(points, mine, (stride, max(1, len(mine) // stride // FITTED)), low, size, desk)
        for g in range(len(desk.lost)):
            _solve(desk.moments[g], desk.right[g], desk.square, desk.plane[g])
        _weigh(points, mine, stride, low, size, desk)
        k = _best_axis(size, grown.shortest, desk)
        if k < 0:
            continue
        nodes.axis[n] = k
        i, j, middle = first, last - 1, low[k] + 0.5 * size[k]
        while i <= j:
            if points.x[order[i], k] >= middle:
                order[i], order[j] = order[j], order[i]
                j -= 1
            else:
                i += 1
        split[at] = i
        for s in range(2):
            half = halves[at, s]
            half[: d + 1] = desk.plane[2 * k + s]
            half[d] = desk.limit[2 * k + s]
            half[d + 1] = half[d + 2] = 0.0
            for q in range(first if s == 0 else i, i if s == 0 else last):
                worth = points.worth[order[q]]
                half[d + 1] += worth
                half[d + 2] += worth == 0.0
            half[d + 3] = 0.0 if half[d + 2] == 0.0 else stride * desk.lost[2 * k + s]
    return 0


def grow(points: Points, shortest: Floats) -> Grown:
    """Return the tree of one face, as finely halved as is worthwhile for its points."""
    d = points.x.shape[1]
    most = MOST_NODES
    nodes = Nodes(
        np.full(most, -1, np.int8),
        np.zeros(most, np.int64),
        np.zeros(most, np.int64),
        np.zeros((most, d)),
        np.ones((most, d)),
        np.zeros((most, d + 1)),
        np.zeros(most),
        np.zeros(most),
        np.zeros(most),
        np.zeros(most, np.int64),
        np.zeros(most, np.int64),
    )
    grown = Grown(nodes, np.arange(len(points.x)), shortest)
    nodes.last[0] = len(points.x)
    nodes.stands[0] = nodes.lost[0] = points.worth.sum(dtype=np.float64)
    nodes.tips[0] = np.count_nonzero(points.worth == 0.0)
    enough = WORTHWHILE * float(nodes.stands[0])
    begin, end = 0, 1
    for level in range(LEVELS):
        here = slice(begin, end)
        wanted = (nodes.tips[here] > 0.0) & (nodes.lost[here] >= (enough if level else 0.0))
        nodes.axis[here] = np.where(wanted, 0, -1)
        count = end - begin
        split, halves = np.zeros(count, np.int64), np.zeros((count, 2, d + 4))
        in_threads(_halve_some, count, begin, points, grown, split, halves)
        halved = np.flatnonzero(nodes.axis[here] >= 0)[: (most - end) // 2]
        nodes.axis[here][~np.isin(np.arange(count), halved)] = -1
        if not len(halved):
            break
        parent = begin + halved
        lower = end + 2 * np.arange(len(halved))
        axis = nodes.axis[parent]
        nodes.child[parent] = lower
        for s in range(2):
            child, half = lower + s, halves[halved, s]
            nodes.parent[child] = parent
            nodes.low[child], nodes.size[child] = nodes.low[parent], nodes.size[parent]
            nodes.size[child, axis] *= 0.5
            if s:
                nodes.low[child, axis] += nodes.size[child, axis]
            nodes.first[child] = split[halved] if s else nodes.first[parent]
            nodes.last[child] = nodes.last[parent] if s else split[halved]
            nodes.plane[child] = half[:, : d + 1]
            nodes.stands[child], nodes.tips[child] = half[:, d + 1], half[:, d + 2]
            nodes.lost[child] = half[:, d + 3]
        begin, end = end, end + 2 * len(halved)
    return grown._replace(nodes=nodes.part(slice(end)))


def joined(parts: list[tuple[Points, Grown]]) -> Forest:
    """Return the trees of all faces as one forest, with those of their points that stand."""
    total, begin = len(parts), 0
    kept, standing = [], []
    for face, (points, (nodes, order, _)) in enumerate(parts):
        at = total - 1 + np.arange(len(nodes.axis))
        at[0] = face
        stands = points.worth[order] > 0.0
        # Of a tree's order, how many of those before each stand.
        before = begin + np.concatenate([[0], np.cumsum(stands)])
        first, last = before[nodes.first], before[nodes.last]
        child, parent = at[nodes.child], at[nodes.parent]
        kept.append(nodes._replace(child=child, parent=parent, first=first, last=last))
        standing.append((points.x[order[stands]], points.worth[order[stands]]))
        total, begin = total + len(at) - 1, int(before[-1])
    ends = [one.part(which) for which in (slice(1), slice(1, None)) for one in kept]
    columns: Any = zip(*ends, strict=True)
    x, worth = map(np.concatenate, zip(*standing, strict=True))
    return Forest(Nodes(*map(np.concatenate, columns)), x, worth)
