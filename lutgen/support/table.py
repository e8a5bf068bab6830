"""The facet table: support facets of one posture, and which lies beyond which edge.

Owns the arrays that the searches fill.  A support facet is a plane that touches at least three
primitives in points that are not collinear, with no primitive below it.  Rolling the plane over an
edge, two primitives carry it along an arc of normals until a third one touches: the facet beyond.
Facets and arcs make up one complex.  It has no cracks where every edge names the facet beyond it
and the corner there at which the same edge begins in the other direction.

Normals are unit vectors, body frame, outward; corners are counter-clockwise seen from outside.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.primitive import RADIUS, support_contact
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, subtract

# Two lengths that differ by less than this part of the robot's size are the same length.
RELATIVE_TOLERANCE = 1e-9
# As many as an int64 has bits for, with the sign and one to spare.
MAX_PRIMITIVES = 62
# Facets and corners that a table has room for, for each primitive.
MOST_FACETS, MOST_CORNERS = 12, 36
UNKNOWN, OUTSIDE = -2, -1
VERTEX, NEIGHBOUR, BACK = 0, 1, 2
FIRST, MASK, PLACE = 0, 1, 2
# Entries of Hull.tally.
FOUND, OVERFLOW, DOUBT = 0, 1, 2


# Ways that one roll may branch into, and facets that it may come to until it counts as lost; pieces
# and cuts of a strip, see `catch` and `strips`.
WAYS, VISITS, MOST_PIECES, CUTS = 32, 48, 12, 8


class Hull(NamedTuple):
    """The hull of one posture's contacts: its facets, and which lies beyond which edge.

    `tally` (3,): facets; 1 where the arrays were too small; 1 where points are too near to a plane
    to tell by themselves whether they touch it.  Per facet: `facet` (F, 4) unit normal, outward,
    and height (length), body frame; `span` (F + 1, 3) its first corner, the bit set of the
    primitives that it touches, and room for its place among the accepted facets.  Per corner,
    counter-clockwise seen from outside: `corner` (E, 3) contact point relative to the com (length);
    `link` (E, 3) primitive, and of the edge from this corner to the next the facet beyond it and
    the corner there at which it begins, or `OUTSIDE`.
    """

    tally: NDArray[np.int64]
    facet: NDArray[np.float64]
    span: NDArray[np.int64]
    corner: NDArray[np.float64]
    link: NDArray[np.int64]


class Workspace(NamedTuple):
    """Arrays that the steps of one posture work in; nobody finds there what another one left.

    `pieces` is the hull before short arcs are united.  `counts` (8, E) serves whoever counts or
    lists; the others are named where they are used.
    """

    pieces: Hull
    counts: NDArray[np.int64]
    owner: NDArray[np.int64]
    place: NDArray[np.float64]
    across: NDArray[np.float64]
    own: NDArray[np.int64]
    grown: NDArray[np.float64]
    shown: NDArray[np.float64]
    normals: NDArray[np.float64]
    points: NDArray[np.float64]
    polygon: NDArray[np.float64]
    flat: NDArray[np.float64]
    brink: NDArray[np.float64]
    roll: NDArray[np.float64]
    way: NDArray[np.float64]
    begin: NDArray[np.float64]
    side: NDArray[np.float64]


class FacetTable(NamedTuple):
    """Facets of one posture, reused from posture to posture.

    `hull`: its facets, corners and edges.  `held` (E, 2): from which part of the edge from each
    corner to which the robot is caught beyond, 1 and 0 if not.  `work` is room for the steps that
    fill it.
    """

    hull: Hull
    held: NDArray[np.float64]
    work: Workspace


@njit()
def _empty_hull(facets: int, corners: int) -> Hull:
    return Hull(
        np.zeros(3, np.int64),
        np.empty((facets, 4)),
        np.zeros((facets + 1, 3), np.int64),
        np.empty((corners, 3)),
        np.empty((corners, 3), np.int64),
    )


@njit()
def facet_table(primitives: int) -> FacetTable:
    """Return an empty table large enough for `primitives` contact primitives."""
    facets, corners = MOST_FACETS * primitives, MOST_CORNERS * primitives
    n = primitives
    work = Workspace(
        _empty_hull(facets, corners),
        np.empty((8, corners), np.int64),
        np.empty((n, n), np.int64),
        np.empty((n, 4)),
        np.empty((3, n)),
        np.empty((n, 2), np.int64),
        np.empty((n, 8)),
        np.empty((n, 8)),
        np.empty((facets, 3)),
        np.empty((n, 3)),
        np.empty((n, 3)),
        np.empty((n, 2)),
        np.empty((corners, 13)),
        np.empty((corners, 13)),
        np.empty((WAYS + VISITS, 17)),
        np.empty((4, 11)),
        np.empty((MOST_PIECES + CUTS, 6)),
    )
    return FacetTable(_empty_hull(facets, corners), np.empty((corners, 2)), work)


@njit(inline=True, bare=True)
def robot_size(primitives: Floats) -> float:
    """Return the largest distance from the first primitive to any other, radii included."""
    size = 0.0
    for i in range(primitives.shape[0]):
        dx = primitives[i, 0] - primitives[0, 0]
        dy = primitives[i, 1] - primitives[0, 1]
        dz = primitives[i, 2] - primitives[0, 2]
        size = max(size, math.sqrt(dx * dx + dy * dy + dz * dz) + primitives[i, RADIUS])
    return size


@njit(inline=True, bare=True)
def corner_after(span: Ints, f: int, at: int) -> int:
    """Return the next corner of facet f, counter-clockwise."""
    return at + 1 if at + 1 < span[f + 1, FIRST] else span[f, FIRST]


@njit(inline=True, bare=True)
def matching_corner(span: Ints, link: Ints, f: int, at: int, other: int) -> int:
    """Return the corner of facet `other` whose edge is that of f from `at`, reversed; or -1."""
    i, j = link[at, VERTEX], link[corner_after(span, f, at), VERTEX]
    begin, end = span[other, FIRST], span[other + 1, FIRST]
    for back in range(begin, end):
        ahead = back + 1 if back + 1 < end else begin
        if link[back, VERTEX] == j and link[ahead, VERTEX] == i:
            return back
    return -1


@njit(inline=True, bare=True)
def join(link: Ints, f: int, at: int, other: int, back: int) -> None:
    """Enter that the edges at corner `at` of f and at `back` of `other` are the two ends of one."""
    link[at, NEIGHBOUR], link[at, BACK] = other, back
    link[back, NEIGHBOUR], link[back, BACK] = f, at


@njit(inline=True, bare=True)
def put(array: Floats, index: int, column: int, vector: Vector) -> None:
    """Write a vector into the three columns of a row that begin at `column`."""
    array[index, column] = vector[0]
    array[index, column + 1] = vector[1]
    array[index, column + 2] = vector[2]


@njit(inline=True, bare=True)
def vector_at(array: Floats, index: int, column: int) -> Vector:
    """Return the three components that begin in a column of a packed row."""
    return array[index, column], array[index, column + 1], array[index, column + 2]


@njit(bare=True)
def add_triangle(
    hull: Hull, primitives: Floats, normal: Vector, three: tuple[int, int, int]
) -> int:
    """Enter a facet of three primitives, counter-clockwise; return its index, or -1 if no room.

    Its corners are where the primitives touch a plane with the unit `normal`.
    """
    count, facet, span, corner, link = hull
    new = count[FOUND]
    at = span[new, FIRST]
    if new + 1 >= facet.shape[0] or at + 3 > link.shape[0]:
        count[OVERFLOW] = 1
        return OUTSIDE
    mask = 0
    height = 0.0
    for c in range(3):
        i = three[c]
        point = support_contact(primitives, i, normal)
        put(corner, at + c, 0, point)
        link[at + c, VERTEX], link[at + c, NEIGHBOUR], link[at + c, BACK] = i, UNKNOWN, OUTSIDE
        height += dot(point, normal) / 3.0
        mask |= 1 << i
    put(facet, new, 0, normal)
    facet[new, 3] = height
    span[new, MASK] = mask
    span[new + 1, FIRST] = at + 3
    count[FOUND] = new + 1
    return int(new)


@njit(inline=True, bare=True)
def doubled_area(corner: Floats, begin: int, end: int) -> float:
    """Return twice the area of a facet's polygon."""
    total = 0.0
    origin = row(corner, begin)
    for at in range(begin + 1, end - 1):
        a, b = subtract(row(corner, at), origin), subtract(row(corner, at + 1), origin)
        total += length(cross(a, b))
    return total
