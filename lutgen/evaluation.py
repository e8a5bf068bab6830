"""Stability of a recipe's robot at any parameters and any directions, exactly.

Owns the step from a recipe to the kernels; nothing here is sampled or interpolated.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import measure_postures
from lutgen.errors import RecipeError
from lutgen.recipe import Recipe
from lutgen.robot import forward, shapes


def evaluate(
    recipe: Recipe,
    params: ArrayLike,
    gravity_dir: ArrayLike,
    channels: Sequence[str] = ("sdg", "tip_angle"),
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of m postures under g gravity directions.

    Parameters
    ----------
    recipe : Recipe
        From `load_recipe` or `parse_recipe`.
    params : (m, k) array_like
        Geometry parameters in recipe order, rad or the recipe's length unit; they may lie outside
        the recipe's ranges.
    gravity_dir : (g, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.
    channels : sequence of str
        See `stability`.

    Returns
    -------
    dict of str to (m, g) float64
        As for `stability`, with the recipe's `upright` and `rock_angle`.

    Raises
    ------
    InputError
        For wrong shapes, numbers that are not finite and unknown channels.
    """
    postures = forward(recipe, params)
    radius, kind = shapes(recipe)
    return measure_postures(
        postures.centres,
        postures.axes,
        radius,
        kind,
        gravity_dir,
        channels,
        recipe.upright,
        recipe.rock_angle,
    )


def require_standing(recipe: Recipe) -> None:
    """Refuse a recipe whose robot stands in none of its postures, in no direction of its chart.

    Looks at 3 knots of every parameter (at most 729 postures) and 9 x 9 directions of each face;
    only where that finds nothing does it look at every node.
    """
    grid, chart = recipe.grid, recipe.chart
    coarse = [np.unique([0, axis.size // 2, axis.size - 1]) for axis in grid.axes[:6]]
    coarse += [np.array([axis.size // 2]) for axis in grid.axes[6:]]
    index = np.stack([part.ravel() for part in np.meshgrid(*coarse, indexing="ij")], axis=1)
    some = np.ravel_multi_index(tuple(index.T), grid.shape) if grid.axes else np.zeros(1, np.intp)
    nodes = np.unique(np.linspace(0, chart.nodes - 1, min(chart.nodes, 9)).astype(int))
    few = chart.directions()[:, nodes][:, :, nodes].reshape(-1, 3)
    if _any_stands(recipe, np.asarray(some, np.intp), few):
        return
    every = chart.directions().reshape(-1, 3)
    step = max(1, 200_000 // len(every))
    for begin in range(0, grid.size, step):
        if _any_stands(recipe, np.arange(begin, min(begin + step, grid.size)), every):
            return
    raise RecipeError(
        f"{recipe.source}: key `robot.contact`: the robot stands in none of its {grid.size} "
        f"postures under any of the {len(every)} gravity directions of its chart (got contacts "
        f"{', '.join(recipe.contact_names)}); check that the contacts lie below the centre of mass "
        "(z up) and are not collinear, or raise `robot.upright`"
    )


def _any_stands(recipe: Recipe, flat: NDArray[np.intp], directions: NDArray[np.float64]) -> bool:
    angle = evaluate(recipe, recipe.grid.params(flat), directions, ("tip_angle",))["tip_angle"]
    return bool((angle >= 0.0).any())
