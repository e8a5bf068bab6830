"""The tree as it grows: boxes that are halved, each with a half-space of its own.

Owns where boxes are halved.  A node is a box of places; a leaf says that all of it is safe, that
none is, or that the side of a plane is.  Level by level every box that would give up much as a leaf
is halved along the axis after which its halves would give up least, each with the better of a plane
of its own and of being halved once more.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.verdict.halves import best_axis, empty_desk, weigh_halves
from firmware_export.verdict.points import Points
from lutgen.jit import in_threads, njit
from lutgen.vector import Floats, Ints, Singles

# Nodes and levels at most, and the share of all that stands for which no box is halved.
MOST_NODES, LEVELS, WORTHWHILE = 400_000, 26, 2.5e-6


class Nodes(NamedTuple):
    """Nodes of a tree, children behind their parents, the two of a node one after the other.

    `axis` (n,) along which a node is halved, -1: it is not; `child` (n,) the lower half; `parent`.
    `low`, `size` (n, d): its box.  `plane` (n, d + 1): what is safe is where the first d, times
    the place in the box, 0 to 1, come to more than the last.  `stands` (n,): how many
    configurations of its box stand, `lost` how many of them the plane gives up; `tips`: how many
    points must not be safe.  `first`, `last` (n,): its points, which lie side by side.
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


class _Growing(NamedTuple):
    """A tree, and the length (d,) than which no side of a box is shorter."""

    nodes: Nodes
    shortest: Floats


class Forest(NamedTuple):
    """The trees of all faces, whose roots are the first nodes.

    `nodes`: `first` and `last` tell the points of each among all that stand, `x` (m, d) with
    `worth` (m,).
    """

    nodes: Nodes
    x: Singles
    worth: Singles


@njit(inline=True)
def _some(points: Points, first: int, last: int) -> Points:
    """Return the points of a node."""
    return Points(
        points.x[first:last],
        points.aim[first:last],
        points.weight[first:last],
        points.worth[first:last],
    )


@njit(inline=True)
def _swap(points: Points, i: int, j: int) -> None:
    for k in range(points.x.shape[1]):
        points.x[i, k], points.x[j, k] = points.x[j, k], points.x[i, k]
    points.aim[i], points.aim[j] = points.aim[j], points.aim[i]
    points.weight[i], points.weight[j] = points.weight[j], points.weight[i]
    points.worth[i], points.worth[j] = points.worth[j], points.worth[i]


@njit()
def _halve_some(
    begin: int, end: int, level: int, points: Points, growing: _Growing, split: Ints, halves: Floats
) -> int:
    """Choose the axes of nodes level + [begin, end), and sort their points.

    An axis is -1 where a node is not to be halved, 0 where the best is sought, else told, plus 1.
    `split` (m,) receives where the upper half's points begin.  `halves` (m, 2, d + 4): of each half
    its plane, `stands`, `tips` and an estimate of `lost`.
    """
    nodes = growing.nodes
    d = nodes.low.shape[1]
    desk = empty_desk(d)
    for at in range(begin, end):
        n = level + at
        first, last = nodes.first[n], nodes.last[n]
        told = nodes.axis[n] - 1
        if told < -1:
            continue
        nodes.axis[n] = -1
        low, size = nodes.low[n], nodes.size[n]
        stride = weigh_halves(_some(points, first, last), low, size, desk)
        k = told if told >= 0 else best_axis(size, growing.shortest, desk)
        if k < 0:
            continue
        nodes.axis[n] = k
        i, j, middle = first, last - 1, low[k] + 0.5 * size[k]
        while i <= j:
            if points.x[i, k] >= middle:
                _swap(points, i, j)
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
                worth = points.worth[q]
                half[d + 1] += worth
                half[d + 2] += worth == 0.0
            half[d + 3] = 0.0 if half[d + 2] == 0.0 else stride * desk.lost[2 * k + s]
    return 0


def grow(points: Points, shortest: Floats, bits: int) -> Nodes:
    """Return the tree of one face, as finely halved as is worthwhile for its points, and sort them.

    Its first levels halve v and u in turn, `bits` times each, for a directory.
    """
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
    growing = _Growing(nodes, shortest)
    nodes.last[0] = len(points.x)
    nodes.stands[0] = nodes.lost[0] = points.worth.sum(dtype=np.float64)
    nodes.tips[0] = np.count_nonzero(points.worth == 0.0)
    enough = WORTHWHILE * float(nodes.stands[0])
    begin, end = 0, 1
    for level in range(LEVELS):
        here = slice(begin, end)
        cells = level < 2 * bits
        worth = nodes.stands[here] > 0.0 if cells else nodes.lost[here] >= enough
        wanted = (nodes.tips[here] > 0.0) & (worth | (level == 0))
        nodes.axis[here] = np.where(wanted, d - level % 2 if cells else 0, -1)
        count = end - begin
        split, halves = np.zeros(count, np.int64), np.zeros((count, 2, d + 4))
        in_threads(_halve_some, count, begin, points, growing, split, halves)
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
    return nodes.part(slice(end))


def joined(parts: list[tuple[Points, Nodes]]) -> Forest:
    """Return the trees of all faces as one forest, with those of their points that stand."""
    total, begin = len(parts), 0
    kept, standing = [], []
    for face, (points, nodes) in enumerate(parts):
        at = total - 1 + np.arange(len(nodes.axis))
        at[0] = face
        stands = points.worth > 0.0
        # How many of those before each stand.
        before = begin + np.concatenate([[0], np.cumsum(stands)])
        first, last = before[nodes.first], before[nodes.last]
        child, parent = at[nodes.child], at[nodes.parent]
        kept.append(nodes._replace(child=child, parent=parent, first=first, last=last))
        standing.append((points.x[stands], points.worth[stands]))
        total, begin = total + len(at) - 1, int(before[-1])
    ends = [one.part(which) for which in (slice(1), slice(1, None)) for one in kept]
    columns: Any = zip(*ends, strict=True)
    x, worth = map(np.concatenate, zip(*standing, strict=True))
    return Forest(Nodes(*map(np.concatenate, columns)), x, worth)
