"""The ground under a robot: what an accelerometer says about body and ground.

`lutgen.channels.resting` explains the conventions.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.posture import Posture
from lutgen.channels import turned
from lutgen.chart import gravity_from_up, unit_directions
from lutgen.errors import InputError, reject


def gravity_transform(normal: ArrayLike) -> NDArray[np.float64]:
    """Return T_g of convention P (3, 3): from the contact plane's frame to the body frame.

    It takes (0, 0, 1) to the plane's upward normal (body frame, any length > 0) by the least angle.
    """
    up = tuple(unit_directions(normal).tolist())
    columns = [turned(up, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    return np.array(columns).T + 0.0


@dataclass(frozen=True)
class TangentPlane:
    """The ground under a robot, from an accelerometer reading; angles in rad.

    `roll` and `pitch` are the body's attitude: body = Ry(pitch) Rx(roll) after any heading, so a
    lowered nose has positive pitch and a lowered right side positive roll.  `normal` (3,) is the
    ground's upward normal in the body frame and `height` the com's distance from the ground.
    `slope` is the ground's inclination, `downhill` the heading in which it falls (0 ahead, pi/2 to
    the left), and `gravity` (3,) relative to the contact plane.  `standing` is the verdict; where
    the robot tips, the ground is the plane of the facet that gravity pierces first.
    """

    roll: float
    pitch: float
    normal: NDArray[np.float64]
    height: float
    slope: float
    downhill: float
    gravity: NDArray[np.float64]
    standing: bool


def tangent_plane(posture: Posture, up_dir: ArrayLike) -> TangentPlane:
    """Return the ground's orientation under a posture from an accelerometer reading.

    `up_dir` (3,) is what the accelerometer reads (specific force, body frame), any length > 0.
    Refused where gravity pierces no support facet: then nothing is known of the ground.
    """
    x, y, z = unit_directions(up_dir)
    roll, pitch = math.atan2(y, z), math.atan2(-x, math.hypot(y, z))
    down = gravity_from_up(up_dir)
    found = diagnose(posture, down)
    if found.facet is None:
        got = f"up_dir = {np.asarray(up_dir, dtype=float).tolist()}"
        what, way_out = "the robot lies on no support facet", "nothing is known of the ground then"
        reject(posture.recipe.source, what, got, way_out, InputError)
    up = -found.facet.normal
    gravity = gravity_transform(up).T @ down
    slope = math.atan2(math.hypot(gravity[0], gravity[1]), -gravity[2])
    downhill = math.atan2(gravity[1], gravity[0])
    height, standing = found.facet.height, found.standing
    return TangentPlane(roll, pitch, up, height, slope, downhill, gravity, standing)
