"""Rotations as URDF and recipes write them: three angles (rad) about fixed axes, both ways."""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.vector import Floats, Vector

# Below this cosine of the pitch, roll and yaw turn about the same axis and roll is set to 0.
_LOCKED = 1e-9


def rotation(rpy: Vector) -> Floats:
    """Return Rz(yaw) Ry(pitch) Rx(roll) (3, 3), the fixed-axis order of URDF."""
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy).tolist(), np.sin(rpy).tolist()
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def axis_rotation(axis: Vector, angle: float) -> Floats:
    """Return the rotation (3, 3) by `angle` about a unit axis (Rodrigues' formula)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turned = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
    return np.asarray(turned, dtype=np.float64)


def from_quaternion(x: float, y: float, z: float, w: float) -> Floats:
    """Return the rotation (3, 3) of a quaternion of any length above 0."""
    x, y, z, w = np.array([x, y, z, w]) / math.hypot(x, y, z, w)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def angles(matrix: NDArray[np.float64]) -> Vector:
    """Return roll, pitch and yaw of a rotation matrix, so that ``rotation`` gives it back.

    At a pitch of +-90 deg only the sum of roll and yaw is known: roll is then 0.
    """
    m = matrix.tolist()
    cosine = math.hypot(m[0][0], m[1][0])
    pitch = math.atan2(-m[2][0], cosine)
    if cosine < _LOCKED:
        return 0.0, pitch, math.atan2(-m[0][1], m[1][1])
    return math.atan2(m[2][1], m[2][2]), pitch, math.atan2(m[1][0], m[0][0])
