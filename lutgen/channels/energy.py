"""The energy margin: the least height over which the com must be lifted until the robot tips over.

The robot tips over an edge of the rest that it stands on; or it rolls over a part of an edge that
is held, and goes on over an edge of the rest on which it lands.  One roll, one landing.
"""

import math

from lutgen.jit import njit
from lutgen.support import (
    ACCEPTED,
    SHOWN,
    Region,
    arc_between,
    arrived,
    edge_after,
    ends_of,
    is_inner,
    is_same_rest,
    rests_at,
    roll_over,
)
from lutgen.vector import Vector, between, cross, dot, length, read3, scale, subtract


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
    for here in range(region.counts[ACCEPTED]):
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
    edge, primitives = region.edge, region.shown[: region.counts[SHOWN]]
    here, there = rests_at(region, e)
    start, stop = ends_of(region, e)
    low, high = edge[e].held[0], edge[e].held[1]
    w = low + (high - low) * _lowest_place(between(start, stop, low), between(start, stop, high), g)
    pair = edge[e].primitive, edge[edge_after(region, e)].primitive
    normals = read3(region.seat[here].normal), read3(region.seat[there].normal)
    path, first, _ = arc_between(primitives, pair, normals)
    roll = roll_over(path, first)
    before = between(start, stop, w)
    beyond = _over_rest(region, there, edge[e].twin, arrived(roll, g)) - dot(roll.sunk, g)
    return max(segment_energy(before, before, g), beyond)


@njit(bare=True)
def energy_margin(region: Region, k: int, g: Vector, nearest: float) -> float:
    """Return the energy margin (length) of a robot that stands on seat k under g.

    `nearest`: the least rise over the boundary, which is the answer if rests are all one group.
    """
    least, alone = math.inf, True
    for here in range(region.counts[ACCEPTED]):
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
