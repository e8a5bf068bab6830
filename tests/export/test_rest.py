"""Whether the facet of three contacts is a rest in every posture, and their series over the box."""

import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from firmware_export.truth import widened
from firmware_export.truth.model import Model
from firmware_export.truth.rest import evaluate, expand, least_edge_of
from lutgen.recipe.recipe import parse_recipe
from tests.fixtures.recipes import contact, feet, rigid, rover, tripod

LEGS = "".join(
    f"""
[[robot.parameter]]
name = "{name}"
min = {low}
max = {high}
unit = "deg"
[[robot.link]]
name = "leg{i}"
rpy = [0, 0, {120 * i}]
parent = "body"
joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{name}" }}
"""
    + contact(f"P{i}", (2.0, 0.0, -0.5), link=f"leg{i}")
    for i, (name, low, high) in enumerate([("a", -5.0, 60.0), ("b", 0.0, 70.0), ("c", 10.0, 30.0)])
)
SAMPLES = "a = 2, b = 2, c = 2"
PAPER_TWO = Path("maps/paper_two.toml").read_text()
ROBOTS = {
    "paper_two": PAPER_TWO,
    "masses, a length and an angle": tripod(),
    "three legs, every direction": rigid(LEGS, samples=SAMPLES, chart="sphere"),
    "no parameters": rigid(feet([(1, 0, -1), (-0.5, 0.8, -1.2), (-0.5, -0.9, -1)])),
}


def model(text):
    return Model(parse_recipe(text, "test.toml"))


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
def test_series_are_the_contacts_anywhere_in_the_box(text):
    robot = model(text)
    series = expand(robot)
    assert series is not None
    t = np.random.default_rng(3).random((500, robot.k))
    exact = robot.postures(robot.lower + t * (robot.upper - robot.lower)).centres
    got = np.stack([evaluate(one, 2.0 * t - 1.0) for one in series], 1)
    order = [int(np.abs(exact - got[:, i, None]).sum((0, 2)).argmin()) for i in range(3)]
    assert sorted(order) == [0, 1, 2]
    # Series are cut off at 1e-13 of the robot's size and have some dozen terms.
    np.testing.assert_allclose(got, exact[:, order], rtol=0.0, atol=1e-11 * np.abs(exact).max())
    assert np.all(np.linalg.det(got) > 0.0)


@pytest.mark.parametrize("text", ROBOTS.values(), ids=ROBOTS)
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
        # The body leans by up to 60 deg when the legs of one side are drawn in.
        rigid(LEGS, head="upright = 20.0", samples=SAMPLES),
        # At -40 deg the foot is above the com, and so is the plane through the other feet.
        rigid(LEGS.replace("min = 0.0", "min = -80.0"), samples=SAMPLES),
    ],
    ids=["wheels", "four", "leans", "above"],
)
def test_a_facet_that_is_no_rest_everywhere_has_no_bound(text):
    assert least_edge_of(model(text)) == 0.0


def test_a_facet_that_is_refused_in_a_corner_of_the_box_only_is_found():
    # paper_two's facet leans most, 26 deg, where one leg is level and the other fully down.
    # The box, and as far beyond its ends as a sensor's slack goes.
    wider = widened(model(PAPER_TWO))
    ends = [(one.minimum, one.maximum) for one in wider.recipe.parameters]
    where = wider.postures(np.array(list(itertools.product(*ends)))).centres
    normal = np.cross(where[:, 1] - where[:, 0], where[:, 2] - where[:, 0])
    lean = math.degrees(np.arccos(normal[:, 2] / np.linalg.norm(normal, axis=1)).max())
    for beyond, holds in ((0.1, True), (-0.1, False)):
        head = PAPER_TWO.replace("upright = 80.0", f"upright = {lean + beyond!r}")
        assert (least_edge_of(model(head)) > 0.0) == holds
