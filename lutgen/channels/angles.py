"""Angles from a direction of gravity to the boundary of the standing region, in float64.

Owns the arcsine that every way to a channel shares, so that all give the same bits, and the
distance to an arc and to the whole boundary.
"""

import math

from lutgen.jit import njit
from lutgen.support import facets_in, is_convex, segments_in, start_at, stop_at, tip_plane_at
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, scale, subtract

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


@njit()
def arc_distance(start: Vector, stop: Vector, normal: Vector, g: Vector) -> float:
    """Return the angle (rad) from g to the great-circle arc between two contact directions."""
    if dot(cross(normal, start), g) >= 0.0 and dot(cross(stop, normal), g) >= 0.0:
        return abs(math.asin(min(max(dot(normal, g), -1.0), 1.0)))
    near_start = length(subtract(g, scale(start, 1.0 / length(start))))
    near_stop = length(subtract(g, scale(stop, 1.0 / length(stop))))
    return 2.0 * math.asin(min(0.5 * min(near_start, near_stop), 1.0))


@njit(inline=True)
def signed_angle(lowest: float, standing: bool) -> float:
    """Return the tip angle (rad) where `lowest` is the least m . g over the tip-over planes."""
    angle = arcsine(lowest)
    return max(angle, 0.0) if standing else min(angle, JUST_OUTSIDE)


@njit()
def tip_angle(count: Ints, segment: Floats, standing: bool, g: Vector) -> float:
    """Return the signed angular distance (rad) from g to the boundary of the standing region.

    Positive inside; pi where there is no boundary, -pi where there is no region.  For a convex
    region it is the smallest asin(m . g) over the tip-over planes, inside and outside: the angle
    of the force-angle measure of Papadopoulos and Rey for a pure gravity load.
    """
    if facets_in(count) == 0:
        return -math.pi
    if segments_in(count) == 0:
        # Without a boundary it never tips, or there is no rest at all.
        return math.pi if standing else -math.pi
    if is_convex(count):
        lowest = 2.0
        for b in range(segments_in(count)):
            lowest = min(lowest, dot(tip_plane_at(segment, b), g))
        return signed_angle(lowest, standing)
    nearest = math.pi
    for b in range(segments_in(count)):
        start, stop = start_at(segment, b), stop_at(segment, b)
        nearest = min(nearest, arc_distance(start, stop, tip_plane_at(segment, b), g))
    return nearest if standing else min(-nearest, JUST_OUTSIDE)
