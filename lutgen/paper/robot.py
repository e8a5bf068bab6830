"""The recipe of the paper's robot: three wheels, of which one or two have a parameter."""

from collections.abc import Sequence

import numpy as np

from lutgen.paper.nominal import AHEAD, NOMINAL_DEG, RADIUS
from lutgen.recipe import Recipe, parse_recipe

__all__ = ["paper_recipe"]

PARAMETERS = ("alpha", "gamma")
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
WHEEL = """
[[robot.link]]
name = "leg{wheel}"
parent = "body"
rpy = [0, {elevation!r}, {azimuth!r}]
{joint}
[[robot.contact]]
name = "P{wheel}"
link = "leg{wheel}"
position = [{radius!r}, 0, 0]
"""
JOINT = 'joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{name}" }}\n'
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
    knots: Sequence[float] = tuple(np.arange(50.0)),
) -> Recipe:
    """Return the robot of simulation 1 (`moving` = 1: P1 alone) or 2 (P1 and P2).

    Parameters
    ----------
    moving : int
        How many of the wheels have a parameter: alpha, gamma.
    azimuths : sequence of float
        Of the three wheels, deg from the body's x axis.
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
        text += WHEEL.format(
            wheel=i + 1,
            elevation=0.0 if i < moving else NOMINAL_DEG,
            azimuth=float(azimuth),
            joint=JOINT.format(name=names[i]) if i < moving else "",
            radius=RADIUS,
        )
    listed = [float(knot) for knot in knots]
    text += SWEEP.format(samples=", ".join(f"{name} = {listed}" for name in names))
    return parse_recipe(text, "the paper's robot")
