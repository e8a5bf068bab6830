"""Primitives that others hide: what lies within another one touches no plane before it.

Owns who is left out of the searches.  Tracks are boxes and cylinders as often as not, and the
corners of the box lie on the rims: at one pitch, or while the plane turns about a tangent, corner
and rim touch it at one place, and which of the two does is told by rounding, or by how many digits
of both were printed.  So a primitive within another one, to a length that is printed in no
description, is no contact; of two that are one the first is.  Among points alone the hull itself
sees to it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.primitive import DISC, KIND, POINT, RADIUS, SPHERE
from lutgen.support.table import FIRST, FOUND, MASK, VERTEX, Hull
from lutgen.vector import Floats, Ints, dot, length, row, scale, subtract

# Part of the radius of what hides by which what is hidden may stick out: of a wheel of 10 cm three
# micrometres, twice as much as sixth decimals are off at worst.  A corner that does so by e beyond
# a rim of radius r carries at most sqrt(2 r e) beside it, 0.008 of the radius.
STICKS_OUT = 3e-5
# Points are one where a wheel of this part of the size would hide one of them.
POINT_WHEEL = 0.2
# Sine between the axes of two discs that are in one plane.
ONE_AXIS = 1e-5


@njit(bare=True)
def lies_within(primitives: Floats, i: int, j: int, part: float, size: float) -> bool:
    """Tell whether primitive i lies within j, a ball, a round plate or a point.

    But for a `part` of the radius of j, or where j is a point of POINT_WHEEL of the size (length).
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
    axle = (primitives[i, 3], primitives[i, 4], primitives[i, 5])
    if primitives[j, KIND] == SPHERE:
        if kind != DISC:
            return bool(length(arm) + (radius if kind == SPHERE else 0.0) <= reach)
        along = dot(arm, axle)
        across = length(subtract(arm, scale(axle, along))) + radius
        return bool(along * along + across * across <= reach * reach)
    if kind == SPHERE:
        return False
    other = (primitives[j, 3], primitives[j, 4], primitives[j, 5])
    if abs(dot(arm, other)) > tolerance:
        return False
    if kind == POINT:
        return True
    apart = subtract(axle, scale(other, math.copysign(1.0, dot(axle, other))))
    return bool(length(apart) < ONE_AXIS and length(arm) + radius <= reach)


@njit(bare=True)
def show(
    primitives: NDArray[np.float64], part: float, size: float, shown: Floats, number: Ints
) -> int:
    """Copy the primitives that no other one hides; return how many they are.

    Parameters
    ----------
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    part : float
        Of the radius of what hides, or of the size, by which what is hidden may stick out.
    size : float
        Of the robot (length).
    shown : (n, 8) float64
        Filled with them, in their order.
    number : (n,) int64
        Filled with the row of each in `primitives`.
    """
    n = primitives.shape[0]
    count = 0
    for i in range(n):
        hidden = False
        for j in range(n):
            if j != i and lies_within(primitives, i, j, part, size):
                # Of two that are one the first stays.
                hidden = hidden or j < i or not lies_within(primitives, j, i, part, size)
        if not hidden:
            number[count] = i
            for c in range(primitives.shape[1]):
                shown[count, c] = primitives[i, c]
            count += 1
    return count


@njit(bare=True)
def renumber(hull: Hull, number: Ints) -> None:
    """Name the primitives of a hull as they are in the array that `show` was given."""
    span, link = hull.span, hull.link
    facets = hull.tally[FOUND]
    for f in range(facets):
        mask = 0
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            link[at, VERTEX] = number[link[at, VERTEX]]
            mask |= 1 << link[at, VERTEX]
        span[f, MASK] = mask
