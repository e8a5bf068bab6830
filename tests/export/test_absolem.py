"""The tracked robot of `maps/absolem.toml`: why wheels must not be points on their rims."""

import math
from pathlib import Path

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


@pytest.fixture(scope="module")
def small() -> Recipe:
    """Return the same robot with a map of 3 x 3 postures."""
    text = (MAPS / "absolem.toml").read_text(encoding="utf-8")
    few = text.replace(
        "samples = { front = 37, rear = 37 }",
        "samples = { front = [-30.0, 45.0, 90.0], rear = [-30.0, 45.0, 90.0] }",
    )
    assert few != text
    return lutgen.parse_recipe(few)


def verdict(recipe: Recipe, tilt: float) -> float:
    """Return the tip angle (rad) with the flippers up and the nose down by a tilt (deg)."""
    gravity = tilted(math.radians(tilt), NOSE_DOWN)
    return float(lutgen.evaluate(recipe, UP, gravity, ("tip_angle",))["tip_angle"][0, 0])


def test_the_com_is_the_published_one_to_a_tenth_of_a_millimetre(absolem: Recipe) -> None:
    level = np.radians([[-10.64, -10.64]])
    _, com = lutgen.postures(absolem, np.vstack([UP, level]))
    assert com[0] == pytest.approx([-0.0322, -0.0057, 0.0988], abs=1e-4)
    assert com[1] == pytest.approx([-0.0322, -0.0057, 0.0892], abs=1e-4)


def test_the_masses_add_up_to_the_published_total(absolem: Recipe) -> None:
    assert sum(link.mass for link in absolem.links) == pytest.approx(29.360, abs=5e-4)


def test_nose_down_at_65_deg_tips_with_the_flippers_straight_up(absolem: Recipe) -> None:
    assert verdict(absolem, 55.0) > 0.0
    assert verdict(absolem, 65.0) < 0.0


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


def test_a_tilted_body_rolls_its_contact_points_but_not_the_com_over_them(absolem: Recipe) -> None:
    # Along the tilt the tip angle falls one to one: the axis is the same from level to the limit.
    angles = [verdict(absolem, tilt) for tilt in (40.0, 50.0, 59.0)]
    assert angles[0] - angles[1] == pytest.approx(math.radians(10.0), abs=1e-9)
    assert angles[1] - angles[2] == pytest.approx(math.radians(9.0), abs=1e-9)


def test_lowered_front_flippers_let_the_nose_go_further_down(absolem: Recipe) -> None:
    level = np.radians([-10.0, 90.0])
    raised = tilt_limits(absolem, UP[0], [NOSE_DOWN])[0]
    lowered = tilt_limits(absolem, level, [NOSE_DOWN])[0]
    assert lowered > raised + math.radians(10.0)


def test_the_map_file_reads_as_the_robot_evaluates(small: Recipe, tmp_path: Path) -> None:
    path = tmp_path / "absolem.h5"
    lutgen.sweep(small, path)
    stability_map = lutgen.load_map(path)
    directions = small.chart.directions().reshape(-1, 3)
    for params in (UP[0], np.radians([-30.0, 45.0])):
        exact = lutgen.evaluate(small, [params], directions, small.channels)
        got = stability_map.read(np.tile(params, (len(directions), 1)), directions)
        clear = np.abs(exact["tip_angle"][0]) > 1e-9
        for name in small.channels:
            np.testing.assert_allclose(
                got[name][clear], exact[name][0][clear], rtol=1e-6, atol=1e-9, err_msg=name
            )  # float32
    # Between the nodes: the verdict agrees from 3 deg of the limit on, half a cell of the chart.
    tilts = np.radians([5.0, 30.0, 56.0, 62.0, 65.0, 70.0])
    got = stability_map.read(np.tile(UP, (6, 1)), tilted(tilts, NOSE_DOWN + 0.01))["tip_angle"]
    assert (got > 0.0).tolist() == [True, True, True, False, False, False]
