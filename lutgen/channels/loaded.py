"""Stability under a load: forces beside the weight, and a com that lies anywhere in a ball.

Owns the channels of loaded robots in float64; without a load `plain` is faster and has the same
meaning.  Verdict and `tip_angle` are exact under forces alone and under an uncertain com alone,
with one exception: where forces have a moment and the region is not convex they are bounds from
below.  Under both together they are such bounds, too (docs/reference/conventions.md).
"""

import math

import numpy as np
from numpy.typing import NDArray

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
    empty_axes,
    find_axes,
    part,
    pierced_first,
    rest,
    zero_moment_point,
)
from lutgen.channels.plain import CHANNELS, JUST_OUTSIDE, arc_distance, axis_margin
from lutgen.jit import njit, prange
from lutgen.support import (
    CENTROID,
    CONVEX,
    FACETS,
    FIRST,
    FIRST_AXIS,
    HEIGHT,
    PLANE,
    SECOND_AXIS,
    SEGMENTS,
    START,
    STOP,
    Limit,
    Region,
    empty_region,
    facet_table,
    find_facets,
    find_region,
    is_standing,
    robot_size,
    supporting_facet,
    vector_at,
)
from lutgen.vector import Bools, Floats, Ints, Vector, cross, dot, length, row, scale, subtract

# As in `each.measure_each`: the six channels, then along, aside and height beyond the region.
ROWS = len(CHANNELS) + 3


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
def counts_whole(convex: bool, load: Floats) -> bool:
    """Tell whether axes count as whole lines: of convex regions, and where only a bound is known.

    That is under a moment, and under a force with an uncertain com.
    """
    pulled = length(part(load, PHI)) > 0.0 and load[RHO] > 0.0
    return convex or pulled or length(part(load, MU)) > 0.0


@njit()
def axis_angle(
    convex: bool,
    axis: Floats,
    ends: Floats,
    start: Vector,
    stop: Vector,
    load: Floats,
    standing: bool,
    g: Vector,
) -> float:
    """Return the signed angle (rad) from g to one boundary segment under a load.

    Where the axis does not count as a whole line, `standing` of the nominal com gives the sign.
    """
    if counts_whole(convex, load):
        return whole_axis_angle(axis, g)
    rho, phi = load[RHO], part(load, PHI)
    if rho == 0.0:
        away = loaded_arc(axis, ends, start, stop, phi, g)
        return away if standing else -away
    if standing:
        return reduced_arc(axis, start, stop, rho, g)
    away = arc_distance(start, stop, _at(axis, NORMAL), g)
    return max(-away - math.asin(min(rho / axis[NEAREST], 1.0)), -math.pi)


@njit()
def loaded_margin(
    convex: bool,
    axis: Floats,
    start: Vector,
    stop: Vector,
    load: Floats,
    standing: bool,
    g: Vector,
) -> float:
    """Return the signed distance from the resultant's line to one axis, less what rho takes.

    Of a convex region the axis is a whole line and the distance (d m . F + e . M) / |e x F|, which
    counts a twist as well; of another one it is the segment, and `standing` gives the sign.  A com
    delta away moves the weight alone, so it takes rho |e x g| / |e x F|, at most rho / |F|.
    """
    rho, mu = load[RHO], part(load, MU)
    force = add(g, part(load, PHI))
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
def _lowest_wall(region: Region, wall: Floats, k: int, g: Vector) -> float:
    """Return the least signed angle (rad) from g to the walls of one facet."""
    lowest = math.pi
    for e in range(region.span[k, FIRST], region.span[k + 1, FIRST]):
        lowest = min(lowest, whole_axis_angle(wall[e], g))
    return lowest


@njit()
def loaded_verdict(
    region: Region, axes: Axes, load: Floats, least_cosine: float, g: Vector
) -> tuple[int, bool, float]:
    """Return the facet that carries, whether the robot stands, and its tip angle (rad).

    Where axes count as whole lines the robot stands inside all of them.  If the region is not
    convex, it stands too while the zero-moment point stays in one facet, and the larger of the two
    angles counts.
    """
    count, segment = region.tally, region.segment
    force, mu = add(g, part(load, PHI)), part(load, MU)
    convex = count[CONVEX] == 1
    if count[FACETS] == 0:
        return -1, False, -math.pi
    if length(part(load, PHI)) + length(mu) > 0.0:
        k = pierced_first(region, force, mu)
        standing = k >= 0
        if standing:
            k, standing = rest(region, axes.wall, force, k, least_cosine)
    else:
        k = supporting_facet(region.plate, count[FACETS], g)
        standing = is_standing(region.span, region.edge, region.link, k, g)
    whole = counts_whole(convex, load)
    angle = math.pi if standing or whole else -math.pi
    for b in range(count[SEGMENTS]):
        start, stop = vector_at(segment, b, START), vector_at(segment, b, STOP)
        here = axis_angle(convex, axes.axis[b], axes.ends[b], start, stop, load, standing, g)
        angle = min(angle, here) if standing or whole else max(angle, here)
    if whole and not convex:
        for f in range(count[FACETS]):
            here = _lowest_wall(region, axes.wall, f, g)
            if here > angle:
                angle = here
                k = f if here >= 0.0 else k
    standing = k >= 0 and angle >= 0.0 and (whole or standing)
    return k, standing, angle if standing else min(angle, JUST_OUTSIDE)


