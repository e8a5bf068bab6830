"""Angles from a direction of gravity to the boundary of the standing region, in float64."""

import math

from lutgen.jit import njit
from lutgen.support import ACCEPTED, ARCS, CONVEX, Region
from lutgen.vector import Vector, dot, read3

# A direction just outside the region gets this where its distance rounds to zero, so that the
# sign alone is always the verdict, in float32 too.
JUST_OUTSIDE = -1e-30


@njit(inline=True)
def arcsine(x: float) -> float:
    """Return asin(x), rad; beyond 1 and -1 it is that of 1 and -1."""
    return math.asin(min(max(x, -1.0), 1.0))


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
