"""What a search makes small, the paper's optima and trace, and minima found from anywhere."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.channels import evaluate_each
from lutgen.errors import InputError
from lutgen.search.methods import multistart, refine
from lutgen.search.objective import TIPS, Objective, parse_objective
from lutgen.search.optima import METHODS
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, feet, link, parameter, rigid, tripod, without_limits

TILTED = [0.4, 0.3, -1.0]


def geometries(count=400):
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
    down = np.tile(TILTED, (len(rows), 1))
    found = evaluate_each(recipe, rows, down, (text, "tip_angle"), convention)
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


LEVEL = [0.0, 0.0, -1.0]


def test_the_map_method_keeps_to_the_nodes_within_the_bounds(two):
    found = lutgen.optimum(two, LEVEL, "map", bounds=np.radians([[35.0, 50.0], [0.0, 20.0]]))
    knots = np.degrees(two.grid.axes[0].knots)
    inside = [knots[(knots >= 35.0) & (knots <= 50.0)], knots[knots <= 20.0]]
    assert found.evaluations == len(inside[0]) * len(inside[1])
    with pytest.raises(InputError, match="no node of the sweep lies within the bounds"):
        lutgen.optimum(two, LEVEL, "map", bounds=np.radians([[30.7, 31.5], [0.0, 50.0]]))


def test_nelder_mead_finds_the_nominal_shape_and_the_map_its_best_node(two):
    for method, convention in (("nelder-mead", "plane"), ("multistart", "body")):
        found = lutgen.optimum(two, LEVEL, method, convention=convention)
        assert found.standing
        # |SD_g| is 0.07 per deg: 1e-5 is 1.4e-4 deg on the diagonal, and at most 2.5e-4 off it.
        assert found.value < 1e-5
        assert np.degrees(found.params) == pytest.approx(
            [math.degrees(math.atan(0.6))] * 2, abs=2.5e-4
        )
    node, nodes = lutgen.optimum(two, LEVEL, "map"), two.grid.params(np.arange(two.grid.size))
    sdg = lutgen.evaluate(two, nodes, LEVEL, ("sdg",))["sdg"][:, 0]
    assert (node.evaluations, node.value) == (2500, np.nanmin(sdg))
    # Turned to deg and back.
    np.testing.assert_allclose(node.params, nodes[np.nanargmin(sdg)], rtol=1e-15)


def test_any_number_of_parameters_is_searched_but_by_a_mesh_of_at_most_eight():
    # A body on feet, each of which goes up and down by itself.
    count = 9
    parts = ""
    for i in range(count):
        parts += parameter(f"leg{i}", 0.3, 0.9, "m")
        parts += link(f"link{i}", "body", ("prismatic", (0, 0, -1), f"leg{i}"))
        angle = 2.0 * math.pi * i / count
        parts += contact(f"foot{i}", (math.cos(angle), math.sin(angle), 0.0), link=f"link{i}")
    spider = rigid(parts, samples=", ".join(f"leg{i} = 2" for i in range(count)))
    recipe, down = lutgen.parse_recipe(spider), [0.15, 0.1, -1.0]
    with pytest.raises(InputError, match=r"at most 8 parameters \(got 9, or 5\^9 nodes a step\)"):
        lutgen.optimum(recipe, down)
    box, best = np.array([[0.5, 0.5]] * 5 + [[0.3, 0.9]] * 4), {}
    for method in METHODS:
        found = lutgen.optimum(recipe, down, method, levels=1, bounds=box)
        assert ((found.params >= box[:, 0] - 1e-12) & (found.params <= box[:, 1] + 1e-12)).all()
        assert found.params[:5].tolist() == [0.5] * 5
        assert found.acceptable.shape == (count, 2)
        best[method] = found.value
    drawn = np.random.default_rng(9).uniform(*box.T, (500, count))
    assert best["multistart"] <= Objective(recipe, down).cost(drawn).min()


@pytest.mark.parametrize("method", METHODS)
def test_where_nothing_stands_the_least_bad_geometry_is_returned(method):
    recipe, down = lutgen.parse_recipe(tripod()), [0.0, 5.0, -1.0]
    found = lutgen.optimum(recipe, down, method)
    assert not found.standing
    assert np.isnan([found.value, *found.acceptable.ravel(), *found.delta]).all()
    corners = [[a, b] for a in (0.0, 0.6) for b in np.radians([-40.0, 50.0])]
    tips = lutgen.evaluate(recipe, [found.params, *corners], down, ("tip_angle",))["tip_angle"]
    assert tips[0, 0] >= tips[1:, 0].max() - 0.02


def test_what_makes_no_sense_is_refused(two):
    for arguments, message in (
        ({"method": "simplex"}, "unknown method 'simplex'; choose from map, nelder-mead"),
        ({"ends": "both"}, "unknown ends 'both'; choose from left, right"),
        ({"bounds": [[0.0, 1.0]]}, r"shape \(2, 2\) \(got \[\[0.0, 1.0\]\]\)"),
        ({"bounds": [[0.0, np.nan], [0.0, 1.0]]}, "bounds must be finite"),
        ({"bounds": [[1.0, 0.0], [0.0, 1.0]]}, "no lower bound may be above the upper one"),
        ({"start": [0.1]}, r"one number for each parameter \(got \[0.1\]\)"),
        ({"start": [0.1, np.nan]}, "the start must lie within the bounds"),
        ({"convention": "F"}, "unknown convention 'F'"),
    ):
        with pytest.raises(InputError, match=message):
            lutgen.optimum(two, LEVEL, **arguments)
    with pytest.raises(InputError):
        lutgen.optimum(two, [0, 0, math.nan])


def test_the_value_is_that_of_the_parameters_returned():
    recipe = lutgen.parse_recipe(tripod())
    for method in METHODS:
        for name in ("sdg", "margin"):
            found = lutgen.optimum(recipe, [0.2, 0.1, -1.0], method, name)
            exact = lutgen.evaluate(recipe, [found.params], [0.2, 0.1, -1.0], (name,))[name]
            assert found.value == pytest.approx(exact[0, 0], rel=1e-12)  # deg and back
            costs = [step.value for step in found.trace]
            best = min(costs) if name == "sdg" else max(costs)
            assert found.value == best


@pytest.mark.parametrize("method", METHODS)
def test_a_parameter_with_equal_bounds_keeps_its_value(two, method):
    kept = math.radians(17.3)  # no node of the sweep
    found = lutgen.optimum(two, LEVEL, method, bounds=[[0.0, math.radians(50.0)], [kept, kept]])
    assert found.params[1] == kept
    assert found.acceptable[1].tolist() == [kept, kept]
    assert found.delta[1] == 0.0
    assert all(
        (step.params[1] == kept) and (step.nodes[:, 1] == kept).all() for step in found.trace
    )


BOX = np.array([[-180.0, 180.0], [-180.0, 180.0]])


def test_multistart_finds_the_global_optimum_of_a_robot_on_tracks():
    goal = Objective(lutgen.load_recipe(MAPS / "absolem.toml"), [-0.6, 0.3, -1.0])

    def cost(points):
        return goal.cost(np.radians(points))

    # Established once by a mesh of 2 deg and finer ones around its minima; the test's own mesh
    # of 6 deg must not find anything better.  It lies where two more contacts begin to touch, which
    # they do within contact_tolerance: while that was rounding alone, 0.047387516 could be had
    # beside it.
    lowest = 0.0473900796
    line = np.linspace(-180.0, 180.0, 61)
    mesh = np.stack(np.meshgrid(line, line), axis=2).reshape(-1, 2)
    assert cost(mesh).min() > lowest
    start = np.random.default_rng(1).uniform(BOX[:, 0], BOX[:, 1])
    assert multistart(cost, BOX, start, 1)[-1].value == pytest.approx(lowest, abs=1e-6)
    assert (
        min(step.value for step in refine(lambda nodes: cost(nodes[0])[None], BOX)[0])
        > lowest + 1e-3
    )
