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
from lutgen.vector import Floats, Vector, dot, length, scale, subtract

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


@njit(inline=True)
def support_height(primitives: Floats, index: int, normal: Vector) -> float:
    """Return the support function: how far primitive `index` extends along a unit `normal`."""
    value: float = (
        primitives[index, 0] * normal[0]
        + primitives[index, 1] * normal[1]
        + primitives[index, 2] * normal[2]
    )
    if primitives[index, KIND] == SPHERE:
        value += primitives[index, RADIUS]
    elif primitives[index, KIND] == DISC:
        axle = (primitives[index, 3], primitives[index, 4], primitives[index, 5])
        radial = subtract(normal, scale(axle, dot(normal, axle)))
        value += primitives[index, RADIUS] * length(radial)
    return value


@njit(inline=True)
def support_contact(primitives: Floats, index: int, normal: Vector) -> Vector:
    """Return the point of primitive `index` that extends furthest along a unit `normal`.

    It is the gradient of `support_height`: c for a point, c + r n for a sphere, and c + r u for a
    disc, with u the normalised part of n orthogonal to the disc's axis.  A disc that lies on its
    face has no such point: the answer is NaN.
    """
    x, y, z = primitives[index, 0], primitives[index, 1], primitives[index, 2]
    if primitives[index, KIND] == SPHERE:
        r = primitives[index, RADIUS]
        return x + r * normal[0], y + r * normal[1], z + r * normal[2]
    if primitives[index, KIND] == DISC:
        axle = (primitives[index, 3], primitives[index, 4], primitives[index, 5])
        radial = subtract(normal, scale(axle, dot(normal, axle)))
        size = length(radial)
        if size < FACE_ANGLE:
            return math.nan, math.nan, math.nan
        r = primitives[index, RADIUS] / size
        return x + r * radial[0], y + r * radial[1], z + r * radial[2]
    return x, y, z
