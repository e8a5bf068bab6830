"""The shape of the paper's robot, reconstructed: the paper prints angles and results only.

Three wheels at the same distance from the com, 120 deg apart in azimuth, each at an elevation
below the body's xy plane.  At the nominal elevation, atan(3/5) = 30.9638 deg, which the paper
rounds to 30.964, the circumradius is 20 and the height 12, so that the nearest edge is 10 away:
"in case of |SD_g| > 10 the robot tips over".  Angles in rad unless a name ends in `_deg`.
"""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CIRCUMRADIUS = 20.0
HEIGHT = 12.0
NOMINAL = math.atan(HEIGHT / CIRCUMRADIUS)
NOMINAL_DEG = math.degrees(NOMINAL)
# The distance R of the wheels from the com; every |SD_g| is proportional to it.
RADIUS = math.hypot(CIRCUMRADIUS, HEIGHT)
# The azimuths (deg) of P1, P2 and P3: on level ground nothing depends on them; on the path P1
# points ahead to the left, P2 back to the left, the fixed P3 to the right, and travel is along x.
AHEAD = (0.0, 120.0, 240.0)
TO_THE_LEFT = (30.0, 150.0, 270.0)
DOWN = np.array([0.0, 0.0, -1.0])


def tripods(alpha: Array, gamma: Array, azimuths_deg: tuple[float, ...] = AHEAD) -> Array:
    """Return the contacts of simulation 2, (..., 3, 3), body frame.

    `alpha` and `gamma`, (...), are the elevations of wheels 1 and 2 below the body's xy plane;
    wheel 3 stays at `NOMINAL`.  Azimuths count from the body's x axis.
    """
    below = np.stack([alpha, gamma, np.full_like(alpha, NOMINAL)], axis=-1)
    around = np.broadcast_to(np.radians(azimuths_deg), below.shape)
    level = np.cos(below)
    shape = [level * np.cos(around), level * np.sin(around), -np.sin(below)]
    return RADIUS * np.stack(shape, axis=-1)


def nominal_wheels() -> Array:
    """Return the contacts of the nominal shape, (3, 3), wheel 1 ahead."""
    azimuth = np.radians(AHEAD)
    below = np.full(3, -HEIGHT)
    return np.column_stack([CIRCUMRADIUS * np.cos(azimuth), CIRCUMRADIUS * np.sin(azimuth), below])
