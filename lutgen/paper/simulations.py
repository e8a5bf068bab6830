"""The paper's three simulations and its Table 1.

Both gravity conventions are computed everywhere, because the paper does not say which one it means.
"""

import logging
import math
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from lutgen.channels import CONVENTIONS, evaluate_each
from lutgen.mapping import load_map, sweep
from lutgen.paper.model import DOWN, NOMINAL, TABLE, TURN, paper_recipe
from lutgen.recipe import Recipe
from lutgen.search import Drive, Optimum, drive, optimum, paper_path, turned
from lutgen.search import Path as TerrainPath
from lutgen.search.optima import METHODS
from lutgen.vector import Floats

log = logging.getLogger("lutgen")
# |SD_g| up to which a shape counts as acceptable (the paper's delta): a tenth of that at which the
# paper's robot tips.
LIMIT = 1.0
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


class Results(NamedTuple):
    """Results of the simulations.

    `first` are the optima of simulation 1 by convention, `second` those of simulation 2 by
    convention and method, and `third` the runs of simulation 3 by their names in `RUNS`.  `table`
    has, by convention, |SD_g| (6,) at the angles of Table 1, and the scale that fits the paper's
    values best.  `swept` is the least node of the 50 x 50 map (deg), and the seconds that its
    evaluation alone (`kernel`) and its sweep into a file (`file`) took.
    """

    first: dict[str, Optimum]
    second: dict[tuple[str, str], Optimum]
    table: dict[str, tuple[Floats, float]]
    swept: dict[str, float]
    third: dict[str, Drive]


def level_values(recipe: Recipe, params: ArrayLike, convention: str) -> dict[str, Floats]:
    """Return sdg and height, each (m,), of m geometries (m, k) on level ground."""
    down = np.tile(DOWN, (len(np.asarray(params)), 1))
    return evaluate_each(recipe, params, down, ("sdg", "height"), convention)


def timed_map(path: Path) -> dict[str, float]:
    """Sweep the paper's 50 x 50 map into an HDF5 file, and time it with compiled kernels."""
    recipe = paper_recipe()
    rows = recipe.grid.params(np.arange(recipe.grid.size))
    spent = []
    for work in (lambda: level_values(recipe, rows, "body"), lambda: sweep(recipe, path)):
        # The first of a process loads the compiled kernels.
        work()
        begin = time.perf_counter()
        work()
        spent.append(time.perf_counter() - begin)
    values = load_map(path).channel("sdg").ravel()
    least = int(np.nanargmin(values))
    found = [values.size, *np.degrees(rows[least]).tolist(), float(values[least]), *spent]
    return dict(zip(("nodes", "alpha", "gamma", "sdg", "kernel", "file"), found, strict=True))


def table_one() -> dict[str, tuple[Floats, float]]:
    """Return |SD_g| at the angles of Table 1, and the fitted scale, by convention.

    |SD_g| is proportional to R, which the paper does not print; the fit takes the least sum of
    squared relative residuals over the entries of the searching algorithm.
    """
    found, params = {}, np.radians([[row.alpha, row.gamma] for row in TABLE])
    fit = [i for i, row in enumerate(TABLE) if row.searching]
    for name in CONVENTIONS:
        values = level_values(paper_recipe(), params, name)["sdg"]
        ratio = values[fit] / [TABLE[i].read_as for i in fit]
        found[name] = values, float(ratio.sum() / (ratio**2).sum())
    return found


def second_optimum() -> float:
    """Return alpha = gamma < 0 (deg) of the other shape whose wheels are equally far apart."""

    def uneven(angle: float) -> float:
        """Return |P1 - P2|^2 - |P2 - P3|^2 over R^2, P3 at the nominal elevation."""
        level, rise = math.cos(angle), math.sin(angle) - math.sin(NOMINAL)
        other = math.cos(NOMINAL)
        return 3.0 * level**2 - (level**2 + level * other + other**2 + rise**2)

    return math.degrees(brentq(uneven, -0.5, 0.0))


def third_simulation(path: TerrainPath | None = None, turn: float = TURN, **options: Any) -> Drive:
    """Drive from the nominal shape along a path, by default the paper's, turned by `turn` deg.

    The paper leaves open which way its wheels point, how the robot leans on its path and where the
    nodes of its search lie.  The defaults are one reading that is consistent with its two
    percentages; `options` are those of `drive`.
    """
    ground = turned(paper_path() if path is None else path, math.radians(turn))
    return drive(paper_recipe(), ground, params0=np.full(2, NOMINAL), **options)


def compute(folder: Path) -> Results:
    """Run all simulations; the map goes into `folder`."""
    log.info("simulation 1")
    one, two = paper_recipe("paper_one"), paper_recipe()
    first = {name: optimum(one, DOWN, "multistart", convention=name) for name in CONVENTIONS}
    log.info("simulation 2")
    second = {
        (name, method): optimum(two, DOWN, method, convention=name, limit=LIMIT)
        for name in CONVENTIONS
        for method in METHODS
    }
    table, swept = table_one(), timed_map(folder / MAP)
    log.info("simulation 3")
    third = {name: third_simulation(**options) for name, options in RUNS.items()}
    return Results(first, second, table, swept, third)
