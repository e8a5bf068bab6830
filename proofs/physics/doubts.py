"""Directions in which noise makes a robot safe, let go in the engine.

Owns the last word on them.  Where a roll branches, the robot without noise may be called tipping
for the sake of certainty, and the same with noise not: that is a fault only if it falls.
"""

import math
from dataclasses import replace

import numpy as np

from lutgen.support import DISC, kind_at, radius_at
from lutgen.vector import Floats
from proofs.physics.asked import ROCK, UPRIGHT
from proofs.physics.body import rigid_body
from proofs.physics.nudged import fates
from proofs.physics.pierced import pierced


def let_go(robot: Floats, gravity_dir: Floats) -> tuple[int, int]:
    """Return how many directions the engine was asked about, and in how many the robot fell.

    `robot` (n, 8) are its primitives without noise, `gravity_dir` (d, 3) directions.

    Raises
    ------
    ValueError
        If the robot is not on discs alone, or gravity leaves it between no contacts.
    """
    wheels = range(len(robot))
    if any(kind_at(robot, i) != DISC for i in wheels):
        raise ValueError("a robot in doubt is not on wheels; give it solids in proofs.physics.body")
    radii = np.array([radius_at(robot, i) for i in wheels])
    posture = rigid_body(robot[:, :3], radii, robot[:, 3:6])
    posture = replace(posture, upright=math.radians(UPRIGHT), rock_angle=math.radians(ROCK))
    fell = 0
    for down, place in zip(gravity_dir, pierced(posture, gravity_dir), strict=True):
        if place is None:
            raise ValueError(f"gravity {down.tolist()} leaves a robot in doubt between no contacts")
        fell += any(fate.fell for fate in fates(posture, place, down))
    return len(gravity_dir), fell
