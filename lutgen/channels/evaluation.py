"""Stability of a recipe's robot at any parameters and any directions, exactly.

Owns the step from a recipe to the kernels; nothing here is sampled or interpolated.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels.load import measure_recipe
from lutgen.channels.plain import (
    CHANNELS,
    checked_directions,
    measure_postures,
    refuse_overflow,
    wanted_channels,
)
from lutgen.recipe import Postures, Recipe, forward, radii_and_kinds


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
        As for `stability`, with the recipe's `upright` and `rock_angle`, its forces and the
        uncertainty of its com; with one of those `energy_margin` is NaN.

    Raises
    ------
    InputError
        For wrong shapes, numbers that are not finite and unknown channels.
    """
    return measure_moved(recipe, forward(recipe, params), gravity_dir, channels)


def measure_moved(
    recipe: Recipe, postures: Postures, gravity_dir: ArrayLike, channels: Sequence[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of postures that `kinematics.forward` has placed; see `evaluate`."""
    if recipe.loaded:
        wanted = wanted_channels(channels)
        directions = checked_directions(gravity_dir)
        values, overflow = measure_recipe(recipe, postures, directions[None], wanted)
        refuse_overflow(recipe.source, overflow, len(recipe.contacts))
        return {name: values[:, CHANNELS.index(name)].copy() for name in channels}
    radius, kind = radii_and_kinds(recipe)
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
