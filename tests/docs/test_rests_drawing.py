"""The drawing of rests, stages and gaps: the file is the script's, and what it shows is so."""

import math

import numpy as np
import pytest

import lutgen
from tests.fixtures.recipes import contact, rigid
from tools.rests_drawing import ROBOTS, TARGET, Drawn, balance, drawing, height, normals

STANDS, ROCKS, TIPS = 0.0, 1.0, 2.0


def status(robot: Drawn, pitches: list[float]) -> list[float]:
    """Return what lutgen says of a drawn robot, with wheels on both sides, at pitches (rad)."""
    wheels = "".join(
        contact(f"{side}_{k}", (x, y, z), robot.radius, (0, 1, 0))
        for k, (x, z) in enumerate(robot.wheels)
        for side, y in (("left", 0.3), ("right", -0.3))
    )
    # The stage that is drawn is 8 cm long.
    recipe = lutgen.parse_recipe(rigid(wheels, head="rest_width = 0.1"))
    angle = np.array(pitches)
    down = np.stack([np.sin(angle), 0.0 * angle, -np.cos(angle)], axis=1)
    return lutgen.evaluate(recipe, np.empty((1, 0)), down, ["status"])["status"][0].tolist()


def test_the_file_is_what_the_script_draws() -> None:
    assert TARGET.read_text(encoding="utf-8") == drawing()


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.title)
def test_each_robot_is_what_its_picture_shows(robot: Drawn) -> None:
    ahead, behind = normals(robot)[0], normals(robot)[-1]
    beyond = max(math.atan2(x, -z) for x, z in robot.wheels) + math.radians(2.0)
    found = status(robot, [-beyond, behind, 0.0, ahead, beyond])
    assert found == [TIPS, STANDS, ROCKS if robot.caught else TIPS, STANDS, TIPS]


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.title)
def test_what_is_caught_is_what_lacks_the_energy_for_the_end(robot: Drawn) -> None:
    end = max(math.atan2(x, -z) for x, z in robot.wheels)
    assert (height(robot, end) > balance(robot)) is robot.caught
    # The turn alone would let each of them rock, and the picture would show nothing.
    assert math.degrees(normals(robot)[0] - normals(robot)[-1]) < 30.0
