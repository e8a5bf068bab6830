"""Axles that swing: on the ground of a facet an axle carries the robot at its pivot alone.

Until its stops engage, an axle acts on the rest of the robot through one point: where its line
meets the plane through both contacts and the normal.  So the rest turns over the line from there
to a contact beside it, and its own weight decides.  The facet's polygon is cut along the planes
through those lines and the com of the rest, and where the axle would turn over one of its contacts.
Beyond the stops nothing is gained: the verdict is that before them.
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
# A line over which the robot turns: two points, which the com and they span its tip-over plane.
Line = tuple[Vector, Vector]


@njit(bare=True)
def _shown(region: Region, primitive: int, mask: int) -> int:
    """Return the place of a primitive among those in a mask that no other covers, or -1."""
    for k in range(region.counts[SHOWN]):
        if region.source[k] == primitive and has_bit(mask, k):
            return k
    return -1


@njit(bare=True)
def _axle_on(region: Region, axles: Floats, mask: int) -> tuple[int, int, int]:
    """Return the row of the axle that is in a mask, and its contacts; -1 if there is none.

    -2 if only one of its contacts is, or if there are two axles, on which nothing stands.
    """
    found = -1, -1, -1
    for k in range(0, axles.shape[0], 2):
        first, second = divmod(int(axles[k, RADIUS]), FIRST)
        i, j = _shown(region, first, mask), _shown(region, second, mask)
        if i < 0 and j < 0:
            continue
        if i < 0 or j < 0 or found[0] >= 0:
            return -2, -1, -1
        found = k, i, j
    return found


@njit(bare=True)
def _cut(region: Region, count: int, line: Line, axes: Line, middle: Vector) -> int:
    """Cut the polygon in row 0 of `Region.swung` along a line; return how many corners it has.

    What is on the side of start x stop stays.  `axes` and `middle` (times the height of the com)
    are the plane of the polygon.
    """
    old, new, kept = region.swung[0], region.swung[1], 0
    wall, side = cross(line[0], line[1]), subtract(line[1], line[0])
    a, b, c = dot(wall, axes[0]), dot(wall, axes[1]), dot(wall, middle)
    slack = SAME * ROW * length(middle) * math.hypot(a, b)
    square, left, back = dot(wall, wall), -1, 1.0
    for k in range(count):
        here, there = old[k], old[(k + 1) % count]
        inside, beyond = a * here.x + b * here.y + c, a * there.x + b * there.y + c
        if inside >= -slack:
            new[kept] = here
            kept += 1
        if (inside >= -slack) == (beyond >= -slack):
            continue
        part = min(max(inside / (inside - beyond), 0.0), 1.0)
        x, y = here.x + part * (there.x - here.x), here.y + part * (there.y - here.y)
        between = here.begin + part * (here.end - here.begin)
        # How much nearer to the com the line is than the ground there: inverse, it is linear.
        point = along(along(middle, axes[0], x), axes[1], y)
        nearer = dot(cross(point, side), wall) / square
        new[kept].x, new[kept].y = x, y
        if inside >= -slack:
            new[kept - 1].end = between
            new[kept].begin, left = nearer, kept
        else:
            new[kept].begin, new[kept].end, back = between, here.end, nearer
        kept += 1
    if left >= 0:
        new[left].end = back
    for k in range(kept):
        old[k] = new[k]
    return kept


@njit(bare=True)
def _pivot(axles: Floats, k: int, normal: Vector, ends: Line) -> tuple[Vector, bool]:
    """Return where an axle carries, and whether there is such a place."""
    across = unit(cross(subtract(ends[1], ends[0]), normal))
    line, point = unit(axle(axles, k)), row(axles, k)
    slope = dot(line, across)
    if abs(slope) < ALONG:
        return point, False
    return along(point, line, dot(subtract(ends[0], point), across) / slope), True


@njit(bare=True)
def _find_lines(
    primitives: Floats, region: Region, axes: Line, mask: int, load: Vector, pivot: Vector
) -> tuple[int, int]:
    """Find the hull of the contacts in a mask and the pivot, as the rest's com, `load`, sees it.

    Returns how many sides it has and the name of the pivot.  The points are left in
    `Region.polygon`, and the names of the corners in `Region.ids`, counter-clockwise.
    """
    normal, points = cross(axes[0], axes[1]), region.polygon
    count, level = 0, -math.inf
    for i in range(primitives.shape[0]):
        if has_bit(mask, i):
            write3(points[count], support_contact(primitives, i, normal))
            level = max(level, dot(row(points, count), normal) - dot(load, normal))
            count += 1
    # The pivot is the last one.
    depth = dot(subtract(pivot, load), normal)
    write3(points[count], along(pivot, normal, max(LEAST_DEPTH * level - depth, 0.0)))
    count += 1
    for k in range(count):
        arm = subtract(row(points, k), load)
        arm = scale(arm, level / dot(arm, normal))
        region.flat[k, 0], region.flat[k, 1] = dot(axes[0], arm), dot(axes[1], arm)
        region.ids[k] = k
    return outline(region.flat, region.ids, count, SAME * ROW * level), count - 1


@njit(bare=True)
def swing(primitives: Floats, axles: Floats, region: Region, f: int, same: float) -> int:
    """Write the edges of facet f anew if it touches an axle that swings.

    Parameters
    ----------
    primitives : (n, 8) float64
        The contacts, none covered by another.
    axles : (2 a, 8) float64
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
    facet, edge = region.facet[f], region.edge
    normal, mask = read3(facet.normal), int(facet.mask)
    k, i, j = _axle_on(region, axles, mask)
    if k < 0:
        return k + 1
    axes, middle = plane_axes(normal), scale(normal, facet.height)
    ends = support_contact(primitives, i, normal), support_contact(primitives, j, normal)
    pivot, good = _pivot(axles, k, normal, ends)
    if not good:
        return -1
    load, share = row(axles, k + 1), axles[k + 1, RADIUS]
    others = mask & ~(1 << i | 1 << j)
    lines, last = _find_lines(primitives, region, axes, others, load, pivot)
    for m in range(lines):
        # Between two contacts the whole robot turns; over the pivot the rest, a `share` of it.
        a, b = region.ids[m], region.ids[(m + 1) % lines]
        away, part = (load, share) if last in (a, b) else ((0.0, 0.0, 0.0), 1.0)
        # The walls are scratch memory until the rests are known.
        write3(region.wall[2 * m], scale(subtract(row(region.polygon, a), away), part))
        write3(region.wall[2 * m + 1], scale(subtract(row(region.polygon, b), away), part))
    if lines == 0:
        return -1
    count = corners_of(primitives, mask, normal, ROW * same, region)
    for m in range(count):
        point, corner = support_contact(primitives, region.ids[m], normal), region.swung[0, m]
        corner.x, corner.y = dot(axes[0], point), dot(axes[1], point)
        corner.begin = corner.end = 1.0
    for m in range(lines):
        line = row(region.wall, 2 * m), row(region.wall, 2 * m + 1)
        count = _cut(region, count, line, axes, middle)
    for side in range(2):
        near, far = subtract(ends[side], pivot), subtract(ends[1 - side], pivot)
        if dot(near, normal) > same:  # Else it hangs below its contacts.
            wall = cross(axle(axles, k), near)
            wall = scale(wall, math.copysign(1.0, dot(wall, far)))
            count = _cut(region, count, _on_ground(wall, normal, middle), axes, middle)
    count = _without_short(region, count, 10.0 * ROW * same)
    first = region.counts[EDGES]
    if count < 3 or first + count > edge.shape[0]:
        return -1
    forget_edges(region, facet.first, facet.count)
    facet.first, facet.count, facet.swings = first, count, 1
    for m in range(count):
        e, corner = first + m, region.swung[0, m]
        point = along(along(middle, axes[0], corner.x), axes[1], corner.y)
        write3(edge[e].point, point)
        edge[e].primitive = _nearest(primitives, mask, normal, point)
        edge[e].facet, edge[e].twin = f, -1
        edge[e].held[0], edge[e].held[1] = 1.0, 0.0
        edge[e].raised[0], edge[e].raised[1] = 1.0 / corner.begin, 1.0 / corner.end
    region.counts[EDGES] = first + count
    for e in range(first, first + count):
        start, stop = ends_of(region, e)
        write3(edge[e].wall, unit(cross(start, stop)))
    return 1


@njit(bare=True)
def _on_ground(wall: Vector, normal: Vector, middle: Vector) -> Line:
    """Return two points of the line in which a plane through the com meets the ground."""
    way = unit(cross(normal, wall))
    across = cross(way, normal)
    point = along(middle, across, -dot(wall, middle) / dot(wall, across))
    if dot(cross(point, way), wall) < 0.0:
        way = scale(way, -1.0)
    return point, along(point, way, length(middle))


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
