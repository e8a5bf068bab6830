"""Support facets of robots with spheres and discs among their contacts.

Owns the search over normals.  A facet is a normal at which three support functions are equal and
no other is larger.  With round contacts facets need not be connected, and three wheels can share
several, so rolling from one to the next may miss some.  Instead the sphere of normals is halved
into cells, and a cell is dropped as soon as fewer than three primitives can be lowest anywhere in
it: the bound is that h_i - h_j changes by at most |p_i - p_j| per radian.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.hull import (
    FIRST,
    MASK,
    NEIGHBOUR,
    OUTSIDE,
    RELATIVE_TOLERANCE,
    VERTEX,
    FacetTable,
    add_facet,
    find_point_facets,
    lowest_beyond,
    robot_size,
)
from lutgen.support.primitive import DISC, KIND, POINT, RADIUS, support_contact, support_height
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract

NEWTON_STEPS = 24
# Halvings of a cube face: at the 7th a cell spans about half a degree.  A cell in which only three
# primitives are left is tried from the fourth on.
DEEPEST = 7
FIRST_TRIED = 4
# Newton may leave a cell by this many times its radius and still be looked at.
SEARCHED = 8.0


@njit()
def common_normal(
    primitives: Floats, i: int, j: int, k: int, start: Vector, reach_of_search: float, size: float
) -> tuple[bool, Vector]:
    """Solve for the plane that touches three primitives; Newton from the normal `start`.

    The contact point is the gradient of the support function, so the plane through the three
    contact points of the last normal is one Newton step.  Gives up where a step ends further
    than `reach_of_search` from the start.  Returns (found, unit normal).
    """
    normal = start
    for _ in range(NEWTON_STEPS):
        p = support_contact(primitives, i, normal)
        q = support_contact(primitives, j, normal)
        r = support_contact(primitives, k, normal)
        step = cross(subtract(q, p), subtract(r, p))
        area = length(step)
        # Written so that NaN (a disc on its face) fails too.
        if not area > RELATIVE_TOLERANCE * size * size:
            return False, normal
        step = scale(step, math.copysign(1.0 / area, dot(step, normal)))
        change = length(subtract(step, normal))
        normal = step
        if length(subtract(step, start)) > reach_of_search:
            return False, normal
        # Newton squares the error, so a step of 1e-9 leaves less than rounding.
        if change < 1e-9:
            return True, normal
    return False, normal


@njit(inline=True)
def _cell_normal(face: int, u: float, v: float) -> Vector:
    """Return the unit normal at (u, v) of a cube face, faces in the order -z +x -x +y -y +z."""
    inverse = 1.0 / math.sqrt(1.0 + u * u + v * v)
    if face == 0 or face == 5:
        return u * inverse, v * inverse, inverse if face == 5 else -inverse
    if face <= 2:
        return inverse if face == 1 else -inverse, u * inverse, v * inverse
    return u * inverse, inverse if face == 3 else -inverse, v * inverse


@njit()
def _furthest_apart(primitives: Floats, i: int, j: int) -> float:
    """Bound the distance of the contact points of two primitives, whatever the normal.

    Their radii point the same way, and so cancel, for two spheres or points and for two discs with
    parallel axes.
    """
    centres = length(subtract(row(primitives, i), row(primitives, j)))
    both = primitives[i, RADIUS] + primitives[j, RADIUS]
    apart = abs(primitives[i, RADIUS] - primitives[j, RADIUS])
    if primitives[i, KIND] != DISC and primitives[j, KIND] != DISC:
        return float(centres + apart)
    if primitives[i, KIND] == DISC and primitives[j, KIND] == DISC:
        a = (primitives[i, 3], primitives[i, 4], primitives[i, 5])
        b = (primitives[j, 3], primitives[j, 4], primitives[j, 5])
        if length(cross(a, b)) < 1e-12:
            return float(centres + apart)
    return float(centres + both)


@njit(inline=True)
def _candidates(
    primitives: Floats, spread: Floats, heights: Floats, normal: Vector, radius: float, among: int
) -> int:
    """Return the bit set, out of `among`, of primitives that can be lowest within `radius`.

    `heights` (n,) is room to work in.
    """
    best = -1
    furthest = -math.inf
    n = primitives.shape[0]
    for i in range(n):
        if among >> i & 1:
            heights[i] = support_height(primitives, i, normal)
            if heights[i] > furthest:
                furthest = heights[i]
                best = i
    kept = 0
    for i in range(n):
        if among >> i & 1 and furthest - heights[i] <= radius * spread[best, i]:
            kept |= 1 << i
    return kept


@njit()
def _try_triples(
    table: FacetTable,
    primitives: Floats,
    owner: Ints,
    normal: Vector,
    among: int,
    radius: float,
    size: float,
) -> float:
    """Look for facets on every three of the primitives `among`, beginning at `normal`.

    Returns the least distance from `normal` to a facet's normal; infinity if there is none.
    """
    nearest = math.inf
    count, facet, span = table.tally, table.facet, table.span
    corner, link = table.corner, table.link
    n = primitives.shape[0]
    for i in range(n):
        if not among >> i & 1:
            continue
        for j in range(i + 1, n):
            if not among >> j & 1:
                continue
            for k in range(j + 1, n):
                if not among >> k & 1:
                    continue
                three = 1 << i | 1 << j | 1 << k
                known = False
                for f in range(count[0]):
                    # A facet of more than three primitives holds all triples of them.
                    if span[f, MASK] & three == three:
                        away = length(subtract(row(facet, f), normal))
                        # Three wheels alone may share a second facet close by.
                        if away <= (radius if span[f, MASK] == three else SEARCHED * radius):
                            nearest = min(nearest, away)
                            known = True
                if known:
                    continue
                found, solved = common_normal(primitives, i, j, k, normal, SEARCHED * radius, size)
                if not found:
                    continue
                height = support_height(primitives, i, solved)
                below, mask = lowest_beyond(primitives, solved, height, RELATIVE_TOLERANCE * size)
                if (
                    below < 0
                    and add_facet(
                        *(count, facet, span, corner, link, owner, primitives),
                        *(solved, height, mask, size),
                    )
                    >= 0
                ):
                    nearest = min(nearest, length(subtract(solved, normal)))
    return nearest


@njit()
def find_round_facets(table: FacetTable, primitives: NDArray[np.float64], lowest_up: float) -> None:
    """Fill `table` with the support facets of any primitives.

    Parameters
    ----------
    table : FacetTable
        Overwritten.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    lowest_up : float
        Only facets whose normal's z is below this are wanted (more may be found).
    """
    n = primitives.shape[0]
    table.tally[0] = table.tally[1] = 0
    table.span[0, FIRST] = 0
    size = robot_size(primitives)
    owner = np.empty((0, 0), np.int64)
    spread = np.empty((n, n))
    heights = np.empty(n)
    for i in range(n):
        for j in range(n):
            spread[i, j] = _furthest_apart(primitives, i, j)
    # Depth first: each level leaves three cells behind.
    stack = np.empty((3 * DEEPEST + 1, 4))
    sets = np.empty(3 * DEEPEST + 1, np.int64)
    for face in range(6):
        stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3] = 0.0, 0.0, 1.0, 0.0
        sets[0] = (1 << n) - 1
        waiting = 1
        while waiting > 0:
            waiting -= 1
            u, v, half, depth = stack[waiting]
            normal = _cell_normal(face, u, v)
            # A corner is at most this far away: the cell lies at distance 1 or more.
            radius = half * math.sqrt(2.0)
            if normal[2] - radius > lowest_up:
                continue
            among = _candidates(primitives, spread, heights, normal, radius, sets[waiting])
            members = 0
            for i in range(n):
                members += among >> i & 1
            if members < 3:
                continue
            if depth == DEEPEST or (members == 3 and depth >= FIRST_TRIED):
                # Newton may leave the cell for another facet: then this one is not done.
                nearest = _try_triples(table, primitives, owner, normal, among, radius, size)
                if depth == DEEPEST or nearest <= radius:
                    continue
            for quarter in range(4):
                stack[waiting, 0] = u + half * (0.5 if quarter & 1 else -0.5)
                stack[waiting, 1] = v + half * (0.5 if quarter & 2 else -0.5)
                stack[waiting, 2] = half * 0.5
                stack[waiting, 3] = depth + 1.0
                sets[waiting] = among
                waiting += 1
    _join(table.tally, table.facet, table.span, table.corner, table.link)


@njit()
def _join(count: Ints, facet: Floats, span: Ints, corner: Floats, link: Ints) -> None:
    """Find for every edge the facet beyond it.

    Rolling over the edge i -> j ends on a facet that has j -> i.  Where several have, it is the
    one that comes first as the normal turns outwards about the edge.  A facet that lies behind the
    edge is not beyond it: two facets of three primitives share all three edges and are joined
    over one or two of them.
    """
    for f in range(count[0]):
        normal = row(facet, f)
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            following = at + 1 if at + 1 < span[f + 1, FIRST] else span[f, FIRST]
            i, j = link[at, VERTEX], link[following, VERTEX]
            outward = cross(subtract(row(corner, following), row(corner, at)), normal)
            outward = scale(outward, 1.0 / length(outward))
            link[at, NEIGHBOUR] = OUTSIDE
            least = math.inf
            for other in range(count[0]):
                if other == f or span[other, MASK] & (1 << i | 1 << j) != (1 << i | 1 << j):
                    continue
                begin, end = span[other, FIRST], span[other + 1, FIRST]
                for back in range(begin, end):
                    ahead = back + 1 if back + 1 < end else begin
                    if link[back, VERTEX] == j and link[ahead, VERTEX] == i:
                        beyond = row(facet, other)
                        turn = math.atan2(dot(beyond, outward), dot(beyond, normal))
                        if 0.0 < turn < least:
                            least = turn
                            link[at, NEIGHBOUR] = other


@njit(inline=True)
def find_facets(table: FacetTable, primitives: NDArray[np.float64], lowest_up: float) -> None:
    """Fill `table` with the support facets of one posture, see the two searches."""
    for i in range(primitives.shape[0]):
        if primitives[i, KIND] != POINT:
            find_round_facets(table, primitives, lowest_up)
            return
    find_point_facets(table, primitives, lowest_up)
