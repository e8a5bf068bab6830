"""Axles that swing: on the ground of a facet an axle carries the robot at its pivot alone.

Until its stops engage, an axle acts on the robot through one point: where its line meets the plane
through both contacts and the normal.  Seen from the com that point is a corner of the support
polygon in place of the two contacts.  No ray is carried beyond the polygon of the contacts
themselves, nor where the axle would turn over one of its own.  Beyond the stops nothing is gained.
"""

import math

from lutgen.jit import njit
from lutgen.support.gather import ROW, forget_edges
from lutgen.support.polygon import corners_of, has_bit, outline, plane_axes
from lutgen.support.primitive import FIRST, RADIUS, axle, support_contact
from lutgen.support.table import EDGES, SAME, SHOWN, Region, ends_of
from lutgen.vector import (
    Floats,
    Vector,
    along,
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

# A pivot counts as at least this part of the com's height below it: seen from the com one that is
# as high has no place on the ground.  A lower one holds less.
LEAST_DEPTH = 0.05
# Sine between an axle's line and the plane across it: of one along that plane there is no pivot.
ALONG = 0.1
Plane = tuple[Vector, Vector, Vector]


@njit(bare=True)
def _shown(region: Region, primitive: int) -> int:
    """Return the place of a primitive among those that no other one covers, or -1."""
    for k in range(region.counts[SHOWN]):
        if region.source[k] == primitive:
            return k
    return -1


@njit(bare=True)
def _ends(region: Region, axles: Floats, k: int, mask: int) -> tuple[int, int]:
    """Return the contacts of an axle that are in a mask, -1 for one that is not."""
    first, second = divmod(int(axles[k, RADIUS]), FIRST)
    i, j = _shown(region, first), _shown(region, second)
    return (i if i >= 0 and has_bit(mask, i) else -1), (j if j >= 0 and has_bit(mask, j) else -1)


@njit(bare=True)
def _pivot(
    axles: Floats, k: int, normal: Vector, ends: tuple[Vector, Vector]
) -> tuple[Vector, bool]:
    """Return where an axle carries, and whether there is such a place."""
    across = unit(cross(subtract(ends[1], ends[0]), normal))
    line = unit(axle(axles, k))
    slope = dot(line, across)
    if abs(slope) < ALONG:
        return row(axles, k), False
    point = along(row(axles, k), line, dot(subtract(ends[0], row(axles, k)), across) / slope)
    least = LEAST_DEPTH * dot(ends[0], normal)
    return along(point, normal, max(least - dot(point, normal), 0.0)), True


@njit(bare=True)
def _cut(region: Region, count: int, wall: Vector, plane: Plane) -> int:
    """Cut the polygon in row 0 of `Region.swung` by a wall through the com; return its corners."""
    old, new, kept = region.swung[0], region.swung[1], 0
    a, b, c = dot(wall, plane[0]), dot(wall, plane[1]), dot(wall, plane[2])
    c += SAME * ROW * length(plane[2]) * math.hypot(a, b)
    for k in range(count):
        here, there = old[k], old[(k + 1) % count]
        inside = a * here.x + b * here.y + c
        beyond = a * there.x + b * there.y + c
        if inside >= 0.0:
            new[kept] = here
            kept += 1
        if (inside >= 0.0) != (beyond >= 0.0):
            part = inside / (inside - beyond)
            cut = here.begin + part * (here.end - here.begin)
            new[kept].x = here.x + part * (there.x - here.x)
            new[kept].y = here.y + part * (there.y - here.y)
            if inside >= 0.0:
                new[kept - 1].end = cut
                new[kept].begin = new[kept].end = 1.0
            else:
                new[kept].begin, new[kept].end = cut, here.end
            kept += 1
    for k in range(kept):
        old[k] = new[k]
    return kept


@njit(bare=True)
def _carriers(primitives: Floats, axles: Floats, region: Region, mask: int, plane: Plane) -> int:
    """Fill row 1 of `Region.swung` with the pivots, and the contacts of a mask that swing not.

    Returns how many they are; 0 if the plane touches no axle, -1 if it touches one contact of an
    axle alone, or one that has no pivot there.
    """
    level, count, free = length(plane[2]), 0, mask
    normal = scale(plane[2], 1.0 / level)
    for k in range(axles.shape[0]):
        i, j = _ends(region, axles, k, mask)
        if i < 0 and j < 0:
            continue
        if i < 0 or j < 0:
            return -1
        free &= ~(1 << i | 1 << j)
        ends = support_contact(primitives, i, normal), support_contact(primitives, j, normal)
        pivot, good = _pivot(axles, k, normal, ends)
        if not good:
            return -1
        _add_carrier(region, count, scale(pivot, level / dot(pivot, normal)), plane)
        region.swung[1, count].begin = level / dot(pivot, normal)
        count += 1
    if count == 0:
        return 0
    for i in range(primitives.shape[0]):
        if has_bit(free, i):
            _add_carrier(region, count, support_contact(primitives, i, normal), plane)
            count += 1
    return count


@njit(bare=True)
def _add_carrier(region: Region, at: int, point: Vector, plane: Plane) -> None:
    """Write a point of the plane as a corner, and as a point of which to take the hull."""
    x, y = dot(plane[0], point), dot(plane[1], point)
    region.flat[at, 0], region.flat[at, 1], region.ids[at] = x, y, at
    corner = region.swung[1, at]
    corner.x, corner.y, corner.begin = x, y, 1.0


@njit(bare=True)
def _cut_axles(
    primitives: Floats, axles: Floats, region: Region, mask: int, plane: Plane, count: int
) -> int:
    """Cut the polygon where an axle would turn over one of its contacts; return its corners."""
    normal = unit(plane[2])
    for k in range(axles.shape[0]):
        i, j = _ends(region, axles, k, mask)
        if i < 0:
            continue
        ends = support_contact(primitives, i, normal), support_contact(primitives, j, normal)
        pivot, _ = _pivot(axles, k, normal, ends)
        line = axle(axles, k)
        for side in range(2):
            near, far = subtract(ends[side], pivot), subtract(ends[1 - side], pivot)
            if dot(near, normal) <= SAME * length(plane[2]):
                continue  # It hangs below its contacts.
            wall = unit(cross(line, near))
            wall = scale(wall, math.copysign(1.0, dot(wall, far)))
            count = _cut(region, count, wall, plane)
    return count


@njit(bare=True)
def swing(primitives: Floats, axles: Floats, region: Region, f: int, same: float) -> int:
    """Write the edges of facet f anew, with pivots in place of the contacts of axles.

    Parameters
    ----------
    primitives : (n, 8) float64
        The contacts, none covered by another.
    axles : (a, 8) float64
        See the head of `primitive`.
    region : Region
        With the facet, whose bits are all contacts near its plane.
    f : int
        The facet.
    same : float
        A length that counts as none.

    Returns
    -------
    int
        1 if it is done, 0 if the facet touches no axle, and -1 if the robot has no rest there.
    """
    facet, edge, first_edge = region.facet[f], region.edge, region.counts[EDGES]
    normal, mask = read3(facet.normal), int(facet.mask)
    one, two = plane_axes(normal)
    plane = one, two, scale(normal, facet.height)
    count = _carriers(primitives, axles, region, mask, plane)
    if count <= 0:
        return count
    count = outline(region.flat, region.ids, count, ROW * same)
    for k in range(count):
        here, after = region.ids[k], region.ids[(k + 1) % count]
        region.swung[0, k] = region.swung[1, here]
        region.swung[0, k].end = region.swung[1, after].begin
    corners = corners_of(primitives, mask, normal, ROW * same, region)
    for k in range(corners):
        start = support_contact(primitives, region.ids[k], normal)
        stop = support_contact(primitives, region.ids[(k + 1) % corners], normal)
        count = _cut(region, count, cross(start, stop), plane)
    count = _cut_axles(primitives, axles, region, mask, plane, count)
    count = _without_short(region, count, 10.0 * ROW * same)
    if count < 3 or first_edge + count > edge.shape[0]:
        return -1
    forget_edges(region, facet.first, facet.count)
    facet.first, facet.count, facet.swings = first_edge, count, 1
    for k in range(count):
        e, corner = first_edge + k, region.swung[0, k]
        point = along(along(plane[2], one, corner.x), two, corner.y)
        write3(edge[e].point, point)
        edge[e].primitive, edge[e].facet, edge[e].twin = (
            _nearest(primitives, mask, normal, point),
            f,
            -1,
        )
        edge[e].held[0], edge[e].held[1] = 1.0, 0.0
        edge[e].raised[0], edge[e].raised[1] = 1.0 / corner.begin, 1.0 / corner.end
    region.counts[EDGES] = first_edge + count
    for e in range(first_edge, first_edge + count):
        start, stop = ends_of(region, e)
        write3(edge[e].wall, unit(cross(start, stop)))
    return 1


@njit(bare=True)
def _without_short(region: Region, count: int, short: float) -> int:
    """Leave out corners that are one with the next; return how many are left."""
    swung, kept = region.swung[0], 0
    for k in range(count):
        after = (k + 1) % count
        if math.hypot(swung[after].x - swung[k].x, swung[after].y - swung[k].y) > short:
            swung[kept] = swung[k]
            kept += 1
    return kept


@njit(bare=True)
def _nearest(primitives: Floats, mask: int, normal: Vector, point: Vector) -> int:
    """Return the contact of a mask that is nearest to a point."""
    best, least = -1, math.inf
    for i in range(primitives.shape[0]):
        if has_bit(mask, i):
            away = length(subtract(support_contact(primitives, i, normal), point))
            if away < least:
                best, least = i, away
    return best
