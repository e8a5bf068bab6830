"""Convex polygons of contact points that lie in one plane.

Owns the planar hull and the area centroid.  Corners are counter-clockwise seen from outside the
robot, that is looking against the plane's outward normal.
"""

import math

from lutgen.jit import njit
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, subtract


@njit(inline=True, bare=True)
def _swap(points: Floats, labels: Ints, a: int, b: int) -> None:
    for c in range(3):
        points[a, c], points[b, c] = points[b, c], points[a, c]
    labels[a, 0], labels[b, 0] = labels[b, 0], labels[a, 0]


@njit(inline=True, bare=True)
def _reverse(points: Floats, labels: Ints, begin: int, end: int) -> None:
    end -= 1
    while begin < end:
        _swap(points, labels, begin, end)
        begin += 1
        end -= 1


@njit(bare=True)
def convex_polygon(
    points: Floats, labels: Ints, begin: int, count: int, normal: Vector, tolerance: float
) -> int:
    """Reorder coplanar points in place to the corners of their convex polygon.

    Parameters
    ----------
    points : (k, 3) float64
        Coplanar points; rows [begin, begin + count) are read, and overwritten.
    labels : (k, 2) int64
        The first column is moved along with the points.
    begin, count : int
        Which rows.
    normal : tuple
        Unit normal of the plane, outward.
    tolerance : float
        Points closer than this are one point; a point that stands out of an edge by less than
        this is not a corner.

    Returns
    -------
    int
        Number of corners, from row `begin` on, counter-clockwise about `normal`, starting with
        the corner of the lowest label; 0 if the points are collinear.

    Notes
    -----
    Gift wrapping: the few touching points of a robot's facet do not repay sorting.  With equal
    turns the furthest point wins, which drops collinear and repeated points.
    """
    if count < 3:
        return 0
    corners = 0
    if count == 3:
        a, b, c = row(points, begin), row(points, begin + 1), row(points, begin + 2)
        turn = dot(cross(subtract(b, a), subtract(c, a)), normal)
        longest = max(length(subtract(b, a)), length(subtract(c, a)), length(subtract(c, b)))
        if abs(turn) <= tolerance * longest:
            return 0
        if turn < 0.0:
            _swap(points, labels, begin + 1, begin + 2)
        corners = 3
    else:
        corners = _wrap(points, labels, begin, begin + count, normal, tolerance) - begin
    lowest = 0
    for i in range(1, corners):
        if labels[begin + i, 0] < labels[begin + lowest, 0]:
            lowest = i
    if lowest > 0:
        # Rotate by three reversals.
        _reverse(points, labels, begin, begin + lowest)
        _reverse(points, labels, begin + lowest, begin + corners)
        _reverse(points, labels, begin, begin + corners)
    return corners if corners >= 3 else 0


@njit(bare=True)
def _wrap(
    points: Floats, labels: Ints, begin: int, end: int, normal: Vector, tolerance: float
) -> int:
    """Bring the corners of more than three points to the front; return the row after the last."""
    across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
    along = cross(normal, across)
    first = begin
    for i in range(begin + 1, end):
        step = subtract(row(points, i), row(points, first))
        ahead = dot(across, step)
        # An extreme edge has two ends; its lower end is a corner, its middle is not.
        if ahead < -tolerance or (ahead <= tolerance and dot(along, step) < 0.0):
            first = i
    _swap(points, labels, begin, first)
    last = begin + 1
    while last < end:
        here = row(points, last - 1)
        best = -1
        best_arm = (0.0, 0.0, 0.0)
        best_length = 0.0
        for i in range(begin, end):
            # Corners already placed cannot come again, save the first, which closes the polygon.
            if begin < i < last or (i == begin and last == begin + 1):
                continue
            arm = subtract(row(points, i), here)
            size = length(arm)
            if size <= tolerance:
                continue
            turn = dot(cross(best_arm, arm), normal)
            slack = tolerance * max(size, best_length)
            if best < 0 or turn < -slack or (turn <= slack and size > best_length):
                best, best_arm, best_length = i, arm, size
        if best <= begin:
            break
        _swap(points, labels, last, best)
        last += 1
    return last


@njit(bare=True)
def outline(flat: Floats, count: int, order: Ints, rank: Ints) -> int:
    """Find the corners of the convex polygon of points in a plane; return their number.

    Parameters
    ----------
    flat : (k, 2) float64
        Coordinates of the points in the plane; the first `count` rows are read.
    count : int
        How many points.
    order : (2 k + 1,) int64
        Receives the rows of the corners, counter-clockwise, from the lowest row on.
    rank : (k,) int64
        Overwritten.

    Returns
    -------
    int
        Number of corners; fewer than 3 if the points are collinear or too few.

    Notes
    -----
    Andrew's monotone chain.  It knows no tolerance: of points that are collinear but for rounding
    some may be corners, which alters neither area, centroid nor width by more than rounding.
    """
    for i in range(count):
        at = i
        while at > 0:
            before = rank[at - 1]
            if flat[before, 0] < flat[i, 0] or (
                flat[before, 0] == flat[i, 0] and flat[before, 1] <= flat[i, 1]
            ):
                break
            rank[at] = before
            at -= 1
        rank[at] = i
    end = 0
    for half in range(2):
        least = end + 1 if half == 1 else 2
        for step in range(half, count):
            i = rank[step if half == 0 else count - 1 - step]
            while end >= least:
                a, b = order[end - 2], order[end - 1]
                turn = (flat[b, 0] - flat[a, 0]) * (flat[i, 1] - flat[b, 1])
                if turn - (flat[b, 1] - flat[a, 1]) * (flat[i, 0] - flat[b, 0]) > 0.0:
                    break
                end -= 1
            order[end] = i
            end += 1
    # The first point has come again at the end.
    corners = end - 1
    lowest = 0
    for c in range(1, corners):
        if order[c] < order[lowest]:
            lowest = c
    for c in range(corners):
        order[corners + c] = order[c]
    for c in range(corners):
        order[c] = order[lowest + c]
    return corners


@njit(inline=True, bare=True)
def area_centroid(points: Floats, begin: int, end: int) -> Vector:
    """Return the area centroid of the convex polygon points[begin:end] (Eqs 22 to 26, in 3-D).

    The polygon is cut into a fan of triangles from its first corner; each is weighted with its
    own area, measured in the polygon's plane, so a vertical plane needs no special case.
    """
    origin = row(points, begin)
    total = 0.0
    x = y = z = 0.0
    for i in range(begin + 1, end - 1):
        a = subtract(row(points, i), origin)
        b = subtract(row(points, i + 1), origin)
        area = length(cross(a, b))
        total += area
        x += area * (a[0] + b[0])
        y += area * (a[1] + b[1])
        z += area * (a[2] + b[2])
    third = 1.0 / (3.0 * total) if total > 0.0 else math.nan
    return (
        origin[0] + x * third,
        origin[1] + y * third,
        origin[2] + z * third,
    )
