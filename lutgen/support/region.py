"""Standing region of one posture: rests, convex cones with plane walls, and the boundary's arcs.

A rest is an accepted facet on which the robot stands still.  The support polygon of a facet is that
of all contacts within `contact_tolerance` of its plane, so four wheels whose positions are off by a
little make up one rectangle.
"""

import math

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.gather import bit_count, leave_old_edges_out
from lutgen.support.pivots import swing
from lutgen.support.polygon import corners_of, measure_polygon, plane_axes
from lutgen.support.primitive import DISC, KIND, axle, support_contact, support_height
from lutgen.support.table import (
    SAME,
    STANDS,
    Acceptance,
    Region,
    edge_after,
    ends_of,
    is_slit,
    rests_at,
    seat_of,
)
from lutgen.vector import (
    add,
    along,
    between,
    cross,
    dot,
    length,
    read3,
    row,
    scale,
    subtract,
    unit,
    write3,
)

# Rests that a shorter turn (rad) joins are one rest.
ONE_REST = 2e-4


@njit(bare=True)
def _is_accepted(
    primitives: Floats, region: Region, f: int, accept: Acceptance, same: float
) -> bool:
    """Return True if a facet faces down below the com, and no wheel lies on its face there."""
    facet = region.facet[f]
    normal = read3(facet.normal)
    if not (facet.height > max(accept.least_height, same) and -normal[2] > accept.steepest):
        return False
    for e in range(facet.first, facet.first + facet.count):
        i = region.edge[e].primitive
        sine = length(cross(axle(primitives, i), normal))
        if primitives[i, KIND] == DISC and sine < accept.face:
            return False
    return True


@njit(bare=True)
def _seat_at(primitives: Floats, region: Region, place: int, f: int, accept: Acceptance) -> None:
    """Fill the row `place` of the accepted facets."""
    seat = region.seat[place]
    facet = region.facet[f]
    normal, height, mask, corners = read3(facet.normal), facet.height, facet.mask, facet.count
    for k in range(corners):
        write3(region.polygon[k], read3(region.edge[facet.first + k].point))
    if bit_count(mask) > corners and facet.swings == 0:
        corners = corners_of(primitives, mask, normal, 0.0, region)
        for k in range(corners):
            write3(region.polygon[k], support_contact(primitives, region.ids[k], normal))
    points = region.polygon[:corners]
    centroid, width = measure_polygon(points, normal)
    one, two = plane_axes(normal)
    plane = scale(normal, 1.0 / height)
    write3(seat.normal, normal)
    write3(seat.plane, plane)
    write3(seat.centroid, centroid)
    write3(seat.axes[0], along(one, plane, -dot(one, centroid)))
    write3(seat.axes[1], along(two, plane, -dot(two, centroid)))
    seat.height, seat.mask, seat.facet, seat.group = height, mask, f, place
    seat.is_rest = (
        1 if accept.rock_angle == math.inf or (width > 0.0 and width >= accept.rest_width) else 0
    )


@njit(bare=True)
def find_rests(
    primitives: Floats, axles: Floats, region: Region, accept: Acceptance, size: float
) -> None:
    """Fill the accepted facets of one posture; none if there is no rest among them.

    If every gap counts (`rock_angle` infinite) every accepted facet is a rest.
    """
    facet, edge, seat, count = region.facet, region.edge, region.seat, region.counts
    same = SAME * size
    tolerance = accept.contact_tolerance
    near = max(tolerance if tolerance >= 0.0 else -tolerance * size, same)
    for f in range(count.facets):
        facet[f].place = 0 if _is_accepted(primitives, region, f, accept, same) else -1
        if facet[f].place == 0:
            normal, level = read3(facet[f].normal), facet[f].height
            for i in range(primitives.shape[0]):
                if level - support_height(primitives, i, normal) <= near:
                    facet[f].mask |= 1 << i
            if axles.shape[0] > 0 and swing(primitives, axles, region, f, same) < 0:
                facet[f].place = -1
    if axles.shape[0] > 0:
        leave_old_edges_out(region)
    accepted = rests = 0
    for f in range(count.facets):
        if facet[f].place < 0:
            continue
        place = 0
        for other in range(count.facets):
            if facet[other].place >= 0 and other != f:
                place += facet[other].mask < facet[f].mask or (
                    facet[other].mask == facet[f].mask and other < f
                )
        facet[f].place = place
        _seat_at(primitives, region, place, f, accept)
        rests += seat[place].is_rest
        accepted += 1
    if rests == 0:
        for f in range(count.facets):
            facet[f].place = -1
        accepted = 0
    count.accepted = accepted
    for e in range(count.edges):
        here, there = rests_at(region, e)
        if here < 0 or edge[e].twin < e:
            continue
        if length(subtract(read3(seat[here].normal), read3(seat[there].normal))) <= ONE_REST:
            old, new = seat[here].group, seat[there].group
            for k in range(accepted):
                if seat[k].group == old:
                    seat[k].group = new


# Sine within which a direction counts as on a wall, where the robot stands.  Rounding is 1e-15.
ON_AXIS = 1e-12
# A region that is concave by less than this (sine) is convex, and sides shorter than this part of
# their distance have no plane.
NOISE = 1e-4
# Directions nearer than this (rad) make no arc.
NO_ARC = 1e-12
# So many times NOISE beyond a short side another wall must have closed the region, by at least this
# part of NOISE: a sliver's long sides all but never meet.
BESIDE, CLOSED = 4.0, 0.1


