"""The tracked robot of `maps/absolem.toml`: why wheels must not be points on their rims."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis.tilt import tilt_limits, tilted
from lutgen.recipe.kinematics import forward
from lutgen.recipe.recipe import Recipe
from tests.fixtures.places import MAPS

UP = np.radians([[90.0, 90.0]])
NOSE_DOWN = 0.0
WHEEL = 0.089


@pytest.fixture(scope="module")
def absolem() -> Recipe:
    """Return the robot."""
    return lutgen.load_recipe(MAPS / "absolem.toml")


def verdict(recipe: Recipe, tilt: float) -> float:
    """Return the tip angle (rad) with the flippers up and the nose down by a tilt (deg)."""
    gravity = tilted(math.radians(tilt), NOSE_DOWN)
    return float(lutgen.evaluate(recipe, UP, gravity, ("tip_angle",))["tip_angle"][0, 0])


def test_the_com_is_the_published_one_to_a_tenth_of_a_millimetre(absolem: Recipe) -> None:
    level = np.radians([[-10.64, -10.64]])
    _, com = lutgen.postures(absolem, np.vstack([UP, level]))
    assert com[0] == pytest.approx([-0.0322, -0.0057, 0.0988], abs=1e-4)
    assert com[1] == pytest.approx([-0.0322, -0.0057, 0.0892], abs=1e-4)


def test_the_hull_of_points_on_the_rims_would_call_that_standing(absolem: Recipe) -> None:
    wheels = forward(absolem, UP).centres[0, :4]
    turns = np.radians(np.arange(8) * 45.0)
    rim = WHEEL * np.stack([np.sin(turns), np.zeros(8), -np.cos(turns)], axis=-1)
    points = (wheels[:, None] + rim).reshape(1, 32, 3)
    gravity = tilted(math.radians(65.0), NOSE_DOWN)
    free = lutgen.stability(points, gravity, ("tip_angle",))["tip_angle"][0, 0]
    assert free > 0.0
    # Even with the recipe's limit on how far a facet may be from level, and no limit on rocking.
    upright = lutgen.stability(points, gravity, ("tip_angle",), absolem.upright)["tip_angle"][0, 0]
    assert upright > 0.0
    # The true wheels, under the same direction.
    assert verdict(absolem, 65.0) < 0.0


def test_the_nose_down_limit_is_at_the_lowest_points_of_the_front_wheels(absolem: Recipe) -> None:
    _, com = lutgen.postures(absolem, UP)
    lever = 0.25 - com[0, 0]
    height = com[0, 2] - (0.01855 - WHEEL)
    closed_form = math.atan(lever / height)
    limit = tilt_limits(absolem, UP[0], [NOSE_DOWN])[0]
    # Both are exact but for the bisection, which ends at 1e-13 rad.
    assert limit == pytest.approx(closed_form, abs=1e-9)
    # The published 59.04 comes from a com rounded to 0.1 mm, which is 0.02 deg here.
    assert math.degrees(limit) == pytest.approx(59.04, abs=0.05)
    assert math.degrees(math.atan((0.25 + 0.0322) / height)) == pytest.approx(59.04, abs=0.05)
