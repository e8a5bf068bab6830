"""The paper's first two simulations, computed.

Owns the numbers of Figs 8 and 10 to 15 and of Table 1; it neither draws nor prints.  Both gravity
conventions are computed everywhere, because the paper does not say which one it means.
"""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lutgen.channels import CONVENTIONS, body_gravity, evaluate_each
from lutgen.mapping import load_map, sweep
from lutgen.paper.nominal import DOWN, RADIUS
from lutgen.paper.published import TABLE, Row
from lutgen.paper.robot import paper_recipe
from lutgen.recipe import Recipe
from lutgen.search import Optimum, optimum

Floats = NDArray[np.float64]

# |SD_g| up to which a shape counts as acceptable (the paper's delta): a tenth of that at which the
# paper's robot tips.
LIMIT = 1.0
# The three methods of the paper, and many starts.
METHODS = ("map", "nelder-mead", "search", "multistart")


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

    published: Row
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
