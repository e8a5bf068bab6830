"""Whether a recipe's robot stands at all: the check before a sweep.

Owns the search for one standing node, with the sweep's own kernel: a second one would have to be
compiled first.
"""

import math

import numpy as np

from lutgen.channels import CHANNELS, Scanner
from lutgen.chart import Chart
from lutgen.errors import RecipeError
from lutgen.recipe import Recipe
from lutgen.vector import Floats

COARSE_NODES = 9
AT_ONCE = 200_000


def require_standing(recipe: Recipe) -> None:
    """Refuse a recipe whose robot stands in none of its postures, in no direction of its chart.

    Looks at 3 knots of every parameter (at most 729 postures) and 9 x 9 directions of each face;
    only where that finds nothing does it look at every node.
    """
    grid, chart = recipe.grid, recipe.chart
    coarse = [np.unique([0, axis.size // 2, axis.size - 1]) for axis in grid.axes[:6]]
    coarse += [np.array([axis.size // 2]) for axis in grid.axes[6:]]
    some = np.zeros(1, np.intp)
    if grid.axes:
        index = [part.ravel() for part in np.meshgrid(*coarse, indexing="ij")]
        some = np.ravel_multi_index(tuple(index), grid.shape)
    few = Chart(chart.kind, min(chart.nodes, COARSE_NODES), chart.max_tilt)
    if _any_stands(recipe, grid.params(np.atleast_1d(some)), few):
        return
    step = max(1, AT_ONCE // math.prod(chart.shape))
    for begin in range(0, grid.size, step):
        nodes = np.arange(begin, min(begin + step, grid.size))
        if _any_stands(recipe, grid.params(nodes), chart):
            return
    raise RecipeError(
        f"{recipe.source}: key `robot.contact`: the robot stands in none of its {grid.size} "
        f"postures under any of the {math.prod(chart.shape)} gravity directions of its chart (got "
        f"contacts {', '.join(recipe.contact_names)}); check that the contacts lie below the "
        "centre of mass (z up) and are not collinear, or raise `robot.upright`"
    )


def _any_stands(recipe: Recipe, params: Floats, chart: Chart) -> bool:
    scanner = Scanner(recipe, chart, ("sdg",))
    out = np.full((len(CHANNELS), len(params) * scanner.rows * chart.nodes), np.nan, np.float32)
    scanner.fill(params, 0, scanner.rows, out)
    return bool(np.isfinite(out[CHANNELS.index("sdg")]).any())
