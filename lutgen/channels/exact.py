"""Channels of one posture under one direction of gravity, in float64: their definitions.

`rows` computes the same numbers for a sweep.  All directions are unit vectors in the body frame,
pointing down.

The energy margin is the least height over which the com must be lifted until the robot tips over:
over an edge of the rest that it stands on; or it rolls over a part of an edge that is held, and
goes on over an edge of the rest on which it lands.  One roll, one landing.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.arrays import Bools, Floats, Vector
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.quantities import CHANNELS
from lutgen.support import (
    TIPS,
    Acceptance,
    Region,
    arc_between,
    cone_of,
    edge_after,
    ends_of,
    is_inner,
    is_same_rest,
    rests_at,
    roll_over,
    turned,
)
from lutgen.vector import along, between, cross, dot, length, read3, scale, subtract

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


@njit(bare=True)
def tip_angle(region: Region, standing: bool, g: Vector) -> float:
    """Return the signed angular distance (rad) from g to the boundary of the standing region.

    Positive inside; pi where there is no boundary, -pi where there is no region.  For a convex
    region it is the least asin(m . g) over the tip-over planes, inside and outside: the angle of
    the force-angle measure of Papadopoulos and Rey for a pure gravity load.
    """
    count = region.counts
    if count.accepted == 0:
        return -math.pi
    if count.arcs == 0:
        return math.pi if standing else -math.pi
    if count.convex == 1:
        lowest = 1.0
        for b in range(count.arcs):
            lowest = min(lowest, dot(read3(region.arc[b].wall), g))
        angle = arcsine(lowest)
        return max(angle, 0.0) if standing else min(angle, JUST_OUTSIDE)
    nearest = 2.0
    for b in range(count.arcs):
        nearest = min(nearest, arc_nearness(region, b, g))
    angle = angle_of(nearest)
    return angle if standing else min(-angle, JUST_OUTSIDE)


@njit(inline=True)
def axis_energy(start: Vector, stop: Vector, wall: Vector, g: Vector) -> float:
    """Return how far the com rises while the robot turns over one axis; negative once past it.

    The com turns on a circle of radius rho about the axis; with U the part of `up` orthogonal to
    the axis the rise is rho |U| - R . U (Messuri and Klein; Hirose), R from the axis to the com.
    """
    edge = subtract(stop, start)
    edge = scale(edge, 1.0 / length(edge))
    arm = subtract(scale(edge, dot(start, edge)), start)
    up = subtract(scale(edge, dot(g, edge)), g)
    top = length(arm) * length(up)
    now = dot(arm, up)
    aside = dot(cross(edge, arm), up)
    # Where the com is nearly above the axis top and now are nearly equal: divide instead.
    rise = aside * aside / (top + now) if now > 0.0 else top - now
    return math.copysign(rise, dot(wall, g))


@njit(inline=True)
def _lowest_place(start: Vector, stop: Vector, g: Vector) -> float:
    """Return where on a segment, in [0, 1], a robot is balanced with its com least high.

    Balanced on a point x the com is |x| above it, and before g . x: on a line the difference is
    least where turning about the line leads to.
    """
    edge = subtract(stop, start)
    size = length(edge)
    if size == 0.0:
        return 0.0
    edge = scale(edge, 1.0 / size)
    begin, sine = dot(start, edge), dot(g, edge)
    foot = length(subtract(start, scale(edge, begin)))
    place = foot * sine / math.sqrt(max(1.0 - sine * sine, 1e-300)) - begin
    return min(max(place / size, 0.0), 1.0)


@njit(inline=True)
def segment_energy(start: Vector, stop: Vector, g: Vector) -> float:
    """Return how far the com rises until the robot is balanced on some point of a segment."""
    point = between(start, stop, _lowest_place(start, stop, g))
    # |x| - g . x without cancellation.
    aside, now, top = cross(point, g), dot(point, g), length(point)
    return dot(aside, aside) / (top + now) if now > 0.0 else top - now


@njit(bare=True)
def _over_rest(region: Region, k: int, came: int, g: Vector) -> float:
    """Return the least rise over an edge of rest k and its group but the one it was come over."""
    least = math.inf
    for here in range(region.counts.accepted):
        if not is_same_rest(region, here, k):
            continue
        facet = region.facet[region.seat[here].facet]
        for e in range(facet.first, facet.first + facet.count):
            if e != came and not is_inner(region, e):
                start, stop = ends_of(region, e)
                least = min(least, segment_energy(start, stop, g))
    return least


@njit(bare=True)
def _over_held(region: Region, e: int, g: Vector) -> float:
    """Return the least rise over the held part of an edge and then over one of the next rest."""
    edge, primitives = region.edge, region.shown[: region.counts.shown]
    here, there = rests_at(region, e)
    start, stop = ends_of(region, e)
    low, high = edge[e].held[0], edge[e].held[1]
    w = low + (high - low) * _lowest_place(between(start, stop, low), between(start, stop, high), g)
    pair = edge[e].primitive, edge[edge_after(region, e)].primitive
    normals = read3(region.seat[here].normal), read3(region.seat[there].normal)
    path, first, _ = arc_between(primitives, pair, normals)
    twist, sunk = roll_over(path, first)
    last, before = turned(normals[0], normals[1], twist, g), between(start, stop, w)
    beyond = _over_rest(region, there, edge[e].twin, last) - dot(sunk, g)
    return max(segment_energy(before, before, g), beyond)


@njit(bare=True)
def energy_margin(region: Region, k: int, g: Vector, nearest: float) -> float:
    """Return the energy margin (length) of a robot that stands on seat k under g.

    `nearest`: the least rise over the boundary, which is the answer if rests are all one group.
    """
    least, alone = math.inf, True
    for here in range(region.counts.accepted):
        if not is_same_rest(region, here, k):
            alone = alone and not region.seat[here].is_rest
            continue
        facet = region.facet[region.seat[here].facet]
        for e in range(facet.first, facet.first + facet.count):
            if is_inner(region, e):
                continue
            start, stop = ends_of(region, e)
            low, high = region.edge[e].held[0], region.edge[e].held[1]
            if low >= high:
                least = min(least, segment_energy(start, stop, g))
                continue
            least = min(least, _over_held(region, e, g))
            if low > 0.0:
                least = min(least, segment_energy(start, between(start, stop, low), g))
            if high < 1.0:
                least = min(least, segment_energy(between(start, stop, high), stop, g))
    return nearest if alone else least


NO_GROUPS = np.empty(0, np.int64)
SDG, HEIGHT, TIP, MARGIN, ENERGY, SHARE, FACET, STATUS = range(len(CHANNELS))


class Setting(NamedTuple):
    """Settings that all postures of a measurement share: acceptance, and the wanted channels.

    `groups` (n,) are those of `shares.least_share`.  With `plane` directions are given relative to
    the contact plane, and turned into the body where they stand, see `resting`.
    """

    acceptance: Acceptance
    wanted: NDArray[np.bool_]
    groups: NDArray[np.int64] = NO_GROUPS
    plane: bool = False


@njit(inline=True)
def axis_margin(start: Vector, stop: Vector, wall: Vector, convex: bool, g: Vector) -> float:
    """Return the horizontal distance from the com to one tip-over axis, positive on its inner side.

    Everything is projected along g.  In a convex region the axis counts as a whole line (McGhee
    and Frank); otherwise as the segment that it is, and the distance is not signed.
    """
    edge = subtract(stop, start)
    across = length(cross(edge, g))
    flat_start = along(start, g, -dot(start, g))
    if across <= 1e-12 * length(edge):
        side = -1.0 if convex else math.copysign(1.0, dot(wall, g))
        return side * length(flat_start)
    if convex:
        return math.copysign(abs(dot(cross(start, stop), g)) / across, dot(wall, g))
    flat_edge = along(edge, g, -dot(edge, g))
    part = -dot(flat_start, flat_edge) / (across * across)
    return length(along(flat_start, flat_edge, min(max(part, 0.0), 1.0)))


@njit(bare=True)
def _margins(
    region: Region, seat: int, standing: bool, g: Vector, wants_energy: bool
) -> tuple[float, float]:
    """Return `margin` and `energy_margin` of a robot that stands on a seat, or tips."""
    count = region.counts
    if count.accepted == 0:
        return -math.inf, -math.inf
    convex = count.convex == 1
    margin = energy = math.inf
    for b in range(count.arcs):
        arc = region.arc[b]
        start, stop, wall = read3(arc.start), read3(arc.stop), read3(arc.wall)
        margin = min(margin, axis_margin(start, stop, wall, convex, g))
        if wants_energy:
            rise = axis_energy(start, stop, wall, g) if convex else segment_energy(start, stop, g)
            energy = min(energy, rise)
    if standing:
        if wants_energy and count.arcs > 0:
            energy = energy_margin(region, seat, g, energy)
        return max(margin, 0.0), max(energy, 0.0)
    if not convex:
        margin, energy = -margin, -energy
    return min(margin, JUST_OUTSIDE), min(energy, JUST_OUTSIDE)


@njit(bare=True)
def measure(region: Region, g: Vector, wanted: Bools, out: Floats) -> None:
    """Fill `out` with the channels of one direction, in the order of `CHANNELS`.

    `wanted` (bool) skips the costly ones, and `least_share` is left to `shares`.  Outside the
    standing region `sdg` and `height` are NaN, `facet` is -1, `status` is TIPS and the others are
    negative.
    """
    k = cone_of(region, g)
    out[SDG] = out[HEIGHT] = math.nan
    out[FACET], out[STATUS] = -1.0, TIPS
    place = -1
    if k >= 0:
        place = region.cone[k].seat
        seat = region.seat[place]
        one, two = dot(read3(seat.axes[0]), g), dot(read3(seat.axes[1]), g)
        out[SDG] = math.sqrt(one * one + two * two) / dot(read3(seat.plane), g)
        out[HEIGHT] = seat.height
        out[FACET], out[STATUS] = place, region.cone[k].status
    if wanted[TIP]:
        out[TIP] = tip_angle(region, k >= 0, g)
    if wanted[MARGIN] or wanted[ENERGY]:
        out[MARGIN], out[ENERGY] = _margins(region, place, k >= 0, g, wanted[ENERGY])


def checked_directions(gravity_dir: ArrayLike) -> NDArray[np.float64]:
    """Return (g, 3) unit directions; refuse other shapes, zero length, NaN and infinity."""
    directions = np.asarray(gravity_dir, dtype=np.float64)
    if directions.ndim == 1:
        directions = directions[None, :]
    if directions.ndim != 2 or directions.shape[1] != 3:
        raise InputError(
            f"gravity_dir must have the shape (g, 3) (got {np.shape(gravity_dir)}); "
            "give one row x, y, z per direction"
        )
    return np.ascontiguousarray(unit_directions(directions))
