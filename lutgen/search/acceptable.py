"""The acceptable range of each parameter around a geometry: the paper's +-delta.

Owns the walk outwards from a geometry to where the cost first exceeds a limit.
"""

import numpy as np

from lutgen.bracket import halve
from lutgen.search.minimise import Cost, Floats

# Steps of the walk across the bounds; a violation narrower than one step may be stepped over.
STEPS = 256
# Halvings of the last step: the end of the range is then known to 1e-13 of the bounds.
HALVINGS = 36


def acceptable_range(cost: Cost, best: Floats, bounds: Floats, limit: float) -> Floats:
    """Return the largest interval of each parameter in which the cost stays within a limit.

    (k, 2), NaN throughout where the geometry `best` (k,) itself exceeds the limit.  While one
    parameter varies the others keep its values; intervals end at the `bounds` (k, 2) at the latest.

    Examples
    --------
    >>> bowl = lambda x: (x**2).sum(axis=1)
    >>> acceptable_range(bowl, np.zeros(2), np.array([[-3.0, 3.0], [-1.0, 3.0]]), 4.0).round(9)
    array([[-2.,  2.],
           [-1.,  2.]])
    """
    result = np.full((len(best), 2), np.nan)
    if not cost(best[None, :])[0] <= limit:
        return result
    for i in range(len(best)):
        for side in (0, 1):
            result[i, side] = _walk(cost, best, i, bounds[i, side], limit)
    return result


def half_widths(found: Floats, best: Floats, bounds: Floats) -> Floats:
    """Return (k,) the paper's delta: best +- delta is acceptable as far as the bounds go.

    A side that reaches its bound does not limit delta.
    """
    left, right = best - found[:, 0], found[:, 1] - best
    free_left, free_right = found[:, 0] <= bounds[:, 0], found[:, 1] >= bounds[:, 1]
    delta = np.minimum(left, right)
    delta = np.where(free_left, right, delta)
    delta = np.where(free_right, left, delta)
    return np.where(free_left & free_right, np.maximum(left, right), delta)


def _walk(cost: Cost, best: Floats, axis: int, end: float, limit: float) -> float:
    """Return how far one parameter can go towards `end`."""

    def costs(values: Floats) -> Floats:
        rows = np.tile(best, (len(values), 1))
        rows[:, axis] = values
        return cost(rows)

    line = np.linspace(best[axis], end, STEPS + 1)
    bad = ~(costs(line[1:]) <= limit)
    if not bad.any():
        return float(end)
    first = int(bad.argmax())
    ends = line[first : first + 1], line[first + 1 : first + 2]
    inside, _ = halve(lambda values: ~(costs(values) <= limit), *ends, HALVINGS)
    return float(inside[0])
