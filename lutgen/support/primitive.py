"""Contact primitives: where a point, a sphere or a disc touches a plane.

Owns the support function of one primitive.  The primitives of a posture are the rows of one array
(n, 8), so that kernels hand on a single array: centre x, y, z; axis x, y, z (zero unless a disc);
radius; kind.  Lengths in the recipe's unit, relative to the com, body frame.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.jit import njit
from lutgen.parts import KINDS
from lutgen.vector import Floats, Vector, cross, dot, length, row, scale, subtract

POINT, SPHERE, DISC = (float(KINDS.index(kind)) for kind in ("point", "sphere", "disc"))
RADIUS, KIND = 6, 7
# A disc whose axis is within this angle (rad) of the plane's normal lies on its face and has no
# single point of contact.
FACE_ANGLE = 1e-6


def pack(
    centre: NDArray[np.float64], axis: NDArray[np.float64], radius: ArrayLike, kind: ArrayLike
) -> NDArray[np.float64]:
    """Return the rows (..., n, 8) of primitives given by centre and axis (..., n, 3)."""
    rows = np.empty((*centre.shape[:-1], 8))
    rows[..., 0:3] = centre
    rows[..., 3:6] = axis
    rows[..., RADIUS] = radius
    rows[..., KIND] = kind
    return rows


@njit(inline=True, bare=True)
def _axle(primitives: Floats, index: int) -> Vector:
    return primitives[index, 3], primitives[index, 4], primitives[index, 5]


# Arrays are read first, and decided upon in functions of numbers alone: where an array lives across
# a branch its references are counted, which took half the time of a search.


@njit(inline=True, bare=True)
def _height(centre: Vector, axle: Vector, radius: float, kind: float, normal: Vector) -> float:
    value: float = dot(centre, normal)
    if kind == SPHERE:
        value += radius
    elif kind == DISC:
        radial = subtract(normal, scale(axle, dot(normal, axle)))
        value += radius * length(radial)
    return value


@njit(inline=True, bare=True)
def _contact(centre: Vector, axle: Vector, radius: float, kind: float, normal: Vector) -> Vector:
    x, y, z = centre
    if kind == SPHERE:
        return x + radius * normal[0], y + radius * normal[1], z + radius * normal[2]
    if kind == DISC:
        radial = subtract(normal, scale(axle, dot(normal, axle)))
        size = length(radial)
        if size < FACE_ANGLE:
            return math.nan, math.nan, math.nan
        r = radius / size
        return x + r * radial[0], y + r * radial[1], z + r * radial[2]
    return centre


@njit(inline=True, bare=True)
def support_height(primitives: Floats, index: int, normal: Vector) -> float:
    """Return the support function: how far primitive `index` extends along a unit `normal`."""
    radius, kind = primitives[index, RADIUS], primitives[index, KIND]
    height: float = _height(row(primitives, index), _axle(primitives, index), radius, kind, normal)
    return height


@njit(inline=True, bare=True)
def support_contact(primitives: Floats, index: int, normal: Vector) -> Vector:
    """Return the point of primitive `index` that extends furthest along a unit `normal`.

    It is the gradient of `support_height`: c for a point, c + r n for a sphere, and c + r u for a
    disc, with u the normalised part of n orthogonal to the disc's axis.  A disc that lies on its
    face has no such point: the answer is NaN.
    """
    radius, kind = primitives[index, RADIUS], primitives[index, KIND]
    point: Vector = _contact(row(primitives, index), _axle(primitives, index), radius, kind, normal)
    return point


@njit(inline=True, bare=True)
def sine_to_axle(primitives: Floats, index: int, normal: Vector) -> float:
    """Return the sine between a unit `normal` and the axle of primitive `index`.

    1 for points and spheres; 0 where a disc lies on its face.
    """
    kind, axle = primitives[index, KIND], _axle(primitives, index)
    return length(cross(axle, normal)) if kind == DISC else 1.0
