"""Standing region of one posture: the gravity directions in which the robot does not tip over.

Owns the choice of facets (`upright`), the gaps between them (`rock_angle`) and the boundary.  The
region is the union of the cones of the accepted facets and of the gaps between two facets over
whose common edge the robot only rocks.  Its boundary is a list of segments between two contact
points: tip-over axes, and the short sides of gaps.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.polygon import area_centroid
from lutgen.support import (
    FIRST,
    MASK,
    NEIGHBOUR,
    RELATIVE_TOLERANCE,
    VERTEX,
    FacetTable,
    matching_corner,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract, unit

# See `limits`.
Limit = tuple[float, float, float]
# Kinds of facet edge.  TIP: beyond it the robot tips.  SHARED: beyond it another accepted facet
# begins at once.  GAP: beyond it the robot rocks over two round contacts onto another facet.
TIP, SHARED, GAP = 0, 1, 2
NO_LIMIT = -2.0
# Entries of Region.tally.
FACETS, SEGMENTS, CONVEX, GAPS = 0, 1, 2, 3
# First columns of the vectors in Region.plate, Region.edge and Region.segment.
PLANE, FIRST_AXIS, SECOND_AXIS, CENTROID, HEIGHT = 0, 3, 6, 9, 12
POINT, WALL, SIDE_FROM, SIDE_TO = 0, 3, 6, 9
START, STOP, TIP_PLANE = 0, 3, 6
EDGE_KIND, ACROSS = 0, 1
SOURCE = 1


class Region(NamedTuple):
    """Standing region of one posture as flat arrays, reused from posture to posture.

    `tally` (4,): accepted facets, boundary segments, 1 if the region is convex, gaps.
    Per facet, in canonical order (ascending bit set of touching primitives): `plate` (F, 13) =
    n/h, so that (n/h) . x = 1 on its plane; two axes with which, for t = 1/((n/h) . g), the
    in-plane components of D_g - s are t (axis . g); centroid s; height h.  `span` (F + 1, 2)
    first edge, and index in the facet table.
    Per edge: `edge` (E, 12) = contact point where it begins; `wall`, the unit inward normal of
    the plane through the edge and the com; for gaps the unit inward normals of its two sides,
    zero where a side is no limit.  `link` (E, 2) kind, and accepted facet beyond it or -1.
    Per boundary segment: `segment` (B, 9) = two contact points and the unit inward normal of the
    tip-over plane, start x stop pointing inward; `contacts` (B, 2) primitives.
    """

    tally: NDArray[np.int64]
    plate: NDArray[np.float64]
    span: NDArray[np.int64]
    edge: NDArray[np.float64]
    link: NDArray[np.int64]
    segment: NDArray[np.float64]
    contacts: NDArray[np.int64]


@njit()
def empty_region(primitives: int) -> Region:
    """Return arrays large enough for the region of `primitives` contact primitives."""
    facets = 8 * primitives
    edges = 24 * primitives
    return Region(
        np.zeros(4, np.int64),
        np.empty((facets, 13)),
        np.zeros((facets + 1, 2), np.int64),
        np.empty((edges, 12)),
        np.empty((edges, 2), np.int64),
        np.empty((3 * edges, 9)),
        np.empty((3 * edges, 2), np.int64),
    )


def limits(upright: float | None, rock_angle: float | None) -> tuple[float, float, float]:
    """Turn the two angles (rad, None = no limit) into the cosines that the kernels compare with.

    Returns
    -------
    steepest : float
        A facet is accepted if -n_z is greater than this.  A facet exactly at the limit is
        refused: a robot that lies on its side does not stand.
    least_cosine : float
        The robot rocks between facets whose normals have at least this scalar product.
    lowest_up : float
        From which n_z on the facet search need not go further, see `support.find_facets`.
    """
    steepest = NO_LIMIT if upright is None or upright >= math.pi else math.cos(upright) + 1e-9
    least_cosine = NO_LIMIT if rock_angle is None else math.cos(rock_angle) - 1e-12
    lowest_up = 0.0 if steepest > 0.0 else 2.0
    return steepest, least_cosine, lowest_up


@njit(inline=True)
def vector_at(array: Floats, index: int, column: int) -> Vector:
    """Return the three components that begin in a column of a packed row."""
    return array[index, column], array[index, column + 1], array[index, column + 2]


@njit(inline=True)
def _put(array: Floats, index: int, column: int, vector: Vector) -> None:
    array[index, column] = vector[0]
    array[index, column + 1] = vector[1]
    array[index, column + 2] = vector[2]


@njit(inline=True)
def _is_accepted(facet: Floats, f: int, steepest: float, tolerance: float) -> bool:
    return f >= 0 and facet[f, 3] > tolerance and -facet[f, 2] > steepest


@njit(inline=True)
def _rocks_onto(
    facet: Floats,
    link: Ints,
    f: int,
    at: int,
    steepest: float,
    least_cosine: float,
    tolerance: float,
) -> int:
    """Return the facet onto which the robot rocks over an edge of facet f, or -1."""
    other = link[at, NEIGHBOUR]
    if (
        other == f
        or not _is_accepted(facet, other, steepest, tolerance)
        or dot(row(facet, f), row(facet, other)) < least_cosine
    ):
        return -1
    return int(other)


@njit(inline=True)
def _after(span: Ints, f: int, at: int) -> int:
    """Return the next corner of facet f, counter-clockwise."""
    return at + 1 if at + 1 < span[f + 1, FIRST] else span[f, FIRST]


@njit(inline=True)
def _before(span: Ints, f: int, at: int) -> int:
    """Return the previous corner of facet f, counter-clockwise."""
    return at - 1 if at > span[f, FIRST] else span[f + 1, FIRST] - 1


@njit()
def _enter_facets(
    count: Ints,
    facet: Floats,
    span: Ints,
    corner: Floats,
    plate: Floats,
    first: Ints,
    steepest: float,
    tolerance: float,
) -> int:
    """Enter the accepted facets in canonical order; return their number."""
    accepted = 0
    for f in range(count[0]):
        if _is_accepted(facet, f, steepest, tolerance):
            place = accepted
            while place > 0 and span[first[place - 1, SOURCE], MASK] > span[f, MASK]:
                first[place, SOURCE] = first[place - 1, SOURCE]
                place -= 1
            first[place, SOURCE] = f
            accepted += 1
    for k in range(accepted):
        f = first[k, SOURCE]
        normal = row(facet, f)
        plane = scale(normal, 1.0 / facet[f, 3])
        centroid = area_centroid(corner, span[f, FIRST], span[f + 1, FIRST])
        # In-plane axes: the body's x as seen in the plane (its y where x is the normal).
        across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
        e1 = unit(subtract(across, scale(normal, dot(across, normal))))
        e2 = cross(normal, e1)
        _put(plate, k, PLANE, plane)
        _put(plate, k, FIRST_AXIS, subtract(e1, scale(plane, dot(e1, centroid))))
        _put(plate, k, SECOND_AXIS, subtract(e2, scale(plane, dot(e2, centroid))))
        _put(plate, k, CENTROID, centroid)
        plate[k, HEIGHT] = facet[f, 3]
    return accepted


@njit()
def _surrounded(
    facet: Floats,
    span: Ints,
    link: Ints,
    f: int,
    at: int,
    forward: bool,
    steepest: float,
    least_cosine: float,
    tolerance: float,
) -> bool:
    """Tell whether the facets around one primitive close into a ring over which the robot rocks.

    Starts by crossing the edge of f that begins at corner `at`; goes round the primitive at its
    beginning (`forward` false) or at its end (`forward` true).
    """
    here, edge = f, at
    for _ in range(facet.shape[0]):
        other = _rocks_onto(facet, link, here, edge, steepest, least_cosine, tolerance)
        if other < 0:
            return False
        if other == f:
            return True
        back = matching_corner(span, link, here, edge, other)
        if back < 0:
            return False
        # `back` runs from the far primitive to the near one: the next edge round the primitive
        # at our beginning starts where it ends, the one round our end ends where it starts.
        edge = _before(span, other, back) if forward else _after(span, other, back)
        here = other
    return False


@njit(inline=True)
def _add_segment(
    tally: Ints,
    segment: Floats,
    contacts: Ints,
    start: Vector,
    stop: Vector,
    inward: Vector,
    i: int,
    j: int,
) -> None:
    """Append a boundary segment; the direction `inward` is on the inner side of its plane."""
    normal = cross(start, stop)
    size = length(normal)
    if size > 0.0:
        b = tally[SEGMENTS]
        if dot(normal, inward) < 0.0:
            start, stop = stop, start
            size = -size
        _put(segment, b, START, start)
        _put(segment, b, STOP, stop)
        _put(segment, b, TIP_PLANE, scale(normal, 1.0 / size))
        contacts[b, 0] = i
        contacts[b, 1] = j
        tally[SEGMENTS] = b + 1


@njit()
def _enter_gap(
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    f: int,
    at: int,
    other: int,
    back: int,
    e: int,
    tally: Ints,
    edge: Floats,
    segment: Floats,
    contacts: Ints,
    limit: Limit,
    tolerance: float,
) -> None:
    """Enter the two sides of the gap beyond edge `e`, where they are boundary."""
    following = _after(span, f, at)
    p, q = row(corner, at), row(corner, following)
    q_far, p_far = row(corner, back), row(corner, _after(span, other, back))
    for end in range(2):
        near, far, opposite = (p, p_far, q) if end == 0 else (q, q_far, p)
        side = (0.0, 0.0, 0.0)
        if length(subtract(near, far)) > tolerance and not _surrounded(
            facet, span, link, f, at, end == 1, limit[0], limit[1], tolerance
        ):
            side = unit(cross(near, far))
            side = scale(side, math.copysign(1.0, dot(side, opposite)))
            # Each gap is entered from both its facets; its sides are boundary once.
            if f < other:
                i = link[at if end == 0 else following, VERTEX]
                _add_segment(tally, segment, contacts, near, far, opposite, i, i)
        _put(edge, e, SIDE_FROM if end == 0 else SIDE_TO, side)


@njit()
def find_region(
    region: Region, table: FacetTable, limit: tuple[float, float, float], size: float
) -> None:
    """Fill `region` from the facets of one posture.

    Parameters
    ----------
    region : Region
        Overwritten.
    table : FacetTable
        As `support.find_facets` leaves it.
    limit : tuple
        See `limits`.
    size : float
        Size of the robot, for the tolerance.
    """
    facet, span, corner, link = table.facet, table.span, table.corner, table.link
    tally, plate, first, edge, about = (
        region.tally,
        region.plate,
        region.span,
        region.edge,
        region.link,
    )
    segment, contacts = region.segment, region.contacts
    steepest, least_cosine = limit[0], limit[1]
    tolerance = RELATIVE_TOLERANCE * size
    accepted = _enter_facets(table.tally, facet, span, corner, plate, first, steepest, tolerance)
    tally[FACETS], tally[SEGMENTS], tally[GAPS] = accepted, 0, 0
    first[0, FIRST] = 0
    e = 0
    for k in range(accepted):
        f = first[k, SOURCE]
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            following = _after(span, f, at)
            p, q = row(corner, at), row(corner, following)
            wall = unit(cross(p, q))
            _put(edge, e, POINT, p)
            _put(edge, e, WALL, wall)
            about[e, EDGE_KIND], about[e, ACROSS] = TIP, -1
            other = link[at, NEIGHBOUR]
            boundary = True
            if other != f and _is_accepted(facet, other, steepest, tolerance):
                for beyond in range(accepted):
                    if first[beyond, SOURCE] == other:
                        about[e, ACROSS] = beyond
                boundary = dot(row(facet, f), row(facet, other)) < least_cosine
                back = matching_corner(span, link, f, at, other)
                moved = 0.0
                if back >= 0:
                    moved = length(subtract(row(corner, back), q)) + length(
                        subtract(row(corner, _after(span, other, back)), p)
                    )
                if moved <= tolerance:
                    about[e, EDGE_KIND] = SHARED
                elif not boundary:
                    about[e, EDGE_KIND] = GAP
                    tally[GAPS] += 1
                    _enter_gap(
                        *(facet, span, corner, link, f, at, other, back, e),
                        *(tally, edge, segment, contacts, limit, tolerance),
                    )
            if boundary:
                i, j = link[at, VERTEX], link[following, VERTEX]
                _add_segment(tally, segment, contacts, p, q, wall, i, j)
            e += 1
        first[k + 1, FIRST] = e
    tally[CONVEX] = 1 if _is_convex(segment, tally[SEGMENTS], edge, e) else 0


@njit()
def _is_convex(segment: Floats, segments: int, edge: Floats, edges: int) -> bool:
    """Tell whether every corner of every accepted facet is inside every tip-over plane."""
    for b in range(segments):
        normal = vector_at(segment, b, TIP_PLANE)
        for e in range(edges):
            point = vector_at(edge, e, POINT)
            depth = dot(normal, point)
            if depth < 0.0 and depth < -RELATIVE_TOLERANCE * length(point):
                return False
    return True


@njit(inline=True)
def supporting_facet(plate: Floats, facets: int, g: Vector) -> int:
    """Return the accepted facet whose plane the ray along g pierces first, or -1.

    The robot's hull lies above all its facets' planes, so the plane pierced first is the one of
    the facet where the ray leaves the hull.  Ties go to the lower index.
    """
    best = -1
    nearest = 0.0
    for k in range(facets):
        rate = dot(vector_at(plate, k, PLANE), g)
        if rate > nearest * (1.0 + 1e-12):
            nearest = rate
            best = k
    return best


@njit()
def is_standing(span: Ints, edge: Floats, link: Ints, k: int, g: Vector) -> bool:
    """Tell whether direction g, whose supporting facet is k, lies in the standing region.

    The far side of a gap needs no test: beyond the middle of it another facet supports.
    """
    if k < 0:
        return False
    inside = True
    for e in range(span[k, FIRST], span[k + 1, FIRST]):
        if link[e, EDGE_KIND] == SHARED or dot(vector_at(edge, e, WALL), g) >= 0.0:
            continue
        inside = False
        if (
            link[e, EDGE_KIND] == GAP
            and dot(vector_at(edge, e, SIDE_FROM), g) >= 0.0
            and dot(vector_at(edge, e, SIDE_TO), g) >= 0.0
        ):
            return True
    return inside
