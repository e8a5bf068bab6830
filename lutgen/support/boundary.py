"""From facets to the standing region: which are accepted, where the robot rocks, where it tips.

Owns the choice of facets (`upright`), the gaps between them (`rock_angle`) and the list of boundary
segments of a `Region`.
"""

import math

from lutgen.jit import njit
from lutgen.support.hull import (
    FIRST,
    MASK,
    NEIGHBOUR,
    PLACE,
    RELATIVE_TOLERANCE,
    VERTEX,
    FacetTable,
    matching_corner,
    robot_size,
)
from lutgen.support.polygon import area_centroid
from lutgen.support.region import (
    ACROSS,
    CENTROID,
    CONVEX,
    EDGE_KIND,
    EDGE_PLANE,
    FACETS,
    FIRST_AXIS,
    GAP,
    GAPS,
    HEIGHT,
    PLANE,
    POINT,
    SECOND_AXIS,
    SEGMENTS,
    SHARED,
    SIDE_FROM,
    SIDE_TO,
    SOURCE,
    START,
    STOP,
    TIP,
    TIP_PLANE,
    Acceptance,
    Region,
    vector_at,
)
from lutgen.support.rounds import find_facets
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract, unit


@njit(inline=True)
def _put(array: Floats, index: int, column: int, vector: Vector) -> None:
    array[index, column] = vector[0]
    array[index, column + 1] = vector[1]
    array[index, column + 2] = vector[2]


@njit(inline=True)
def _is_accepted(facet: Floats, f: int, accept: Acceptance) -> bool:
    return f >= 0 and facet[f, 3] > accept.least_height and -facet[f, 2] > accept.steepest


@njit(inline=True)
def _rocks_onto(facet: Floats, link: Ints, f: int, at: int, accept: Acceptance) -> int:
    """Return the facet onto which the robot rocks over an edge of facet f, or -1."""
    other = link[at, NEIGHBOUR]
    if (
        other == f
        or not _is_accepted(facet, other, accept)
        or dot(row(facet, f), row(facet, other)) < accept.least_cosine
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
    entered: Floats,
    first: Ints,
    accept: Acceptance,
) -> int:
    """Enter the accepted facets in canonical order; return their number."""
    accepted = 0
    for f in range(count[0]):
        if _is_accepted(facet, f, accept):
            place = accepted
            while place > 0 and span[first[place - 1, SOURCE], MASK] > span[f, MASK]:
                first[place, SOURCE] = first[place - 1, SOURCE]
                place -= 1
            first[place, SOURCE] = f
            accepted += 1
    for k in range(accepted):
        f = first[k, SOURCE]
        span[f, PLACE] = k
        normal = row(facet, f)
        plane = scale(normal, 1.0 / facet[f, 3])
        centroid = area_centroid(corner, span[f, FIRST], span[f + 1, FIRST])
        # In-plane axes: the body's x as seen in the plane (its y where x is the normal).
        across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
        e1 = unit(subtract(across, scale(normal, dot(across, normal))))
        e2 = cross(normal, e1)
        _put(entered, k, PLANE, plane)
        _put(entered, k, FIRST_AXIS, subtract(e1, scale(plane, dot(e1, centroid))))
        _put(entered, k, SECOND_AXIS, subtract(e2, scale(plane, dot(e2, centroid))))
        _put(entered, k, CENTROID, centroid)
        entered[k, HEIGHT] = facet[f, 3]
    return accepted


