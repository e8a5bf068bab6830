"""From a recipe to its channels, and the refusal of robots that never stand."""

import numpy as np
import pytest

import lutgen
from lutgen.errors import InputError, RecipeError
from lutgen.mapping.compute import require_standing
from tests.fixtures.recipes import ALL_CHANNELS, feet, rigid, tripod

FEET = [(1.0, 0.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, -1.0)]
DOWN = [[0.0, 0.0, -1.0]]


def refusal(text):
    """Return the sentence with which a recipe is refused."""
    with pytest.raises(RecipeError) as caught:
        require_standing(lutgen.parse_recipe(text, "robot.toml"))
    assert str(caught.value).startswith("robot.toml: key `robot.contact`: ")
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_evaluate_of_point_feet_is_stability_of_their_postures():
    recipe = lutgen.parse_recipe(tripod())
    rng = np.random.default_rng(1)
    params = np.column_stack([rng.uniform(0, 0.6, 15), rng.uniform(-0.7, 0.8, 15)])
    gravity = rng.normal(size=(40, 3)) - [0, 0, 2]
    contacts, _ = lutgen.postures(recipe, params)
    got = lutgen.evaluate(recipe, params, gravity, ALL_CHANNELS)
    want = lutgen.stability(contacts, gravity, ALL_CHANNELS, recipe.upright, recipe.rock_angle)
    for name in ALL_CHANNELS:
        assert got[name].shape == (15, 40)
        np.testing.assert_array_equal(got[name], want[name])


def test_the_recipes_limits_count():
    lying = rigid(feet([(x, y, z) for x, y, z in FEET] + [(0, 0, 1)]), head="upright = {}")
    up = [[0.3, 0.1, 1.0]]
    upright, anyhow = (
        lutgen.evaluate(lutgen.parse_recipe(lying.format(limit)), np.zeros((1, 0)), up)["tip_angle"]
        for limit in (90.0, 180.0)
    )
    assert upright[0, 0] < 0.0 < anyhow[0, 0]


def test_parameters_beyond_their_limits_are_refused_such_as_degrees_for_radians():
    recipe = lutgen.parse_recipe(tripod(), "r.toml")
    with pytest.raises(InputError, match=r"r\.toml: .* swing must lie in -40 .* = 50 rad in row 1"):
        lutgen.evaluate(recipe, [[0.6, 0.0], [0.6, 50.0]], DOWN)
    # The ends belong to the range, as they come out of degrees.
    ends = [[0.0, np.radians(-40.0)], [0.6, np.radians(50.0)]]
    assert np.isfinite(lutgen.evaluate(recipe, ends, DOWN, ("tip_angle",))["tip_angle"]).all()


def test_feet_above_the_com_are_refused_in_a_sentence():
    message = refusal(rigid(feet([(x, y, -z) for x, y, z in FEET])))
    assert "P1, P2, P3" in message
    assert "below the centre of mass" in message


def test_a_com_beside_its_feet_is_refused_though_they_are_below_it():
    # 4 ahead of the com: only a tilt of more than 50 deg would bring it over them.
    refusal(rigid(feet([(x + 6.0, y, z) for x, y, z in FEET])))


def test_a_robot_that_stands_at_one_direction_of_its_map_is_accepted():
    # A narrow foot triangle under the direction of one node that is not among the first looked at.
    recipe = lutgen.parse_recipe(rigid(feet(FEET), nodes=33, max_tilt=50.0))
    u = recipe.chart.coords
    # Of 33 nodes the search first looks at every fourth.
    narrow = [(u[18] + 0.01 * x, u[13] + 0.01 * y, -1.0) for x, y, _ in FEET]
    require_standing(lutgen.parse_recipe(rigid(feet(narrow), nodes=33, max_tilt=50.0)))
    between = [(u[18] + 0.02 + 0.01 * x, u[13] + 0.02 + 0.01 * y, -1.0) for x, y, _ in FEET]
    refusal(rigid(feet(between), nodes=33, max_tilt=50.0))


def test_a_robot_that_stands_at_one_posture_of_its_map_is_accepted():
    # The front foot must be ahead of the com, which it is at the last but one knot only.
    text = tripod("reach = [0.0, 0.1, 0.2, 0.3, 0.5, 0.6], swing = 2", nodes=1)
    require_standing(lutgen.parse_recipe(text))