@njit(inline=True, bare=True)
def add_wall(region: Region, normal: Vector) -> None:
    """Append a unit inward normal to the walls."""
    write3(region.wall[region.counts.walls], normal)
    region.counts.walls += 1


@njit(bare=True)
def add_arc(region: Region, start: Vector, stop: Vector, contacts: tuple[int, int]) -> None:
    """Append a piece of the boundary; the region is on the side of start x stop.

    The sine squared of the distance of a direction g is (wall . g)^2 + max(0, |along . g| - amid .
    g)^2: `amid` is the unit vector to the arc's middle times the sine of half of it, and `along`
    its unit direction there times the cosine; `spread` is the cotangent of half of it, squared.
    """
    a, b = unit(start), unit(stop)
    side, middle = subtract(b, a), add(a, b)
    long, wide = length(side), length(middle)
    if long < NO_ARC:
        return
    arc = region.arc[region.counts.arcs]
    write3(arc.start, start)
    write3(arc.stop, stop)
    write3(arc.wall, unit(cross(middle, side)))
    write3(arc.along, scale(side, 0.5 * wide / long))
    write3(arc.amid, scale(middle, 0.5 * long / wide))
    arc.spread = wide * wide / (long * long)
    arc.contacts[0], arc.contacts[1] = contacts
    region.counts.arcs += 1


@njit(bare=True)
def add_rests(region: Region) -> None:
    """Add the cones of the rests, the first ones."""
    cone, count = region.cone, region.counts
    count.cones = count.walls = count.arcs = 0
    for k in range(count.accepted):
        if not region.seat[k].is_rest:
            continue
        facet, last = region.facet[region.seat[k].facet], count.cones
        cone[last].first, cone[last].count = count.walls, facet.count
        cone[last].seat, cone[last].status = k, STANDS
        for e in range(facet.first, facet.first + facet.count):
            add_wall(region, read3(region.edge[e].wall))
        count.cones = last + 1


@njit(bare=True)
def add_boundary(region: Region, gaps: int) -> None:
    """Add the parts of each rest's edges that are not held, and note if the region is convex.

    `gaps`: how many there are, but for those between rests of a group.
    """
    edge, count = region.edge, region.counts
    for e in range(count.edges):
        here = seat_of(region, e)
        if here < 0 or not region.seat[here].is_rest:
            continue
        if rests_at(region, e)[1] >= 0 and edge[e].twin < e and is_slit(region, e):
            continue  # It is there already, for the other rest.
        start, stop = ends_of(region, e)
        low, high = edge[e].held[0], edge[e].held[1]
        pair = edge[e].primitive, edge[edge_after(region, e)].primitive
        if low >= high:
            add_arc(region, start, stop, pair)
        else:
            if low > 0.0:
                add_arc(region, start, between(start, stop, low), pair)
            if high < 1.0:
                add_arc(region, between(start, stop, high), stop, pair)
    count.convex = 1 if gaps == 0 and _is_convex(region) else 0
    if count.convex == 1:
        _leave_short_out(region)


@njit(bare=True)
def _is_short(region: Region, b: int) -> bool:
    """Return True if an arc is so short that noise decides where its plane is."""
    start = read3(region.arc[b].start)
    return length(subtract(read3(region.arc[b].stop), start)) <= NOISE * length(start)


@njit(bare=True)
def _is_noise(region: Region, b: int) -> bool:
    """Return True if an arc is short, and longer ones close the region beside it.

    In a region as narrow as that, which is a sliver, every arc counts.
    """
    if not _is_short(region, b):
        return False
    beyond = along(unit(read3(region.arc[b].start)), read3(region.arc[b].wall), -BESIDE * NOISE)
    for other in range(region.counts.arcs):
        inside = dot(read3(region.arc[other].wall), beyond)
        if inside < -CLOSED * NOISE and not _is_short(region, other):
            return True
    return False


@njit(bare=True)
def _is_convex(region: Region) -> bool:
    """Return True if every corner of every rest is inside every tip-over plane, but for noise."""
    edge = region.edge
    for b in range(region.counts.arcs):
        if _is_noise(region, b):
            continue
        normal = read3(region.arc[b].wall)
        for e in range(region.counts.edges):
            here = seat_of(region, e)
            if here >= 0 and region.seat[here].is_rest:
                point = read3(edge[e].point)
                if dot(normal, point) < -NOISE * length(point):
                    return False
    return True


@njit(bare=True)
def _leave_short_out(region: Region) -> None:
    """Take the arcs out of a convex region's boundary whose planes are noise."""
    arcs, kept = region.counts.arcs, 0
    for b in range(arcs):
        if not _is_noise(region, b):
            region.arc[kept] = region.arc[b]
            kept += 1
    region.counts.arcs = kept


@njit(bare=True)
def cone_of(region: Region, g: Vector) -> int:
    """Return the cone that a unit direction is in, the first of several; -1 for none."""
    for k in range(region.counts.cones):
        inside = True
        for w in range(region.cone[k].first, region.cone[k].first + region.cone[k].count):
            inside &= dot(row(region.wall, w), g) >= -ON_AXIS
        if inside:
            return k
    return -1


@njit(bare=True)
def seat_under(region: Region, g: Vector) -> int:
    """Return the accepted facet whose plane the ray along g pierces first, or -1.

    Ties go to the lower index.
    """
    best, nearest = -1, 0.0
    for k in range(region.counts.accepted):
        rate = dot(read3(region.seat[k].plane), g)
        if rate > nearest * (1.0 + 1e-12):
            best, nearest = k, rate
    return best
