"""A robot driving slowly along a path, with and without changing its shape.

As in the paper, at each point the robot takes the geometry that was found for the gravity direction
of an earlier point, and it may turn, too.  It tips where the attitude that it takes does.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import body_gravity, evaluate_each
from lutgen.errors import InputError, reject
from lutgen.recipe import Recipe
from lutgen.search.objective import Objective
from lutgen.search.optima import optimum, searched_each
from lutgen.search.terrain import Path, turned
from lutgen.vector import Floats

DRIVE_CHANNELS = ("sdg", "height", "tip_angle", "margin")
# No value is within this limit, so that a search does not look for acceptable ranges.
NO_LIMIT = math.nan
# Headings are equally good within this cost, which has rounding errors where the robot tips (the
# cost is then around 1e9): a robot that looks the same from several sides does not turn.
EQUAL, ROUNDING = 1e-9, 1e-15


@dataclass(frozen=True, eq=False)
class Drive:
    """One run along a path of p points.

    `path` is as given, the robot in its own heading.  `params` (p, k) is the geometry at each
    point, rad or length, and `wanted` (p, k) the one that control requested; another one only where
    rates are limited.  `turn` (p,) is by how much the robot is turned against the path's heading,
    to the left, and `heading` (p,) its yaw in the world, rad.  `gravity_body` (p, 3) are unit
    vectors, down, in the body frame, in the attitude that the robot takes.  `channels` are sdg,
    height, tip_angle and margin (p,), as `evaluate` gives them; `evaluations` counts the geometries
    that the searches evaluated.
    """

    path: Path
    params: Floats
    wanted: Floats
    turn: Floats
    heading: Floats
    gravity_body: Floats
    channels: dict[str, Floats]
    evaluations: int

    @property
    def tips(self) -> NDArray[np.bool_]:
        """Where the robot tips over, (p,)."""
        return np.asarray(self.channels["tip_angle"] < 0.0)

    @property
    def share(self) -> float:
        """Share of the points at which the robot tips over."""
        return float(self.tips.mean())


def drive(
    recipe: Recipe,
    path: Path,
    *,
    control: bool = True,
    lag: int = 1,
    method: str = "search",
    objective: str = "sdg",
    convention: str = "plane",
    params0: ArrayLike | None = None,
    rates: Mapping[str, float] | None = None,
    speed: float | None = None,
    headings: int | None = None,
    **options: Any,
) -> Drive:
    """Drive a robot along a path.

    `path` is in the recipe's length unit.  Without `control` the robot keeps `params0` (k,), rad or
    length, by default the middle of the ranges.  Control is late by `lag` points: point i has what
    was found for point i - lag, and the first ones have `params0` and the path's own heading.
    `method`, `objective`, `convention` and `options` (`bounds`, `start`, `levels`, `ends`, `seed`)
    are those of `optimum`.  Under ``"plane"`` the path's gravity is relative to the ground, and the
    robot leans as its shape makes it; under ``"body"`` the body keeps the ground's attitude.
    `rates` are the fastest changes of parameters, rad or length per second, at a `speed` (length
    per second); a parameter without one follows at once.  The robot may turn about the ground's
    normal to so many `headings`, evenly spaced, its own among them; of equally good ones the
    nearest to its own counts.

    Examples
    --------
    The paper's robot, its wheels at 0, 120 and 240 deg, turned by 30 deg to the left:

    >>> from lutgen.recipe.recipe import load_recipe
    >>> from lutgen.search.terrain import paper_path
    >>> robot, nominal = load_recipe("maps/paper_two.toml"), [math.atan(0.6)] * 2
    >>> path = turned(paper_path(), math.radians(30))
    >>> drive(robot, path, control=False, params0=nominal).share
    0.72
    >>> drive(robot, path, params0=nominal).share
    0.22
    """
    if control and not recipe.parameters:
        what = "the robot has no geometry parameter to control"
        reject(recipe.source, what, "none", "drive it without control (--no-control)", InputError)
    middle = [(p.minimum + p.maximum) / 2.0 for p in recipe.parameters]
    start = np.array(middle if params0 is None else params0, dtype=np.float64)
    fastest = _rates(recipe, rates, speed)
    count = len(path.position)
    turn, wanted = np.zeros(count), np.tile(start, (count, 1))
    evaluations = 0
    turns = _turns(1 if headings is None else headings)
    if (control or headings is not None) and lag < count:
        options |= {"method": method, "objective": objective, "convention": convention}
        options.setdefault("limit", NO_LIMIT)
        kept = None if control else start
        found = _best(recipe, path.gravity[: count - lag], turns, kept, options)
        wanted[lag:], turn[lag:], evaluations = found
    taken = turned(path, turn)
    params = wanted if fastest is None else _follow(wanted, start, path, fastest)
    gravity = body_gravity(recipe, params, taken.gravity, convention)
    channels = evaluate_each(recipe, params, gravity, DRIVE_CHANNELS)
    return Drive(path, params, wanted, turn, taken.heading, gravity, channels, evaluations)


def _best(
    recipe: Recipe, gravity: Floats, turns: Floats, kept: Floats | None, options: dict[str, Any]
) -> tuple[Floats, Floats, int]:
    """Return geometries (p, k), turns (p,), rad, and evaluations for directions on the ground.

    `kept` (k,) is the geometry of a robot that does not change it; `options` are the keywords of
    `optimum`.
    """
    # Equal directions (p, 3) are searched once.
    unlike, which = np.unique(gravity, axis=0, return_inverse=True)
    each = np.repeat(unlike, len(turns), axis=0)
    ground = Path(np.zeros((len(each), 3)), np.zeros(len(each)), each)
    down = turned(ground, np.tile(turns, len(unlike))).gravity
    if kept is not None:
        params, evaluations = np.tile(kept, (len(down), 1)), len(down)
    elif options["method"] == "search":
        others = ("method", "limit", "start", "seed")
        meshed = {key: options[key] for key in options if key not in others}
        params, evaluations = searched_each(recipe, down, **meshed)
    else:
        found = [optimum(recipe, one, **options) for one in down]
        params = np.array([one.params for one in found])
        evaluations = sum(one.evaluations for one in found)
    goal = Objective(recipe, down[0], options["objective"], options["convention"])
    costs = goal.cost(params, down).reshape(len(unlike), len(turns))
    least = costs.min(axis=1, keepdims=True)
    chosen = (costs <= least + EQUAL + ROUNDING * np.abs(least)).argmax(axis=1)
    rows = np.arange(len(unlike)) * len(turns) + chosen
    return params[rows][which.ravel()], turns[chosen][which.ravel()], evaluations


def _turns(headings: int) -> Floats:
    """Return the turns to evenly spaced headings, rad, the smallest first."""
    whole = np.arange(headings)
    # Half a turn and more to the left is less to the right.
    steps = np.where(2 * whole > headings, whole - headings, whole)
    return np.asarray(2.0 * np.pi * steps[np.argsort(np.abs(steps), kind="stable")] / headings)


def _rates(recipe: Recipe, rates: Mapping[str, float] | None, speed: float | None) -> Floats | None:
    """Return the largest change of each parameter per length of path, (k,); None without rates."""
    if not rates and speed is None:
        return None
    if not rates or speed is None:
        what = "limited rates need a speed, and a speed needs rates"
        got = f"rates {dict(rates or {})}, speed {speed}"
        reject(recipe.source, what, got, "give both or none", InputError)
    names = [p.name for p in recipe.parameters]
    for name, rate in rates.items():
        if name not in names:
            what, got = f"there is no parameter {name!r} to limit", f"the rate {rate:g}"
            reject(recipe.source, what, got, f"it has {', '.join(names) or 'none'}", InputError)
        if not rate >= 0.0:
            what = f"the rate of {name} must be 0 or more"
            reject(recipe.source, what, f"{rate:g}", "turn its sign", InputError)
    return np.array([rates.get(name, math.inf) for name in names]) / speed


def _follow(wanted: Floats, start: Floats, path: Path, fastest: Floats) -> Floats:
    """Return the geometry that actuators of limited speed reach at each point, (p, k)."""
    reached = np.empty_like(wanted)
    before, distance = start, path.distance
    for i in range(len(wanted)):
        step = distance[i] - distance[max(i - 1, 0)]
        # A parameter without a limit follows even where no time passes.
        free = np.isinf(fastest)
        most = np.where(free, np.inf, np.where(free, 0.0, fastest) * step)
        change = wanted[i] - before
        # Added only where limited: so a parameter that arrives has exactly the wanted value.
        before = np.where(np.abs(change) <= most, wanted[i], before + np.clip(change, -most, most))
        reached[i] = before
    return reached
