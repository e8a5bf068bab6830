"""Answer for a recipe's robot over its box of parameters and its chart of directions, exactly."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import measure_recipe
from lutgen.chart import unit_directions
from lutgen.parts import Parameter
from lutgen.recipe import Postures, Recipe, forward, radii_and_kinds
from lutgen.vector import Floats

# Tolerance of a sensor beyond the ends of an axis: rad, and parts of an axis of lengths.
SENSOR_TOLERANCE, TOLERANCE_SHARE = math.radians(0.5), 0.005


def combinations(axes: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return every combination (m, k) of places on k axes, the last one fastest."""
    mesh = np.meshgrid(*axes, indexing="ij")
    return np.stack([one.ravel() for one in mesh], axis=1) if mesh else np.zeros((1, 0))


class Exact(NamedTuple):
    """Exact channels, each (m, d) float64; lengths in the recipe's unit.

    `sdg` and `height` are NaN and `tip_angle` (rad) is negative outside the standing region.
    """

    sdg: Floats
    height: Floats
    tip_angle: Floats


class Model:
    """The robot of a recipe with its box (rad or length) and chart.

    `radius` (n,) and `kind` (n,) are of its contacts: 0 for points; 1 sphere, 2 disc.
    `chart_limit` is the largest |u| and |v|: tan(max_tilt), or 1 for the sphere of 6 faces.
    """

    def __init__(self, recipe: Recipe) -> None:
        self.recipe = recipe
        self.lower = np.array([p.minimum for p in recipe.parameters], dtype=np.float64)
        self.upper = np.array([p.maximum for p in recipe.parameters], dtype=np.float64)
        self.k = len(recipe.parameters)
        self.radius, self.kind = radii_and_kinds(recipe)
        self.faces = recipe.chart.faces
        self.chart_limit = math.tan(recipe.chart.max_tilt) if recipe.chart.kind == "cone" else 1.0

    @property
    def is_tripod(self) -> bool:
        """True if three points are all there is to stand on: one facet, everything smooth."""
        return len(self.kind) == 3 and not self.kind.any() and not self.recipe.axles

    def at(self, t: Floats) -> Floats:
        """Return the parameters (..., k), rad or length, for places (..., k) in 0..1 of the box."""
        return np.asarray(self.lower + (self.upper - self.lower) * t)

    def postures(self, params: ArrayLike) -> Postures:
        """Return centres (m, n, 3) relative to the com, axes (m, n, 3) and com (m, 3)."""
        return forward(self.recipe, params)

    def uv_to_gravity(self, face: ArrayLike, u: ArrayLike, v: ArrayLike) -> Floats:
        """Return the directions (..., 3), not normalised, of places on the chart's faces."""
        frames = self.recipe.chart.basis()[np.asarray(face, np.intp)]
        middle, across, up = np.moveaxis(frames, -2, 0)
        return np.asarray(
            middle + np.asarray(u)[..., None] * across + np.asarray(v)[..., None] * up
        )

    def tip_angle(self, where: Postures, gravity: ArrayLike) -> Floats:
        """Return the tip angles (m, d), rad, of m postures under directions (m, d, 3), down."""
        names = ("tip_angle",)
        return measure_recipe(self.recipe, where, unit_directions(gravity), names)["tip_angle"]

    def exact(self, params: ArrayLike, gravity: ArrayLike) -> Exact:
        """Measure m postures (m, k), rad or length, under d directions each (m, d, 3), down."""
        names = ("sdg", "height", "tip_angle")
        where, directions = self.postures(params), unit_directions(gravity)
        return Exact(**measure_recipe(self.recipe, where, directions, names))


def sensor_tolerance(parameter: Parameter) -> float:
    """Return how far beyond the ends of its axis a parameter is still read (rad or length)."""
    span = parameter.maximum - parameter.minimum
    return min(SENSOR_TOLERANCE, span) if parameter.unit == "rad" else TOLERANCE_SHARE * span


@lru_cache(maxsize=8)
def widened(model: Model) -> Model:
    """Return the model over its box and what sensors may say beyond its ends."""
    recipe = model.recipe
    wider = tuple(
        replace(p, minimum=p.minimum - sensor_tolerance(p), maximum=p.maximum + sensor_tolerance(p))
        for p in recipe.parameters
    )
    return Model(replace(recipe, parameters=wider))
