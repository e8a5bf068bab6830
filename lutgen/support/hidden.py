"""Primitives that others hide: what lies within another one touches no plane before it.

Owns who is left out of the searches.  Tracks are boxes and cylinders as often as not, and the
corners of the box lie on the rims: at one pitch, or while the plane turns about a tangent, corner
and rim touch it at one place, and which of the two does is told by rounding.  So a primitive within
another one, to a length that no sensor could tell, is no contact; of two that are one the first is.
Among points alone the hull itself sees to it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.primitive import DISC, KIND, POINT, RADIUS, SPHERE
from lutgen.support.table import FIRST, FOUND, MASK, VERTEX, Hull
from lutgen.vector import Floats, Ints, dot, length, row, scale, subtract

# Part of the size by which what is hidden may stick out.  A corner that does so by e beyond a rim
# of radius r carries at most sqrt(2 r e) beside it, a twenty-thousandth of the size.
STICKS_OUT = 1e-8
# Sine between the axes of two discs that are in one plane.
ONE_AXIS = 1e-7


@njit(bare=True)
def lies_within(primitives: Floats, i: int, j: int, tolerance: float) -> bool:
    """Tell whether primitive i lies within j, a ball, a round plate or a point, to a length."""
    radius, kind = primitives[i, RADIUS], primitives[i, KIND]
    arm = subtract(row(primitives, i), row(primitives, j))
    reach = primitives[j, RADIUS] + tolerance
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
def show(primitives: NDArray[np.float64], tolerance: float, shown: Floats, number: Ints) -> int:
    """Copy the primitives that no other one hides; return how many they are.

    Parameters
    ----------
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    tolerance : float
        By which what is hidden may stick out (length).
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
            if j != i and lies_within(primitives, i, j, tolerance):
                # Of two that are one the first stays.
                hidden = hidden or j < i or not lies_within(primitives, j, i, tolerance)
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
