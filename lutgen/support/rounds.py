"""Support facets of any primitives, by rolling: from one facet over each edge onto the next.

Owns the general search.  On the sphere of normals each primitive is lowest in a cell; where two
cells meet two primitives carry, along an arc, and where three meet is a facet.  The search finds
one facet under the robot, and follows every arc from it until a third primitive touches.

What lies on one plane by design differs by rounding, and a search that takes what is near for equal
cannot be right for every noise: near is not transitive.  So every primitive is made larger by a
length of its own, a tenth of a billionth of the size, and in the robot that this makes three
primitives and never four touch one plane, well above rounding.  Its facets say who is whose
neighbour; where a facet is, is solved for with the primitives as they are, and what was torn apart
is put together again by `unite`.  Should the arcs not fit together even so, other lengths are
tried.  The lengths depend on the primitive's number by no straight line: the corners of a box are
numbered so that those across both diagonals of a face add up to the same, and such lengths would
leave all four on one plane.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.follow import OpenArc, excess, follow
from lutgen.support.primitive import KIND, POINT, RADIUS, SPHERE, support_contact, support_height
from lutgen.support.table import (
    FIRST,
    FOUND,
    MAX_PRIMITIVES,
    NEIGHBOUR,
    OUTSIDE,
    OVERFLOW,
    UNKNOWN,
    VERTEX,
    Hull,
    Workspace,
    add_triangle,
    corner_after,
    join,
)
from lutgen.vector import Floats, Vector, cross, dot, length, row, scale, subtract, unit

# Part of the size by which primitives are made larger.
GROWN = 1e-10
# Which part of that each is made larger by: the fraction of a cubic in its number.  No sum of these
# with whole weights is whole, so no weights of four contacts on one plane that are fractions cancel
# four such parts; of the triples of roots that were tried these come least near to it on boxes.
CUBIC = (math.sqrt(3.0) - 1.0, math.sqrt(23.0) - 4.0, math.sqrt(11.0) - 3.0)
ATTEMPTS = 4
NEWTON_STEPS = 24
# How far (n_z) above the highest wanted normal facets are still rolled on from, further than arcs
# are followed: they join pieces of the complex whose wanted facets are not joined by wanted ones.
BEYOND = 0.5
# Steps of the relaxation that looks for a plane on which a primitive is lowest.
RELAXATIONS = 24
# The z of a normal that leads out and down, before it is one; and how often a way there is begun.
DOWN, DOWNWARDS = -0.5, 4
# Parts of the size by which contacts may be off a facet's plane; beyond, the search is lost.
OFF = 1e-6
# What stands for a facet that is none: the search has lost its way.
LOST = -3
# Normals nearer than this (rad) with the same three primitives are one facet.
SAME = 1e-7


@njit(bare=True)
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
        if not area > 1e-9 * size * size:
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


@njit(bare=True)
def _enter(
    hull: Hull,
    solved: Floats,
    primitives: Floats,
    normal: Vector,
    three: tuple[int, int, int],
    size: float,
) -> int:
    """Return the facet of three primitives, counter-clockwise, at a normal; a new one if need be.

    `solved` (F, 3) holds the normals of the search, which are those of the enlarged primitives.
    """
    count, span, link = hull.tally, hull.span, hull.link
    for f in range(count[FOUND]):
        at = span[f, FIRST]
        for turn in range(3):
            a = link[at + turn, VERTEX]
            b, c = link[at + (turn + 1) % 3, VERTEX], link[at + (turn + 2) % 3, VERTEX]
            if (
                a == three[0]
                and b == three[1]
                and c == three[2]
                and length(subtract(row(solved, f), normal)) < SAME
            ):
                return f
    found, exact = common_normal(primitives, three[0], three[1], three[2], normal, 1e-5, size)
    place = exact if found else normal
    for c in range(3):
        # A disc that lies on its face touches in no single point.
        if math.isnan(support_contact(primitives, three[c], place)[0]):
            return OUTSIDE
    level = support_height(primitives, three[0], place)
    for m in range(primitives.shape[0]):
        above = level - support_height(primitives, m, place)
        if above < -OFF * size or (m in three and above > OFF * size):
            return LOST
    f = add_triangle(hull, primitives, place, three)
    if f >= 0:
        solved[f, 0], solved[f, 1], solved[f, 2] = normal
    return f


@njit(bare=True)
def _seed(
    hull: Hull,
    solved: Floats,
    primitives: Floats,
    grown: Floats,
    normal: Vector,
    lowest_up: float,
    size: float,
) -> bool:
    """Enter a facet found from a normal: turn the plane onto a second contact, and onto a third.

    Tells whether there is one that is wanted.
    """
    i = 0
    for m in range(1, grown.shape[0]):
        if excess(grown, m, i, normal) > 0.0:
            i = m
    across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.7 else (0.0, 1.0, 0.0)
    along = unit(subtract(across, scale(normal, dot(across, normal))))
    for _ in range(4):
        j, there = follow(grown, OpenArc(i, -1, normal, along), -1, lowest_up, size)
        if j >= 0:
            for turn in range(2):
                p, q = (i, j) if turn == 0 else (j, i)
                arm = subtract(support_contact(grown, q, there), support_contact(grown, p, there))
                ahead = cross(arm, there)
                if not length(ahead) > 0.0:
                    continue
                arc = OpenArc(p, q, there, unit(ahead))
                k, onto = follow(grown, arc, -1, lowest_up, size)
                # One way leads up where the other leads down.
                if (
                    k >= 0
                    and onto[2] <= lowest_up
                    and _enter(hull, solved, primitives, onto, (q, p, k), size) >= 0
                ):
                    return True
        along = cross(normal, along)
    return False


@njit(bare=True)
def _lowered(primitives: Floats, m: int, normal: Vector) -> tuple[int, Vector]:
    """Turn a plane until primitive m is lowest; return which one is, and the normal.

    Relaxation (Agmon; Motzkin and Schoenberg 1954): turn it past where the two are equally low.
    """
    lowest = 0
    for _ in range(RELAXATIONS):
        lowest = m
        for i in range(primitives.shape[0]):
            if excess(primitives, i, lowest, normal) > 0.0:
                lowest = i
        if lowest == m:
            break
        apart = subtract(
            support_contact(primitives, m, normal), support_contact(primitives, lowest, normal)
        )
        past = 1.5 * dot(apart, normal) / max(dot(apart, apart), 1e-300)
        normal = unit(subtract(normal, scale(apart, past)))
    return lowest, normal


@njit(bare=True)
def _roll_on(
    hull: Hull,
    solved: Floats,
    primitives: Floats,
    grown: Floats,
    first: int,
    lowest_up: float,
    size: float,
) -> bool:
    """Follow all arcs from facet `first` on; tell whether the ends of all of them agree."""
    count, span, link = hull.tally, hull.span, hull.link
    agreed = True
    f = first
    while f < count[FOUND]:
        normal = row(solved, f)
        begin = span[f, FIRST]
        for at in range(begin, begin + 3):
            if link[at, NEIGHBOUR] != UNKNOWN:
                continue
            following = corner_after(span, f, at)
            i, j = link[at, VERTEX], link[following, VERTEX]
            third = link[corner_after(span, f, following), VERTEX]
            link[at, NEIGHBOUR] = OUTSIDE
            if normal[2] > lowest_up + BEYOND:
                continue
            arm = subtract(support_contact(grown, j, normal), support_contact(grown, i, normal))
            ahead = cross(arm, normal)
            if not length(ahead) > 0.0:
                agreed = False
                continue
            arc = OpenArc(i, j, normal, unit(ahead))
            m, onto = follow(grown, arc, third, lowest_up, size)
            if m < 0:
                continue
            other = _enter(hull, solved, primitives, onto, (j, i, m), size)
            if other < 0:
                agreed = agreed and other != LOST
                continue
            back = span[other, FIRST]
            while link[back, VERTEX] != j:
                back += 1
            if link[back, NEIGHBOUR] >= 0 or (other == f and back == at):
                agreed = False
                continue
            join(link, f, at, other, back)
        f += 1
    return agreed


@njit(bare=True)
def find_round_facets(
    work: Workspace, primitives: NDArray[np.float64], lowest_up: float, size: float
) -> bool:
    """Fill the pieces of `work` with the support facets of any primitives.

    Parameters
    ----------
    work : Workspace
        Overwritten; every facet has three corners.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    lowest_up : float
        Only facets whose normal's z is below this are wanted (more may be found).
    size : float
        Size of the robot (length).

    Returns
    -------
    bool
        Whether the ends of all arcs agree and there was room for what was found.
    """
    n = primitives.shape[0]
    hull, solved, grown = work.pieces, work.normals, work.grown[:n]
    count, span, link = hull.tally, hull.span, hull.link
    for i in range(n):
        for c in range(primitives.shape[1]):
            grown[i, c] = primitives[i, c]
    agreed = True
    for attempt in range(ATTEMPTS):
        count[FOUND] = count[OVERFLOW] = 0
        span[0, FIRST] = 0
        if n < 3:
            return True
        for i in range(n):
            number = 1.0 + i + attempt * MAX_PRIMITIVES
            own = number * (CUBIC[0] + number * (CUBIC[1] + number * CUBIC[2]))
            grown[i, RADIUS] = primitives[i, RADIUS] + GROWN * size * (own - math.floor(own))
            if primitives[i, KIND] == POINT:
                grown[i, KIND] = SPHERE
        agreed, met, seen = True, 0, 0
        for m in range(n):
            # Whatever is lowest somewhere is a corner of some facet.
            while seen < span[count[FOUND], FIRST]:
                met |= 1 << link[seen, VERTEX]
                seen += 1
            if met >> m & 1:
                continue
            lowest, normal = _lowered(grown, m, unit(row(grown, m)))
            for _ in range(DOWNWARDS):
                if lowest == m and normal[2] <= max(lowest_up, 0.0):
                    break
                # It may be lowest further down: the centre of a foot may be above the com and its
                # sole below.
                lowest, normal = _lowered(grown, m, unit((normal[0], normal[1], DOWN)))
            if lowest != m or normal[2] > max(lowest_up, 0.0):
                continue
            first = count[FOUND]
            if _seed(hull, solved, primitives, grown, normal, lowest_up, size):
                agreed = (
                    _roll_on(hull, solved, primitives, grown, first, lowest_up, size) and agreed
                )
        if agreed or count[OVERFLOW] == 1:
            break
    for at in range(span[count[FOUND], FIRST]):
        if link[at, NEIGHBOUR] == UNKNOWN:
            link[at, NEIGHBOUR] = OUTSIDE
    return agreed and count[OVERFLOW] == 0
