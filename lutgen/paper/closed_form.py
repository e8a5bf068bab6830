"""The robot of the paper's simulations, its search and its path, in closed form.

Owns a reconstruction: the paper prints no geometry.  Recipes, maps and the search of the library
have no part in it, so that it can serve as a second way.  Angles in rad unless a name ends in
`_deg`.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.channels import stability
from lutgen.paper.forces import HEIGHT, RADIUS
from lutgen.paper.printed import eq33

Array = NDArray[np.float64]

# The nominal elevation of the wheels, printed as 30.964 deg, and their distance from the com.
NOMINAL = math.atan(HEIGHT / RADIUS)
REACH = math.hypot(RADIUS, HEIGHT)
# The range of the search (deg), the nodes per parameter, and how far it goes at most.
RANGE_DEG = (0.0, 50.0)
NODES = 5
MOST_LEVELS = 12
# Half a unit in the fourth decimal place, as the angles of Table 1 are printed.
PRINTED_DEG = 5e-5


def tripods(alpha: Array, gamma: Array, azimuth_deg: float = 0.0) -> Array:
    """Return the contacts of simulation 2, (m, 3, 3), wheel 1 at `azimuth_deg`.

    Parameters
    ----------
    alpha, gamma : (m,) float64
        Elevation of wheels 1 and 2 below the body's xy plane, rad.  Wheel 3 stays at `NOMINAL`.
    azimuth_deg : float
        The others follow after 120 and 240 deg.
    """
    down = np.stack([alpha, gamma, np.full_like(alpha, NOMINAL)], axis=1)
    around = np.broadcast_to(np.radians(azimuth_deg + np.array([0.0, 120.0, 240.0])), down.shape)
    level = np.cos(down)
    return REACH * np.stack([level * np.cos(around), level * np.sin(around), -np.sin(down)], axis=2)


def factor_at(alpha_deg: float, gamma_deg: float) -> float:
    """Return |SD_g| of simulation 2 with gravity along the body's -z."""
    shape = tripods(np.radians([alpha_deg]), np.radians([gamma_deg]))
    return float(stability(shape, [[0.0, 0.0, -1.0]], ("sdg",))["sdg"][0, 0])


def search_trace(levels: int) -> list[float]:
    """Return the angle (deg) of the best node of each level of the paper's search.

    Parameters
    ----------
    levels : int
        How many times 5 x 5 nodes.

    Returns
    -------
    list of float
        Of alpha; gamma's is the same.  The five nodes are the left ends of five cells of the
        interval; the next interval is one cell to either side of the best node.
    """
    low, width = RANGE_DEG[0], RANGE_DEG[1] - RANGE_DEG[0]
    start = [low, low]
    trace = []
    for _ in range(levels):
        step = width / NODES
        nodes = [s + step * np.arange(NODES) for s in start]
        alpha, gamma = (grid.ravel() for grid in np.meshgrid(*nodes, indexing="ij"))
        shapes = tripods(np.radians(alpha), np.radians(gamma))
        factor = stability(shapes, [[0.0, 0.0, -1.0]], ("sdg",))["sdg"][:, 0]
        best = int(factor.argmin())
        trace.append(float(alpha[best]))
        start = [float(alpha[best]) - step, float(gamma[best]) - step]
        width = 2.0 * step
    return trace


def levels_until(angle_deg: float) -> int:
    """Return how many levels the search needs to print `angle_deg`; 0 if it never does."""
    trace = search_trace(MOST_LEVELS)
    hits = [i + 1 for i, angle in enumerate(trace) if abs(angle - angle_deg) < PRINTED_DEG]
    return hits[0] if hits else 0


def path_slope(x: float) -> float:
    """Return dz/dx of Eq 33, whose singularity at 0 is removable: 15 there."""
    sinc = float(np.sinc(x / np.pi))
    # d/dx of x sinc(x)^2.
    return 15.0 * (2.0 * math.cos(x) * sinc - sinc * sinc)


def path_height(x: float) -> float:
    """Return z of Eq 33 with its limit, 0, at 0."""
    return 0.0 if x == 0.0 else eq33(x)


def tipping_points(places: Array) -> int:
    """Return at how many places of the path the uncontrolled robot tips.

    Parameters
    ----------
    places : (m,) float64
        Values of s, in order along the path.

    Notes
    -----
    The robot has its nominal shape, wheels at 30, 150 and 270 deg, heads along x and pitches
    with dz/ds.
    """
    pitch = np.arctan([path_slope(float(s)) for s in places])
    gravity = np.column_stack([-np.sin(pitch), np.zeros(len(pitch)), -np.cos(pitch)])
    shape = tripods(np.array([NOMINAL]), np.array([NOMINAL]), 30.0)
    angle = stability(shape, gravity, ("tip_angle",))["tip_angle"][0]
    return int((angle < 0.0).sum())