@njit()
def _surrounded(
    facet: Floats, span: Ints, link: Ints, f: int, at: int, forward: bool, accept: Acceptance
) -> bool:
    """Tell whether the facets around one primitive close into a ring over which the robot rocks.

    Starts by crossing the edge of f that begins at corner `at`; goes round the primitive at its
    beginning (`forward` false) or at its end (`forward` true).
    """
    here, edge = f, at
    for _ in range(facet.shape[0]):
        other = _rocks_onto(facet, link, here, edge, accept)
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
    e: int,
    tally: Ints,
    edge: Floats,
    segment: Floats,
    contacts: Ints,
    accept: Acceptance,
    tolerance: float,
) -> None:
    """Enter the two sides of the gap beyond edge `e`, where they are boundary."""
    following = _after(span, f, at)
    other = link[at, NEIGHBOUR]
    back = matching_corner(span, link, f, at, other)
    p, q = row(corner, at), row(corner, following)
    q_far, p_far = row(corner, back), row(corner, _after(span, other, back))
    for end in range(2):
        near, far, opposite = (p, p_far, q) if end == 0 else (q, q_far, p)
        side = (0.0, 0.0, 0.0)
        if length(subtract(near, far)) > tolerance and not _surrounded(
            facet, span, link, f, at, end == 1, accept
        ):
            side = unit(cross(near, far))
            side = scale(side, math.copysign(1.0, dot(side, opposite)))
            # Each gap is entered from both its facets; its sides are boundary once.
            if f < other:
                i = link[at if end == 0 else following, VERTEX]
                _add_segment(tally, segment, contacts, near, far, opposite, i, i)
        _put(edge, e, SIDE_FROM if end == 0 else SIDE_TO, side)


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
def find_region(region: Region, table: FacetTable, acceptance: Acceptance, size: float) -> None:
    """Fill `region` from the facets of one posture.

    Parameters
    ----------
    region : Region
        Overwritten.
    table : FacetTable
        As `rounds.find_facets` leaves it.
    acceptance : Acceptance
        Which facets count.
    size : float
        Size of the robot, for the tolerance.
    """
    facet, span, corner, link = table.facet, table.span, table.corner, table.link
    tally, first, edge, about = region.tally, region.span, region.edge, region.link
    segment, contacts = region.segment, region.contacts
    tolerance = RELATIVE_TOLERANCE * size
    accept = Acceptance(
        acceptance.steepest,
        acceptance.least_cosine,
        acceptance.lowest_up,
        max(acceptance.least_height, tolerance),
    )
    accepted = _enter_facets(table.tally, facet, span, corner, region.facet, first, accept)
    tally[FACETS], tally[SEGMENTS], tally[GAPS] = accepted, 0, 0
    first[0, FIRST] = 0
    e = 0
    for k in range(accepted):
        f = first[k, SOURCE]
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            following = _after(span, f, at)
            p, q = row(corner, at), row(corner, following)
            edge_plane = unit(cross(p, q))
            _put(edge, e, POINT, p)
            _put(edge, e, EDGE_PLANE, edge_plane)
            about[e, EDGE_KIND], about[e, ACROSS] = TIP, -1
            other = link[at, NEIGHBOUR]
            boundary = True
            if other != f and _is_accepted(facet, other, accept):
                about[e, ACROSS] = span[other, PLACE]
                boundary = dot(row(facet, f), row(facet, other)) < accept.least_cosine
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
                        *(facet, span, corner, link, f, at, e),
                        *(tally, edge, segment, contacts, accept, tolerance),
                    )
            if boundary:
                i, j = link[at, VERTEX], link[following, VERTEX]
                _add_segment(tally, segment, contacts, p, q, edge_plane, i, j)
            e += 1
        first[k + 1, FIRST] = e
    tally[CONVEX] = 1 if _is_convex(segment, tally[SEGMENTS], edge, e) else 0


@njit(inline=True)
def stand(table: FacetTable, region: Region, primitives: Floats, acceptance: Acceptance) -> int:
    """Find the facets and the standing region of one posture.

    Parameters
    ----------
    table, region : FacetTable, Region
        Overwritten; as `facet_table` and `empty_region` make them for so many primitives.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    acceptance : Acceptance
        Which facets count.

    Returns
    -------
    int
        1 where the table was too small, which only spheres that overlap oddly do.
    """
    find_facets(table, primitives, acceptance.lowest_up)
    find_region(region, table, acceptance, robot_size(primitives))
    return int(table.tally[1])
