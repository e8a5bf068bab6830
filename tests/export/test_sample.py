"""Where exports are measured: the whole box and chart, and where tables err most."""

import numpy as np
import pytest

import lutgen
from firmware_export.truth.crossing import unit
from firmware_export.truth.model import Model
from firmware_export.truth.sample import biased, on_chart, uniform
from tests.fixtures.recipes import feet, rigid, rover, tripod

BALL = ("upright = 90.0", "upright = 90.0\ncom_uncertainty = 0.01")
MODELS = {
    "three points on a cone": Model(lutgen.parse_recipe(tripod())),
    "three points on the sphere": Model(
        lutgen.parse_recipe(tripod("reach = 3, swing = 2", chart="sphere", nodes=6))
    ),
    "wheels": Model(lutgen.parse_recipe(rover())),
    "wheels under a ball of coms": Model(lutgen.parse_recipe(rover().replace(*BALL, 1))),
    "rigid": Model(lutgen.parse_recipe(rigid(feet([(1, 0, -1), (-1, 1, -1), (-1, -1, -1)])))),
}
each_model = pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
CONE, SPHERE, WHEELS = list(MODELS.values())[:3]


def in_box(model, sample):
    return bool(((sample.params >= model.lower) & (sample.params <= model.upper)).all())


def normalised(model, sample):
    """Return the postures over the box, 0 to 1."""
    return np.asarray((sample.params - model.lower) / (model.upper - model.lower))


@each_model
@pytest.mark.parametrize("draw", [uniform, biased])
def test_points_lie_in_the_box_and_on_the_chart(model, draw):
    sample = draw(model, 3000, 7)
    assert sample.points >= 3000
    assert in_box(model, sample)
    assert on_chart(model, sample.gravity).all()
    length = np.linalg.norm(sample.gravity, axis=-1)
    np.testing.assert_allclose(length, 1.0, rtol=1e-15 * 4)  # a few roundings


@pytest.mark.parametrize("model", [CONE, SPHERE], ids=["cone", "sphere"])
def test_directions_are_uniform_in_solid_angle(model):
    sample = uniform(model, 200_000, 3)
    chart = model.recipe.chart
    face, u, v, _ = chart.locate(sample.gravity.reshape(-1, 3))
    bins = np.linspace(-chart.limit, chart.limit, 9)
    corner = np.arctan(
        bins[:, None] * bins / np.sqrt(1.0 + bins[:, None] ** 2 + bins**2)
    )  # solid angle of a rectangle from the middle of the face
    angle = np.diff(np.diff(corner, axis=0), axis=1)
    expected = angle / angle.sum() * sample.points / model.faces
    for number in range(model.faces):
        here = face == number
        count = np.histogram2d(u[here], v[here], (bins, bins))[0]
        chi = ((count - expected) ** 2 / expected).sum()
        # 64 cells: mean 63, standard deviation 11; a wrong density gives thousands.
        assert chi < 63.0 + 5.0 * 11.3


def test_many_biased_postures_are_on_faces_and_corners_of_the_box():
    t = normalised(CONE, biased(CONE, 8000, 5))
    at_end = (t == 0.0) | (t == 1.0)
    assert at_end.any(axis=1).mean() > 0.3
    assert at_end.all(axis=1).mean() > 0.1
    corners = {tuple(row) for row in t[at_end.all(axis=1)].tolist()}
    assert corners == {(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)}


@each_model
def test_many_biased_directions_are_close_to_the_tip_over_boundary_on_both_sides(model):
    sample = biased(model, 4000, 5)
    tip = model.exact(*sample).tip_angle
    near = np.abs(tip) < 1e-3
    assert near.mean() > 0.2
    assert 0.3 < (tip[near] < 0.0).mean() < 0.7
    assert (np.abs(tip) < 1e-6).mean() > 0.02


def test_cells_of_a_table_are_met_in_their_middles():
    knots = np.array([0.0, 0.3, 1.0])
    cells = (knots, np.array([0.0, 0.5, 1.0]))
    t = normalised(CONE, biased(CONE, 4000, 5, cells))
    for column, middles in enumerate([(0.15, 0.65), (0.25, 0.75)]):
        for middle in middles:
            # Half of the postures, two thirds of them in one of two middles.
            assert np.isclose(t[:, column], middle).mean() > 0.1


def test_the_chart_holds_its_rim_and_nothing_beyond():
    limit = CONE.chart_limit
    rim = CONE.uv_to_gravity(0, [limit, -limit, 0.0], [0.0, limit, limit])
    assert on_chart(CONE, unit(rim)).all()
    beyond = CONE.uv_to_gravity(0, [limit * 1.0001, 0.0], [0.0, -limit * 1.0001])
    assert not on_chart(CONE, beyond).any()
    assert not on_chart(CONE, np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])).any()
    assert on_chart(SPHERE, np.array([[0.0, 0.0, 1.0]])).all()
