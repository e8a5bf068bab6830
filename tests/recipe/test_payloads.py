"""Payloads, forces and an uncertain com in a recipe: what they mean, and what is refused."""

import numpy as np
import pytest
from numpy.typing import NDArray

import lutgen
from lutgen.search.objective import Objective
from tests.fixtures.pulled import BOX, LEVEL, robot
from tests.fixtures.recipes import feet, rigid

Floats = NDArray[np.float64]


def test_a_payload_moves_the_com_as_a_link_of_its_mass_does() -> None:
    recipe = lutgen.parse_recipe(
        rigid(
            feet(BOX)
            + '[[robot.link]]\nname = "body"\nmass = 6.0\n'
            + '[[robot.payload]]\nname = "tool"\nlink = "body"\n'
            + "position = [0.4, 0, 0.2]\nmass = 2.0\n"
        )
    )
    assert lutgen.postures(recipe, np.zeros((1, 0)))[1][0] == pytest.approx([0.1, 0.0, 0.05])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mass = 0.0", "must be above 0"),
        ("mass = -1.0", "must be above 0"),
        ('mass = 1.0\nlinks = "body"', "is not a known key"),
    ],
)
def test_a_payload_that_makes_no_sense_is_refused(text: str, words: str) -> None:
    payload = f'[[robot.payload]]\nname = "tool"\nlink = "body"\nposition = [0, 0, 0]\n{text}\n'
    with pytest.raises(lutgen.RecipeError, match=words):
        robot(feet(BOX), payload)


@pytest.mark.parametrize("kind", ["payload", "force"])
def test_a_robot_without_masses_carries_nothing(kind: str) -> None:
    value = "mass = 1.0" if kind == "payload" else "force = [1, 0, 0]"
    entry = f'[[robot.{kind}]]\nname = "x"\nlink = "body"\nposition = [0, 0, 0]\n{value}\n'
    with pytest.raises(lutgen.RecipeError, match="give its links masses"):
        lutgen.parse_recipe(rigid(feet(BOX) + entry))
    with pytest.raises(lutgen.RecipeError, match="is not a link of the robot"):
        robot(feet(BOX), entry.replace('"body"', '"trunk"'))
    with pytest.raises(lutgen.RecipeError, match="is given twice"):
        robot(feet(BOX), entry + entry)


def test_a_negative_uncertainty_and_an_energy_margin_under_a_load_are_refused() -> None:
    with pytest.raises(lutgen.RecipeError, match="com_uncertainty"):
        robot(feet(BOX), head="com_uncertainty = -0.1")
    text = rigid(feet(BOX), head="com_uncertainty = 0.1", channels=("tip_angle", "energy_margin"))
    with pytest.raises(lutgen.RecipeError, match="energy_margin is not defined"):
        lutgen.parse_recipe(text)
    with pytest.raises(lutgen.InputError, match="energy_margin is not defined"):
        Objective(robot(feet(BOX), rho=0.1), LEVEL, "energy_margin")
