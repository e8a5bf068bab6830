"""Support facets of one posture: the planes on which the robot can stand.

Owns the facet table and the search for point contacts.  A support facet is a plane that touches at
least three primitives in points that are not collinear, with no primitive below it.  The facets of
points are those of their hull: the search finds one and rolls the plane over each edge onto the
next, so its cost grows with facets times contacts, not with the number of triples.  Round contacts
are `rounds`'s.  Nothing here knows of gravity, of the `upright` limit or of tipping.

Normals are unit vectors, body frame, outward.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.polygon import convex_polygon
from lutgen.support.primitive import RADIUS, support_contact, support_height
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract

# Two lengths that differ by less than this part of the robot's size are the same length: contacts
# within it of a plane touch the plane.  Hulls of rotated cubes stay whole for any noise from 0 to
# 1e-7 with it, and break with 0.
RELATIVE_TOLERANCE = 1e-9
MAX_PRIMITIVES = 32
# Two normals with a larger scalar product (1.4e-5 rad) are one; three wheels may share several.
SAME_NORMAL = 1.0 - 1e-10
UNKNOWN, OUTSIDE = -2, -1
VERTEX, NEIGHBOUR = 0, 1
FIRST, MASK, PLACE = 0, 1, 2


class FacetTable(NamedTuple):
    """Facets of one posture as flat arrays, reused from posture to posture.

    `tally` (2,): facets, and 1 where the table was too small.  Per facet: `facet` (F, 4) normal
    and height; `span` (F + 1, 3) its first corner, the bit set of the primitives that it
    touches, and room for its place among the accepted facets.  Per corner, counter-clockwise seen
    from outside: `corner` (E, 3) contact point; `link` (E, 2) primitive, and facet across the edge
    from this corner to the next.
    """

    tally: NDArray[np.int64]
    facet: NDArray[np.float64]
    span: NDArray[np.int64]
    corner: NDArray[np.float64]
    link: NDArray[np.int64]


@njit()
def facet_table(primitives: int) -> FacetTable:
    """Return an empty table large enough for `primitives` contact primitives."""
    facets = 8 * primitives
    corners = 24 * primitives
    return FacetTable(
        np.zeros(2, np.int64),
        np.empty((facets, 4)),
        np.zeros((facets + 1, 3), np.int64),
        np.empty((corners, 3)),
        np.empty((corners, 2), np.int64),
    )


@njit(inline=True)
def robot_size(primitives: Floats) -> float:
    """Return the largest distance from the first primitive to any other, radii included."""
    size = 0.0
    for i in range(primitives.shape[0]):
        dx = primitives[i, 0] - primitives[0, 0]
        dy = primitives[i, 1] - primitives[0, 1]
        dz = primitives[i, 2] - primitives[0, 2]
        size = max(size, math.sqrt(dx * dx + dy * dy + dz * dz) + primitives[i, RADIUS])
    return size


@njit(inline=True)
def lowest_beyond(
    primitives: Floats, normal: Vector, height: float, tolerance: float
) -> tuple[int, int]:
    """Return the primitive furthest below a plane, or -1, and the bit set that touches it."""
    below = -1
    excess = tolerance
    mask = 0
    for m in range(primitives.shape[0]):
        over = support_height(primitives, m, normal) - height
        if over > excess:
            excess = over
            below = m
        if over >= -tolerance:
            mask |= 1 << m
    return below, mask


@njit()
def add_facet(
    count: Ints,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    owner: Ints,
    primitives: Floats,
    normal: Vector,
    height: float,
    mask: int,
    size: float,
) -> int:
    """Enter a plane that has no primitive below it; return its index, or -1 if it is no facet.

    The arrays of the table come one by one, here and in what calls this: out of a tuple their
    references are counted at every call, which takes a tenth of the time of a posture of points.
    """
    n = primitives.shape[0]
    new = count[0]
    begin = span[new, FIRST]
    if new + 1 >= facet.shape[0] or begin + n > link.shape[0]:
        count[1] = 1
        return OUTSIDE
    for f in range(new):
        if span[f, MASK] == mask and dot(row(facet, f), normal) > SAME_NORMAL:
            return f
    touching = 0
    for i in range(n):
        if mask >> i & 1:
            point = support_contact(primitives, i, normal)
            corner[begin + touching, 0] = point[0]
            corner[begin + touching, 1] = point[1]
            corner[begin + touching, 2] = point[2]
            link[begin + touching, VERTEX] = i
            touching += 1
    corners = convex_polygon(corner, link, begin, touching, normal, RELATIVE_TOLERANCE * size)
    if corners == 0:
        return OUTSIDE
    for t in range(corners):
        at = begin + t
        link[at, NEIGHBOUR] = UNKNOWN
        if owner.shape[0] == 0:
            continue
        # Two facets of points have one edge in common at most, so the plane need not be rolled over
        # an edge whose two facets are known.
        i, j = link[at, VERTEX], link[at + 1 if t + 1 < corners else begin, VERTEX]
        facing = owner[j, i]
        owner[i, j] = new * MAX_PRIMITIVES + t
        if facing >= 0:
            f = facing // MAX_PRIMITIVES
            link[at, NEIGHBOUR] = f
            link[span[f, FIRST] + facing % MAX_PRIMITIVES, NEIGHBOUR] = new
    facet[new, 0], facet[new, 1], facet[new, 2] = normal
    facet[new, 3] = height
    span[new, MASK] = mask
    span[new + 1, FIRST] = begin + corners
    count[0] = new + 1
    return int(new)


@njit(inline=True)
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


@njit()
def _roll(
    count: Ints,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    owner: Ints,
    primitives: Floats,
    f: int,
    at: int,
    size: float,
) -> int:
    """Return the facet reached by rolling f over the edge that starts at corner `at`, or -1."""
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
    return _enter_plane(count, facet, span, corner, link, owner, primitives, q, p, k, size)


@njit()
def _enter_plane(
    count: Ints,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    owner: Ints,
    primitives: Floats,
    p: Vector,
    q: Vector,
    k: int,
    size: float,
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
        if over > tolerance:
            return OUTSIDE
        mask |= (1 if over >= -tolerance else 0) << m
    return add_facet(
        count, facet, span, corner, link, owner, primitives, normal, height, mask, size
    )


@njit(inline=True)
def matching_corner(span: Ints, link: Ints, f: int, at: int, other: int) -> int:
    """Return the corner of facet `other` whose edge is that of f from `at`, reversed; or -1."""
    following = at + 1 if at + 1 < span[f + 1, FIRST] else span[f, FIRST]
    i, j = link[at, VERTEX], link[following, VERTEX]
    begin, end = span[other, FIRST], span[other + 1, FIRST]
    for back in range(begin, end):
        ahead = back + 1 if back + 1 < end else begin
        if link[back, VERTEX] == j and link[ahead, VERTEX] == i:
            return back
    return -1


@njit()
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


@njit()
def _seed(
    count: Ints,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    owner: Ints,
    primitives: Floats,
    size: float,
) -> None:
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
    _enter_plane(count, facet, span, corner, link, owner, primitives, p, q, k, size)


@njit()
def find_point_facets(table: FacetTable, primitives: NDArray[np.float64], lowest_up: float) -> None:
    """Fill `table` with the facets of the hull of point contacts.

    Parameters
    ----------
    table : FacetTable
        Overwritten.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com; only the centres are read.
    lowest_up : float
        Facets are rolled onwards only from normals whose z is below this: 0 finds every facet
        that faces down and its neighbours, 2 finds all.
    """
    count, facet, span = table.tally, table.facet, table.span
    corner, link = table.corner, table.link
    n = primitives.shape[0]
    count[0] = count[1] = 0
    span[0, FIRST] = 0
    size = robot_size(primitives)
    owner = np.full((n, n), OUTSIDE, np.int64)
    _seed(count, facet, span, corner, link, owner, primitives, size)
    if count[0] == 0:
        return
    if facet[0, 3] < 0.0 and span[0, MASK] == (1 << n) - 1:
        # All contacts in one plane above the com: the robot could hang from its other side.
        normal = scale(row(facet, 0), -1.0)
        height, mask = -facet[0, 3], span[0, MASK]
        owner[:] = OUTSIDE
        count[0] = 0
        add_facet(count, facet, span, corner, link, owner, primitives, normal, height, mask, size)
    faces_down = False
    f = 0
    while f < count[0]:
        faces_down = faces_down or facet[f, 2] < lowest_up
        # The seed may face up: roll on until a facet faces down, then only over those.
        if facet[f, 2] < lowest_up or not faces_down:
            for at in range(span[f, FIRST], span[f + 1, FIRST]):
                if link[at, NEIGHBOUR] != UNKNOWN:
                    continue
                other = _roll(count, facet, span, corner, link, owner, primitives, f, at, size)
                link[at, NEIGHBOUR] = other
                if other >= 0 and other != f:
                    back = matching_corner(span, link, f, at, other)
                    if back >= 0:
                        link[back, NEIGHBOUR] = f
        f += 1