@njit()
def _measure(
    region: Region,
    axes: Axes,
    load: Floats,
    least_cosine: float,
    g: Vector,
    wanted: Bools,
    out: Floats,
) -> None:
    """Fill `out` (6,) with the channels of one direction, see `plain.measure`."""
    count, segment = region.tally, region.segment
    k, standing, angle = loaded_verdict(region, axes, load, least_cosine, g)
    out[0] = out[1] = out[4] = math.nan
    out[2] = angle
    out[5] = -1.0
    if standing:
        plane = vector_at(region.plate, k, PLANE)
        pierced = zero_moment_point(plane, add(g, part(load, PHI)), part(load, MU))
        out[0] = length(subtract(pierced, vector_at(region.plate, k, CENTROID)))
        out[1] = region.plate[k, HEIGHT]
        out[5] = k
    if not wanted[3]:
        return
    convex = count[CONVEX] == 1
    outward = not standing and not convex
    margin = -math.inf if outward or count[FACETS] == 0 else math.inf
    for b in range(count[SEGMENTS]):
        start, stop = vector_at(segment, b, START), vector_at(segment, b, STOP)
        away = loaded_margin(convex, axes.axis[b], start, stop, load, standing, g)
        margin = max(margin, away) if outward else min(margin, away)
    out[3] = max(margin, 0.0) if standing else min(margin, JUST_OUTSIDE)


@njit()
def _measure_posture(
    primitives: Floats, load: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools, out: Floats
) -> int:
    """Fill `out` (9, d) for one posture; return 1 where its facet table was too small."""
    n = primitives.shape[0]
    table, region = facet_table(n), empty_region(n)
    axes = empty_axes(region)
    values = np.empty(6)
    find_facets(table, primitives, limit[2])
    find_region(region, table, limit, robot_size(primitives))
    find_axes(region, load, axes)
    for d in range(gravity_dir.shape[0]):
        g = row(gravity_dir, d)
        _measure(region, axes, load, limit[1], g, wanted, values)
        for c in range(6):
            out[c, d] = values[c]
        force = add(g, part(load, PHI))
        k = supporting_facet(region.plate, region.tally[FACETS], force)
        out[6, d] = out[7, d] = out[8, d] = math.nan
        if k >= 0 and length(part(load, MU)) == 0.0:
            reach = 1.0 / dot(vector_at(region.plate, k, PLANE), force)
            out[6, d] = dot(vector_at(region.plate, k, FIRST_AXIS), force) * reach
            out[7, d] = dot(vector_at(region.plate, k, SECOND_AXIS), force) * reach
            out[8, d] = region.plate[k, HEIGHT]
    return int(table.tally[1])


@njit(parallel=True)
def measure_loaded(
    primitives: Floats, load: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools
) -> tuple[NDArray[np.float64], Ints]:
    """Measure m postures under d directions.

    Parameters
    ----------
    primitives : (m, n, 8) float64
        As `primitive.pack` makes them.
    load : (m, 7) float64
        From `load.loads`.
    gravity_dir : (m, d, 3) or (1, d, 3) float64
        Unit directions, pointing down, of each posture or of all.
    limit : tuple
        See `region.limits`; its least height is rho.
    wanted : (6,) bool
        Which of `CHANNELS` to compute; all but margin are computed always, energy_margin is NaN.

    Returns
    -------
    (m, 9, d) float64
        As `each.measure_each`; its last three rows are NaN under a moment.
    (m,) int64
        1 where a facet table was too small.
    """
    m = primitives.shape[0]
    out = np.empty((m, ROWS, gravity_dir.shape[1]))
    overflow = np.zeros(m, np.int64)
    for posture in prange(m):
        overflow[posture] = _measure_posture(
            primitives[posture],
            load[posture],
            gravity_dir[np.int64(posture) % np.int64(gravity_dir.shape[0])],
            limit,
            wanted,
            out[posture],
        )
    return out, overflow
