"""Every way to a reading: `evaluate`, pairs, sweeps and diagnoses agree; and `status` by hand."""

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Posture, diagnose
from lutgen.channels import Scanner, evaluate_each
from lutgen.errors import InputError, RecipeError
from lutgen.mapping.compute import require_standing
from lutgen.quantities import CHANNELS
from tests.fixtures.pulled import moving
from tests.fixtures.recipes import feet, rigid, rocker, rover, tripod

FEET = np.array([(1.0, 0.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, -1.0, -1.0)])
STANDS, ROCKS, TIPS = 0.0, 1.0, 2.0


@pytest.mark.parametrize(
    "recipe",
    [lutgen.parse_recipe(tripod()), lutgen.parse_recipe(rover()), moving()],
    ids=["points", "discs with gaps", "loaded points"],
)
def test_pairs_are_the_diagonal_of_all_and_what_a_diagnosis_says(recipe):
    random = np.random.default_rng(1)
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    params = random.uniform(low, high, (60, len(low)))
    down = random.normal(0.0, 0.7, (60, 3)) - [0.0, 0.0, 1.0]
    pairs = evaluate_each(recipe, params, down, CHANNELS)
    crossed = lutgen.evaluate(recipe, params, down, CHANNELS)
    several = evaluate_each(recipe, params, np.stack([down, down[::-1]], axis=1), CHANNELS)
    # A guard that never sees the robot tip, or stand, sees half.
    assert 10 < (pairs["tip_angle"] < 0.0).sum() < 50
    for name in CHANNELS:
        # Bit for bit: all run the same kernel on the same numbers.
        np.testing.assert_array_equal(pairs[name], np.diagonal(crossed[name]), err_msg=name)
        each = np.stack([pairs[name], np.diagonal(crossed[name][:, ::-1])], axis=1)
        np.testing.assert_array_equal(several[name], each, err_msg=name)
    for k in range(40):
        found = diagnose(Posture(recipe, params[k]), down[k])
        assert found.standing is bool(pairs["tip_angle"][k] >= 0.0)
        for name in CHANNELS:
            # Compiled for one direction and for many: the last bits may differ, and near a tip-over
            # axis they are all there is.
            np.testing.assert_allclose(
                found.channels[name], pairs[name][k], rtol=1e-9, atol=1e-12, err_msg=name
            )


def test_directions_that_are_not_those_of_the_postures_and_unknown_channels_are_refused():
    recipe = lutgen.parse_recipe(tripod())
    params = np.tile([0.2, 0.1], (5, 1))
    for shape in ((1, 3), (5, 7, 2), (4, 7, 3), (5, 1, 7, 3), (3,)):
        with pytest.raises(InputError, match="one row x, y, z for each of 5 postures"):
            evaluate_each(recipe, params, np.ones(shape))
    with pytest.raises(InputError, match="unknown channel 'sgd'"):
        evaluate_each(recipe, params, np.ones((5, 3)), ("sgd",))


@pytest.mark.parametrize("recipe", [moving(), lutgen.parse_recipe(tripod())])
def test_sweeps_under_forces_or_with_margins_read_what_evaluate_reads(recipe):
    params = recipe.grid.params(np.arange(recipe.grid.size))
    g = recipe.chart.directions().reshape(-1, 3)
    names = ("sdg", "height", "tip_angle", "margin", "facet")
    got = lutgen.evaluate(recipe, params, g, names)
    assert (got["tip_angle"] >= 0).any()
    assert (got["tip_angle"] < 0).any()
    np.testing.assert_array_equal(got["margin"] < 0, got["tip_angle"] < 0)
    scanner = Scanner(recipe, recipe.chart, names)
    out = np.full((len(CHANNELS), len(params) * len(g)), 7.0, np.float32)
    scanner.fill(params, out)
    for name in names:
        want = got[name].ravel().astype(np.float32)
        assert (out[CHANNELS.index(name)] == want).sum() == np.isfinite(want).sum()


def test_evaluate_of_point_feet_is_stability_of_their_postures():
    recipe = lutgen.parse_recipe(tripod())
    rng = np.random.default_rng(1)
    params = np.column_stack([rng.uniform(0, 0.6, 15), rng.uniform(-0.7, 0.8, 15)])
    gravity = rng.normal(size=(40, 3)) - [0, 0, 2]
    contacts, _ = lutgen.postures(recipe, params)
    got = lutgen.evaluate(recipe, params, gravity, CHANNELS)
    want = lutgen.stability(contacts, gravity, CHANNELS, recipe.upright, recipe.rock_angle)
    for name in CHANNELS:
        assert got[name].shape == (15, 40)
        np.testing.assert_array_equal(got[name], want[name])


