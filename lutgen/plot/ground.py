"""Ground: a slab under a robot in a film, which is seen as ground from every side.

Owns its shape and its shades.  A bare square all but vanishes where a slope turns its edge to the
eye, so the ground has a thickness, and strips across the way on top, which pass by as the robot
goes on.
"""

import math
from itertools import pairwise

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray

from lutgen.plot.palette import GREY

Floats = NDArray[np.float64]

# Shades of the top, strip by strip, of the sides, and of the underside.
TOP, SIDE, UNDER = ("#e4e4e4", "#cfcfcf"), "#a9a9a9", "#bdbdbd"
# Half a side, the width of a strip and the thickness, in reaches of the robot.
HALF, STRIP, THICK = 1.05, 0.25, 0.14


def eye(elevation: float, azimuth: float) -> Floats:
    """Return the unit vector (3,) towards the eye, of two angles in deg."""
    up, round_ = math.radians(elevation), math.radians(azimuth)
    return np.array(
        [math.cos(up) * math.cos(round_), math.cos(up) * math.sin(round_), math.sin(up)]
    )


def lay(slab: Poly3DCollection, place: Floats, reach: float, gone: float, to_eye: Floats) -> None:
    """Put the ground where the robot stands.

    Parameters
    ----------
    slab : Poly3DCollection
        What is drawn, in the order of its faces.
    place : array (4, 3)
        The middle of its top; unit vectors along the way and across it; the unit normal, down into
        the ground.
    reach : float
        Of the robot, in its unit of length.
    gone : float
        Way so far, in the same unit: the strips stay behind.
    to_eye : array (3,)
        As of `eye`.
    """
    middle, along, across, down = place
    half, width = HALF * reach, STRIP * reach
    deep = THICK * reach * down
    corners = middle + half * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) @ [along, across]
    sides = [
        np.array([a, b, b + deep, a + deep])
        for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True)
    ]
    # Of a convex body no face towards the eye covers another, and together they hide the rest.
    faces = [(side, SIDE) for side in sides if (side[0] + side[1] - 2.0 * middle) @ to_eye > 0.0]
    if down @ to_eye < 0.0:
        faces += strips(middle, np.stack([along, across]), half, width, gone)
    else:
        faces.append((corners + deep, UNDER))
    slab.set_verts([face for face, _ in faces])
    slab.set_facecolor([shade for _, shade in faces])
    slab.set_edgecolor([shade if shade in TOP else GREY for _, shade in faces])


def strips(
    middle: Floats, axes: Floats, half: float, width: float, gone: float
) -> list[tuple[Floats, str]]:
    """Return the strips of the top with their shades; `axes` (2, 3) are along and across."""
    first = math.floor((gone - half) / width)
    count = math.ceil(2.0 * half / width) + 1
    ends = np.clip((first + np.arange(count + 1)) * width - gone, -half, half)
    found = []
    for i, (a, b) in enumerate(pairwise(ends)):
        if b > a:
            corner = np.array([[a, -half], [b, -half], [b, half], [a, half]])
            found.append((middle + corner @ axes, TOP[(first + i) % 2]))
    return found
