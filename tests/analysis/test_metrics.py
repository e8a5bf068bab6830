"""Five metrics side by side; the force-angle measure and others of a public library."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.analysis import Posture, compare_metrics, diagnose, tilted
from lutgen.analysis.metrics import METRICS, axis_force_angle, force_angle
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from proofs.margins import MARGINS
from tests.fixtures.pulled import BOX, LEVEL, pull, robot
from tests.fixtures.recipes import feet, rigid, without_limits

# 2 long, 1.2 wide, 1 high, its com a little off the centre.
TABLE = rigid(feet([(1, 0.6, -1), (-1, 0.6, -1), (-1, -0.6, -1), (1, -0.6, -1)]), name="table")


def test_each_is_divided_by_its_value_on_level_ground():
    table = lutgen.parse_recipe(TABLE)
    found = compare_metrics(Posture(table, []), tilted(math.radians(20.0), [math.pi / 2.0]))
    level = math.atan(0.6)
    # To the left, across a level axis 0.6 away and 1 below.
    arm = math.hypot(1.0, 0.6)
    left = level - math.radians(20.0)
    expected = {
        "tip_angle": left / level,
        "margin": math.sin(left) * arm / 0.6,
        "energy_margin": arm * (1.0 - math.cos(left)) / (arm - 1.0),
        "force_angle": left * math.sin(left) * arm / (level * 0.6),
        # D_g has moved by tan 20 deg of the 0.6 to the nearest side.
        "sdg": 1.0 - math.tan(math.radians(20.0)) / 0.6,
    }
    assert list(found.normalised) == list(METRICS)
    for name, value in expected.items():
        assert found.normalised[name] == pytest.approx([value], abs=1e-12), name
    assert found.level["force_angle"] == pytest.approx(level * 0.6, abs=1e-12)
    # In units again they are the channels, and the measure is the product of two of them.
    down = tilted(math.radians(20.0), [math.pi / 2.0])
    exact = lutgen.evaluate(table, [[]], down, ("sdg", "tip_angle", "margin", "energy_margin"))
    for name, values in exact.items():
        assert found.values[name] == pytest.approx(values[0])
    product = exact["tip_angle"][0] * exact["margin"][0]
    assert found.values["force_angle"] == pytest.approx(product, abs=1e-14)


def test_what_does_not_stand_on_level_ground_or_knows_more_than_a_weight_is_refused():
    for one, said in (
        (
            lutgen.parse_recipe(rigid(feet([(1, 0, -1), (3, 1, -1), (3, -1, -1)]))),
            r"does not stand or cannot tip \(got a tip angle of -24.1 deg",
        ),
        (robot(feet(BOX), pull((5, 0, 0))), "counts the weight and no other force"),
        (robot(feet(BOX), rho=0.01), "metrics are those of one com"),
    ):
        with pytest.raises(InputError, match=said):
            compare_metrics(Posture(one, []), LEVEL)


# The polygon of hector_stability_metrics, its edges in order, and what that library prints.
CORNERS = [(0, 0), (0, 2), (1, 2), (1, 0)]
EDGES = [("P1", "P2"), ("P2", "P3"), ("P3", "P4"), ("P4", "P1")]
WEIGHT = 9.81
COMS = {
    0.2: (
        (0.2, 1.3, 0.8, 0.7),
        (0.019803903, 0.640121947, 0.280624847, 0.220655562),
        (0.387290088, 11.670279234, 5.295366915, 4.193855197),
    ),
    -0.2: (
        (-0.2, 1.3, 1.2, 0.7),
        (-0.019803903, 0.640121947, 0.562049935, 0.220655562),
        (-0.387290088, 11.670279234, 10.312955372, 4.193855197),
    ),
}


def polygon(x, y, z=1.0):
    """Return the reference polygon, its corners relative to a com."""
    return lutgen.parse_recipe(rigid(feet([(cx - x, cy - y, -z) for cx, cy in CORNERS])))


def measured(posture, gravity_dir):
    """Return the measure of one posture (g,) under directions (g, 3) of any length."""
    names = ("tip_angle", "margin")
    found = lutgen.evaluate(posture.recipe, posture.row, gravity_dir, names)
    angle, margin = (found[name][0] for name in names)
    return force_angle(posture, unit_directions(gravity_dir), angle, margin)


@pytest.mark.parametrize("x", COMS)
def test_every_axis_of_the_reference_polygon_has_the_published_values(x):
    found = diagnose(Posture(polygon(x, 0.7), []), (0, 0, -1))
    by_names = {frozenset(axis.names): axis for axis in found.tip_over_axes}
    axes = [by_names[frozenset(names)] for names in EDGES]
    margin, energy, measure = COMS[x]
    # Nine digits are printed.
    assert [axis.margin for axis in axes] == pytest.approx(margin, abs=1e-8)
    assert [axis.energy_margin for axis in axes] == pytest.approx(energy, abs=1e-8)
    got = [axis_force_angle(axis.start, axis.stop, (0, 0, -WEIGHT)) for axis in axes]
    assert got == pytest.approx(measure, abs=1e-8)
    assert found.channels["margin"] == pytest.approx(min(margin), abs=1e-8)
    assert found.channels["energy_margin"] == pytest.approx(min(energy), abs=1e-8)
    whole = WEIGHT * measured(Posture(polygon(x, 0.7), []), [[0, 0, -1]])
    assert whole == pytest.approx([min(measure)], abs=1e-8)


def test_a_com_exactly_over_an_edge_is_zero_under_any_rotation():
    turns = Rotation.random(200_000, random_state=8).as_matrix()
    corners = np.array([(x, y - 0.7, -1.0) for x, y in CORNERS])
    points = np.einsum("rij,pj->rpi", turns, corners)
    force = turns @ np.array([0.0, 0.0, -WEIGHT])
    stop = np.roll(points, -1, axis=1)
    each = axis_force_angle(points, stop, force[:, None, :])
    assert np.isfinite(each).all()
    # theta and the moment are both rounding, 1e-15 and 1e-14: their product is far below this.
    assert np.abs(each.min(axis=1)).max() < 1e-20
    assert each.argmin(axis=1).tolist() == [0] * len(turns)
    # The other edges keep their values: a measure that is 0 everywhere would not.
    expected = [WEIGHT * d * math.atan(d) for d in (1.3, 1.0, 0.7)]
    assert np.abs(each[:, 1:] - expected).max() < 1e-12


def test_a_robot_that_supports_nothing_or_cannot_tip_has_an_infinite_measure():
    line = lutgen.parse_recipe(rigid(feet([(1, 0, -1), (0, 0, -1), (-1, 0, -1)])))
    assert measured(Posture(line, []), [[0, 0, -1]]).tolist() == [-math.inf]
    around = [(1, 0, -1), (-1, 1, -1), (-1, -1, -1), (0, 0, 2)]
    solid = without_limits(rigid(feet(around)))
    assert measured(Posture(solid, []), [[0, 0, -1], [1, 1, 1]]).tolist() == [math.inf] * 2


def test_on_one_polygon_they_are_our_channels_under_any_gravity():
    posture = Posture(lutgen.load_recipe("recipe:paper_two"), np.radians([31.0, 12.0]))
    down = np.random.default_rng(3).normal(size=(50, 3)) * 0.4 + LEVEL
    down /= np.linalg.norm(down, axis=1, keepdims=True)
    ours = compare_metrics(posture, down)
    corners = posture.facets[0].points
    for name, channel in (("static_margin", "margin"), ("force_angle", "force_angle")):
        assert MARGINS[name](corners, down) == pytest.approx(ours.values[channel], rel=1e-6)
    stands = ours.standing
    assert stands.any()
    assert not stands.all()
    # Beyond the limit ours takes the least rise of the axes that are passed, theirs of all.
    energy = MARGINS["energy_margin"](corners, down)
    assert energy[stands] == pytest.approx(ours.values["energy_margin"][stands], rel=1e-6)
    for rule in MARGINS.values():
        assert np.array_equal(rule(corners, down) > 0.0, stands)
