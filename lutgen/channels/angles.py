"""Angles from a direction of gravity to the boundary of the standing region, in float64."""

import math

from lutgen.jit import njit
from lutgen.support import ACCEPTED, ARCS, CONVEX, Region
from lutgen.vector import Vector, dot, read3

# What a direction just outside the region gets where its distance rounds to zero, so that the
# sign alone always tells the verdict, in float32 too.
JUST_OUTSIDE = -1e-30
HALF_PI = math.pi / 2.0
# What pi / 2 has beyond the digits of a float64.
REST_OF_HALF_PI = 6.123233995736766e-17


@njit(inline=True)
def arcsine(x: float) -> float:
    """Return asin(x), rad, without a branch, so that loops over it become vector instructions.

    The error is below 0.7 units in the last place (1.3 on a processor without fused
    multiply-add); beyond 1 and -1 the answer is that of 1 and -1, and NaN stays NaN.  Above 1/2
    it is pi/2 - 2 asin(sqrt((1 - x) / 2)), with what the square root and pi/2 lose put back.  The
    polynomial meets (asin(s) - s) / s^3, as a function of s^2 <= 1/4, in 13 Chebyshev nodes; there
    it is off by at most 6e-18 of asin(s).
    """
    size = abs(x)
    steep = size > 0.5
    z = max(0.5 - 0.5 * size, 0.0) if steep else size * size
    s = math.sqrt(z) if steep else size
    p = 0.02875785136742157
    p = p * z - 0.014851887071247209
    p = p * z + 0.017400879442694025
    p = p * z + 0.005457506718640357
    p = p * z + 0.01032281435018578
    p = p * z + 0.011479177415184906
    p = p * z + 0.013971212973552933
    p = p * z + 0.017352392720869973
    p = p * z + 0.02237217294214989
    p = p * z + 0.030381944138531247
    p = p * z + 0.04464285714635543
    p = p * z + 0.07499999999998433
    p = p * z + 0.16666666666666669
    bent = p * z * s
    lost = (z - s * s) / max(2.0 * s, 1e-300)
    rest = HALF_PI - 2.0 * s
    lost_there = (HALF_PI - rest) - 2.0 * s + REST_OF_HALF_PI
    angle = rest - (2.0 * (bent + lost) - lost_there) if steep else s + bent
    return math.copysign(angle, x)


@njit(bare=True)
def arc_nearness(region: Region, b: int, g: Vector) -> float:
    """Return the squared sine of the angle from g to arc b; beyond 90 deg, 2 less it.

    It grows with the angle, without end points and without cancellation.
    """
    arc = region.arc[b]
    off = dot(read3(arc.wall), g)
    reach, ahead = abs(dot(read3(arc.along), g)), dot(read3(arc.amid), g)
    beyond = max(reach - ahead, 0.0)
    square = off * off + beyond * beyond
    return square if ahead * arc.spread + reach >= 0.0 else 2.0 - square


@njit(inline=True)
def angle_of(nearness: float) -> float:
    """Return the angle (rad) of a squared sine, or beyond 90 deg of 2 less it."""
    angle = arcsine(math.sqrt(min(nearness, 2.0 - nearness)))
    return angle if nearness <= 1.0 else math.pi - angle


@njit(bare=True)
def arc_angle(region: Region, b: int, g: Vector) -> float:
    """Return the angle (rad) from g to arc b of the boundary."""
    return angle_of(arc_nearness(region, b, g))


@njit(inline=True)
def signed_angle(sine: float, standing: bool) -> float:
    """Return asin (rad), moved to the side of 0 that the verdict is on."""
    angle = arcsine(sine)
    return max(angle, 0.0) if standing else min(angle, JUST_OUTSIDE)


@njit(bare=True)
def tip_angle(region: Region, standing: bool, g: Vector) -> float:
    """Return the signed angular distance (rad) from g to the boundary of the standing region.

    Positive inside; pi where there is no boundary, -pi where there is no region.  For a convex
    region it is the least asin(m . g) over the tip-over planes, inside and outside: the angle of
    the force-angle measure of Papadopoulos and Rey for a pure gravity load.
    """
    count = region.counts
    if count[ACCEPTED] == 0:
        return -math.pi
    if count[ARCS] == 0:
        return math.pi if standing else -math.pi
    if count[CONVEX] == 1:
        lowest = 1.0
        for b in range(count[ARCS]):
            lowest = min(lowest, dot(read3(region.arc[b].wall), g))
        return signed_angle(lowest, standing)
    nearest = 2.0
    for b in range(count[ARCS]):
        nearest = min(nearest, arc_nearness(region, b, g))
    angle = angle_of(nearest)
    return angle if standing else min(-angle, JUST_OUTSIDE)
