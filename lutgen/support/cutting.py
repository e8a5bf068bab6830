"""Cut a polygon in the plane of a facet by walls through the com."""

import math
from typing import NamedTuple

from lutgen.jit import njit
from lutgen.support.gather import ROW
from lutgen.support.table import SAME, Region
from lutgen.vector import Vector, along, cross, dot, length, scale, subtract, unit

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
    slack = SAME * ROW * length(ground.foot) * math.hypot(a, b)
    left, back = -1, 1.0
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
        point = place_on(ground, x, y)
        nearer = dot(cross(point, side), plane) / dot(plane, plane)
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
def without_short(region: Region, count: int, short: float) -> int:
    """Leave out corners that are one with the next; return how many are left."""
    swung, kept = region.swung[0], 0
    for k in range(count):
        after = (k + 1) % count
        if math.hypot(swung[after].x - swung[k].x, swung[after].y - swung[k].y) > short:
            swung[kept] = swung[k]
            kept += 1
    return kept
