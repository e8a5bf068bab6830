"""The best geometry of a robot for a gravity direction.

A search varies parameters in the units that people read; its results are in rad or length.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from lutgen.arrays import Bools, Floats
from lutgen.bounds import LEVELS as MOST_LEVELS
from lutgen.bounds import SEARCHED, check
from lutgen.channels import checked_directions
from lutgen.errors import InputError, reject
from lutgen.grid import Grid
from lutgen.recipe import Recipe
from lutgen.search import methods
from lutgen.search.methods import LEVELS, Step, acceptable_range, half_widths
from lutgen.search.objective import AT_ONCE, TIPS, Objective

METHODS = ("map", "nelder-mead", "search", "multistart")
ENDS = ("left", "right")


@dataclass(frozen=True)
class Optimum:
    """Result of a search; parameters in rad or the recipe's length unit.

    `params` (k,) is the best geometry seen in the whole search, and `value` the objective there:
    the channel's value, or the cost of a weighted sum; NaN where the robot tips.  If it is not
    `standing`, none of the geometries tried stands, and this is the one closest to standing.
    `evaluations` counts geometries.  `trace` are the steps of the method; the last one is where the
    method itself ends, which for `search` may be worse than the best it has seen.  `acceptable`
    (k, 2) is the largest interval of each parameter, the others kept, in which the robot stands and
    the objective stays within the limit; NaN where the optimum itself does not.  `delta` (k,) is
    the paper's: params +- delta is acceptable as far as the bounds go.
    """

    params: Floats
    value: float
    standing: bool
    evaluations: int
    trace: tuple[Step, ...]
    acceptable: Floats
    delta: Floats
    method: str
    objective: str
    convention: str


def optimum(
    recipe: Recipe,
    gravity_dir: ArrayLike,
    method: str = "search",
    objective: str = "sdg",
    *,
    convention: str = "body",
    bounds: ArrayLike | None = None,
    start: ArrayLike | None = None,
    limit: float | None = None,
    levels: int = LEVELS,
    ends: str = "left",
    seed: int = 0,
) -> Optimum:
    """Return the best geometry of a robot for one gravity direction.

    Parameters
    ----------
    recipe : Recipe
        A robot with at least one geometry parameter.
    gravity_dir : (3,) array_like
        Pointing down, any length > 0.
    method : {"map", "nelder-mead", "search", "multistart"}
        `map`: the best node of the recipe's sweep.  `search`: the paper's refinement, `levels`
        steps of 5 nodes a side.  `nelder-mead`: from `start`.  `multistart`: many points that
        improve on each other, for objectives with several minima.
    objective : str
        A channel of `quantities.RANKED`, made as small or as large as is better, or a sum such as
        `sdg+0.1*height`.
    convention : {"body", "plane"}
        Gravity is fixed in the body frame, or relative to the contact plane, so that it
        turns in the body while the shape changes; see `channels.resting`.
    bounds : (k, 2) array_like, optional
        Where to search, rad or length; the recipe's ranges by default.  A parameter whose two
        bounds are equal keeps that value and is not searched.
    start : (k,) array_like, optional
        For `nelder-mead` and `multistart`; the middle of the bounds by default.
    limit : float, optional
        The objective's worst acceptable value, for the acceptable ranges.  By default all
        geometries in which the robot stands are acceptable.
    levels, ends
        For `search`: see `methods.refine`.
    seed : int
        For `multistart`.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> found = optimum(load_recipe("maps/paper_two.toml"), [0, 0, -1])
    >>> [round(float(np.degrees(step.params[0])), 4) for step in found.trace]
    [30.0, 32.0, 31.2, 30.88, 31.008, 30.9568]
    """
    _check(method, ends, levels)
    goal = Objective(recipe, gravity_dir, objective, convention)
    space = _space(recipe, bounds, method)
    begin = space.points(_start(recipe, start, space)[None, :])[0]

    def cost(points: Floats) -> Floats:
        return goal.cost(space.params(points))

    if method == "map":
        steps = methods.smallest_node(cost, _nodes(recipe, space))
    elif method == "search":
        steps = methods.refine(lambda nodes: cost(nodes[0])[None], space.box, 1, levels, ends)[0]
    elif method == "nelder-mead":
        steps = methods.nelder_mead(cost, space.box, begin)
    else:
        steps = methods.multistart(cost, space.box, begin, seed)
    evaluations = goal.evaluations
    best = min(steps, key=lambda step: step.value)
    # Costs of standing geometries lie below TIPS.
    bar = np.nextafter(TIPS, 0.0) if limit is None else goal.cost_of(limit)
    found = acceptable_range(cost, best.params, space.box, bar)
    acceptable, delta = space.params(found.T).T, np.zeros(len(space.kept))
    delta[space.free] = half_widths(found, best.params, space.box) * space.factor
    if np.isnan(found).any():
        # A kept value is no more acceptable than the geometry that it belongs to.
        acceptable[:], delta[:] = np.nan, np.nan
    shown = _named(best, goal, space)
    return Optimum(
        shown.params,
        shown.value,
        standing=best.value < TIPS,
        evaluations=evaluations,
        trace=tuple(_named(step, goal, space) for step in steps),
        acceptable=acceptable,
        delta=delta,
        method=method,
        objective=objective,
        convention=convention,
    )


def searched_each(
    recipe: Recipe,
    gravity_dir: ArrayLike,
    objective: str,
    convention: str,
    bounds: ArrayLike | None = None,
    levels: int = LEVELS,
    ends: str = "left",
) -> tuple[Floats, int]:
    """Return what the method `search` of `optimum` finds for each gravity direction (m, 3).

    These are the best geometries seen (m, k), rad or length; and how many were evaluated in all.
    One direction after the other takes five times as long for two parameters.
    """
    _check("search", ends, levels)
    down = np.array([checked_directions(one)[0] for one in np.asarray(gravity_dir)])
    space, found = _space(recipe, bounds, "search"), list[Floats]()
    goal = Objective(recipe, down[0], objective, convention)
    at_once = max(1, AT_ONCE // methods.NODES ** len(space.box))
    for begin in range(0, len(down), at_once):
        some = down[begin : begin + at_once]

        def cost(nodes: Floats, some: Floats = some) -> Floats:
            rows = space.params(nodes.reshape(-1, nodes.shape[2]))
            costs = goal.cost(rows, np.repeat(some, nodes.shape[1], axis=0))
            return costs.reshape(nodes.shape[:2])

        for steps in methods.refine(cost, space.box, len(some), levels, ends):
            found.append(min(steps, key=lambda step: step.value).params)
    return space.params(np.array(found)), goal.evaluations


def _check(method: str, ends: str, levels: int) -> None:
    """Refuse unknown words and levels that make no search."""
    if method not in METHODS:
        raise InputError(f"unknown method {method!r}; choose from {', '.join(METHODS)}")
    if ends not in ENDS:
        raise InputError(f"unknown ends {ends!r}; choose from {', '.join(ENDS)}")
    if levels < 1:
        raise InputError(f"a search needs at least one level (got {levels})")
    check(levels, MOST_LEVELS, "the levels of a search", "use fewer, 6 by default")


@dataclass(frozen=True)
class _Space:
    """The parameters of a search: those that are free, in the units that people read.

    The paper's nodes are whole degrees.  `box` (f, 2) and `factor` (f,) belong to the free ones;
    `free` (k,) says which they are, and `whole` (k, 2) are the bounds of all, rad or length.
    """

    box: Floats
    factor: Floats
    free: Bools
    whole: Floats

    @property
    def kept(self) -> Floats:
        """The lowest values (k,), of which those that are not free are kept."""
        return self.whole[:, 0]

    def params(self, points: Floats) -> Floats:
        """Return whole geometries (m, k), rad or length, of points (m, f)."""
        rows = np.tile(self.kept, (len(points), 1))
        rows[:, self.free] = points * self.factor
        return rows

    def points(self, params: Floats) -> Floats:
        """Return the points (m, f) of geometries (m, k)."""
        return np.asarray(params[:, self.free] / self.factor)


def _space(recipe: Recipe, bounds: ArrayLike | None, method: str) -> _Space:
    """Return the space of a search within bounds (k, 2), rad or length; refuse others."""
    count = len(recipe.parameters)
    ranges = [[p.minimum, p.maximum] for p in recipe.parameters]
    box = np.array(ranges if bounds is None else bounds, dtype=np.float64)
    box = box.reshape(-1, 2) if bounds is None else box
    if box.shape != (count, 2) or not np.isfinite(box).all():
        what = f"bounds must be finite and have the shape ({count}, 2)"
        way_out = "give a lowest and a highest value for each parameter"
        reject(recipe.source, what, np.asarray(bounds).tolist(), way_out, InputError)
    if not (box[:, 0] <= box[:, 1]).all():
        what = "no lower bound may be above the upper one"
        reject(recipe.source, what, box.tolist(), "swap them", InputError)
    free = box[:, 0] < box[:, 1]
    if not free.any():
        what = "the robot has no geometry parameter to search"
        reject(recipe.source, what, f"{len(box)}, all kept", "leave at least one free", InputError)
    most, searched = SEARCHED.most, int(free.sum())
    if method == "search" and searched > most:
        raise InputError(
            f"{recipe.source}: the method search takes at most {most} parameters (got {searched}, "
            f"or 5^{searched} nodes a step); use multistart, or keep some by equal bounds"
        )
    units = [np.pi / 180.0 if p.display_unit == "deg" else 1.0 for p in recipe.parameters]
    factor = np.array(units)[free]
    return _Space(box[free] / factor[:, None], factor, free, box)


def _named(step: Step, goal: Objective, space: _Space) -> Step:
    """Return a step of a method in rad or length, with the objective for the cost."""
    return replace(
        step,
        params=space.params(step.params[None, :])[0],
        value=goal.value(step.value),
        nodes=space.params(step.nodes),
    )


def _nodes(recipe: Recipe, space: _Space) -> Iterator[Floats]:
    """Yield the nodes of the recipe's sweep inside the box, in blocks."""
    axes = zip(recipe.grid.axes, space.free, strict=True)
    grid = Grid(tuple(axis for axis, free in axes if free))
    box = space.box
    rounding = 1e-12 * np.maximum(np.abs(box).max(axis=1), 1.0)
    inside = 0
    for begin in range(0, grid.size, AT_ONCE):
        nodes = grid.params(np.arange(begin, min(begin + AT_ONCE, grid.size))) / space.factor
        kept = (nodes >= box[:, 0] - rounding).all(axis=1) & (nodes <= box[:, 1] + rounding).all(
            axis=1
        )
        inside += int(kept.sum())
        if kept.any():
            yield nodes[kept]
    if not inside:
        what = "no node of the sweep lies within the bounds"
        reject(recipe.source, what, box.tolist(), "widen them or use the method search", InputError)


def _start(recipe: Recipe, start: ArrayLike | None, space: _Space) -> Floats:
    """Return where a search begins (k,), rad or length; in the middle unless it is given."""
    low, high = space.whole.T
    begin = np.array(space.whole.mean(axis=1) if start is None else start, dtype=np.float64)
    # A NaN is not inside either.
    if begin.shape != low.shape or not ((begin >= low) & (begin <= high)).all():
        what = "the start must lie within the bounds, one number for each parameter"
        way_out = "leave it out to begin in the middle"
        reject(recipe.source, what, np.asarray(start).tolist(), way_out, InputError)
    return begin
