"""Axles that swing: on the ground of a facet an axle carries the robot at its pivot alone.

Until its stops engage, an axle acts on the rest of the robot through one point: where its line
meets the plane through both contacts and the normal.  So the rest turns over the line from there
to a contact beside it, and its own weight decides.  The facet's polygon is cut along the planes
through those lines and the com of the rest, and where the axle would turn over one of its contacts.
Beyond the stops nothing is gained: the verdict is that before them.  `proofs.physics.swinging`
judges that by a physics engine.
"""

import math
from typing import NamedTuple

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.gather import ROW, forget_edges, write_edge
from lutgen.support.polygon import corners_of, has_bit, outline, plane_axes
from lutgen.support.primitive import FIRST, RADIUS, axle, support_contact
from lutgen.support.table import SAME, Region, ends_of
from lutgen.vector import along, cross, dot, length, read3, row, scale, subtract, unit, write3

# A line over which something turns, by two of its points.
Line = tuple[Vector, Vector]


class Ground(NamedTuple):
    """The plane of a facet: its unit normal, two unit axes, and the foot of the com."""

    normal: Vector
    first: Vector
    second: Vector
    foot: Vector


@njit(inline=True, bare=True)
def place_on(ground: Ground, x: float, y: float) -> Vector:
    """Return a point of the ground."""
    return along(along(ground.foot, ground.first, x), ground.second, y)


@njit(bare=True)
def line_on(wall: Vector, ground: Ground) -> Line:
    """Return two points of the line in which a plane through the com meets the ground."""
    way = unit(cross(ground.normal, wall))
    across = cross(way, ground.normal)
    point = along(ground.foot, across, -dot(wall, ground.foot) / dot(wall, across))
    if dot(cross(point, way), wall) < 0.0:
        way = scale(way, -1.0)
    return point, along(point, way, length(ground.foot))


@njit(bare=True)
def cut(region: Region, count: int, wall: Vector, line: Line, ground: Ground) -> int:
    """Cut the polygon in row 0 of `Region.swung` by a wall; return how many corners it has.

    The inner side of the wall through the com stays; over `line` the robot turns there.
    """
    old, new, kept = region.swung[0], region.swung[1], 0
    side, plane = subtract(line[1], line[0]), cross(line[0], line[1])
    a, b, c = dot(wall, ground.first), dot(wall, ground.second), dot(wall, ground.foot)
    hair = SAME * ROW * length(ground.foot) * math.hypot(a, b)
    left, back = -1, 1.0
    for k in range(count):
        here, there = old[k], old[(k + 1) % count]
        inside, beyond = a * here.x + b * here.y + c, a * there.x + b * there.y + c
        if inside >= -hair:
            new[kept] = here
            kept += 1
        if (inside >= -hair) == (beyond >= -hair):
            continue
        part = min(max(inside / (inside - beyond), 0.0), 1.0)
        x, y = here.x + part * (there.x - here.x), here.y + part * (there.y - here.y)
        between = here.begin + part * (here.end - here.begin)
        # How much nearer to the com the line is than the ground there: inverse, it is linear.
        point = place_on(ground, x, y)
        nearer = dot(cross(point, side), plane) / dot(plane, plane)
        new[kept].x, new[kept].y = x, y
        if inside >= -hair:
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
def without_short(region: Region, count: int, short: float) -> int:
    """Leave out corners that are one with the next; return how many are left."""
    swung, kept = region.swung[0], 0
    for k in range(count):
        after = (k + 1) % count
        if math.hypot(swung[after].x - swung[k].x, swung[after].y - swung[k].y) > short:
            swung[kept] = swung[k]
            kept += 1
    return kept


# A pivot counts as at least this part of the com's height below it: seen from the com one that is
# as high has no place on the ground.  A lower one holds less.
LEAST_DEPTH = 0.05
# Sine between an axle's line and the plane across it: of one along that plane there is no pivot.
ALONG = 0.1
# So many times as far from the pivot an axle's com counts at most where the rest pulls it up.
MOST = 20.0


