"""Contact primitives: where a point, a sphere or a disc touches a plane.

The primitives of a posture are the rows of one array (n, 8): centre x, y, z; axis x, y, z (zero
unless a disc); radius (zero of a point); kind.  Lengths in the recipe's unit, relative to the com,
body frame.  Behind them are two rows for each axle that swings, of a kind of their own: a point and
the direction of the line about which it does, and its two contacts, FIRST * i + j; the com of the
rest of the robot, three zeros, and its share of the mass.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.arrays import Floats, Ints, Vector
from lutgen.jit import njit
from lutgen.parts import KINDS
from lutgen.vector import along, cross, dot, length, row, scale, subtract, write3

POINT, SPHERE, DISC = (float(KINDS.index(kind)) for kind in ("point", "sphere", "disc"))
AXLE, FIRST = 3.0, 64
RADIUS, KIND = 6, 7
# A disc whose axis is within this angle (rad) of the plane's normal lies on its face.
FACE_ANGLE = 1e-6
NO_FACE = FACE_ANGLE * FACE_ANGLE
# Steps of Newton's method: it converges in 4 to 6 from any plane near the solution.  The
# last step (squared) is so short that the next one would be rounding; if two planes are about to be
# one, half as long as the one before.
NEWTON, CONVERGED, NEARLY = 30, 1e-18, 1e-16
# Sine between the axes of two discs that are one.
ONE_AXLE = 1e-13


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


@njit(bare=True)
def contact_count(primitives: Floats) -> int:
    """Return how many rows are contacts: axles that swing stand behind them."""
    count = int(primitives.shape[0])
    while count > 0 and primitives[count - 1, KIND] == AXLE:
        count -= 1
    return count


@njit(inline=True, bare=True)
def axle(primitives: Floats, i: int) -> Vector:
    """Return the axis of primitive i."""
    return primitives[i, 3], primitives[i, 4], primitives[i, 5]


@njit(bare=True)
def support_contact(primitives: Floats, i: int, normal: Vector) -> Vector:
    """Return the point of primitive i that extends furthest along a unit `normal`.

    It is c of a point, c + r n of a sphere, and c + r u of a disc, with u the normalised part of n
    orthogonal to the axis.  A disc that lies on its face is taken to touch near its centre.
    """
    centre, radius = row(primitives, i), primitives[i, RADIUS]
    if radius == 0.0:
        return centre
    if primitives[i, KIND] != DISC:
        return along(centre, normal, radius)
    axis = axle(primitives, i)
    cosine = dot(axis, normal)
    radius /= math.sqrt(max(1.0 - cosine * cosine, NO_FACE))
    return along(along(centre, normal, radius), axis, -radius * cosine)


@njit(bare=True)
def fill_contacts(primitives: Floats, normal: Vector, contacts: Floats) -> None:
    """Fill `contacts` (n, 3) with the support contact of every primitive."""
    for i in range(primitives.shape[0]):
        write3(contacts[i], support_contact(primitives, i, normal))


@njit(bare=True)
def support_height(primitives: Floats, i: int, normal: Vector) -> float:
    """Return the support function: how far primitive i extends along a unit `normal`."""
    return dot(support_contact(primitives, i, normal), normal)


@njit(inline=True, bare=True)
def are_alike(primitives: Floats, i: int, j: int) -> bool:
    """Return True if the contacts of two primitives are as far apart on every plane.

    They are points, or of one radius and one axis, if they have any.
    """
    if primitives[i, RADIUS] != primitives[j, RADIUS] or primitives[i, KIND] != primitives[j, KIND]:
        return False
    apart = cross(axle(primitives, i), axle(primitives, j))
    return bool(dot(apart, apart) <= ONE_AXLE * ONE_AXLE)


@njit(bare=True)
def tangent_plane(
    primitives: Floats, i: int, j: int, k: int, across: Vector, normal: Vector
) -> tuple[Vector, bool]:
    """Turn a plane until it touches primitives i, j and k.

    With k = -1 it touches i and j and is parallel to `across`.  Newton's method is to take the
    plane through the places where they touched the plane before.  Returns the unit normal, on the
    side of `normal`, and True if the method converged.
    """
    third = k if k >= 0 else j
    flat = are_alike(primitives, i, j) and are_alike(primitives, i, third)
    moved = 9.0
    for _ in range(NEWTON):
        origin = support_contact(primitives, i, normal)
        if k >= 0:
            across = subtract(support_contact(primitives, k, normal), origin)
        turned = cross(subtract(support_contact(primitives, j, normal), origin), across)
        size = length(turned)
        if size == 0.0:
            return normal, False
        turned = scale(turned, math.copysign(1.0 / size, dot(turned, normal)))
        change = subtract(turned, normal)
        normal, moved = turned, dot(change, change)
        if flat or moved < CONVERGED:
            return normal, True
    return normal, moved < NEARLY


# Part of the radius of what covers by which what is covered may stick out: of a wheel of 10 cm
# 3 um.  A corner that does so carries at most 0.008 of the radius beside the rim.
STICKS_OUT = 3e-5
# Points are one where a wheel of this part of the size would cover one of them.
POINT_WHEEL = 0.2
# Sine between the axes of two discs that are in one plane.
ONE_AXIS = 1e-5


@njit(bare=True)
def lies_within(primitives: Floats, i: int, j: int, part: float, size: float) -> bool:
    """Return True if primitive i lies within j, a ball, a round plate or a point.

    But for a `part` of the radius of j, or of POINT_WHEEL of the size (length) if j is a point.
    """
    radius, kind = primitives[i, RADIUS], primitives[i, KIND]
    arm = subtract(row(primitives, i), row(primitives, j))
    outer = primitives[j, RADIUS]
    tolerance = part * (outer if outer > 0.0 else POINT_WHEEL * size)
    reach = outer + tolerance
    if dot(arm, arm) > reach * reach:
        return False
    if primitives[j, KIND] == POINT:
        return bool(kind == POINT)
    if primitives[j, KIND] == SPHERE:
        if kind != DISC:
            return bool(length(arm) + (radius if kind == SPHERE else 0.0) <= reach)
        aside = dot(arm, axle(primitives, i))
        across = length(subtract(arm, scale(axle(primitives, i), aside))) + radius
        return bool(aside * aside + across * across <= reach * reach)
    if kind == SPHERE:
        return False
    other = axle(primitives, j)
    if abs(dot(arm, other)) > tolerance:
        return False
    if kind == POINT:
        return True
    own = axle(primitives, i)
    apart = subtract(own, scale(other, math.copysign(1.0, dot(own, other))))
    return bool(length(apart) < ONE_AXIS and length(arm) + radius <= reach)


@njit(bare=True)
def show(primitives: Floats, size: float, shown: Floats, source: Ints) -> int:
    """Copy the primitives (n, 8) that no other one covers; return how many they are.

    They fill `shown` in their order, and their rows `source`; `size` is that of the robot (length).
    """
    n = primitives.shape[0]
    # Points that are one are gathered by the facets.
    bent = False
    for i in range(n):
        bent |= primitives[i, KIND] != POINT
    count = 0
    for i in range(n):
        covered = False
        for j in range(n):
            if bent and j != i and lies_within(primitives, i, j, STICKS_OUT, size):
                # If two are one, the first stays.
                covered |= j < i or not lies_within(primitives, j, i, STICKS_OUT, size)
        if not covered:
            source[count] = i
            for c in range(8):
                shown[count, c] = primitives[i, c]
            count += 1
    return count
