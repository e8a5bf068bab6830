"""The paper's robot, reconstructed, and what the paper prints of it.

The paper prints angles and results, but no coordinates.  Three wheels stand at the same distance
from the com, 120 deg apart in azimuth, each at an elevation below the body's xy plane.  At the
nominal elevation, atan(3/5) = 30.9638 deg, which the paper rounds to 30.964, the circumradius is
20 and the height 12, so that the nearest edge is 10 away: "in case of |SD_g| > 10 the robot tips
over".
"""

import math
import re
from dataclasses import dataclass

import numpy as np

from lutgen.recipe import Recipe, gallery_text, parse_recipe

CIRCUMRADIUS, HEIGHT = 20.0, 12.0
NOMINAL = math.atan(HEIGHT / CIRCUMRADIUS)
# The distance R of the wheels from the com; every |SD_g| is proportional to it.
RADIUS = math.hypot(CIRCUMRADIUS, HEIGHT)
DOWN = np.array([0.0, 0.0, -1.0])
# The robot is turned on its path by so much, deg: P1 points ahead to the left, P2 back to the left,
# the fixed P3 to the right.  On level ground nothing depends on it.
TURN = 30.0
# The paper's robot tips at so many of the 100 points of its path.
UNCONTROLLED, CONTROLLED = 72, 22
# Nodes of each parameter's map, deg: the paper's 50 x 50 map must have a node at 31.
KNOTS = [float(knot) for knot in range(50)]


def paper_recipe(name: str = "paper_two") -> Recipe:
    """Return the gallery's robot of simulation 1 (``"paper_one"``: P1 moves) or 2 (P1 and P2).

    Its map holds one gravity direction, straight down.
    """
    # The page says what its figures show, so they need no titles.
    text = re.sub(r"(?m)^(title|meaning) = .*\n", "", gallery_text(name))
    text = re.sub(r"(alpha|gamma) = \d+", rf"\1 = {KNOTS}", text)
    return parse_recipe(re.sub(r"\bnodes = \d+", "nodes = 1", text), "the paper's robot")


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
