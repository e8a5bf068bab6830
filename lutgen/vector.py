"""Vectors of three components as plain tuples, for compiled kernels, and rotations, as matrices.

Tuples of scalars stay in registers where small arrays would be allocated.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit


@njit(inline=True)
def row(array: Floats, index: int) -> Vector:
    """Return row `index` of an (n, 3) array as a tuple."""
    return array[index, 0], array[index, 1], array[index, 2]


@njit(inline=True)
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(inline=True)
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@njit(inline=True)
def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(inline=True)
def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(inline=True)
def scale(a: Vector, factor: float) -> Vector:
    """Return factor * a."""
    return a[0] * factor, a[1] * factor, a[2] * factor


@njit(inline=True)
def length(a: Vector) -> float:
    """Return the Euclidean length of a."""
    return math.sqrt(dot(a, a))


@njit(inline=True)
def unit(a: Vector) -> Vector:
    """Return a / |a|, or the zero vector for the zero vector."""
    size = length(a)
    if size == 0.0:
        return 0.0, 0.0, 0.0
    return scale(a, 1.0 / size)


@njit(inline=True)
def along(a: Vector, b: Vector, way: float) -> Vector:
    """Return a + way * b."""
    return a[0] + way * b[0], a[1] + way * b[1], a[2] + way * b[2]


@njit(inline=True)
def between(a: Vector, b: Vector, share: float) -> Vector:
    """Return a + share * (b - a)."""
    return along(a, subtract(b, a), share)


@njit(inline=True, bare=True)
def read3(a: Floats) -> Vector:
    """Return an array of three numbers as a tuple."""
    return a[0], a[1], a[2]


@njit(inline=True, bare=True)
def write3(a: Floats, vector: Vector) -> None:
    """Write a tuple into an array of three numbers."""
    a[0], a[1], a[2] = vector


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
