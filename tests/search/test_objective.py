"""What a search makes small: words, signs, units, and standing before tipping."""

import numpy as np
import pytest

import lutgen
from lutgen.channels.evaluation import evaluate_each
from lutgen.channels.resting import body_gravity
from lutgen.errors import InputError
from lutgen.search.objective import TIPS, Objective, parse_objective
from tests.fixtures.recipes import feet, rigid, tripod, without_limits

TILTED = [0.4, 0.3, -1.0]


def geometries(count=400):
    """Return random geometries of `tripod`."""
    return np.random.default_rng(4).uniform([0.0, -0.69], [0.6, 0.87], (count, 2))


def test_objectives_are_read_as_they_are_written_and_others_are_refused():
    for text, weights in (
        (" tip_angle ", {"tip_angle": 1.0}),
        ("sdg+0.1*height", {"sdg": 1.0, "height": 0.1}),
        ("2e-3 * margin + .5*sdg", {"margin": 2e-3, "sdg": 0.5}),
    ):
        assert parse_objective(text) == weights
    for text in ("", "facet", "sdg+sdg", "-1*sdg", "0*sdg", "sdg-height", "1e999*sdg", "sdg+"):
        with pytest.raises(InputError, match=r"not understood \(got the term .*; write one of sdg"):
            parse_objective(text)


@pytest.mark.parametrize(
    ("convention", "text", "sign"),
    [
        ("body", "sdg", 1),
        ("plane", "height", 1),
        ("plane", "tip_angle", -1),
        ("body", "margin", -1),
    ],
)
def test_the_cost_is_the_channel_with_its_good_end_down_and_large_where_it_tips(
    convention, text, sign
):
    recipe, rows = lutgen.parse_recipe(tripod()), geometries()
    goal = Objective(recipe, TILTED, text, convention)
    cost = goal.cost(rows)
    down = body_gravity(recipe, rows, TILTED, convention)
    found = evaluate_each(recipe, rows, down, (text, "tip_angle"))
    angle = found["tip_angle"]
    stands = angle >= 0.0
    assert 20 < stands.sum() < 380
    np.testing.assert_array_equal(cost[stands], sign * found[text][stands])
    for value in cost[stands]:
        assert goal.value(value) == sign * value
        assert goal.cost_of(goal.value(value)) == value
    # Beside 1e9 a float has steps of 1.2e-7: the nearer to standing, the less it costs.
    assert cost[stands].max() < TIPS < cost[~stands].min()
    np.testing.assert_allclose(cost[~stands] - TIPS, -angle[~stands], atol=2e-7)
    assert np.isnan(goal.value(cost[~stands][0]))


def test_a_sum_weighs_its_channels_and_is_its_own_value():
    recipe = lutgen.parse_recipe(tripod())
    level = [0, 0, -1]
    rows = geometries(50)
    one = lutgen.evaluate(recipe, rows, level, ("sdg", "height", "tip_angle"))
    goal = Objective(recipe, level, "2*sdg+0.5*height+0.1*tip_angle")
    stands = one["tip_angle"][:, 0] >= 0.0
    expected = 2.0 * one["sdg"] + 0.5 * one["height"] - 0.1 * one["tip_angle"]
    # The same three products, perhaps added in another order.
    np.testing.assert_allclose(goal.cost(rows)[stands], expected[stands, 0], rtol=1e-15)
    assert goal.value(0.7) == 0.7
    assert goal.cost_of(0.7) == 0.7


def test_a_robot_that_cannot_tip_is_as_good_as_can_be():
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    recipe = without_limits(rigid(feet(corners)))
    for text in ("margin", "energy_margin"):
        goal = Objective(recipe, [0, 0, -1], text)
        (cost,) = goal.cost(np.empty((1, 0)))
        assert np.isfinite(cost)
        assert goal.value(cost) == np.inf
    assert Objective(recipe, [0, 0, -1], "tip_angle").cost(np.empty((1, 0))) == -np.pi