def test_parameters_beyond_their_limits_are_refused_such_as_degrees_for_radians():
    recipe, down = lutgen.parse_recipe(tripod(), "r.toml"), [[0.0, 0.0, -1.0]]
    with pytest.raises(InputError, match=r"r\.toml: .* swing must lie in -40 .* = 50 rad in row 1"):
        lutgen.evaluate(recipe, [[0.6, 0.0], [0.6, 50.0]], down)
    # The ends belong to the range, as they come out of degrees.
    ends = [[0.0, np.radians(-40.0)], [0.6, np.radians(50.0)]]
    assert np.isfinite(lutgen.evaluate(recipe, ends, down, ("tip_angle",))["tip_angle"]).all()


def narrow(u, v):
    """Return a robot with a narrow triangle of feet under one direction, on 33 x 33 nodes."""
    places = FEET * [0.01, 0.01, 1.0] + [u, v, 0.0]
    return rigid(feet(places.tolist()), nodes=33, max_tilt=50.0)


COORDS = lutgen.parse_recipe(narrow(0.0, 0.0)).chart.coords


@pytest.mark.parametrize(
    ("text", "stands"),
    [
        # Feet above the com, and feet below it but 4 ahead: only a tilt of over 50 deg would do.
        (rigid(feet((FEET * [1, 1, -1]).tolist())), False),
        (rigid(feet((FEET + np.array([6, 0, 0])).tolist())), False),
        # At one node, of which every fourth is looked at first, and between nodes.
        (narrow(COORDS[18], COORDS[13]), True),
        (narrow(COORDS[18] + 0.02, COORDS[13] + 0.02), False),
        # The front foot must be ahead of the com, which it is at the last but one knot only.
        (tripod("reach = [0.0, 0.1, 0.2, 0.3, 0.5, 0.6], swing = 2", nodes=1), True),
    ],
    ids=["above", "beside", "a node", "between", "a posture"],
)
def test_a_robot_that_stands_nowhere_on_its_map_is_refused_in_a_sentence(text, stands):
    recipe = lutgen.parse_recipe(text, "robot.toml")
    if stands:
        require_standing(recipe)
        return
    with pytest.raises(
        RecipeError, match=r"^robot\.toml: key `robot\.contact`: .*P1, P2, P3"
    ) as caught:
        require_standing(recipe)
    assert "below the centre of mass" in str(caught.value)


BOX = feet(((1.0, 0.5, -1.0), (-1.0, 0.5, -1.0), (-1.0, -0.5, -1.0), (1.0, -0.5, -1.0)))
PUSH = '[[robot.link]]\nname = "body"\nmass = 10.0\n[[robot.force]]\nname = "push"\nlink = "body"\n'
PUSH += "position = [0, 0, 0]\nforce = [9.80665, 0, 0]\n"
EDGE = float(np.degrees(np.arctan(0.99)))
BACK = float(np.degrees(np.arcsin(-0.1)))


@pytest.mark.parametrize(
    ("text", "pitch", "status"),
    [
        # Six wheels, the middle ones lower, which it rolls along by 0.1 sin(5.7 deg) = 0.00995
        # either way; the com is 0.45 above their rims: by 1.27 deg.
        (rocker(), (-60, -20, -1.4, -1.2, 0, 1.2), (TIPS, STANDS, STANDS, ROCKS, ROCKS, ROCKS)),
        (rocker(), (1.4, 20, 60), (STANDS, STANDS, TIPS)),
        (rocker(head="rock_angle = 0.0"), (-20, 0, 20), (STANDS, TIPS, STANDS)),
        (rocker(middle=0.0), (-20, 0, 20, 70), (STANDS, STANDS, STANDS, TIPS)),
        # Pushed forward by a tenth of its weight it rocks where without the push it stands.
        (rocker(), (0.0, BACK), (ROCKS, STANDS)),
        (rocker(head=PUSH), (0.0, BACK), (STANDS, ROCKS)),
        # A com that may be beyond the edge tips.
        (rigid(BOX), (EDGE,), (STANDS,)),
        (rigid(BOX, head="com_uncertainty = 0.02"), (EDGE,), (TIPS,)),
        # The recipe's limit counts: on its back only a robot that may lie there stands.
        (
            rigid(BOX + feet([(0, 0, 1)]).replace("P1", "top"), head="upright = 90.0"),
            (170,),
            (TIPS,),
        ),
        (rigid(BOX + feet([(0, 0, 1)]).replace("P1", "top"), head="upright = 180.0"), (170,), (0,)),
    ],
)
def test_a_robot_stands_rocks_or_tips_as_worked_by_hand(text, pitch, status):
    angle = np.radians(pitch)
    down = np.stack([np.sin(angle), 0.0 * angle, -np.cos(angle)], axis=1)
    found = lutgen.evaluate(lutgen.parse_recipe(text), np.empty((1, 0)), down, ["status"])
    assert found["status"][0].tolist() == list(status)
