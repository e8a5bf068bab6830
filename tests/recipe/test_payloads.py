"""Payloads, forces and an uncertain com in a recipe: what they mean, and what is refused."""

import numpy as np
import pytest

import lutgen
from lutgen.search.objective import Objective
from tests.fixtures.pulled import BOX, LEVEL, robot
from tests.fixtures.recipes import feet, rigid

FORCE = "force = [1, 0, 0]"


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


@pytest.mark.parametrize(("kind", "value"), [("payload", "mass = 1.0"), ("force", FORCE)])
def test_a_robot_without_masses_carries_nothing(kind: str, value: str) -> None:
    entry = f'[[robot.{kind}]]\nname = "x"\nlink = "body"\nposition = [0, 0, 0]\n{value}\n'
    with pytest.raises(lutgen.RecipeError, match=rf"{kind}\[1\]\..*give its links masses"):
        lutgen.parse_recipe(rigid(feet(BOX) + entry))


def test_an_energy_margin_under_a_load_is_refused() -> None:
    with pytest.raises(lutgen.InputError, match="energy_margin is not defined"):
        Objective(robot(feet(BOX), rho=0.1), LEVEL, "energy_margin")
