"""The paper's three simulations, its Table 1, and its Eq 12 against exact forces.

Both gravity conventions are computed everywhere, because the paper does not say which one it means.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from lutgen.analysis import heuristic_forces, normal_forces
from lutgen.channels import CONVENTIONS, body_gravity, evaluate_each
from lutgen.mapping import load_map, sweep
from lutgen.paper.model import (
    AHEAD,
    DOWN,
    HEIGHT,
    NOMINAL,
    RADIUS,
    TABLE,
    TO_THE_LEFT,
    Entry,
    Floats,
    nominal_wheels,
    paper_recipe,
)
from lutgen.recipe import Recipe
from lutgen.search import Drive, Optimum, drive, optimum, paper_path

# |SD_g| up to which a shape counts as acceptable (the paper's delta): a tenth of that at which the
# paper's robot tips.
LIMIT = 1.0
# The three methods of the paper, and many starts.
METHODS = ("map", "nelder-mead", "search", "multistart")
MAP = "paper_two.h5"
# Headings among which the robot may turn on the path.
HEADINGS = 24
# Runs of simulation 3: without control, with the geometry found for the point
# before or for the point itself, with the heading alone free to turn, and with heading and shape.
RUNS: dict[str, dict[str, Any]] = {
    "fixed": {"control": False},
    "lagged": {},
    "prompt": {"lag": 0},
    "turning": {"control": False, "headings": HEADINGS},
    "both": {"headings": HEADINGS},
}
BEHIND = (60.0, -60.0, 180.0)
# Pitch and heading (deg).  The slope rises towards the heading, seen from the com; wheel 1 is at
# heading 0.  39.7 and 58 deg are close to tipping, atan(10/12) = 39.81 and atan(20/12) = 59.04.
SLOPES = ((0, 0), (10, 0), (20, 0), (30, 0), (39.7, 0), (30, 180), (58, 180), (30, 90))


def level_values(recipe: Recipe, params: Floats, convention: str) -> dict[str, Floats]:
    """Return sdg and height, each (m,), of m geometries on level ground."""
    down = body_gravity(recipe, params, DOWN, convention)
    return evaluate_each(recipe, params, down, ("sdg", "height"))


@dataclass(frozen=True)
class First:
    """Simulation 1: |SD_g| and |OC| over alpha, and where |SD_g| is least.

    `alpha` (m,) in deg; `sdg` and `height` by convention, (m,); `best` by convention.
    """

    alpha: Floats
    sdg: dict[str, Floats]
    height: dict[str, Floats]
    best: dict[str, Optimum]


def first_simulation() -> First:
    """Compute simulation 1 (Fig 8): alpha from 0 to 50 deg, on level ground."""
    recipe = paper_recipe(moving=1)
    alpha = np.linspace(0.0, 50.0, 501)
    found = First(alpha, {}, {}, {})
    for name in CONVENTIONS:
        values = level_values(recipe, np.radians(alpha)[:, None], name)
        found.sdg[name], found.height[name] = values["sdg"], values["height"]
        found.best[name] = optimum(recipe, DOWN, "multistart", convention=name)
    return found


def second_simulation() -> dict[tuple[str, str], Optimum]:
    """Compute simulation 2: what each method finds, by (convention, method)."""
    recipe = paper_recipe()
    return {
        (name, method): optimum(recipe, DOWN, method, convention=name, limit=LIMIT)
        for name in CONVENTIONS
        for method in METHODS
    }


@dataclass(frozen=True)
class MapTime:
    """The 50 x 50 map: where it is, its least node, and how long it took.

    `kernel` is the time of the evaluation alone and `file` that of the sweep into a file, seconds.
    """

    path: Path
    nodes: int
    alpha: float
    gamma: float
    sdg: float
    kernel: float
    file: float


def timed_map(path: Path) -> MapTime:
    """Sweep the paper's 50 x 50 map into an HDF5 file, and time it with compiled kernels."""
    recipe = paper_recipe()
    rows = recipe.grid.params(np.arange(recipe.grid.size))
    level_values(recipe, rows, "body")
    begin = time.perf_counter()
    level_values(recipe, rows, "body")
    kernel = time.perf_counter() - begin
    # The first sweep of a process loads the compiled kernels.
    sweep(recipe, path)
    begin = time.perf_counter()
    sweep(recipe, path)
    file = time.perf_counter() - begin
    values = load_map(path).channel("sdg")[:, :, 0, 0, 0]
    i, j = np.unravel_index(int(np.nanargmin(values)), values.shape)
    alpha, gamma = (
        np.degrees(axis.knots[at]) for axis, at in zip(recipe.grid.axes, (i, j), strict=True)
    )
    return MapTime(path, values.size, float(alpha), float(gamma), float(values[i, j]), kernel, file)


@dataclass(frozen=True)
class TableRow:
    """One column of Table 1 beside our values at the same angles.

    `exact` by convention at the scale of the reconstruction; `fitted` by convention at the scale
    that fits the four values of the searching algorithm best, and `residual` = fitted/read_as - 1.
    """

    published: Entry
    exact: dict[str, float]
    fitted: dict[str, float]
    residual: dict[str, float]


