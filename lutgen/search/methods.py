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
# `multistart`: points for each parameter, generations at most, and the spread of costs that ends
# them.  With half as many points 3 of 12 optima of Absolem were missed.
POINTS, GENERATIONS, SPREAD = 64, 100, 1e-5
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
    cost: Cost, bounds: Floats, start: Floats, simplex: float = FIRST_SIMPLEX
) -> list[Step]:
    """Walk a simplex downhill from a point, within the bounds (Nelder and Mead 1965).

    `start` (k,) is the first corner of the simplex; the others lie along the axes, towards the
    middle.  Its size, as a share of the bounds (k, 2), is `simplex` at first and `TOLERANCE` at
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
    options = {"initial_simplex": corners, "xatol": TOLERANCE, "fatol": np.inf}
    options["maxfev"] = EVALUATIONS * k
    how = {"method": "Nelder-Mead", "bounds": [(0.0, 1.0)] * k, "options": options}
    found = minimize(one, first, callback=note, **how)
    steps.append(Step(low + np.asarray(found.x) * width, float(found.fun), seen, none))
    return steps


def multistart(cost: Cost, bounds: Floats, start: Floats, seed: int = 0) -> list[Step]:
    """Let points that fill the box improve on each other, and refine the best of them.

    The points are a Sobol sequence, scrambled by `seed`, and `start` (k,); they improve by
    differential evolution (Storn and Price 1997), and the best of them by Nelder-Mead.  The first
    step is the best point, then comes one per refinement that improved on it; the last is the
    result.
    """
    from scipy.optimize import differential_evolution

    seen = 0

    def each(points: Floats) -> Floats:
        nonlocal seen
        seen += points.shape[1]
        return cost(points.T)

    found = differential_evolution(
        each,
        bounds,
        x0=start,
        init="sobol",
        seed=seed,
        popsize=POINTS,
        maxiter=GENERATIONS,
        tol=0.0,
        atol=SPREAD,
        polish=False,
        vectorized=True,
        updating="deferred",
    )
    none = np.empty((0, len(bounds)))
    best = Step(np.asarray(found.x), float(found.fun), seen, none)
    steps = [best]
    for _ in range(ROUNDS):
        before = best
        for simplex in FRESH_SIMPLICES:
            last = nelder_mead(cost, bounds, best.params, simplex)[-1]
            seen += last.evaluations
            if last.value < best.value:
                best = replace(last, evaluations=seen)
                steps.append(best)
        if best is before:
            break
    steps.append(replace(best, evaluations=seen))
    return steps


def acceptable_range(cost: Cost, best: Floats, bounds: Floats, limit: float) -> Floats:
    """Return the largest interval of each parameter in which the cost stays within a limit.

    (k, 2), NaN throughout where the geometry `best` (k,) itself exceeds the limit.  While one
    parameter varies the others keep its values; intervals end at the `bounds` (k, 2) at the latest.
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
