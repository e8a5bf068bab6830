"""The paper's robot, reconstructed, and what the paper prints of it.

The paper prints angles and results, but no coordinates.  Three wheels stand at the same distance
from the com, 120 deg apart in azimuth, each at an elevation below the body's xy plane.  At the
nominal elevation, atan(3/5) = 30.9638 deg, which the paper rounds to 30.964, the circumradius is
20 and the height 12, so that the nearest edge is 10 away: "in case of |SD_g| > 10 the robot tips
over".
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lutgen.recipe import Recipe, parse_recipe

Floats = NDArray[np.float64]

CIRCUMRADIUS, HEIGHT = 20.0, 12.0
NOMINAL = math.atan(HEIGHT / CIRCUMRADIUS)
# The distance R of the wheels from the com; every |SD_g| is proportional to it.
RADIUS = math.hypot(CIRCUMRADIUS, HEIGHT)
# The azimuths (deg) of P1, P2 and P3: on level ground nothing depends on them; on the path P1
# points ahead to the left, P2 back to the left, the fixed P3 to the right, and travel is along x.
AHEAD = (0.0, 120.0, 240.0)
TO_THE_LEFT = (30.0, 150.0, 270.0)
DOWN = np.array([0.0, 0.0, -1.0])
# The paper's robot tips at so many of the 100 points of its path.
UNCONTROLLED, CONTROLLED = 72, 22

PARAMETER = '[[robot.parameter]]\nname = "{}"\nmin = 0.0\nmax = 50.0\nunit = "deg"\n'
LEG = """
[[robot.link]]
name = "leg{number}"
parent = "body"
rpy = [0, {elevation!r}, {azimuth!r}]
{joint}

[[robot.contact]]
name = "P{number}"
link = "leg{number}"
position = [{radius!r}, 0, 0]
"""
JOINT = 'joint = {{ type = "revolute", axis = [0, 1, 0], parameter = "{}" }}'
SWEEP = """
[sweep]
samples = {{ {samples} }}

[sweep.gravity]
chart = "cone"
max_tilt = 45.0
nodes = 1
channels = ["sdg", "height", "tip_angle"]
"""
# Nodes of each parameter's map, deg: the paper's 50 x 50 map must have a node at 31.
KNOTS = [float(knot) for knot in range(50)]


def paper_recipe(moving: int = 2, azimuths: Sequence[float] = AHEAD) -> Recipe:
    """Return the robot of simulation 1 (`moving` = 1: P1 alone) or 2 (P1 and P2).

    Azimuths of the wheels in deg from the body's x axis.  The map holds one gravity direction,
    straight down.
    """
    names = ("alpha", "gamma")[:moving]
    parts = [f'[robot]\nname = "paper_{("one", "two")[moving - 1]}"\nlength_unit = "1"\n']
    parts += [PARAMETER.format(name) for name in names]
    for number, azimuth in enumerate(azimuths, 1):
        moves = number <= moving
        joint = JOINT.format(names[number - 1]) if moves else ""
        elevation = 0.0 if moves else math.degrees(NOMINAL)
        parts.append(
            LEG.format(
                number=number,
                elevation=elevation,
                azimuth=float(azimuth),
                joint=joint,
                radius=RADIUS,
            )
        )
    parts.append(SWEEP.format(samples=", ".join(f"{name} = {KNOTS}" for name in names)))
    return parse_recipe("\n".join(parts), "the paper's robot")


def nominal_wheels() -> Floats:
    """Return the contacts of the nominal shape, (3, 3), wheel 1 ahead."""
    azimuth = np.radians(AHEAD)
    below = np.full(3, -HEIGHT)
    return np.column_stack([CIRCUMRADIUS * np.cos(azimuth), CIRCUMRADIUS * np.sin(azimuth), below])


@dataclass(frozen=True)
class Entry:
    """One column of Table 1: angles in deg, |SD_g| in the paper's ratios.

    `read_as` is |SD_g| as we take it to be meant, where the print contradicts itself.
    """

    method: str
    evaluations: int
    alpha: float
    gamma: float
    sdg: float
    read_as: float

    @property
    def searching(self) -> bool:
        """True if the entry is one of the searching algorithm."""
        return self.method.startswith("searching")


TABLE = (
    Entry("stability map", 2500, 31.0, 31.0, 0.0022, 0.0022),
    Entry("fminsearch", 49, 30.9628, 30.9605, 0.00009092, 0.00009092),
    Entry("searching algorithm, step 1", 25, 30.0, 30.0, 0.0821, 0.0521),
    Entry("searching algorithm, step 2", 50, 32.0, 32.0, 0.0566, 0.0566),
    Entry("searching algorithm, step 3", 75, 31.2, 31.2, 0.0131, 0.0131),
    Entry("searching algorithm, step 6", 150, 30.9568, 30.9568, 0.00037889, 0.00037889),
)
