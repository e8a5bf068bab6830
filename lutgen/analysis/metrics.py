"""Metrics of stability side by side: one posture, many directions, five measures.

Owns what makes them comparable: the normalisation.  Only `tip_angle` is the verdict.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.force_angle import footing_force_angle
from lutgen.analysis.stance import find_footing
from lutgen.channels import checked_directions, evaluate
from lutgen.errors import InputError
from lutgen.recipe import Recipe

__all__ = ["METRICS", "Metrics", "compare_metrics"]

Floats = NDArray[np.float64]

METRICS = ("sdg", "tip_angle", "margin", "energy_margin", "force_angle")
CHANNELS = ("sdg", "tip_angle", "margin", "energy_margin")
LEVEL = np.array([[0.0, 0.0, -1.0]])


@dataclass(frozen=True)
class Metrics:
    """Five metrics under g directions, by name: (g,) float64 each.

    `values` are in rad and the recipe's length unit, `force_angle` in rad x length for a weight
    of 1; `sdg` is NaN where the robot tips.  `normalised` are without unit: each is its value
    divided by that on level ground; of `sdg`, which is 0 at its best, it is 1 - |SD_g| / r with r
    the distance from the support polygon's centroid to its nearest side, the largest |SD_g| at
    which the robot stands wherever D_g lies.  `level` are the values on level ground.
    """

    standing: NDArray[np.bool_]
    values: dict[str, Floats]
    normalised: dict[str, Floats]
    level: dict[str, float]


def compare_metrics(recipe: Recipe, params: ArrayLike, gravity_dir: ArrayLike) -> Metrics:
    """Compute the metrics of one posture.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (k,) array_like
        Geometry parameters, rad or length.
    gravity_dir : (g, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.

    Returns
    -------
    Metrics

    Raises
    ------
    InputError
        Where the posture tips on level ground or has no tip-over axis, so that nothing normalises
        it; for wrong shapes and numbers that are not finite.
    """
    if recipe.com_uncertainty > 0.0:
        raise InputError(
            f"{recipe.source}: key `robot.com_uncertainty`: metrics are those of one com (got "
            f"{recipe.com_uncertainty:g}); leave it out to compare them"
        )
    directions = np.vstack([LEVEL, checked_directions(gravity_dir)])
    posture = np.asarray(params, dtype=np.float64)
    found = evaluate(recipe, np.atleast_2d(posture), directions, CHANNELS)
    values = {name: channel[0] for name, channel in found.items()}
    standing = values["tip_angle"] >= 0.0
    footing = find_footing(recipe, posture)
    values["force_angle"] = footing_force_angle(
        footing, directions, values["tip_angle"], values["margin"]
    )
    level = values["tip_angle"][0]
    if not level > 0.0 or not len(footing.start):
        degrees = f"{np.degrees(level):.3g} deg"
        raise InputError(
            f"{recipe.source}: metrics are compared with those on level ground, where this posture "
            f"does not stand or cannot tip (got a tip angle of {degrees}); choose another posture."
        )
    normalised = {name: values[name][1:] / values[name][0] for name in METRICS if name != "sdg"}
    radius = np.array([facet.inradius for facet in footing.facets])
    normalised["sdg"] = 1.0 - values["sdg"][1:] / radius[footing.under(directions[1:])]
    return Metrics(
        standing[1:],
        {name: values[name][1:] for name in METRICS},
        {name: normalised[name] for name in METRICS},
        {name: float(values[name][0]) for name in METRICS},
    )