class Axle(NamedTuple):
    """An axle on the ground: where it touches, its pivot, its direction, and its own com.

    `mass` is its share of the whole.  The `rest` is a load with a com and a share; it may pull the
    axle up by a part of its weight, and then the axle turns as if its com were at `pulled`.
    """

    ends: Line
    pivot: Vector
    way: Vector
    com: Vector
    mass: float
    rest: Vector
    share: float
    pulled: Vector


@njit(bare=True)
def _shown(region: Region, primitive: int, mask: int) -> int:
    """Return the place of a primitive among those in a mask that no other covers, or -1."""
    for k in range(region.counts.shown):
        if region.source[k] == primitive and has_bit(mask, k):
            return k
    return -1


@njit(bare=True)
def _axle_on(region: Region, axles: Floats, mask: int) -> tuple[int, int, int]:
    """Return the row of the axle that is in a mask, and its contacts, or -1.

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
def _read_axle(axles: Floats, k: int, ends: Line, normal: Vector) -> tuple[Axle, bool]:
    """Return the axle in row k on the ground, and True if it has a pivot there."""
    across = unit(cross(subtract(ends[1], ends[0]), normal))
    way, point = unit(axle(axles, k)), row(axles, k)
    slope = dot(way, across)
    good = abs(slope) >= ALONG
    pivot = along(point, way, dot(subtract(ends[0], point), across) / slope) if good else point
    rest, share = row(axles, k + 1), axles[k + 1, RADIUS]
    mass = 1.0 - share
    com = scale(rest, -share / mass) if mass > 0.0 else pivot
    # Pulled up, it turns over a contact sooner: at most as if at 45 deg.
    lever = subtract(com, pivot)
    rise = -dot(lever, normal)
    room = 0.5 * length(subtract(ends[1], ends[0])) - dot(subtract(ends[0], com), normal)
    further = max(min(room / rise, MOST), 0.0) if rise > 0.0 else MOST
    hung = mass * further / (1.0 + further)
    rest = scale(along(scale(rest, share), pivot, hung), 1.0 / (share + hung))
    pulled = along(com, lever, further)
    return Axle(ends, pivot, way, com, mass, rest, share + hung, pulled), good


@njit(bare=True)
def _find_sides(
    primitives: Floats, region: Region, ground: Ground, mask: int, axle: Axle
) -> tuple[int, int]:
    """Find the hull of contacts in a mask and the pivot, seen from the com of the rest.

    Returns how many sides it has and the name of the pivot.  The points are left in
    `Region.polygon`, and the names of the corners in `Region.ids`, counter-clockwise.
    """
    normal, points = ground.normal, region.polygon
    count, level = 0, -math.inf
    for i in range(primitives.shape[0]):
        if has_bit(mask, i):
            write3(points[count], support_contact(primitives, i, normal))
            level = max(level, dot(row(points, count), normal) - dot(axle.rest, normal))
            count += 1
    depth = dot(subtract(axle.pivot, axle.rest), normal)
    write3(points[count], along(axle.pivot, normal, max(LEAST_DEPTH * level - depth, 0.0)))
    for k in range(count + 1):
        arm = subtract(row(points, k), axle.rest)
        arm = scale(arm, level / dot(arm, normal))
        region.flat[k, 0], region.flat[k, 1] = dot(ground.first, arm), dot(ground.second, arm)
        region.ids[k] = k
    return outline(region.flat, region.ids, count + 1, SAME * ROW * level), count


@njit(bare=True)
def _cut_sides(
    region: Region, count: int, sides: int, pivot: int, axle: Axle, ground: Ground
) -> int:
    """Cut the polygon by the sides of the hull; return how many corners it has."""
    for m in range(sides):
        a, b = region.ids[m], region.ids[(m + 1) % sides]
        start, stop = row(region.polygon, a), row(region.polygon, b)
        begin, end = subtract(start, axle.rest), subtract(stop, axle.rest)
        line = scale(begin, axle.share), scale(end, axle.share)
        wall = cross(line[0], line[1])
        count = cut(region, count, wall, line, ground)
        if pivot in (a, b) and axle.mass > 0.0:
            # Through the hinge the axle's own weight turns the rest about any line but its own.
            side = subtract(stop, start)
            side = along(side, axle.way, -dot(side, axle.way))
            own = cross(side, subtract(axle.com, axle.pivot))
            wall = along(wall, own, axle.mass * axle.share)
            count = cut(region, count, wall, line, ground)
    return count


@njit(bare=True)
def _cut_axle(region: Region, count: int, axle: Axle, load: Vector, ground: Ground) -> int:
    """Cut the polygon where a load on the axle turns it over one of its contacts."""
    for side in range(2):
        near, far = subtract(axle.ends[side], load), subtract(axle.ends[1 - side], load)
        if dot(near, ground.normal) > SAME * length(ground.foot):  # Else it hangs below them.
            wall = cross(axle.way, near)
            wall = scale(wall, math.copysign(1.0, dot(wall, far)))
            count = cut(region, count, wall, line_on(wall, ground), ground)
    return count


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


@njit(bare=True)
def swing(primitives: Floats, axles: Floats, region: Region, f: int, same: float) -> int:
    """Write the edges of facet f anew if it touches an axle that swings.

    Its bits are all contacts near its plane; `axles` (2 a, 8) are as the head of `primitive` says,
    and `same` is a length that counts as none.  Returns 1 if it is done, 0 if the facet touches no
    axle, and -1 if the robot has no rest there.
    """
    facet, edge = region.facet[f], region.edge
    normal, mask = read3(facet.normal), int(facet.mask)
    k, i, j = _axle_on(region, axles, mask)
    if k < 0:
        return k + 1
    first, second = plane_axes(normal)
    ground = Ground(normal, first, second, scale(normal, facet.height))
    ends = support_contact(primitives, i, normal), support_contact(primitives, j, normal)
    axle, good = _read_axle(axles, k, ends, normal)
    others = mask & ~(1 << i | 1 << j)
    count = corners_of(primitives, mask, normal, ROW * same, region)
    for m in range(count):
        point, corner = support_contact(primitives, region.ids[m], normal), region.swung[0, m]
        corner.x, corner.y = dot(first, point), dot(second, point)
        corner.begin = corner.end = 1.0
    sides, pivot = _find_sides(primitives, region, ground, others, axle)
    if not good or sides == 0:
        return -1
    count = _cut_sides(region, count, sides, pivot, axle, ground)
    for load in (axle.pivot, axle.com, axle.pulled):
        count = _cut_axle(region, count, axle, load, ground)
    count = without_short(region, count, 10.0 * ROW * same)
    begin = region.counts.edges
    if count < 3 or begin + count > edge.shape[0]:
        return -1
    forget_edges(region, facet.first, facet.count)
    facet.first, facet.count, facet.swings = begin, count, 1
    kept = region.axle[f]
    kept.first, kept.second, kept.mass = i, j, axle.mass
    write3(kept.pivot, axle.pivot)
    write3(kept.way, axle.way)
    write3(kept.com, axle.com)
    region.counts.edges = begin + count
    for m in range(count):
        e, corner = begin + m, region.swung[0, m]
        point = place_on(ground, corner.x, corner.y)
        write_edge(region, e, f, _nearest(primitives, mask, normal, point), point)
        edge[e].raised[0], edge[e].raised[1] = 1.0 / corner.begin, 1.0 / corner.end
    for e in range(begin, begin + count):
        start, stop = ends_of(region, e)
        write3(edge[e].wall, unit(cross(start, stop)))
    return 1
