"""Train the codes of a table: points, the cost of a reading, and descent over the nodes.

A reading is one multilinear interpolation of the codes of a cell's corners.  Codes are in steps:
STANDS and above says that the robot stands, MOST that it is at least 30 deg from tipping over.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Ints, Singles
from lutgen.jit import njit

# The sine of a tip angle of 0 and of 30 deg as codes; codes of a sine of 1; the largest code.
STANDS, MOST, SCALE, LARGEST = 100.0, 250.0, 300.0, 255.0
# Codes by which the exact code at a point is held off: 0.1 deg.
GUARD = 0.5
# The cost of a reading too low where the verdict is lost with it, and up to which code it is;
# the cost of one too high at first and at last.
LOST, NEARLY, FIRST, LAST = 7.0, STANDS + 2.5, 4.0, 300.0
BATCH = 40_000
# In the place of these costs: least squares.
SQUARES = -1.0


class Lattice(NamedTuple):
    """Axes of a table: `nodes` and `cells` (d,) of each, `knots` (d, most) in places."""

    nodes: Ints
    cells: Ints
    knots: Singles


class Points(NamedTuple):
    """Places x (n, d), the block of each (n,), -1: none, and the code wanted there (n,).

    In a table of tip angles a code below STANDS means that the robot tips.
    """

    x: Singles
    block: NDArray[np.int8]
    aim: Singles


class Course(NamedTuple):
    """How codes are trained: `guard` is by how many a reading must be below the exact code.

    A reading too high costs `first` to `last`, `SQUARES` where squares are minimised.
    """

    steps: int
    rate: float
    first: float
    last: float
    guard: float


@njit(inline=True)
def corners(points: Points, p: int, lattice: Lattice, node: Ints, weight: Singles) -> int:
    """Find the nodes of a point's cell and their weights; return how many, 0 beyond the axes."""
    nodes, cells, knots = lattice
    count = 1
    node[0], weight[0] = points.block[p], 1.0
    for c in range(len(nodes)):
        x, n, last = points.x[p, c], nodes[c], cells[c]
        if points.block[p] < 0 or x < knots[c, 0] or x > knots[c, last]:
            return 0
        i = 0
        while i < last - 1 and x >= knots[c, i + 1]:
            i += 1
        f = (x - knots[c, i]) / (knots[c, i + 1] - knots[c, i])
        up = i + 1 if i + 1 < n else 0
        for j in range(count):
            base, w = node[j] * n, weight[j]
            node[j], node[j + count] = base + i, base + up
            weight[j], weight[j + count] = w * (1.0 - f), w * f
        count *= 2
    return count


@njit()
def read(values: Singles, points: Points, lattice: Lattice) -> Singles:
    """Return the readings (n,) of points, 0 beyond the axes."""
    out = np.zeros(len(points.x), np.float32)
    node = np.empty(1 << len(lattice.nodes), np.int64)
    weight = np.empty(1 << len(lattice.nodes), np.float32)
    for p in range(len(out)):
        for j in range(corners(points, p, lattice, node, weight)):
            out[p] += values[node[j]] * weight[j]
    return out


@njit()
def _slope(
    values: Singles, points: Points, lattice: Lattice, begin: int, high: float, guard: float
) -> Singles:
    """Return the gradient (nodes,) of the loss of a batch; `high` < 0: of squares."""
    slopes = np.zeros_like(values)
    node = np.empty(1 << len(lattice.nodes), np.int64)
    weight = np.empty(1 << len(lattice.nodes), np.float32)
    for p in range(begin, min(begin + BATCH, len(points.x))):
        count = corners(points, p, lattice, node, weight)
        y, aim = np.float32(0.0), points.aim[p]
        for j in range(count):
            y += values[node[j]] * weight[j]
        if high < 0.0:
            slope = y - aim
        elif aim < STANDS:
            slope = high if y > STANDS - guard else 0.0
        elif y > aim - guard:
            slope = high
        else:
            slope = -LOST if y < NEARLY else -1.0
        if slope != 0.0:
            for j in range(count):
                slopes[node[j]] += np.float32(slope) * weight[j]
    return slopes


def descend(
    values: Singles, points: Points, lattice: Lattice, course: Course, rng: np.random.Generator
) -> Singles:
    """Return the codes after the steps of a course of Adam."""
    mean, square = np.zeros_like(values), np.zeros_like(values)
    for step in range(course.steps):
        done = step / course.steps
        high = course.first * (course.last / course.first) ** done
        begin = int(rng.integers(0, max(1, len(points.x) - BATCH + 1)))
        slope = _slope(values, points, lattice, begin, high, course.guard)
        mean = 0.9 * mean + 0.1 * slope
        square = 0.98 * square + 0.02 * slope * slope
        root = np.sqrt(square)
        rate = course.rate * (1.01 - done)
        change = rate * mean / (root + 1e-6 + 0.05 * np.sqrt(square.mean()))
        values = np.clip(values - change, 0.0, LARGEST).astype(np.float32)
    return values


@njit()
def lower(values: Singles, points: Points, lattice: Lattice, whole: bool, least: float) -> int:
    """Lower codes in place until no point is read above its exact code; return the false safes met.

    Each goes down by the least change that does; a point that tips to `least` below STANDS.
    """
    node = np.empty(1 << len(lattice.nodes), np.int64)
    weight = np.empty(1 << len(lattice.nodes), np.float32)
    met = 0
    for p in range(len(points.x)):
        count = corners(points, p, lattice, node, weight)
        aim = points.aim[p]
        tips = aim < STANDS
        limit = STANDS - GUARD if tips else aim
        goal = STANDS - least if tips else aim - GUARD
        for turn in range(60):
            y = square = 0.0
            for j in range(count):
                y += values[node[j]] * weight[j]
                square += weight[j] * weight[j]
            if y <= limit:
                break
            if turn == 0 and tips and y >= STANDS:
                met += 1
            for j in range(count):
                down = (y - goal) / square * weight[j]
                if whole:
                    down = np.floor(down + 0.4 + 0.02 * turn)
                values[node[j]] = max(values[node[j]] - down, 0.0)
    return met
