"""Stability of a recipe's robot at any parameters and any directions, exactly.

Owns the step from a recipe to the kernels; nothing here is sampled or interpolated.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import measure_postures
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
