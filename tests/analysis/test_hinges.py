"""Wheels on hinges in MuJoCo: they stay where the robot holds and go where it rolls."""

import math

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")

from lutgen.analysis import Posture, holds, may_hold, roll_limits, tilted
from proofs.physics import holding

TRICYCLE = [(0.6, 0.05), (-0.4, 0.45), (-0.35, -0.4)]
SIX = [(x, y) for x in (0.5, 0.0, -0.5) for y in (0.4, -0.4)]


def wheeled(places, rolling, friction):
    """Return a robot on wheels half a metre below its com, for the engine and for lutgen."""
    robot = holding.standing(places, [i not in rolling for i in range(len(places))], 0.5)
    return robot, Posture(robot.recipe(f"friction = {friction}"), np.zeros(0))


@pytest.mark.parametrize(("rolling", "heading"), [((0,), 35.0), ((2,), 215.0), ((0, 1), 0.0)])
def test_three_wheels_roll_away_from_the_same_tilt_on(rolling, heading):
    robot, posture = wheeled(TRICYCLE, rolling, 0.8)
    ahead = math.radians(heading)
    limit = float(roll_limits(posture, [ahead])[0])
    assert math.radians(2.0) < limit < math.atan(0.8) - math.radians(1.0)
    for side in (-0.5, 0.5):
        down = tilted(limit + math.radians(side), ahead)
        assert holding.moves(robot, down, 0.8) is (side > 0.0)


@pytest.mark.parametrize("rolling", [(2, 3), (0, 1, 4, 5), (0, 1), (2, 3, 4, 5)])
def test_six_wheels_stay_where_they_hold_and_go_where_they_roll(rolling):
    (robot, posture), moved = wheeled(SIX, rolling, 0.7), set()
    for slope in (0.1, 0.35, 0.5, 0.68):
        down = tilted(math.atan(slope), 0.0)
        goes = holding.moves(robot, down, 0.7)
        assert not (goes and holds(posture, down[None]).any())
        assert goes or may_hold(posture, down[None]).all()
        moved.add(goes)
    assert moved == {True, False}
