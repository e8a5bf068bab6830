"""Thresholds of the definition that a robot is near: there noise may change a verdict.

Owns the question of one robot.  The definition compares numbers with `rest_width`,
`contact_tolerance`, `upright` and `rock_angle`, and the energy of a roll with that of edges on its
way.  Each of these is moved, on the robot without noise, by as much as noise can move what it is
compared with; where the verdict changes, it is near.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.support.region import TIPS, Acceptance
from lutgen.vector import Floats
from proofs.physics.asked import NEAR, ROCK, UPRIGHT, WIDTH, ask, limits_for

# Noise moves a length by up to so many times its sigma, and an angle by as much over the width.
FAR = 10.0
# The last is where a roll branches: an edge on its way that the robot just passes, or just not.
THRESHOLDS = ("rest_width", "contact_tolerance", "upright", "rock_angle", "the energy of an edge")


def moved(threshold: str, length: float, angle: float, size: float) -> Acceptance:
    """Return the default limits with one threshold moved by a length (or an angle, rad)."""
    by = math.degrees(angle)
    return limits_for(
        size,
        upright=UPRIGHT + (by if threshold == "upright" else 0.0),
        rock=max(ROCK + (by if threshold == "rock_angle" else 0.0), 0.0),
        width=max(WIDTH + (length / size if threshold == "rest_width" else 0.0), 0.0),
        near=max(NEAR + (length / size if threshold == "contact_tolerance" else 0.0), 0.0),
    )


def thresholds_near(
    primitives: Floats, gravity_dir: Floats, sigma: float, width: float, size: float
) -> NDArray[np.bool_]:
    """Tell which thresholds a robot is near in each direction: (d, 5), as `THRESHOLDS`.

    `primitives` (n, 8) are those of the robot without noise, `gravity_dir` (d, 3) unit directions;
    `sigma`, the `width` of its support and its `size` are lengths.  Energies are moved by moving
    the com, which directions far from the region's boundary do not notice.
    """
    asked = gravity_dir[None]
    here = ask(primitives[None], limits_for(size), asked)[0][0] == TIPS
    found = np.zeros((len(gravity_dir), len(THRESHOLDS)), bool)
    for column, threshold in enumerate(THRESHOLDS[:-1]):
        for way in (-FAR, FAR):
            limits = moved(threshold, way * sigma, way * sigma / width, size)
            found[:, column] |= (ask(primitives[None], limits, asked)[0][0] == TIPS) != here
    for shift in FAR * sigma * np.vstack([np.eye(3), -np.eye(3)]):
        other = primitives.copy()
        other[:, :3] += shift
        found[:, -1] |= (ask(other[None], limits_for(size), asked)[0][0] == TIPS) != here
    return found
