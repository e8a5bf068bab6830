"""Four methods that find a minimum inside a box, and how far it may be left.

Three are the paper's: the smallest node of a map, Nelder-Mead (MATLAB's fminsearch), and a search
that refines a mesh of five nodes a side.  The paper says of its search that it can end in a local
minimum; `multistart` is the answer to that.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from lutgen.arrays import Bools, Floats
from lutgen.bracket import halve

# Takes (m, k) points and returns (m,) costs.
Cost = Callable[[Floats], Floats]

NODES = 5
LEVELS = 6
# Nelder-Mead, as shares of the bounds, so that neither units nor zeros of joints matter.  For
# the paper's 50 deg the simplex ends at the 1e-4 (deg) of MATLAB's fminsearch.
FIRST_SIMPLEX = 0.05
TOLERANCE = 2e-6
EVALUATIONS = 400  # for each parameter
# `multistart`: candidates for k parameters, how many of them are refined roughly (to this share
# of the bounds), and how many of those to the end.
CANDIDATES_LOG2 = 7
MOST_LOG2 = 12
STARTS = 32
ROUGH = 0.01
FINALISTS = 5
# The best of them is refined again and again with these simplices, because the first one may have
# collapsed on a crease of |SD_g|, until none of them helps or for so many rounds.
FRESH_SIMPLICES = (FIRST_SIMPLEX, FIRST_SIMPLEX / 4.0, FIRST_SIMPLEX / 16.0)
ROUNDS = 5
# Steps of the walk across the bounds to the end of what is acceptable; a violation narrower than
# one may be stepped over.  The last one is halved: the end is known to 1e-13 of the bounds.
STEPS, HALVINGS = 256, 36


@dataclass(frozen=True)
class Step:
    """The best point of one step of a search, and the value there.

    In this file points are those of the box, and values are costs; in an `Optimum` `params` (k,) is
    in rad or length, and `value` that of the objective, NaN where the robot tips.  `evaluations`
    counts from the beginning; `nodes` (n, k) is empty where a step has no mesh.
    """

    params: Floats
    value: float
    evaluations: int
    nodes: Floats


def smallest_node(cost: Cost, blocks: Iterator[Floats]) -> list[Step]:
    """Return the best of all nodes, one step per block of nodes (n, k)."""
    steps: list[Step] = []
    seen = 0
    for nodes in blocks:
        costs = cost(nodes)
        seen += len(nodes)
        best = int(np.argmin(costs))
        if not steps or costs[best] < steps[-1].value:
            none = np.empty((0, nodes.shape[1]))
            steps.append(Step(nodes[best].copy(), float(costs[best]), seen, none))
    return [replace(best_node, evaluations=seen) for best_node in steps[-1:]]


def refine(
    cost: Cost, bounds: Floats, count: int = 1, levels: int = LEVELS, ends: str = "left"
) -> list[list[Step]]:
    """Refine meshes of 5 nodes a side around the best node, as the paper's search does.

    The interval, `bounds` (k, 2) at first, is cut into 5 equal cells, of which each gives its left
    or right end as a node, moved onto the bounds where it is beyond; the next interval is the best
    node +- the spacing.  So the spacing shrinks to 2/5 in each level of 5^k evaluations, the
    best node of the level before is dropped with left ends as with right ones, and the search is
    not monotone: its last value may be worse than one seen before.

    `cost` takes meshes (n, 5^k, k) of n = `count` searches, and returns what the i-th has on the
    i-th mesh (n, 5^k); the steps of each are returned.
    """
    low, width = np.tile(bounds[:, 0], (count, 1)), np.tile(np.ptp(bounds, axis=1), (count, 1))
    first = 0 if ends == "left" else 1
    steps: list[list[Step]] = [[] for _ in range(count)]
    turns = np.indices((NODES,) * len(bounds)).reshape(len(bounds), -1).T + first
    for level in range(levels):
        spacing = width / NODES
        nodes = low[:, None] + spacing[:, None] * turns
        nodes = np.clip(nodes, bounds[:, 0], bounds[:, 1])
        costs = cost(nodes)
        best = costs.argmin(axis=1)
        chosen = nodes[np.arange(count), best]
        for i, at in enumerate(best):
            seen = (level + 1) * len(turns)
            steps[i].append(Step(chosen[i].copy(), float(costs[i, at]), seen, nodes[i]))
        low, width = chosen - spacing, 2.0 * spacing
    return steps


def nelder_mead(
    cost: Cost,
    bounds: Floats,
    start: Floats,
    tolerance: float = TOLERANCE,
    simplex: float = FIRST_SIMPLEX,
) -> list[Step]:
    """Walk a simplex downhill from a point, within the bounds (Nelder and Mead 1965).

    `start` (k,) is the first corner of the simplex; the others lie along the axes, towards the
    middle.  Its size, as a share of the bounds (k, 2), is `simplex` at first and `tolerance` at
    last: it ends where the simplex is small, for any cost there, since |SD_g| may jump.
    One step per iteration; the last is the result.
    """
    from scipy.optimize import minimize

    low, width = bounds[:, 0], bounds[:, 1] - bounds[:, 0]
    k = len(bounds)
    seen = 0
    steps: list[Step] = []
    none = np.empty((0, k))

    def one(share: Floats) -> float:
        nonlocal seen
        seen += 1
        return float(cost((low + share * width)[None, :])[0])

    def note(intermediate_result) -> None:  # type: ignore[no-untyped-def]
        point = low + np.asarray(intermediate_result.x) * width
        steps.append(Step(point, float(intermediate_result.fun), seen, none))

    first = (start - low) / width
    corners = np.vstack([first, first + np.diag(np.where(first > 0.5, -simplex, simplex))])
    options = {
        "initial_simplex": corners,
        "xatol": tolerance,
        "fatol": np.inf,
        "maxfev": EVALUATIONS * k,
    }
    how = {"method": "Nelder-Mead", "bounds": [(0.0, 1.0)] * k, "options": options}
    found = minimize(one, first, callback=note, **how)
    steps.append(Step(low + np.asarray(found.x) * width, float(found.fun), seen, none))
    return steps


def multistart(cost: Cost, bounds: Floats, start: Floats, seed: int = 0) -> list[Step]:
    """Refine many points that fill the box roughly, and the best results to the end.

    Each refinement is Nelder-Mead.  The points are a Sobol sequence, shifted by `seed`, and
    `start` (k,).  The first step is the best of these candidates with all of them as nodes, then
    comes one per start that improved on those before; the last is the result.
    """
    from scipy.stats.qmc import Sobol

    k = len(bounds)
    # Shifted at random and wrapped round (Cranley and Patterson): as even as the sequence itself.
    even = Sobol(k, scramble=False).random_base2(min(CANDIDATES_LOG2 + k // 2, MOST_LOG2))
    even = (even + np.random.default_rng(seed).random(k)) % 1.0
    points = np.vstack([start, bounds[:, 0] + even * (bounds[:, 1] - bounds[:, 0])])
    costs = cost(points)
    seen = len(points)
    first = int(np.argmin(costs))
    best = Step(points[first], float(costs[first]), seen, points)
    steps = [best]

    def refined(point: Floats, tolerance: float, simplex: float = FIRST_SIMPLEX) -> Step:
        """Refine a point, and note it where it leads below the best so far."""
        nonlocal best, seen
        last = nelder_mead(cost, bounds, point, tolerance, simplex)[-1]
        seen += last.evaluations
        last = replace(last, evaluations=seen)
        if last.value < best.value:
            best = last
            steps.append(best)
        return last

    chosen = _apart(points, costs, bounds, STARTS)
    # The caller's own start is the first of the points.
    rough = [refined(points[at], ROUGH) for at in dict.fromkeys([*chosen, 0])]
    ends, end_costs = np.array([r.params for r in rough]), np.array([r.value for r in rough])
    for at in _apart(ends, end_costs, bounds, FINALISTS):
        refined(ends[at], TOLERANCE)
    for _ in range(ROUNDS):
        before = best
        for simplex in FRESH_SIMPLICES:
            refined(best.params, TOLERANCE, simplex)
        if best is before:
            break
    steps.append(replace(best, evaluations=seen))
    return steps


def _apart(points: Floats, costs: Floats, bounds: Floats, most: int) -> list[int]:
    """Return the best points of which no two are close."""
    scaled = (points - bounds[:, 0]) / (bounds[:, 1] - bounds[:, 0])
    # Half the mean distance of as many evenly spread points.
    near = 0.5 * len(points) ** (-1.0 / points.shape[1])
    chosen: list[int] = []
    for at in np.argsort(costs, kind="stable"):
        if all(np.abs(scaled[at] - scaled[other]).max() >= near for other in chosen):
            chosen.append(int(at))
        if len(chosen) == most:
            break
    return chosen


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
    for axis, side in np.ndindex(result.shape):

        def exceeds(values: Floats, axis: int = axis) -> Bools:
            rows = np.tile(best, (len(values), 1))
            rows[:, axis] = values
            return ~(cost(rows) <= limit)

        line = np.linspace(best[axis], bounds[axis, side], STEPS + 1)
        bad = np.flatnonzero(exceeds(line[1:]))
        result[axis, side] = bounds[axis, side]
        if bad.size:
            ends = line[bad[:1]], line[bad[:1] + 1]
            result[axis, side] = halve(exceeds, *ends, HALVINGS)[0][0]
    return result


def half_widths(found: Floats, best: Floats, bounds: Floats) -> Floats:
    """Return (k,) the paper's delta: best +- delta is acceptable as far as the bounds go.

    A side that reaches its bound does not limit delta.
    """
    left, right = best - found[:, 0], found[:, 1] - best
    free_left, free_right = found[:, 0] <= bounds[:, 0], found[:, 1] >= bounds[:, 1]
    delta = np.where(free_left, right, np.where(free_right, left, np.minimum(left, right)))
    return np.where(free_left & free_right, np.maximum(left, right), delta)
