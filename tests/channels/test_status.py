"""The channel `status`: whether the robot stands, rocks between rests, or tips over."""

import numpy as np

import lutgen
from tests.fixtures.recipes import feet, rigid, rocker

STANDS, ROCKS, TIPS = 0.0, 1.0, 2.0
BOX = ((1.0, 0.5, -1.0), (-1.0, 0.5, -1.0), (-1.0, -0.5, -1.0), (1.0, -0.5, -1.0))


def pitched(*degrees):
    """Return directions of gravity for a nose that is down by so many degrees."""
    angle = np.radians(degrees)
    return np.stack([np.sin(angle), 0.0 * angle, -np.cos(angle)], axis=1)


def status(text, directions):
    """Return the status of a robot without parameters."""
    recipe = lutgen.parse_recipe(text)
    return lutgen.evaluate(recipe, np.empty((1, 0)), directions, ["status"])["status"][0].tolist()


def test_a_robot_on_six_wheels_of_which_the_middle_ones_are_lower_rocks_on_those():
    # The com is 0.45 above the rims of the middle wheels, which it rolls along by
    # 0.1 sin(5.7 deg) = 0.00995 either way: by 1.27 deg.
    assert status(rocker(), pitched(-60, -20, -1.4, -1.2, 0, 1.2, 1.4, 20, 60)) == [
        *(TIPS, STANDS, STANDS, ROCKS, ROCKS, ROCKS, STANDS, STANDS, TIPS)
    ]


def test_where_rocking_is_forbidden_it_tips_instead():
    forbidden = rocker(head="rock_angle = 0.0")
    assert status(forbidden, pitched(-20, 0, 20)) == [STANDS, TIPS, STANDS]


def test_where_the_middle_wheels_are_level_with_the_others_nothing_rocks():
    assert status(rocker(middle=0.0), pitched(-20, 0, 20, 70)) == [STANDS, STANDS, STANDS, TIPS]


def test_a_force_moves_where_it_rocks():
    # Pushed forward by a tenth of its weight it rocks where without the push it stands.
    push = 'name = "push"\nlink = "body"\nposition = [0, 0, 0]\nforce = [9.80665, 0, 0]\n'
    head = f'[[robot.link]]\nname = "body"\nmass = 10.0\n[[robot.force]]\n{push}'
    nose_up = float(np.degrees(np.arcsin(-0.1)))
    assert status(rocker(), pitched(0.0, nose_up)) == [ROCKS, STANDS]
    assert status(rocker(head=head), pitched(0.0, nose_up)) == [STANDS, ROCKS]


def test_a_com_that_may_be_beyond_the_edge_tips():
    near = pitched(float(np.degrees(np.arctan(0.99))))
    assert status(rigid(feet(BOX)), near) == [STANDS]
    assert status(rigid(feet(BOX), head="com_uncertainty = 0.02"), near) == [TIPS]
