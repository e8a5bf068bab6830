"""The lattice of middles at which outlines are drawn, and how far contacts move around each.

Owns how finely the box of parameters is cut, and what is tightened for the parts of it.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numba
import numpy as np

from firmware_export.grid import PLACES
from firmware_export.truth import Model, combinations
from firmware_export.verdict.outline import CURVED, WIDTH, Slab
from lutgen.channels import acceptance_of
from lutgen.jit import in_pool
from lutgen.support import pack
from lutgen.vector import Floats, Ints

# Middles at most, in all and along an axis, and of a slab that is worked on at once.
MOST, MOST_ALONG, AT_ONCE = 600_000, 4096, 4096
# Sides of a box are no shorter than so many sub-cells, of which a middle speaks for two, and than
# such a part of the chart: in less there are too few points to turn a plane by.
SUB_CELLS, SHORTEST = 6.0, 1.0 / 256.0
# Part of how far contacts move by which the line between two middles may be off for one in between.
BENT = 0.2
# By how many units of an axis the runtime may misplace a parameter.
MISPLACED = 4.0

Job = TypeVar("Job")
Result = TypeVar("Result")


class Middles:
    """The middles of a model's box, `per_axis` along each parameter."""

    def __init__(self, model: Model) -> None:
        self.model, self.k = model, model.k
        along = min(MOST ** (1.0 / max(self.k, 1)) * (1.0 + 1e-9), MOST_ALONG)
        # Boxes of the tree end where sub-cells do: 2^n or 3 2^n of them.
        finest = 1 << max(int(math.log2(along)), 1)
        self.per_axis = finest * 3 // 2 if finest * 3 // 2 <= along else finest
        n = self.per_axis
        beyond = MISPLACED / PLACES
        middle = (np.arange(n) + 0.5) / n
        # What is next to the first and the last middle is what ends there.
        self._place = np.concatenate([[-beyond], middle, [1.0 + beyond]])

    @property
    def shortest(self) -> Floats:
        """Return the shortest side of a box along each axis: some middles, or part of the chart."""
        return np.array([SUB_CELLS / self.per_axis] * self.k + [SHORTEST] * 2)

    def slab(self, first: Ints, last: Ints) -> Slab:
        """Return the middles with indices first <= i < last (k,) along each axis."""
        k, n, model = self.k, self.per_axis, self.model
        axes = [self._place[a : b + 2] for a, b in zip(first, last, strict=True)]
        shape = tuple(len(axis) for axis in axes)
        where = model.postures(model.at(combinations(axes)))
        inner = (slice(1, -1),) * k
        centres = where.centres.reshape(*shape, -1, 3)
        middle = np.ascontiguousarray(centres[inner]).reshape(-1, centres.shape[-2], 3)
        axle = where.axes.reshape(*shape, -1, 3)[inner].reshape(middle.shape)
        moved = np.zeros(middle.shape[:2])
        # Summed over the axes: a corner differs along all of them.
        reach = CURVED * (0.5 + MISPLACED * n / PLACES)
        ways = np.empty((len(middle), 2 * k, *middle.shape[1:]))
        for a in range(k):
            for s, side in enumerate((slice(None, -2), slice(2, None))):
                beside = centres[(*inner[:a], side, *inner[a + 1 :])].reshape(middle.shape)
                ways[:, 2 * a + s] = reach * (beside - middle)
            moved += np.sqrt((ways[:, 2 * a : 2 * a + 2] ** 2).sum(axis=3)).max(axis=1)
        inside = [np.arange(a, b) for a, b in zip(first, last, strict=True)]
        index = combinations(inside)
        low, high = np.maximum((index - 0.5) / n, 0.0), np.minimum((index + 1.5) / n, 1.0)
        farthest = BENT * float(moved.max(initial=0.0))
        size = float(np.sqrt((middle**2).sum(axis=2)).max())
        tighter = farthest / (WIDTH * size)
        accept = acceptance_of(model.recipe, tighter)
        wider = 2.0 * (farthest + tighter * float(model.radius.max(initial=0.0)))
        accept = accept._replace(rest_width=accept.rest_width + wider, contact_tolerance=0.0)
        return Slab(
            low, high, pack(middle, axle, model.radius, model.kind), moved, ways, accept, tighter
        )

    def slabs(self) -> Iterator[tuple[Ints, Ints]]:
        """Yield first and last (k,) of slabs that make up the lattice."""
        k, n = self.k, self.per_axis
        if k == 0:
            yield np.zeros(0, np.int64), np.zeros(0, np.int64)
            return
        rows = max(1, min(n, round(AT_ONCE / n ** (k - 1))))
        for row in range(0, n, rows):
            first, last = np.zeros(k, np.int64), np.full(k, n)
            first[0], last[0] = row, min(row + rows, n)
            yield first, last


def each(work: Callable[[Job], Result], jobs: Iterable[Job]) -> list[Result]:
    """Return what `work` answers to each job, in order; in threads, as it is NumPy and kernels."""
    first, *others = jobs
    # What is not compiled yet is compiled here: Ctrl-C does not reach other threads.
    return [work(first), *in_pool(work, others, numba.get_num_threads())]
