"""Facets that are one: neighbours joined by a shorter arc than any sensor could tell.

Owns the step from the complex, whose facets have three contacts each, to facets with as many
corners as a plane has contacts.  Four wheels on one plane come as two triangles, or as two with a
sliver between them; the arcs that join them are as short as the rounding of their positions.  What
is joined by such arcs, and is convex, gets one normal, that of its largest member, and one polygon;
its edges are those of its members that lead to other facets, so what lies beyond each stays known.
"""

from lutgen.jit import njit
from lutgen.support.primitive import support_contact, support_height
from lutgen.support.table import (
    BACK,
    FIRST,
    FOUND,
    MASK,
    NEIGHBOUR,
    OUTSIDE,
    OVERFLOW,
    RELATIVE_TOLERANCE,
    VERTEX,
    FacetTable,
    Hull,
    corner_after,
    doubled_area,
    put,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, subtract

# rad; arcs shorter than this join what is one facet, see docs/reference/conventions.md.
SHORT_ARC = 1e-7


@njit(inline=True, bare=True)
def _root(parent: Ints, f: int) -> int:
    while parent[f] != f:
        f = parent[f]
    return f


@njit(inline=True, bare=True)
def _joined(facet: Floats, link: Ints, f: int, at: int) -> bool:
    """Tell whether the arc at an edge of facet f is short and known from both its ends."""
    other = link[at, NEIGHBOUR]
    if other < 0 or link[at, BACK] < 0:
        return False
    return length(subtract(row(facet, f), row(facet, other))) < SHORT_ARC


@njit(bare=True)
def _groups(hull: Hull, parent: Ints) -> int:
    """Fill `parent` with the first facet of each one's group; return how many arcs are short."""
    facets, facet, span, link = hull.tally[FOUND], hull.facet, hull.span, hull.link
    short = 0
    for f in range(facets):
        parent[f] = f
    for f in range(facets):
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            if link[at, NEIGHBOUR] > f and _joined(facet, link, f, at):
                short += 1
                a, b = _root(parent, f), _root(parent, link[at, NEIGHBOUR])
                parent[max(a, b)] = min(a, b)
    for f in range(facets):
        parent[f] = _root(parent, f)
    return short


@njit(bare=True)
def _walk(
    hull: Hull, parent: Ints, owner: Ints, group: int, start: int, out: Ints, begin: int
) -> int:
    """List the corners where the edges of a group's outline begin, from `start` on.

    Returns the end of the list in `out`, which is filled from `begin` on; `owner` (E,) holds the
    facet of each corner.
    """
    span, link = hull.span, hull.link
    at, end = start, begin
    for _ in range(link.shape[0]):
        out[end] = at
        end += 1
        at = corner_after(span, owner[at], at)
        for _ in range(link.shape[0]):
            other = link[at, NEIGHBOUR]
            if other < 0 or parent[other] != group:
                break
            at = corner_after(span, other, link[at, BACK])
        if at == start or end >= out.shape[0]:
            break
    return end


@njit(bare=True)
def _is_bent_in(corner: Floats, outline: Ints, normal: Vector, size: float) -> bool:
    """Tell whether a corner of an outline lies inside the line between its neighbours."""
    n = outline.shape[0]
    for at in range(n):
        p, q = row(corner, outline[at - 1]), row(corner, outline[at])
        r = row(corner, outline[at + 1 if at + 1 < n else 0])
        along = subtract(r, p)
        depth = dot(cross(subtract(q, p), along), normal)
        if depth < -RELATIVE_TOLERANCE * size * length(along):
            return True
    return False


@njit(bare=True)
def _outlines(hull: Hull, parent: Ints, owner: Ints, outline: Ints, size: float) -> None:
    """Take groups apart whose outline is bent in, since a facet's cone is cut out by its edges."""
    facets, facet, span, link = hull.tally[FOUND], hull.facet, hull.span, hull.link
    for f in range(facets):
        if parent[f] != f:
            continue
        start, members = -1, 0
        for member in range(f, facets):
            if parent[member] == f:
                members += 1
                for at in range(span[member, FIRST], span[member + 1, FIRST]):
                    other = link[at, NEIGHBOUR]
                    if start < 0 and (other < 0 or parent[other] != f):
                        start = at
        if members == 1:
            continue
        end = _walk(hull, parent, owner, f, start, outline, 0) if start >= 0 else 0
        if end < 3 or _is_bent_in(hull.corner, outline[:end], row(facet, f), size):
            for member in range(f, facets):
                if parent[member] == f:
                    parent[member] = -1 - member
    for f in range(facets):
        if parent[f] < 0:
            parent[f] = -1 - parent[f]


@njit(bare=True)
def _begin_at_lowest(link: Ints, outline: Ints, begin: int, end: int) -> None:
    """Turn an outline round so that it begins at the corner of its lowest primitive."""
    lowest = begin
    for at in range(begin, end):
        if link[outline[at], VERTEX] < link[outline[lowest], VERTEX]:
            lowest = at
    for _ in range(lowest - begin):
        first = outline[begin]
        for at in range(begin, end - 1):
            outline[at] = outline[at + 1]
        outline[end - 1] = first


@njit(bare=True)
def unite(table: FacetTable, primitives: Floats, size: float) -> None:
    """Fill the hull of `table` from its pieces: those that short arcs join as one facet.

    Parameters
    ----------
    table : FacetTable
        Its `work` is as `search.find_facets` leaves it; where no arc is short the pieces are
        copied.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    size : float
        Size of the robot (length).
    """
    pieces, counts = table.work.pieces, table.work.counts
    count, facet, span, corner, link = pieces
    tally, new, bounds, points, links = table.hull
    facets = count[FOUND]
    tally[FOUND], tally[OVERFLOW] = facets, count[OVERFLOW]
    bounds[0, FIRST] = 0
    corners = span[facets, FIRST]
    parent, moved = counts[0], counts[1, :corners]
    moved[:] = OUTSIDE
    if _groups(pieces, parent) == 0:
        for f in range(facets):
            put(new, f, 0, row(facet, f))
            new[f, 3] = facet[f, 3]
            begin, end = span[f, FIRST], span[f + 1, FIRST]
            bounds[f, FIRST], bounds[f, MASK] = begin, span[f, MASK]
            lowest = begin
            for at in range(begin, end):
                if link[at, VERTEX] < link[lowest, VERTEX]:
                    lowest = at
            for at in range(begin, end):
                moved[at] = begin + (at - lowest + end - begin) % (end - begin)
        bounds[facets, FIRST] = span[facets, FIRST]
        for at in range(span[facets, FIRST]):
            to, back = moved[at], link[at, BACK]
            put(points, to, 0, row(corner, at))
            links[to, VERTEX], links[to, NEIGHBOUR] = link[at, VERTEX], link[at, NEIGHBOUR]
            links[to, BACK] = moved[back] if back >= 0 else OUTSIDE
        return
    owner, outline, number = counts[2], counts[3, :corners], counts[4]
    for f in range(facets):
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            owner[at] = f
    _outlines(pieces, parent, owner, outline, size)
    groups, end = 0, 0
    for f in range(facets):
        if parent[f] != f:
            continue
        largest, best, start, mask = -1.0, f, -1, 0
        for member in range(f, facets):
            if parent[member] != f:
                continue
            area = doubled_area(corner, span[member, FIRST], span[member + 1, FIRST])
            mask |= span[member, MASK]
            if area > largest:
                largest, best = area, member
            for at in range(span[member, FIRST], span[member + 1, FIRST]):
                other = link[at, NEIGHBOUR]
                if start < 0 and (other < 0 or parent[other] != f):
                    start = at
        begin = end
        bounds[groups, FIRST], bounds[groups, MASK] = begin, mask
        put(new, groups, 0, row(facet, best))
        new[groups, 3] = facet[best, 3]
        if start >= 0:
            end = _walk(pieces, parent, owner, f, start, outline, begin)
        _begin_at_lowest(link, outline, begin, end)
        normal = row(facet, best)
        for at in range(begin, end):
            moved[outline[at]] = at
            i = link[outline[at], VERTEX]
            put(points, at, 0, support_contact(primitives, i, normal))
            new[groups, 3] = max(new[groups, 3], support_height(primitives, i, normal))
        for member in range(f, facets):
            if parent[member] == f:
                number[member] = groups
        groups += 1
    bounds[groups, FIRST] = end
    tally[FOUND] = groups
    for at in range(end):
        old = outline[at]
        other, back = link[old, NEIGHBOUR], link[old, BACK]
        links[at, VERTEX] = link[old, VERTEX]
        links[at, NEIGHBOUR] = number[other] if other >= 0 else other
        links[at, BACK] = moved[back] if back >= 0 else OUTSIDE
