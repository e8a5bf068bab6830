"""Accepted facets, and which of them are rests: where the robot stands still.

The support polygon of a facet is that of all contacts within `contact_tolerance` of its plane, so
four wheels whose positions are off by a little make up one rectangle.
"""

from lutgen.jit import njit
from lutgen.support.gather import bit_count, leave_old_edges_out
from lutgen.support.pivots import swing
from lutgen.support.polygon import corners_of, measure_polygon, plane_axes
from lutgen.support.primitive import DISC, KIND, axle, support_contact, support_height
from lutgen.support.table import (
    ACCEPTED,
    EDGES,
    FACETS,
    SAME,
    Acceptance,
    Region,
    asks_nothing,
    rests_at,
)
from lutgen.vector import Floats, along, cross, dot, length, read3, scale, subtract, write3

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
    seat.is_rest = 1 if asks_nothing(accept) or (width > 0.0 and width >= accept.rest_width) else 0


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
    for f in range(count[FACETS]):
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
    for f in range(count[FACETS]):
        if facet[f].place < 0:
            continue
        place = 0
        for other in range(count[FACETS]):
            if facet[other].place >= 0 and other != f:
                place += facet[other].mask < facet[f].mask or (
                    facet[other].mask == facet[f].mask and other < f
                )
        facet[f].place = place
        _seat_at(primitives, region, place, f, accept)
        rests += seat[place].is_rest
        accepted += 1
    if rests == 0:
        for f in range(count[FACETS]):
            facet[f].place = -1
        accepted = 0
    count[ACCEPTED] = accepted
    for e in range(count[EDGES]):
        here, there = rests_at(region, e)
        if here < 0 or edge[e].twin < e:
            continue
        if length(subtract(read3(seat[here].normal), read3(seat[there].normal))) <= ONE_REST:
            old, new = seat[here].group, seat[there].group
            for k in range(accepted):
                if seat[k].group == old:
                    seat[k].group = new