def table_one() -> tuple[tuple[TableRow, ...], dict[str, float]]:
    """Return Table 1 beside ours, and the fitted R by convention.

    |SD_g| is proportional to R, which the paper does not print; the fit takes the least sum of
    squared relative residuals over the entries of the searching algorithm.
    """
    recipe = paper_recipe()
    params = np.radians([[row.alpha, row.gamma] for row in TABLE])
    meant = np.array([row.read_as for row in TABLE])
    fit = np.array([row.searching for row in TABLE])
    rows = [TableRow(row, {}, {}, {}) for row in TABLE]
    radius = {}
    for name in CONVENTIONS:
        values = level_values(recipe, params, name)["sdg"]
        ratio = values[fit] / meant[fit]
        scale = float(ratio.sum() / (ratio**2).sum())
        radius[name] = RADIUS * scale
        for row, value, said in zip(rows, values.tolist(), meant.tolist(), strict=True):
            row.exact[name], row.fitted[name] = value, value * scale
            row.residual[name] = value * scale / said - 1.0
    return tuple(rows), radius


def second_optimum() -> float:
    """Return alpha = gamma < 0 (deg) of the other shape whose wheels are equally far apart."""

    def uneven(angle: float) -> float:
        """Return |P1 - P2|^2 - |P2 - P3|^2 over R^2, P3 at the nominal elevation."""
        level, rise = math.cos(angle), math.sin(angle) - math.sin(NOMINAL)
        other = math.cos(NOMINAL)
        return 3.0 * level**2 - (level**2 + level * other + other**2 + rise**2)

    return math.degrees(brentq(uneven, -0.5, 0.0))


def third_simulation() -> dict[str, Drive]:
    """Compute simulation 3 (Figs 16 and 17) and the runs in which the robot may turn.

    The paper leaves open which way its wheels point, how the robot leans on its path and where the
    nodes of its search lie.  This is one reading that is consistent with its two percentages.
    """
    recipe = paper_recipe(azimuths=TO_THE_LEFT)
    return {name: _run(recipe, **options) for name, options in RUNS.items()}


def _run(recipe: Recipe, attitude: str = "pitch", points: int = 100, **options: Any) -> Drive:
    """Drive from the nominal shape along the paper's path."""
    return drive(recipe, paper_path(points, attitude), params0=np.full(2, NOMINAL), **options)


@dataclass(frozen=True)
class Variant:
    """One other reading of simulation 3, and the shares that tip without and with control."""

    name: str
    points: int
    without: float
    control: float


def variants() -> tuple[Variant, ...]:
    """Return the shares for readings of the paper that depart from simulation 3 in one thing."""
    recipe = paper_recipe(azimuths=TO_THE_LEFT)

    def shares(name: str, robot: Recipe = recipe, points: int = 100, **options: Any) -> Variant:
        kept = {key: options[key] for key in ("attitude", "convention") if key in options}
        without = _run(robot, points=points, control=False, **kept).share
        return Variant(name, points, without, _run(robot, points=points, **options).share)

    return (
        shares("the reading above"),
        *(shares("other number of points", points=points) for points in (50, 200, 500)),
        shares("nodes of the search at the right ends of its cells", ends="right"),
        shares("no lag: the geometry found for the point itself", lag=0),
        shares("ground level across the path, heading kept", attitude="surface"),
        shares("gravity fixed in the body while the legs move (F)", convention="body"),
        shares("P1 ahead", paper_recipe(azimuths=AHEAD)),
        shares("P1 and P2 ahead, P3 behind", paper_recipe(azimuths=BEHIND)),
        shares("tip-over angle as the objective instead of |SD_g|", objective="tip_angle"),
    )


@dataclass(frozen=True)
class ForceRow:
    """One slope: the exact shares of the load and those of Eq 12 without its leading minus.

    Angles in degrees, forces as shares of |N_g|.
    """

    pitch_deg: float
    heading_deg: float
    exact: Floats
    heuristic: Floats


def force_table() -> tuple[ForceRow, ...]:
    """Return exact and heuristic forces on the nominal robot's wheels."""
    wheels = nominal_wheels()
    rows = []
    for pitch, heading in SLOPES:
        # Gravity leaves the com away from the rise.
        out = -HEIGHT * math.tan(math.radians(pitch))
        around = math.radians(heading)
        pierced = np.array([out * math.cos(around), out * math.sin(around), -HEIGHT])
        exact, rough = normal_forces(wheels, pierced), heuristic_forces(wheels, pierced)
        rows.append(ForceRow(pitch, heading, exact, rough))
    return tuple(rows)


@dataclass(frozen=True)
class Results:
    """All numbers of the report."""

    first: First
    second: dict[tuple[str, str], Optimum]
    table: tuple[TableRow, ...]
    fitted_radius: dict[str, float]
    swept: MapTime
    third: dict[str, Drive]
    variants: tuple[Variant, ...]
    forces: tuple[ForceRow, ...]


def compute(folder: Path, progress: Callable[[str], None] = lambda _: None) -> Results:
    """Run all simulations; the map goes into `folder`."""
    progress("simulation 1")
    first = first_simulation()
    progress("simulation 2")
    second = second_simulation()
    table, radius = table_one()
    swept = timed_map(folder / MAP)
    progress("simulation 3")
    third = third_simulation()
    return Results(first, second, table, radius, swept, third, variants(), force_table())
