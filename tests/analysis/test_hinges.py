"""Wheels on hinges in MuJoCo: they stay where the robot holds and go where it rolls."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Posture, holds, may_hold, roll_limits, tilted
from tests.fixtures.recipes import contact, rigid

TRICYCLE = [(0.6, 0.05), (-0.4, 0.45), (-0.35, -0.4)]
SIX = [(x, y) for x in (0.5, 0.0, -0.5) for y in (0.4, -0.4)]

pytestmark = pytest.mark.needs("mujoco")


def wheeled(places, rolling, friction):
    """Return a robot on wheels half a metre below its com."""
    text = ""
    for i, (x, y) in enumerate(places):
        text += contact(f"w{i}", (x, y, -0.4), 0.1, (0, 1, 0))
        text += "rolling = true\n" if i in rolling else ""
    return Posture(lutgen.parse_recipe(rigid(text, head=f"friction = {friction}")), [])


def moved(posture, places, heading, tilt):
    """Return how far MuJoCo's wheels go in a second after gravity has leant over slowly."""
    import mujoco

    friction, wheels = posture.recipe.friction, ""
    for one, (x, y) in zip(posture.recipe.contacts, places, strict=True):
        look = f'type="ellipsoid" size="0.1 0.02 0.1" friction="{friction} 0 0"'
        place = f'pos="{x} {y} -0.4"'
        if one.rolling:
            hinge = f'<joint type="hinge" axis="0 1 0" armature="1e-6"/><geom {look} mass="0.02"/>'
            wheels += f"<body {place}>{hinge}</body>"
        else:
            wheels += f'<geom {place} {look} mass="1e-6"/>'
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.001" integrator="implicitfast" solver="Newton" '
        'iterations="100" tolerance="1e-12" cone="elliptic" impratio="100"/>'
        '<default><geom solref="0.004 1" solimp=".99 .999 1e-4" condim="3"/></default><worldbody>'
        f'<geom type="plane" size="9 9 1" pos="0 0 -0.5" friction="{friction} 0 0"/><body>'
        '<freejoint/><inertial pos="0 0 0" mass="20" diaginertia="1 1.5 2"/>'
        f"{wheels}</body></worldbody></mujoco>"
    )
    state, start = mujoco.MjData(model), np.zeros(7)
    for step in range(2500):
        model.opt.gravity[:] = 9.81 * tilted(tilt * min(1.0, step / 1500), heading)
        mujoco.mj_step(model, state)
        if step == 1500:
            start = state.qpos[:7].copy()
    # A shift in m, and half of the quaternion's change: a robot that swings round moves too.
    return float(np.abs(state.qpos[:7] - start).max())


@pytest.mark.parametrize(("rolling", "heading"), [((0,), 35.0), ((2,), 215.0), ((0, 1), 0.0)])
def test_three_wheels_roll_away_from_the_same_tilt_on(rolling, heading):
    robot, ahead = wheeled(TRICYCLE, rolling, 0.8), math.radians(heading)
    limit = float(roll_limits(robot, [ahead])[0])
    assert math.radians(2.0) < limit < math.atan(0.8) - math.radians(1.0)
    below, beyond = (
        moved(robot, TRICYCLE, ahead, limit + math.radians(side)) for side in (-0.4, 0.4)
    )
    assert below < 0.002
    assert beyond > 0.01


@pytest.mark.parametrize("rolling", [(2, 3), (0, 1, 4, 5), (0, 1), (2, 3, 4, 5)])
def test_six_wheels_stay_where_they_hold_and_go_where_they_roll(rolling):
    robot, stayed = wheeled(SIX, rolling, 0.7), set()
    for slope in (0.1, 0.35, 0.5, 0.69):
        down, way = tilted(math.atan(slope), [0.0]), moved(robot, SIX, 0.0, math.atan(slope))
        # What springs give is microns, and what rolls or slips goes centimetres in a second; what
        # lies between creeps, and says nothing.
        assert way < 0.01 or not holds(robot, down).any()
        assert way > 0.002 or may_hold(robot, down).all()
        stayed |= {True} if way < 0.002 else {False} if way > 0.01 else set()
    assert stayed == {True, False}
