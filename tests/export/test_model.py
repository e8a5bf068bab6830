"""Where exports are measured, and whether the facet of three contacts is a rest everywhere."""

import itertools
import math

import numpy as np
import pytest

import lutgen
from firmware_export.model import Model, biased, least_edge_of, on_chart, uniform, widened
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import contact, feet, rigid, rover, tripod


def model(text):
    return Model(lutgen.parse_recipe(text, "test.toml"))


BALL = ("upright = 90.0", "upright = 90.0\ncom_uncertainty = 0.01")
RIGID = rigid(feet([(1, 0, -1), (-0.5, 0.8, -1.2), (-0.5, -0.9, -1)]))
MODELS = {
    "three points on a cone": model(tripod()),
    "three points on the sphere": model(tripod("reach = 3, swing = 2", chart="sphere", nodes=6)),
    "wheels under a ball of coms": model(rover().replace(*BALL, 1)),
    "rigid": model(RIGID),
}
CONE, SPHERE = list(MODELS.values())[:2]


def normalised(one, sample):
    return np.asarray((sample.params - one.lower) / (one.upper - one.lower))


@pytest.mark.parametrize("name", MODELS)
def test_points_lie_in_the_box_and_on_the_chart_many_of_them_where_it_all_but_tips(name):
    one = MODELS[name]
    for draw in (uniform, biased):
        sample = draw(one, 4000, 5)
        assert sample.points >= 4000
        assert ((sample.params >= one.lower) & (sample.params <= one.upper)).all()
        assert on_chart(one, sample.gravity).all()
        length = np.linalg.norm(sample.gravity, axis=-1)
        np.testing.assert_allclose(length, 1.0, rtol=1e-15 * 4)  # a few roundings
    tip = one.exact(*sample).tip_angle
    near = np.abs(tip) < 1e-3
    assert near.mean() > 0.2
    assert 0.3 < (tip[near] < 0.0).mean() < 0.7
    assert (np.abs(tip) < 1e-6).mean() > 0.02


@pytest.mark.parametrize("one", [CONE, SPHERE], ids=["cone", "sphere"])
def test_directions_are_uniform_in_solid_angle(one):
    sample = uniform(one, 200_000, 3)
    chart = one.recipe.chart
    face, u, v, _ = chart.locate(sample.gravity.reshape(-1, 3))
    bins = np.linspace(-chart.limit, chart.limit, 9)
    # The solid angle of a rectangle from the middle of the face.
    corner = np.arctan(bins[:, None] * bins / np.sqrt(1.0 + bins[:, None] ** 2 + bins**2))
    angle = np.diff(np.diff(corner, axis=0), axis=1)
    expected = angle / angle.sum() * sample.points / one.faces
    for number in range(one.faces):
        here = face == number
        count = np.histogram2d(u[here], v[here], (bins, bins))[0]
        chi = ((count - expected) ** 2 / expected).sum()
        # 64 cells: mean 63, standard deviation 11; a wrong density gives thousands.
        assert chi < 63.0 + 5.0 * 11.3


def test_many_postures_are_at_ends_of_the_box_and_in_the_middles_of_cells():
    t = normalised(CONE, biased(CONE, 8000, 5))
    at_end = (t == 0.0) | (t == 1.0)
    assert at_end.any(axis=1).mean() > 0.3
    assert at_end.all(axis=1).mean() > 0.1
    corners = {tuple(row) for row in t[at_end.all(axis=1)].tolist()}
    assert corners == {(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)}
    cells = (np.array([0.0, 0.3, 1.0]), np.array([0.0, 0.5, 1.0]))
    t = normalised(CONE, biased(CONE, 4000, 5, cells))
    for column, middles in enumerate([(0.15, 0.65), (0.25, 0.75)]):
        for middle in middles:
            # Half of the postures, two thirds of them in one of two middles.
            assert np.isclose(t[:, column], middle).mean() > 0.1


PAPER_TWO, SPREAD = (
    (MAPS / f"{name}.toml").read_text() for name in ("paper_two", "three_leg_sphere")
)


@pytest.mark.parametrize("text", [PAPER_TWO, SPREAD, tripod(), RIGID])
def test_no_edge_is_shorter_than_the_bound_and_the_shortest_hardly_longer(text):
    robot = widened(model(text))
    p = robot.postures(robot.at(np.random.default_rng(5).random((20_000, robot.k)))).centres
    lengths = np.linalg.norm(np.cross(p, np.roll(p, -1, axis=1)), axis=2)
    least = least_edge_of(model(text))
    assert 0.0 < least <= lengths.min()
    assert least > 0.8 * lengths.min()


@pytest.mark.parametrize(
    "text",
    [
        rover(),
        tripod(contacts=contact("rear", (-1, 0, -1))),
        # Feet that are lifted are above the com.
        SPREAD.replace("min = 20.0", "min = -80.0"),
    ],
    ids=["wheels", "four", "above"],
)
def test_a_facet_that_is_no_rest_everywhere_has_no_bound(text):
    assert least_edge_of(model(text)) == 0.0


def test_a_facet_that_is_refused_in_a_corner_of_the_box_only_is_found():
    # paper_two's facet leans most, 26 deg, where one leg is level and the other fully down.
    # The box, and as far beyond its ends as a sensor's tolerance goes.
    wider = widened(model(PAPER_TWO))
    ends = [(one.minimum, one.maximum) for one in wider.recipe.parameters]
    where = wider.postures(np.array(list(itertools.product(*ends)))).centres
    normal = np.cross(where[:, 1] - where[:, 0], where[:, 2] - where[:, 0])
    lean = math.degrees(np.arccos(normal[:, 2] / np.linalg.norm(normal, axis=1)).max())
    for beyond, holds in ((0.1, True), (-0.1, False)):
        head = PAPER_TWO.replace("upright = 80.0", f"upright = {lean + beyond!r}")
        assert (least_edge_of(model(head)) > 0.0) == holds
