"""The paper's robot, reconstructed: the paper prints angles and results, but no coordinates.

Three wheels at the same distance R from the centre of mass, 120 deg apart in azimuth, each at an
elevation below the body's xy plane.  At the nominal elevation atan(3/5) = 30.9638 deg, which the
paper rounds to 30.964, the circumradius is 20 and the height 12, so that the nearest edge is 10
away: "in case of |SD_g| > 10 the robot tips over".
"""

import math
from collections.abc import Sequence

import numpy as np

from lutgen.recipe import Recipe, parse_recipe

__all__ = ["NOMINAL", "NOMINAL_DEG", "RADIUS", "paper_recipe"]

NOMINAL = math.atan(3.0 / 5.0)
NOMINAL_DEG = math.degrees(NOMINAL)
RADIUS = math.hypot(20.0, 12.0)
PARAMETERS = ("alpha", "gamma")
# The azimuths of P1, P2, P3 that simulations 1 and 2 do not depend on, in deg.
AHEAD = (0.0, 120.0, 240.0)

HEAD = """[robot]
name = "{name}"
length_unit = "1"
"""
PARAMETER = """
[[robot.parameter]]
name = "{name}"
min = 0.0
max = 50.0
unit = "deg"
"""
MOVING = """
[[robot.link]]
name = "leg{wheel}"
parent = "body"
rpy = [0, 0, {azimuth!r}]
joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{name}" }}
"""
FIXED = """
[[robot.link]]
name = "leg{wheel}"
parent = "body"
rpy = [0, {elevation!r}, {azimuth!r}]
"""
WHEEL = """
[[robot.contact]]
name = "P{wheel}"
link = "leg{wheel}"
position = [{radius!r}, 0, 0]
"""
SWEEP = """
[sweep]
samples = {{ {samples} }}
[sweep.gravity]
chart = "cone"
max_tilt = 45.0
nodes = 1
channels = ["sdg", "height", "tip_angle"]
"""


def paper_recipe(
    moving: int = 2,
    azimuths: Sequence[float] = AHEAD,
    radius: float = RADIUS,
    knots: Sequence[float] = tuple(np.arange(50.0)),
) -> Recipe:
    """Return the robot of simulation 1 (`moving` = 1: P1 alone) or 2 (P1 and P2).

    Parameters
    ----------
    moving : int
        How many of the wheels have a parameter: alpha, gamma.
    azimuths : sequence of float
        Of the three wheels, deg from the body's x axis.
    radius : float
        Distance of the wheels from the centre of mass; every |SD_g| is proportional to it.
    knots : sequence of float
        Nodes of each parameter's map, deg.  The paper's 50 x 50 map must have a node at 31 deg,
        so its step is 1 deg.

    Returns
    -------
    Recipe
        Its map holds one gravity direction, straight down.
    """
    names = PARAMETERS[:moving]
    text = HEAD.format(name=f"paper_{('one', 'two')[moving - 1]}")
    text += "".join(PARAMETER.format(name=name) for name in names)
    for i, azimuth in enumerate(azimuths):
        if i < moving:
            text += MOVING.format(wheel=i + 1, azimuth=float(azimuth), name=names[i])
        else:
            text += FIXED.format(wheel=i + 1, azimuth=float(azimuth), elevation=NOMINAL_DEG)
    text += "".join(WHEEL.format(wheel=i + 1, radius=float(radius)) for i in range(len(azimuths)))
    listed = [float(knot) for knot in knots]
    text += SWEEP.format(samples=", ".join(f"{name} = {listed}" for name in names))
    return parse_recipe(text, "the paper's robot")
