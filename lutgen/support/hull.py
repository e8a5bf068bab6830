"""Support facets of point contacts: the facets of their hull.

Owns the search for point contacts: it finds one facet and rolls the plane over each edge onto the
next, so its cost grows with facets times contacts, not with the number of triples.  Contacts within
`RELATIVE_TOLERANCE` of a plane touch it, which is right as long as none is near enough to it to
matter and further than rounding; where one is, the search says so, and `rounds` is asked.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.polygon import convex_polygon
from lutgen.support.table import (
    BACK,
    DOUBT,
    FIRST,
    FOUND,
    MASK,
    MAX_PRIMITIVES,
    NEIGHBOUR,
    OUTSIDE,
    OVERFLOW,
    RELATIVE_TOLERANCE,
    UNKNOWN,
    VERTEX,
    Hull,
    Workspace,
    join,
    matching_corner,
    put,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract

# Two normals with a larger scalar product (1.4e-5 rad) are one.
SAME_NORMAL = 1.0 - 1e-10
# Parts of the size: a contact further from a plane than the first and nearer than the second may
# touch it or not, and which it is cannot be told for each plane by itself.
ROUNDING, CLEAR = 1e-13, 1e-8


@njit(bare=True)
def add_facet(
    hull: Hull,
    owner: Ints,
    primitives: Floats,
    normal: Vector,
    height: float,
    mask: int,
    size: float,
) -> int:
    """Enter a plane that has no primitive below it; return its index, or -1 if it is no facet.

    `owner` (n, n) holds the facet and the corner at which the edge between two contacts begins, or
    `OUTSIDE`.
    """
    count, facet, span, corner, link = hull
    n = primitives.shape[0]
    new = count[FOUND]
    begin = span[new, FIRST]
    if new + 1 >= facet.shape[0] or begin + n > link.shape[0]:
        count[OVERFLOW] = 1
        return OUTSIDE
    for f in range(new):
        if span[f, MASK] == mask and dot(row(facet, f), normal) > SAME_NORMAL:
            return f
    touching = 0
    for i in range(n):
        # Of contacts at one place the first stands for all, in every facet.
        first = mask >> i & 1 == 1
        for t in range(touching):
            apart = subtract(row(primitives, i), row(corner, begin + t))
            first = first and dot(apart, apart) > (RELATIVE_TOLERANCE * size) ** 2
        if first:
            put(corner, begin + touching, 0, row(primitives, i))
            link[begin + touching, VERTEX] = i
            touching += 1
    corners = convex_polygon(corner, link, begin, touching, normal, RELATIVE_TOLERANCE * size)
    if corners == 0:
        return OUTSIDE
    for t in range(corners):
        at = begin + t
        link[at, NEIGHBOUR], link[at, BACK] = UNKNOWN, OUTSIDE
        # Two facets of points have one edge in common at most, so the plane need not be rolled over
        # an edge whose two facets are known.
        i, j = link[at, VERTEX], link[at + 1 if t + 1 < corners else begin, VERTEX]
        facing = owner[j, i]
        owner[i, j] = new * MAX_PRIMITIVES + t
        if facing >= 0:
            f = facing // MAX_PRIMITIVES
            join(link, new, at, f, span[f, FIRST] + facing % MAX_PRIMITIVES)
    facet[new, 0], facet[new, 1], facet[new, 2] = normal
    facet[new, 3] = height
    span[new, MASK] = mask
    span[new + 1, FIRST] = begin + corners
    count[FOUND] = new + 1
    return int(new)


@njit(inline=True, bare=True)
def _first_touched(
    primitives: Floats,
    normal: Vector,
    base: Vector,
    outward: Vector,
    i: int,
    j: int,
    tolerance: float,
) -> int:
    """Return the primitive that a plane turning about an axis in it touches first, or -1.

    The plane has unit `normal`, holds `base`, and its part along `outward` sinks.  Primitives `i`
    and `j` and whatever else lies on the axis or behind it in the plane are left out.
    """
    best = -1
    best_ahead = best_depth = 0.0
    for k in range(primitives.shape[0]):
        if k in (i, j):
            continue
        arm = subtract(row(primitives, k), base)
        ahead = dot(arm, outward)
        depth = max(-dot(arm, normal), 0.0)
        if depth <= tolerance and ahead <= tolerance:
            continue
        # Angles are in [0, pi), so the sign of the cross product orders them without an arctangent.
        if best < 0 or ahead * best_depth - best_ahead * depth > 0.0:
            best, best_ahead, best_depth = k, ahead, depth
    return best


@njit(bare=True)
def _roll(hull: Hull, owner: Ints, primitives: Floats, f: int, at: int, size: float) -> int:
    """Return the facet reached by rolling f over the edge that starts at corner `at`, or -1."""
    facet, span, corner, link = hull.facet, hull.span, hull.corner, hull.link
    following = at + 1 if at + 1 < span[f + 1, FIRST] else span[f, FIRST]
    p, q = row(corner, at), row(corner, following)
    i, j = link[at, VERTEX], link[following, VERTEX]
    outward = cross(subtract(q, p), row(facet, f))
    outward = scale(outward, 1.0 / length(outward))
    tolerance = RELATIVE_TOLERANCE * size
    k = _first_touched(primitives, row(facet, f), p, outward, i, j, tolerance)
    if k < 0:
        # All contacts lie in this plane.
        return OUTSIDE
    return _enter_plane(hull, owner, primitives, q, p, k, size)


@njit(bare=True)
def _enter_plane(
    hull: Hull, owner: Ints, primitives: Floats, p: Vector, q: Vector, k: int, size: float
) -> int:
    """Enter the plane through points p and q and contact k, counter-clockwise, or return -1."""
    normal = cross(subtract(q, p), subtract(row(primitives, k), p))
    area = length(normal)
    if not area > RELATIVE_TOLERANCE * size * size:
        return OUTSIDE
    normal = scale(normal, 1.0 / area)
    height = dot(p, normal)
    tolerance = RELATIVE_TOLERANCE * size
    mask = 0
    for m in range(primitives.shape[0]):
        over = dot(row(primitives, m), normal) - height
        if abs(over) > ROUNDING * size and abs(over) < CLEAR * size:
            hull.tally[DOUBT] = 1
        if over > tolerance:
            return OUTSIDE
        mask |= (1 if over >= -tolerance else 0) << m
    return add_facet(hull, owner, primitives, normal, height, mask, size)


@njit(bare=True)
def _turn_onto(
    primitives: Floats,
    normal: Vector,
    base: Vector,
    outward: Vector,
    i: int,
    j: int,
    tolerance: float,
) -> tuple[int, float]:
    """Return the first contact touched by turning either way, or -1, and which way."""
    k = _first_touched(primitives, normal, base, outward, i, j, tolerance)
    if k >= 0:
        return k, 1.0
    return _first_touched(primitives, normal, base, scale(outward, -1.0), i, j, tolerance), -1.0


@njit(bare=True)
def _seed(hull: Hull, owner: Ints, primitives: Floats, size: float) -> None:
    """Enter a first facet: lower a level plane onto a contact and turn it onto two more."""
    tolerance = RELATIVE_TOLERANCE * size
    i = 0
    for k in range(1, primitives.shape[0]):
        if primitives[k, 2] < primitives[i, 2]:
            i = k
    down, ahead = (0.0, 0.0, -1.0), (1.0, 0.0, 0.0)
    base = row(primitives, i)
    j, way = _turn_onto(primitives, down, base, ahead, i, i, tolerance)
    if j < 0:
        return
    arm = subtract(row(primitives, j), base)
    # Turned until arm lies in it, the plane has the normal x n + d m, where m is the sinking
    # direction, x how far ahead the contact is and d how deep.
    x, depth = way * dot(arm, ahead), max(-dot(arm, down), 0.0)
    breadth = math.sqrt(x * x + depth * depth)
    normal = (way * depth / breadth, 0.0, -x / breadth)
    outward = cross(arm, normal)
    outward = scale(outward, 1.0 / length(outward))
    k, way = _turn_onto(primitives, normal, base, outward, i, j, tolerance)
    if k < 0:
        return
    # Counter-clockwise about the new normal: outward is to the right of base -> j.
    p, q = (row(primitives, j), base) if way > 0.0 else (base, row(primitives, j))
    _enter_plane(hull, owner, primitives, p, q, k, size)


@njit(bare=True)
def find_point_facets(
    work: Workspace, primitives: NDArray[np.float64], lowest_up: float, size: float
) -> None:
    """Fill the pieces of `work` with the facets of the hull of point contacts.

    Parameters
    ----------
    work : Workspace
        Overwritten.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com; only the centres are read.
    lowest_up : float
        Facets are rolled onwards only from normals whose z is below this: 0 finds every facet
        that faces down and its neighbours, 2 finds all.
    size : float
        Size of the robot (length).
    """
    hull, owner = work.pieces, work.owner
    count, facet, span, link = hull.tally, hull.facet, hull.span, hull.link
    n = primitives.shape[0]
    count[FOUND] = count[OVERFLOW] = count[DOUBT] = 0
    span[0, FIRST] = 0
    owner[:] = OUTSIDE
    _seed(hull, owner, primitives, size)
    if count[FOUND] == 0:
        return
    if facet[0, 3] < 0.0 and span[0, MASK] == (1 << n) - 1:
        # All contacts in one plane above the com: the robot could hang from its other side.
        normal = scale(row(facet, 0), -1.0)
        height, mask = -facet[0, 3], span[0, MASK]
        owner[:] = OUTSIDE
        count[FOUND] = 0
        add_facet(hull, owner, primitives, normal, height, mask, size)
    faces_down = False
    f = 0
    while f < count[FOUND]:
        faces_down = faces_down or facet[f, 2] < lowest_up
        # The seed may face up: roll on until a facet faces down, then only over those.
        if facet[f, 2] < lowest_up or not faces_down:
            for at in range(span[f, FIRST], span[f + 1, FIRST]):
                if link[at, NEIGHBOUR] != UNKNOWN:
                    continue
                other = _roll(hull, owner, primitives, f, at, size)
                link[at, NEIGHBOUR] = other
                if other >= 0 and other != f:
                    back = matching_corner(span, link, f, at, other)
                    if back >= 0:
                        join(link, f, at, other, back)
        f += 1
