"""Primitives that others cover: what lies within another one touches no plane before it.

A track is often described as a box and cylinders, and the corners of the box lie on the rims.
Rounding decides then which of the two touches the ground.  So a primitive within another one is no
contact, even if it sticks out by less than the last digit of a description.
"""

import math

from lutgen.jit import njit
from lutgen.support.primitive import DISC, KIND, POINT, RADIUS, SPHERE, axle
from lutgen.vector import Floats, Ints, dot, length, row, scale, subtract

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
    """Copy the primitives that no other one covers; return how many they are.

    Parameters
    ----------
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    size : float
        Size of the robot (length).
    shown : (n, 8) float64
        Filled with them, in their order.
    source : (n,) int64
        Filled with the row of each in `primitives`.
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
