"""Ridges: what rolling over each edge of the accepted facets does to the weight, for any gravity.

Owns how high the com rises over an edge and what gravity becomes in the body beyond it.  Both are
linear in gravity, so each ridge is worked out once for a posture: the rolling robot does not slip
and does not turn about the ground's normal, and the ground's normal is that of the facet.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.arc import angle_between, arc_normal, rise_over, turned_along
from lutgen.support.gaps import HIGH, LOW
from lutgen.support.primitive import KIND, POINT, support_contact
from lutgen.support.region import (
    ACROSS,
    EDGE_PLANE,
    FACETS,
    SEGMENTS,
    SOURCE,
    Region,
    vector_at,
)
from lutgen.support.region import POINT as CORNER
from lutgen.support.table import FIRST, NEIGHBOUR, VERTEX, FacetTable, corner_after, put
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract, unit

# Places along an arc at which height and slope are known; a cubic between them is good to 2e-6 of
# the radius on the longest arc, of a right angle.  Steps of the rolling plane from one to the next.
PLACES, STEPS = 9, 4
# Columns of Ridges.beyond, and what BEYOND holds where the robot tips over.
BEYOND, MOVES = 0, 1
OVER = -1
# Columns of Ridges.turn and of Ridges.arc.
SEEN, RISE = 0, 9
TURNED, HEIGHT_AT, SLOPE_AT = 0, 1, 4


class Ridges(NamedTuple):
    """The edges of a region's facets as ridges; in the order of `Region.edge`.

    `beyond` (E, 2): accepted facet to which the robot rolls or OVER; 1 if its contacts move.
    `held` (E, 2): the part of the edge over which it is caught beyond, as in `FacetTable.held`.
    `turn` (E, 12): three rows that give gravity as the body sees it beyond, and the vector whose
    product with gravity is how far the com has risen there.  `arc` (E, PLACES, 7), where contacts
    move: the turn so far (rad), and the vectors that give height and slope (length per rad).
    `label` (L, 5) and `way` (L, 3) are room for `channels.barrier`.
    """

    beyond: NDArray[np.int64]
    held: NDArray[np.float64]
    turn: NDArray[np.float64]
    arc: NDArray[np.float64]
    label: NDArray[np.float64]
    way: NDArray[np.int64]


@njit()
def empty_ridges(primitives: int, labels: int) -> Ridges:
    """Return room for the ridges of `primitives` contact primitives; 0: none will be asked for."""
    edges = 36 * primitives
    return Ridges(
        np.empty((edges, 2), np.int64),
        np.empty((edges, 2)),
        np.empty((edges, 12)),
        np.empty((edges, PLACES, 7)),
        np.empty((labels, 5)),
        np.empty((labels, 3), np.int64),
    )


@njit(inline=True)
def has_ridges(tally: Ints) -> bool:
    """Tell whether a robot can roll to another facet before it tips over."""
    more: bool = (tally[FACETS] > 1) & (tally[SEGMENTS] > 0)
    return more


@njit()
def _enter(
    primitives: Floats, i: int, j: int, begin: Vector, end: Vector, moves: bool, e: int, out: Ridges
) -> None:
    """Fill the ridge of edge e: over primitives i and j from one facet's normal to another's."""
    # Where the three axes of the body of the start are by now, and how far each would have risen.
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    rise = (0.0, 0.0, 0.0)
    here = begin
    contact = support_contact(primitives, i, here)
    turned = 0.0
    steps = (PLACES - 1) * STEPS if moves else 1
    for step in range(steps + 1):
        if step > 0:
            there = (
                end
                if step == steps
                else arc_normal(primitives, i, j, begin, end, float(step) / steps)
            )
            beyond = support_contact(primitives, i, there)
            u, v, w = (
                turned_along(here, there, x),
                turned_along(here, there, y),
                turned_along(here, there, z),
            )
            # The com's height above the contact is g . p, and the contact's own changes by -g . dp.
            middle = (
                0.5 * (contact[0] + beyond[0]),
                0.5 * (contact[1] + beyond[1]),
                0.5 * (contact[2] + beyond[2]),
            )
            rise = (
                rise[0] + dot(subtract(u, x), middle),
                rise[1] + dot(subtract(v, y), middle),
                rise[2] + dot(subtract(w, z), middle),
            )
            turned += angle_between(here, there)
            x, y, z, here, contact = u, v, w, there, beyond
        if moves and step % STEPS == 0:
            at = step // STEPS
            apart = subtract(support_contact(primitives, j, here), contact)
            lever = scale(cross(contact, apart), 1.0 / length(apart))
            out.arc[e, at, TURNED] = turned
            for c in range(3):
                out.arc[e, at, HEIGHT_AT + c] = rise[c]
            out.arc[e, at, SLOPE_AT] = dot(lever, x)
            out.arc[e, at, SLOPE_AT + 1] = dot(lever, y)
            out.arc[e, at, SLOPE_AT + 2] = dot(lever, z)
    for c in range(3):
        out.turn[e, SEEN + 3 * c], out.turn[e, SEEN + 3 * c + 1] = x[c], y[c]
        out.turn[e, SEEN + 3 * c + 2] = z[c]
    put(out.turn, e, RISE, rise)


@njit()
def find_ridges(ridges: Ridges, table: FacetTable, region: Region, primitives: Floats) -> None:
    """Fill `ridges` from one posture's facets and region.

    Parameters
    ----------
    ridges : Ridges
        Overwritten; from `empty_ridges`.
    table, region : FacetTable, Region
        As `stand` leaves them.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    """
    span, link = table.span, table.link
    for k in range(region.tally[FACETS]):
        f = region.span[k, SOURCE]
        for c in range(span[f + 1, FIRST] - span[f, FIRST]):
            at, e = span[f, FIRST] + c, region.span[k, FIRST] + c
            ridges.held[e, LOW], ridges.held[e, HIGH] = table.held[at, LOW], table.held[at, HIGH]
            ridges.beyond[e, BEYOND] = region.link[e, ACROSS]
            if not table.held[at, LOW] < table.held[at, HIGH]:
                ridges.beyond[e, BEYOND] = OVER
            if ridges.beyond[e, BEYOND] == OVER:
                continue
            i, j = link[at, VERTEX], link[corner_after(span, f, at), VERTEX]
            moves = primitives[i, KIND] != POINT or primitives[j, KIND] != POINT
            ridges.beyond[e, MOVES] = 1 if moves else 0
            begin, end = row(table.facet, f), row(table.facet, link[at, NEIGHBOUR])
            _enter(primitives, i, j, begin, end, moves, e, ridges)


@njit(inline=True)
def _place_at_top(p: Vector, q: Vector, g: Vector) -> float:
    """Return over which part of the segment from p to q the com is when it is above the line."""
    apart = subtract(q, p)
    along = unit(apart)
    slant = dot(g, along)
    from_start = -dot(p, along)
    arm = length(cross(p, along))
    flat = math.sqrt(max(1.0 - slant * slant, 1e-30))
    return float(min(max((from_start + arm * slant / flat) / length(apart), 0.0), 1.0))


@njit(inline=True)
def _highest(arc: Floats, e: int, g: Vector) -> float:
    """Return how far the com rises along an arc at most, by cubics between its places."""
    most = 0.0
    a = slope = before = 0.0
    for at in range(PLACES):
        turned = arc[e, at, TURNED]
        b = arc[e, at, HEIGHT_AT] * g[0] + arc[e, at, 2] * g[1] + arc[e, at, 3] * g[2]
        falls = arc[e, at, SLOPE_AT] * g[0] + arc[e, at, 5] * g[1] + arc[e, at, 6] * g[2]
        most = max(most, b)
        if at > 0 and slope > 0.0 and falls < 0.0:
            first, last = slope * (turned - before), falls * (turned - before)
            c2 = 3.0 * (b - a) - 2.0 * first - last
            c3 = 2.0 * (a - b) + first + last
            root = math.sqrt(max(c2 * c2 - 3.0 * c3 * first, 0.0))
            t = min(max(first / (root - c2) if root - c2 > 0.0 else 0.5, 0.0), 1.0)
            most = max(most, a + t * (first + t * (c2 + t * c3)))
        a, slope, before = b, falls, turned
    return most


@njit()
def roll_over(
    region: Region, ridges: Ridges, e: int, following: int, g: Vector
) -> tuple[int, float, float, Vector]:
    """Roll over edge e of a facet, at whose end edge `following` begins.

    Returns the facet beyond, or OVER where the robot tips over; how far the com rises at most and
    in the end (length); and gravity as the body then sees it.  An edge that gravity is beyond
    already asks for no rise.
    """
    p, q = vector_at(region.edge, e, CORNER), vector_at(region.edge, following, CORNER)
    inside = dot(vector_at(region.edge, e, EDGE_PLANE), g) >= 0.0
    most = rise_over(p, q, g) if inside else 0.0
    other = ridges.beyond[e, BEYOND]
    if other != OVER and (ridges.held[e, LOW] > 0.0 or ridges.held[e, HIGH] < 1.0):
        place = _place_at_top(p, q, g)
        if not ridges.held[e, LOW] <= place <= ridges.held[e, HIGH]:
            other = OVER
    if other == OVER:
        return OVER, most, most, g
    turn = ridges.turn
    end = dot(vector_at(turn, e, RISE), g)
    seen = (
        dot(vector_at(turn, e, SEEN), g),
        dot(vector_at(turn, e, SEEN + 3), g),
        dot(vector_at(turn, e, SEEN + 6), g),
    )
    if ridges.beyond[e, MOVES] == 1:
        most = _highest(ridges.arc, e, g)
    elif inside and dot(cross(p, q), seen) >= 0.0:
        # The next facet is on the ground before the com is above the edge.
        most = max(end, 0.0)
    return other, most, end, seen
