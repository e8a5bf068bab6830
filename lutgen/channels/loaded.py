"""Stability under a wrench: forces beside the weight, and a com that lies anywhere in a ball.

Owns the channels of loaded robots in float64; without a wrench `plain` is faster and has the same
meaning.  Verdict and `tip_angle` are exact under forces alone and under an uncertain com alone,
with one exception: where forces have a moment and the region is not convex they are bounds from
below.  Under both together they are such bounds, too (docs/reference/conventions.md).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.angles import JUST_OUTSIDE, arc_distance
from lutgen.channels.axes import (
    ALONG,
    ALWAYS,
    BOUND,
    COSINE,
    DISTANCE,
    MOMENT,
    MU,
    NEAREST,
    NEVER,
    NORMAL,
    OFFSET,
    PHI,
    RHO,
    SINE,
    TOWARDS,
    Axes,
    add,
    part,
    pierced_first,
    rest,
    zero_moment_point,
)
from lutgen.channels.plain import axis_margin
from lutgen.jit import njit
from lutgen.quantities import CHANNELS
from lutgen.support import (
    ROCKS,
    STANDS,
    TIPS,
    Region,
    centroid_at,
    edges_at,
    facets_in,
    height_at,
    is_convex,
    is_rest_at,
    plane_at,
    segments_in,
    start_at,
    status_of,
    stop_at,
    supporting_facet,
)
from lutgen.vector import Bools, Floats, Vector, cross, dot, length, scale, subtract


@njit(inline=True)
def _asin(sine: float) -> float:
    return math.asin(min(max(sine, -1.0), 1.0))


@njit(inline=True)
def _at(axis: Floats, column: int) -> Vector:
    return axis[column], axis[column + 1], axis[column + 2]


@njit()
def turned_sine(axis: Floats, g: Vector) -> float:
    """Return the least m' . g over all planes through an axis turned by up to beta either way.

    m' = m cos(t) - a sin(t) for |t| <= beta, a the direction from the com towards the axis.
    """
    u, w = dot(_at(axis, NORMAL), g), dot(_at(axis, TOWARDS), g)
    if u < 0.0 and abs(w) * axis[COSINE] <= -u * axis[SINE]:
        return -math.sqrt(u * u + w * w)
    return float(axis[COSINE] * u - axis[SINE] * abs(w))


@njit()
def loaded_arc(
    axis: Floats, ends: Floats, start: Vector, stop: Vector, phi: Vector, g: Vector
) -> float:
    """Return the angle (rad) from g to where the resultant meets the axis between its ends."""
    m, offset = _at(axis, NORMAL), axis[OFFSET]
    aside = dot(m, g)
    flat = subtract(g, scale(m, aside))
    size = length(flat)
    if abs(offset) < 1.0 and size > 0.0:
        root = math.sqrt(1.0 - offset * offset) / size
        force = add(subtract(scale(flat, root), scale(m, offset)), phi)
        if dot(cross(m, start), force) >= 0.0 and dot(cross(stop, m), force) >= 0.0:
            return abs(_asin(aside) + math.asin(offset))
    nearest = math.pi
    for end in range(4):
        if ends[end, 0] == ends[end, 0]:
            away = length(subtract(g, _at(ends[end], 0)))
            nearest = min(nearest, 2.0 * math.asin(min(0.5 * away, 1.0)))
    return nearest


@njit()
def reduced_arc(axis: Floats, start: Vector, stop: Vector, rho: float, g: Vector) -> float:
    """Return the least angle (rad) from g to an axis seen from any com in the ball.

    It is the least angle(g, x) - asin(rho / |x|) over the points x of the axis, negative where
    the ray along g passes within rho of it.  Over the whole line the least is the angle to the
    plane through the axis turned by beta towards g; where that is met beyond an end, the end
    counts, because the points nearer than any angle fill a convex cone about g widened by rho.
    """
    aside = dot(_at(axis, NORMAL), g)
    sign = math.copysign(1.0, aside)
    out = sign * axis[SINE]
    towards = _at(axis, TOWARDS)
    ahead = axis[COSINE] * dot(towards, g) + out * aside
    if ahead > 0.0:
        along = _at(axis, ALONG)
        place = axis[DISTANCE] * axis[COSINE] * dot(along, g) / ahead
        if dot(start, along) <= place <= dot(stop, along):
            return _asin(axis[COSINE] * abs(aside) - axis[SINE] * dot(towards, g))
    nearest = math.pi
    for end in range(2):
        point = start if end == 0 else stop
        size = length(point)
        away = 2.0 * math.asin(min(0.5 * length(subtract(g, scale(point, 1.0 / size))), 1.0))
        nearest = min(nearest, away - math.asin(min(rho / size, 1.0)))
    return nearest


@njit(inline=True)
def whole_axis_angle(axis: Floats, g: Vector) -> float:
    """Return the signed angle (rad) from g to a whole axis, for any com in the ball."""
    if axis[BOUND] >= NEVER:
        return math.pi
    if axis[BOUND] <= ALWAYS:
        return -math.pi
    return _asin(turned_sine(axis, g)) + math.asin(axis[BOUND])


@njit(inline=True)
def counts_whole(convex: bool, wrench: Floats) -> bool:
    """Tell whether axes count as whole lines: of convex regions, and where only a bound is known.

    That is under a moment, and under a force with an uncertain com.
    """
    pulled = length(part(wrench, PHI)) > 0.0 and wrench[RHO] > 0.0
    return convex or pulled or length(part(wrench, MU)) > 0.0


class LoadedAxis(NamedTuple):
    """A segment of the boundary as an axis under a wrench.

    `start`, `stop`: its contact points relative to the com (length), body frame; `axis` (16,) and
    `ends` (4, 3): its rows of `Axes`.
    """

    start: Vector
    stop: Vector
    axis: NDArray[np.float64]
    ends: NDArray[np.float64]


@njit(inline=True)
def loaded_axis(region: Region, axes: Axes, b: int) -> LoadedAxis:
    """Return boundary segment b as an axis."""
    start, stop = start_at(region.segment, b), stop_at(region.segment, b)
    return LoadedAxis(start, stop, axes.axis[b], axes.ends[b])


@njit(bare=True)
def axis_angle(
    convex: bool, segment: LoadedAxis, wrench: Floats, standing: bool, g: Vector
) -> float:
    """Return the signed angle (rad) from g to one boundary segment under a wrench.

    Where the axis does not count as a whole line, `standing` of the nominal com gives the sign.
    """
    start, stop, axis, ends = segment
    if counts_whole(convex, wrench):
        return whole_axis_angle(axis, g)
    rho, phi = wrench[RHO], part(wrench, PHI)
    if rho == 0.0:
        away = loaded_arc(axis, ends, start, stop, phi, g)
        return away if standing else -away
    if standing:
        return reduced_arc(axis, start, stop, rho, g)
    away = arc_distance(start, stop, _at(axis, NORMAL), g)
    return max(-away - math.asin(min(rho / axis[NEAREST], 1.0)), -math.pi)


@njit(bare=True)
def loaded_margin(
    convex: bool, segment: LoadedAxis, wrench: Floats, standing: bool, g: Vector
) -> float:
    """Return the signed distance from the resultant's line to one axis, less what rho takes.

    Of a convex region the axis is a whole line and the distance (d m . F + e . M) / |e x F|, which
    counts a twist as well; of another one it is the segment, and `standing` gives the sign.  A com
    delta away moves the weight alone, so it takes rho |e x g| / |e x F|, at most rho / |F|.
    """
    start, stop, axis = segment.start, segment.stop, segment.axis
    rho, mu = wrench[RHO], part(wrench, MU)
    force = add(g, part(wrench, PHI))
    size = length(force)
    if size < 1e-12:
        return -math.inf
    direction = scale(force, 1.0 / size)
    along = _at(axis, ALONG)
    across = length(cross(along, direction))
    if convex and across > 1e-12:
        lever = axis[DISTANCE] * (dot(_at(axis, NORMAL), force) + axis[MOMENT])
        return float((lever - rho * length(cross(along, g))) / (across * size))
    through = scale(cross(force, mu), 1.0 / (size * size))
    start, stop = subtract(start, through), subtract(stop, through)
    away = axis_margin(start, stop, _at(axis, NORMAL), False, direction)
    return float((away if standing and not convex else -away) - rho / size)


@njit()
def _lowest_edge_plane(region: Region, edge_plane: Floats, k: int, g: Vector) -> float:
    """Return the least signed angle (rad) from g to the edge planes of one facet."""
    lowest = math.pi
    for e in range(*edges_at(region.span, k)):
        lowest = min(lowest, whole_axis_angle(edge_plane[e], g))
    return lowest


@njit()
def loaded_verdict(region: Region, axes: Axes, wrench: Floats, g: Vector) -> tuple[int, int, float]:
    """Return the facet that carries, whether the robot stands, rocks or tips, and its tip angle.

    The angle is in rad, and not negative where the robot does not tip.  With an uncertain com the
    status is that of the nominal one where no com in the ball tips.

    Where axes count as whole lines the robot stands inside all of them.  If the region is not
    convex, it stands too while the zero-moment point stays in one rest, and the larger of the two
    angles counts.
    """
    count = region.tally
    force, mu = add(g, part(wrench, PHI)), part(wrench, MU)
    convex = is_convex(count)
    if facets_in(count) == 0:
        return -1, TIPS, -math.pi
    if length(part(wrench, PHI)) + length(mu) > 0.0:
        k = pierced_first(region, force, mu)
        status = TIPS
        if k >= 0:
            k, status = rest(region, axes.edge_plane, force, k)
    else:
        k = supporting_facet(region.facet, facets_in(count), g)
        status = status_of(region, k, g)
    standing = status != TIPS
    whole = counts_whole(convex, wrench)
    angle = math.pi if standing or whole else -math.pi
    for b in range(segments_in(count)):
        segment = loaded_axis(region, axes, b)
        here = axis_angle(convex, segment, wrench, standing, g)
        angle = min(angle, here) if standing or whole else max(angle, here)
    if whole and not convex:
        for f in range(facets_in(count)):
            if not is_rest_at(region.span, f):
                continue
            here = _lowest_edge_plane(region, axes.edge_plane, f, g)
            if here > angle:
                angle = here
                k, status = (f, STANDS) if here >= 0.0 else (k, status)
    if k < 0 or angle < 0.0 or not (whole or standing):
        return k, TIPS, min(angle, JUST_OUTSIDE)
    # Inside all axes as whole lines, but as rounding has it on none of its rests: it may rock.
    if status == TIPS:
        status = STANDS if convex else ROCKS
    return k, status, angle


@njit()
def measure_loaded(
    region: Region,
    axes: Axes,
    wrench: Floats,
    g: Vector,
    wanted: Bools,
    out: Floats,
) -> None:
    """Fill `out` with the channels of one direction, see `plain.measure`.

    All wanted channels but margin are computed always; energy_margin is NaN.
    """
    count = region.tally
    k, status, angle = loaded_verdict(region, axes, wrench, g)
    standing = status != TIPS
    out[: len(CHANNELS)] = math.nan
    out[2] = angle
    out[5] = -1.0
    out[6] = status
    if standing:
        plane = plane_at(region.facet, k)
        pierced = zero_moment_point(plane, add(g, part(wrench, PHI)), part(wrench, MU))
        out[0] = length(subtract(pierced, centroid_at(region.facet, k)))
        out[1] = height_at(region.facet, k)
        out[5] = k
    if not wanted[3]:
        return
    convex = is_convex(count)
    outward = not standing and not convex
    margin = -math.inf if outward or facets_in(count) == 0 else math.inf
    for b in range(segments_in(count)):
        segment = loaded_axis(region, axes, b)
        away = loaded_margin(convex, segment, wrench, standing, g)
        margin = max(margin, away) if outward else min(margin, away)
    out[3] = max(margin, 0.0) if standing else min(margin, JUST_OUTSIDE)
