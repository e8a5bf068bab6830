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
from lutgen.support.arc import Arc, angle_between, arc_normal, turned_along
from lutgen.support.gaps import HIGH, LOW
from lutgen.support.primitive import KIND, POINT, support_contact
from lutgen.support.region import (
    ACROSS,
    EDGE_PLANE,
    FACETS,
    SEGMENTS,
    SOURCE,
    Region,
)
from lutgen.support.table import (
    FIRST,
    MOST_CORNERS,
    NEIGHBOUR,
    VERTEX,
    FacetTable,
    corner_after,
    put,
    vector_at,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract, unit

# Places along an arc at which height and slope are known; a cubic between them is good to 2e-6 of
# the radius on the longest arc, of a right angle.  Steps of the rolling plane from one to the next.
PLACES, STEPS = 9, 4
# Columns of Ridges.beyond, and what BEYOND holds where the robot tips over.
BEYOND, MOVES = 0, 1
OVER = -1
# Columns of Ridges.ridge and of Ridges.arc.
WALL, ALONG, ARM, REACH, FOOT, LENGTH, HELD_FROM, HELD_TO, SEEN, RISE = (
    *(0, 3, 6, 9, 10, 11, 12, 13, 14),
    23,
)
TURNED, HEIGHT_AT, SLOPE_AT = 0, 1, 4


class Ridges(NamedTuple):
    """The edges of a region's facets as ridges; in the order of `Region.edge`.

    `ridge` (E, 26): inward unit normal of the plane through edge and com; unit vector along the
    edge; from its line to the com, and how far; from its start to
    the foot of that, and its length; the part of it over which the
    robot is caught beyond (`FacetTable.held`); three rows that give gravity as the body sees it
    beyond, and the vector whose product with gravity is how far the com has risen there.
    `beyond` (E, 2): accepted facet to which the robot rolls or OVER; 1 if its contacts move.
    `arc` (E, PLACES, 7), where they do: the turn so far (rad), and the vectors that give height and
    slope (length per rad).  `label` (L, 5) and `way` (L, 3) are room for `channels.barrier`.
    """

    ridge: NDArray[np.float64]
    beyond: NDArray[np.int64]
    arc: NDArray[np.float64]
    label: NDArray[np.float64]
    way: NDArray[np.int64]


@njit()
def empty_ridges(primitives: int, labels: int) -> Ridges:
    """Return room for the ridges of `primitives` contact primitives; 0: none will be asked for."""
    edges = MOST_CORNERS * primitives
    return Ridges(
        np.empty((edges, 26)),
        np.empty((edges, 2), np.int64),
        np.empty((edges, PLACES, 7)),
        np.empty((labels, 5)),
        np.empty((labels, 3), np.int64),
    )


@njit(inline=True, bare=True)
def has_ridges(tally: Ints) -> bool:
    """Tell whether a robot can roll to another facet before it tips over."""
    more: bool = (tally[FACETS] > 1) & (tally[SEGMENTS] > 0)
    return more


@njit(bare=True)
def _enter(ridges: Ridges, e: int, primitives: Floats, way: Arc, moves: bool) -> None:
    """Fill the ridge of edge e, over which the robot rolls along an arc of normals."""
    ridge, arc = ridges.ridge, ridges.arc
    i, j, begin, end = way
    # Where the three axes of the body of the start are by now, and how far each would have risen.
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    rise = (0.0, 0.0, 0.0)
    here = begin
    contact = support_contact(primitives, i, here)
    turned = 0.0
    steps = (PLACES - 1) * STEPS if moves else 1
    for step in range(steps + 1):
        if step > 0:
            there = end if step == steps else arc_normal(primitives, way, float(step) / steps)
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
            arc[e, at, TURNED] = turned
            for c in range(3):
                arc[e, at, HEIGHT_AT + c] = rise[c]
            arc[e, at, SLOPE_AT] = dot(lever, x)
            arc[e, at, SLOPE_AT + 1] = dot(lever, y)
            arc[e, at, SLOPE_AT + 2] = dot(lever, z)
    for c in range(3):
        ridge[e, SEEN + 3 * c], ridge[e, SEEN + 3 * c + 1] = x[c], y[c]
        ridge[e, SEEN + 3 * c + 2] = z[c]
    put(ridge, e, RISE, rise)


@njit(bare=True)
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
    hull, held = table.hull, table.held
    facet, span, corner, link = hull.facet, hull.span, hull.corner, hull.link
    ridge, ways = ridges.ridge, ridges.beyond
    for k in range(region.tally[FACETS]):
        f = region.span[k, SOURCE]
        for c in range(span[f + 1, FIRST] - span[f, FIRST]):
            at, e = span[f, FIRST] + c, region.span[k, FIRST] + c
            following = corner_after(span, f, at)
            p, q = row(corner, at), row(corner, following)
            apart = subtract(q, p)
            along = unit(apart)
            arm = subtract(scale(along, dot(p, along)), p)
            put(ridge, e, WALL, vector_at(region.edge, e, EDGE_PLANE))
            put(ridge, e, ALONG, along)
            put(ridge, e, ARM, arm)
            ridge[e, REACH], ridge[e, FOOT] = length(arm), -dot(p, along)
            ridge[e, LENGTH] = length(apart)
            ridge[e, HELD_FROM], ridge[e, HELD_TO] = held[at, LOW], held[at, HIGH]
            caught = held[at, LOW] < held[at, HIGH]
            ways[e, BEYOND] = region.link[e, ACROSS] if caught else OVER
            if ways[e, BEYOND] == OVER:
                continue
            i, j = link[at, VERTEX], link[following, VERTEX]
            moves = primitives[i, KIND] != POINT or primitives[j, KIND] != POINT
            ways[e, MOVES] = 1 if moves else 0
            way = Arc(i, j, row(facet, f), row(facet, link[at, NEIGHBOUR]))
            _enter(ridges, e, primitives, way, moves)


@njit(inline=True, bare=True)
def _place_at_top(ridge: Floats, e: int, slant: float, flat: float) -> float:
    """Return over which part of edge e the com is when it is above its line.

    `slant` is the part of gravity along the edge, `flat` that across it.
    """
    place = (ridge[e, FOOT] + ridge[e, REACH] * slant / max(flat, 1e-30)) / ridge[e, LENGTH]
    return float(min(max(place, 0.0), 1.0))


@njit(inline=True, bare=True)
def _highest(arc: Floats, e: int, g: Vector) -> float:
    """Return how far the com rises along an arc at most, by cubics between its places."""
    most = a = slope = before = 0.0
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


@njit(inline=True, bare=True)
def roll_over(
    ridge: Floats, beyond: Ints, arc: Floats, e: int, g: Vector
) -> tuple[int, float, float, Vector]:
    """Roll over edge e.

    Returns the facet beyond, or OVER where the robot tips over; how far the com rises at most and
    in the end (length); and gravity as the body then sees it.  An edge that gravity is beyond
    already asks for no rise.  The rise over a line is that of `channels.plain.axis_energy`.
    """
    wall = vector_at(ridge, e, WALL)
    inside = dot(wall, g)
    slant = dot(vector_at(ridge, e, ALONG), g)
    flat = math.sqrt(max(1.0 - slant * slant, 0.0))
    reach = ridge[e, REACH]
    top, now = reach * flat, -dot(vector_at(ridge, e, ARM), g)
    most = top - now
    if now > 0.0:
        most = (reach * inside) * (reach * inside) / (top + now)
    most = most if inside >= 0.0 else 0.0
    other = beyond[e, BEYOND]
    if other != OVER and ridge[e, HELD_TO] - ridge[e, HELD_FROM] < 1.0:
        place = _place_at_top(ridge, e, slant, flat)
        if not ridge[e, HELD_FROM] <= place <= ridge[e, HELD_TO]:
            other = OVER
    last, seen = most, g
    if other != OVER:
        last = dot(vector_at(ridge, e, RISE), g)
        seen = (
            dot(vector_at(ridge, e, SEEN), g),
            dot(vector_at(ridge, e, SEEN + 3), g),
            dot(vector_at(ridge, e, SEEN + 6), g),
        )
        if beyond[e, MOVES] == 1:
            most = _highest(arc, e, g)
        elif inside >= 0.0 and dot(wall, seen) >= 0.0:
            # The next facet is on the ground before the com is above the edge.
            most = max(last, 0.0)
    return other, most, last, seen
