"""Stability under a wrench: forces beside the weight, and a com that lies anywhere in a ball.

Verdict and `tip_angle` are exact under forces alone and under an uncertain com alone, but if forces
have a moment and the region is not convex they are bounds from below, as under both together
(docs/reference/conventions.md).
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Bools, Floats, Vector
from lutgen.channels.axes import ALWAYS, NEVER, Axes, Wrench, lowest_lever, zero_moment_point
from lutgen.channels.exact import (
    FACET,
    HEIGHT,
    JUST_OUTSIDE,
    MARGIN,
    SDG,
    STATUS,
    TIP,
    arc_angle,
    arcsine,
    axis_margin,
)
from lutgen.jit import njit
from lutgen.quantities import CHANNELS
from lutgen.support import ROCKS, STANDS, TIPS, Region, cone_of, seat_under
from lutgen.vector import add, along, cross, dot, length, read3, scale, subtract, unit


@njit(bare=True)
def _seat_under_moment(region: Region, force: Vector, mu: Vector) -> tuple[int, int]:
    """Return the seat that carries under a resultant with a moment, and STANDS or TIPS.

    That whose plane the resultant's central line leaves first; its zero-moment point decides if
    it stands there, or on any other rest.  The line goes through (force x mu) / |force|^2.
    """
    best, nearest = -1, math.inf
    square = dot(force, force)
    if square < 1e-24:
        return best, TIPS
    through = scale(cross(force, mu), 1.0 / square)
    for k in range(region.counts.accepted):
        plane = read3(region.seat[k].plane)
        rate = dot(plane, force)
        if rate > 0.0:
            reach = (1.0 - dot(plane, through)) / rate
            if reach < nearest - 1e-12 * abs(nearest) or best < 0:
                best, nearest = k, reach
    for turn in range(region.counts.accepted + 1):
        k = best if turn == 0 else turn - 1
        if k >= 0 and region.seat[k].is_rest and lowest_lever(region, k, force, mu) >= 0.0:
            return k, STANDS
    return best, TIPS


@njit(bare=True)
def whole_axis_angle(axes: NDArray[np.void], b: int, g: Vector) -> float:
    """Return the signed angle (rad) from g to a whole axis, for any com in the ball.

    It is the least m' . g over all planes through the axis turned by up to beta either way:
    m' = m cos(t) - a sin(t) for |t| <= beta, a the direction from the com towards the axis.
    """
    axis = axes[b]
    if axis.bound >= NEVER:
        return math.pi
    if axis.bound <= ALWAYS:
        return -math.pi
    u, w = dot(read3(axis.normal), g), dot(read3(axis.towards), g)
    sine = axis.cosine * u - axis.sine * abs(w)
    if u < 0.0 and abs(w) * axis.cosine <= -u * axis.sine:
        sine = -math.sqrt(u * u + w * w)
    return arcsine(sine) + math.asin(axis.bound)


@njit(bare=True)
def loaded_arc(region: Region, axes: Axes, b: int, phi: Vector, g: Vector) -> float:
    """Return the angle (rad) from g to where the resultant meets an arc between its ends."""
    axis, arc = axes.arc[b], region.arc[b]
    m, offset = read3(axis.normal), axis.offset
    aside = dot(m, g)
    flat = along(g, m, -aside)
    size = length(flat)
    if abs(offset) < 1.0 and size > 0.0:
        root = math.sqrt(1.0 - offset * offset) / size
        force = add(along(scale(flat, root), m, -offset), phi)
        before, behind = cross(m, read3(arc.start)), cross(read3(arc.stop), m)
        if dot(before, force) >= 0.0 and dot(behind, force) >= 0.0:
            return abs(arcsine(aside) + math.asin(offset))
    nearest = math.pi
    for end in range(4):
        point = read3(axis.ends[end])
        if point[0] == point[0]:
            nearest = min(nearest, 2.0 * math.asin(min(0.5 * length(subtract(g, point)), 1.0)))
    return nearest


@njit(bare=True)
def reduced_arc(region: Region, axes: Axes, b: int, rho: float, g: Vector) -> float:
    """Return the least angle (rad) from g to an arc's axis seen from any com in the ball.

    It is the least angle(g, x) - asin(rho / |x|) over the points x of the axis, negative where
    the ray along g passes within rho of it.  Over the whole line the least is the angle to the
    plane through the axis turned by beta towards g; where that is met beyond an end, the end
    counts, because the points nearer than any angle fill a convex cone about g widened by rho.
    """
    axis, arc = axes.arc[b], region.arc[b]
    start, stop = read3(arc.start), read3(arc.stop)
    aside, towards = dot(read3(axis.normal), g), read3(axis.towards)
    out = math.copysign(1.0, aside) * axis.sine
    ahead = axis.cosine * dot(towards, g) + out * aside
    if ahead > 0.0:
        side = read3(axis.along)
        place = axis.distance * axis.cosine * dot(side, g) / ahead
        if dot(start, side) <= place <= dot(stop, side):
            return arcsine(axis.cosine * abs(aside) - axis.sine * dot(towards, g))
    nearest = math.pi
    for end in range(2):
        point = start if end == 0 else stop
        size = length(point)
        away = 2.0 * math.asin(min(0.5 * length(subtract(g, scale(point, 1.0 / size))), 1.0))
        nearest = min(nearest, away - math.asin(min(rho / size, 1.0)))
    return nearest


@njit(inline=True, bare=True)
def counts_whole(region: Region, wrench: Wrench) -> bool:
    """Return True if axes count as whole lines: of convex regions, and where only a bound is known.

    That is under a moment, and under a force with an uncertain com.
    """
    pulled = length(read3(wrench.phi)) > 0.0 and wrench.rho > 0.0
    return region.counts.convex == 1 or pulled or length(read3(wrench.mu)) > 0.0


@njit(bare=True)
def axis_angle(
    region: Region, axes: Axes, b: int, wrench: Wrench, standing: bool, g: Vector
) -> float:
    """Return the signed angle (rad) from g to one arc of the boundary under a wrench.

    Where the axis does not count as a whole line, `standing` of the nominal com gives the sign.
    """
    if counts_whole(region, wrench):
        return whole_axis_angle(axes.arc, b, g)
    rho, phi = wrench.rho, read3(wrench.phi)
    if rho == 0.0:
        away = loaded_arc(region, axes, b, phi, g)
        return away if standing else -away
    if standing:
        return reduced_arc(region, axes, b, rho, g)
    return max(-arc_angle(region, b, g) - math.asin(min(rho / axes.arc[b].nearest, 1.0)), -math.pi)


@njit(bare=True)
def loaded_margin(
    region: Region, axes: Axes, b: int, wrench: Wrench, standing: bool, g: Vector
) -> float:
    """Return the signed distance from the resultant's line to one axis, less what rho takes.

    In a convex region the axis is a whole line and the distance (d m . F + e . M) / |e x F|, which
    counts a twist as well.  In others the axis is a segment, and `standing` gives the sign.  A com
    delta away moves the weight alone, so it takes rho |e x g| / |e x F|, at most rho / |F|.
    """
    axis, arc = axes.arc[b], region.arc[b]
    rho, mu = wrench.rho, read3(wrench.mu)
    force = add(g, read3(wrench.phi))
    size = length(force)
    if size < 1e-12:
        return -math.inf
    direction = scale(force, 1.0 / size)
    side, normal = read3(axis.along), read3(axis.normal)
    across = length(cross(side, direction))
    convex = region.counts.convex == 1
    if convex and across > 1e-12:
        lever = axis.distance * (dot(normal, force) + axis.moment)
        return float((lever - rho * length(cross(side, g))) / (across * size))
    through = scale(cross(force, mu), 1.0 / (size * size))
    start, stop = subtract(read3(arc.start), through), subtract(read3(arc.stop), through)
    away = axis_margin(start, stop, normal, False, direction)
    return float((away if standing and not convex else -away) - rho / size)


@njit(bare=True)
def loaded_verdict(region: Region, axes: Axes, wrench: Wrench, g: Vector) -> tuple[int, int, float]:
    """Return the seat that carries, the status (stands, rocks, tips), and the tip angle.

    The angle is in rad, and not negative where the robot does not tip.  With an uncertain com the
    status is that of the nominal one where no com in the ball tips.

    Where axes count as whole lines the robot stands inside all of them.  If the region is not
    convex, it stands too while the zero-moment point stays in one rest, and the larger of the two
    angles counts.
    """
    count = region.counts
    if count.accepted == 0:
        return -1, TIPS, -math.pi
    force, mu = add(g, read3(wrench.phi)), read3(wrench.mu)
    convex = count.convex == 1
    if length(mu) > 0.0:
        k, status = _seat_under_moment(region, force, mu)
    else:
        k, status = seat_under(region, force), TIPS
        cone = cone_of(region, unit(force)) if k >= 0 else -1
        if cone >= 0:
            k, status = region.cone[cone].seat, region.cone[cone].status
    standing, whole = status != TIPS, counts_whole(region, wrench)
    angle = math.pi if standing or whole else -math.pi
    for b in range(count.arcs):
        here = axis_angle(region, axes, b, wrench, standing, g)
        angle = min(angle, here) if standing or whole else max(angle, here)
    if whole and not convex:
        for f in range(count.accepted):
            if not region.seat[f].is_rest:
                continue
            here, facet = math.pi, region.facet[region.seat[f].facet]
            for e in range(facet.first, facet.first + facet.count):
                here = min(here, whole_axis_angle(axes.edge, e, g))
            if here > angle:
                angle = here
                k, status = (f, STANDS) if here >= 0.0 else (k, status)
    if k < 0 or angle < 0.0 or not (whole or standing):
        return k, TIPS, min(angle, JUST_OUTSIDE)
    # Inside all axes as whole lines, but as rounding has it on none of its rests: it may rock.
    if status == TIPS:
        status = STANDS if convex else ROCKS
    return k, status, angle


@njit(bare=True)
def measure_loaded(
    region: Region, axes: Axes, wrench: Wrench, g: Vector, wanted: Bools, out: Floats
) -> None:
    """Fill `out` with the channels of one direction, see `exact.measure`.

    All wanted channels but margin are computed always; energy_margin is NaN.
    """
    k, status, angle = loaded_verdict(region, axes, wrench, g)
    standing = status != TIPS
    for c in range(len(CHANNELS)):
        out[c] = math.nan
    out[TIP], out[FACET], out[STATUS] = angle, -1.0, status
    if standing:
        seat = region.seat[k]
        force, mu = add(g, read3(wrench.phi)), read3(wrench.mu)
        pierced = zero_moment_point(read3(seat.plane), force, mu)
        out[SDG] = length(subtract(pierced, read3(seat.centroid)))
        out[HEIGHT], out[FACET] = seat.height, k
    if not wanted[MARGIN]:
        return
    outward = not standing and region.counts.convex == 0
    margin = -math.inf if outward or region.counts.accepted == 0 else math.inf
    for b in range(region.counts.arcs):
        away = loaded_margin(region, axes, b, wrench, standing, g)
        margin = max(margin, away) if outward else min(margin, away)
    out[MARGIN] = max(margin, 0.0) if standing else min(margin, JUST_OUTSIDE)
