"""Convex polygons of contacts in a plane: corners, area centroid and width."""

import math

from lutgen.arrays import Floats, Ints, Vector
from lutgen.jit import njit
from lutgen.support.primitive import support_contact
from lutgen.support.table import Region
from lutgen.vector import along, cross, dot, row, subtract, unit


@njit(inline=True, bare=True)
def plane_axes(normal: Vector) -> tuple[Vector, Vector]:
    """Return two unit axes of a plane, right-handed with its unit normal."""
    across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
    first = unit(along(across, normal, -dot(across, normal)))
    return first, cross(normal, first)


@njit(bare=True)
def _left(flat: Floats, a: int, b: int, c: int) -> float:
    """Return twice the area of a triangle of rows, positive if it turns left."""
    x, y = flat[a, 0], flat[a, 1]
    return float((flat[b, 0] - x) * (flat[c, 1] - y) - (flat[b, 1] - y) * (flat[c, 0] - x))


@njit(bare=True)
def outline(flat: Floats, ids: Ints, count: int, near: float) -> int:
    """Find the corners of the convex hull of points in a plane (Andrew's monotone chain).

    The first `count` rows of `flat` (k, 2) are read and sorted; `ids` (3 k + 2,) has their names,
    and then those of the corners, counter-clockwise from the lowest on.  A point nearer than `near`
    (length) to another corner, or to the line between its neighbours, is no corner.  Returns how
    many there are; 0 if the points are in a line or too few.
    """
    for last in range(1, count):
        at = last
        while at > 0 and (
            flat[at, 0] < flat[at - 1, 0]
            or (flat[at, 0] == flat[at - 1, 0] and flat[at, 1] < flat[at - 1, 1])
        ):
            for axis in range(2):
                flat[at, axis], flat[at - 1, axis] = flat[at - 1, axis], flat[at, axis]
            ids[at], ids[at - 1] = ids[at - 1], ids[at]
            at -= 1
    chain, kept = ids[count:], 0
    for half in range(2):
        base = kept
        for step in range(count):
            k = step if half == 0 else count - 1 - step
            while kept - base > 1 and _left(flat, chain[kept - 2], chain[kept - 1], k) <= 0.0:
                kept -= 1
            chain[kept] = k
            kept += 1
        kept -= 1
    at = 0
    while at < kept and kept > 2:
        a, b, c = chain[(at + kept - 1) % kept], chain[at], chain[(at + 1) % kept]
        chord = math.hypot(flat[c, 0] - flat[a, 0], flat[c, 1] - flat[a, 1])
        step_before = math.hypot(flat[b, 0] - flat[a, 0], flat[b, 1] - flat[a, 1])
        if step_before <= near or _left(flat, a, b, c) <= near * chord:
            for k in range(at, kept - 1):
                chain[k] = chain[k + 1]
            kept -= 1
            at = 0
        else:
            at += 1
    lowest = 0
    for k in range(kept):
        chain[k] = ids[chain[k]]
        lowest = k if chain[k] < chain[lowest] else lowest
    for k in range(kept):
        ids[k] = chain[(lowest + k) % kept]
    return kept if kept > 2 else 0


@njit(bare=True)
def corners_of(primitives: Floats, mask: int, normal: Vector, near: float, region: Region) -> int:
    """Leave in `region.ids` the primitives at the corners of a plane's polygon; return how many.

    `mask`: those that touch the plane; counter-clockwise seen from outside.
    """
    first, second = plane_axes(normal)
    flat, ids = region.flat, region.ids
    count = 0
    for i in range(primitives.shape[0]):
        if has_bit(mask, i):
            point = support_contact(primitives, i, normal)
            x, y = dot(first, point), dot(second, point)
            # If contacts are one, the first counts, in every facet.
            fresh = True
            for other in range(count):
                fresh &= max(abs(flat[other, 0] - x), abs(flat[other, 1] - y)) > near
            if fresh:
                flat[count, 0], flat[count, 1], ids[count] = x, y, i
                count += 1
    return outline(flat, ids, count, near) if count > 2 else 0


@njit(inline=True, bare=True)
def has_bit(mask: int, i: int) -> bool:
    """Return True if bit i of a mask is set."""
    return (mask >> i) & 1 == 1


@njit(bare=True)
def measure_polygon(points: Floats, normal: Vector) -> tuple[Vector, float]:
    """Return the area centroid (Eqs 22 to 26, in 3-D) and the least width of a support polygon.

    `points` (k, 3) are its corners, counter-clockwise seen from where the unit `normal` points to.
    Triangles of a fan count by their area along the normal: contacts a little off the plane have
    no part in it.
    """
    origin, count = row(points, 0), points.shape[0]
    area, width, centroid = 0.0, math.inf, (0.0, 0.0, 0.0)
    for k in range(count):
        a, b = row(points, k), row(points, (k + 1) % count)
        inward = unit(cross(normal, subtract(b, a)))
        furthest = nearest = 0.0
        for other in range(count):
            depth = dot(subtract(row(points, other), a), inward)
            furthest, nearest = max(furthest, depth), min(nearest, depth)
        width = min(width, furthest - nearest)
        u, v = subtract(a, origin), subtract(b, origin)
        part = dot(cross(u, v), normal)
        area += part
        centroid = along(along(centroid, u, part), v, part)
    return along(origin, centroid, 1.0 / (3.0 * area)), width
