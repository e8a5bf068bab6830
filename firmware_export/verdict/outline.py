"""Outlines of the standing region at a lattice of postures, drawn so that they hold around them.

Owns the argument by which a tree is safe for any robot: round contacts, gaps over which it rocks,
facets that `upright` or `rock_angle` refuse, so that the region jumps with the parameters.

The box of parameters is cut into sub-cells.  What may tip anywhere in a sub-cell is found at its
middle:

- Each segment of the outline lies on the edge between two contact points.  They move by at most D
  from the middle to any corner (measured on the contacts' centres, plus the radius times the turn
  of the facet), so the segment, at the distance d from the com, turns by at most delta =
  asin(D / d).  It is made longer by that at both ends.  What shifts it inwards is only how far they
  move across its plane, seen from the com where its ends are: on a great circle no place between
  two ends is shifted by more than these.
- Where a facet is accepted or the robot rocks at the middle but not at q, the region jumps.
  Normals turn by at most about D / w over a facet of width w, so the region is computed with
  `upright` and `rock_angle` tightened by that for w a quarter of the robot's size.  A rest at the
  middle may be narrower at q by 2 D and what its rims roll; and contacts near its plane may have
  left it, so none but those on it count.
- The part of an edge that a gap holds ends where a wall of a rest meets it, which moves faster than
  the wall itself: a segment on the side of a gap is shifted by `SWAY` delta, and every segment is
  made longer by as much.
- No angle tells how near a roll is to going over an edge that it does not go over.  So a middle
  speaks for twice the width of its sub-cell, and a posture is safe where all the 2^k middles around
  it say so: of 3.2 million configurations of Absolem the nearest middle alone missed nine.

At one posture what is safe must meet no piece of outline, and stand at one place.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import PLACES
from firmware_export.truth import Model
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.support import (
    TIPS,
    Acceptance,
    FacetTable,
    Region,
    empty_region,
    facet_table,
    facets_in,
    is_convex,
    radius_at,
    robot_size,
    segments_in,
    stand,
    start_at,
    status_of,
    stop_at,
    supporting_facet,
    tip_plane_at,
)
from lutgen.vector import Floats, Vector, cross, dot, length, row, scale

# Pieces of outline that a posture can have, and the longest arc of one (rad).
MOST_PIECES, LONGEST = 160, 0.35
# Width of facets that the limits are tightened for, in robot sizes.
WIDTH = 0.25
# Contacts move a little further to a corner than along each axis by itself.
CURVED = 1.02
# How much faster than a wall the end of a gap moves along its edge: the rests beyond it, whose
# walls cut it off, lean as the robot's contacts move, and gravity has turned with the roll.
SWAY = 3.0
# By how much the runtime may misplace gravity, without floats most: as a part of u and v by the
# rounding of two divisions and of the chart's limit, rad at 45 deg; and by places of 65536.
ASTRAY, ROUNDED = 1.2e-4, 4.0


class Slab(NamedTuple):
    """Middles of a box of the lattice, as kernels read them.

    `low`, `high` (m, k): the places, 0 to 1, for which each middle speaks.  `primitives` (m, n, 8),
    `moved` (m, n): the contacts, and how far each moves at most from there to such a place;
    `ways` (m, 2 k, n, 3): where it moves half of that along each axis by itself, down and up.
    `acceptance`: tightened for all of them, angles by `tighter` (rad).
    """

    low: Floats
    high: Floats
    primitives: Floats
    moved: Floats
    ways: NDArray[np.float64]
    acceptance: Acceptance
    tighter: float


class View(NamedTuple):
    """What is the same for all postures.

    `basis` (faces, 3, 3) and `reach`: the chart.  `slack` (rad): added to every shift.
    """

    basis: Floats
    reach: float
    slack: float


class Sheet(NamedTuple):
    """Room for the outline of one posture, and what is drawn there.

    `pieces` (MOST_PIECES, 4): straight pieces u0, v0, u1, v1, each -1 to 1 over the chart;
    `counts` (faces,) of each face, one after another.  `arcs` (B, 13): per segment the direction
    in which it begins, the way it runs, its normal; its length, by how much it is made longer, and
    the sine of its shift and the shift.
    """

    table: FacetTable
    region: Region
    pieces: NDArray[np.float64]
    counts: NDArray[np.int64]
    arcs: NDArray[np.float64]


def view_of(basis: Floats, reach: float) -> View:
    """Return the view of a chart."""
    return View(basis, reach, ASTRAY + ROUNDED * 2.0 * reach / PLACES)


def too_many_pieces(model: Model) -> InputError:
    """Return the error for a robot whose standing region has more pieces than there is room for."""
    return InputError(
        f"{model.recipe.source}: a standing region has more than {MOST_PIECES} pieces of outline; "
        "choose the codec `contacts`."
    )


@njit()
def empty_sheet(contacts: int, faces: int) -> Sheet:
    """Return room for the outline of a posture with so many contacts."""
    region = empty_region(contacts)
    return Sheet(
        facet_table(contacts),
        region,
        np.empty((MOST_PIECES, 4)),
        np.zeros(faces, np.int64),
        np.empty((len(region.segment), 13)),
    )


@njit(inline=True)
def _blend(a: Vector, wa: float, b: Vector, wb: float) -> Vector:
    return a[0] * wa + b[0] * wb, a[1] * wa + b[1] * wb, a[2] * wa + b[2] * wb


@njit()
def _clip(p: Vector, q: Vector, basis: Floats, limit: float, out: Floats, at: int) -> int:
    """Append the part of a chord that lies on a face; return the new count."""
    low, high = 0.0, 1.0
    middle, across, upward = row(basis, 0), row(basis, 1), row(basis, 2)
    for side in range(5):
        if side == 0:
            f, g = dot(middle, p) - 1e-9, dot(middle, q) - 1e-9
        else:
            way = across if side < 3 else upward
            sign = 1.0 if side & 1 else -1.0
            f = limit * dot(middle, p) + sign * dot(way, p)
            g = limit * dot(middle, q) + sign * dot(way, q)
        if f < 0.0 and g < 0.0:
            return at
        if f < 0.0:
            low = max(low, f / (f - g))
        elif g < 0.0:
            high = min(high, f / (f - g))
    if low >= high:
        return at
    for end in range(2):
        x = _blend(p, 1.0 - (high if end else low), q, high if end else low)
        depth = dot(middle, x)
        out[at, 2 * end] = min(max(dot(across, x) / depth / limit, -1.0), 1.0)
        out[at, 2 * end + 1] = min(max(dot(upward, x) / depth / limit, -1.0), 1.0)
    return at + 1


@njit()
def _across(ways: NDArray[np.float64], i: int, normal: Vector) -> float:
    """Return how far a contact moves at most across a plane."""
    total = 0.0
    for a in range(0, len(ways), 2):
        total += max(abs(dot(row(ways[a], i), normal)), abs(dot(row(ways[a + 1], i), normal)))
    return total


@njit()
def _enter_arcs(sheet: Sheet, slab: Slab, p: int, slack: float) -> int:
    """Fill `arcs`: the segments of the boundary, and by how much each is shifted."""
    region, arcs = sheet.region, sheet.arcs
    primitives, moved, ways = slab.primitives[p], slab.moved[p], slab.ways[p]
    n = primitives.shape[0]
    size = robot_size(primitives)
    farthest = 0.0
    for i in range(n):
        farthest = max(farthest, moved[i])
    turn = farthest / (WIDTH * size)
    everywhere = farthest
    for i in range(n):
        everywhere = max(everywhere, moved[i] + radius_at(primitives, i) * turn)
    segments = segments_in(region.tally)
    for b in range(segments):
        start, stop = start_at(region.segment, b), stop_at(region.segment, b)
        normal = tip_plane_at(region.segment, b)
        i, j = region.contacts[b, 0], region.contacts[b, 1]
        shift = max(
            moved[i] + radius_at(primitives, i) * turn,
            moved[j] + radius_at(primitives, j) * turn,
        )
        if i == j:
            # On the side of a gap, with whatever is on its other side.
            shift = SWAY * everywhere
        # Distance of the com from the segment.
        edge = _blend(stop, 1.0, start, -1.0)
        part = -dot(start, edge) / max(dot(edge, edge), 1e-300)
        near = length(_blend(start, 1.0, edge, min(max(part, 0.0), 1.0)))
        delta = math.asin(min(shift / max(near, 1e-300), 1.0)) + slack
        across = delta
        if i != j:
            most = max(
                _across(ways, i, normal) + radius_at(primitives, i) * turn,
                _across(ways, j, normal) + radius_at(primitives, j) * turn,
            )
            # Of a part of an edge the ends are between the contacts, and may be nearer than these.
            ends = max(min(length(start), length(stop)) - shift, 1e-300)
            across = min(math.asin(min(CURVED * most / ends, 1.0)) + slack, delta)
        a = scale(start, 1.0 / length(start))
        along = cross(normal, a)
        for c in range(3):
            arcs[b, c], arcs[b, 3 + c], arcs[b, 6 + c] = a[c], along[c], normal[c]
        arcs[b, 9] = math.atan2(dot(along, stop), dot(a, stop))
        arcs[b, 10], arcs[b, 11] = delta, math.sin(min(across, 0.5 * math.pi))
        arcs[b, 12] = across
    return segments


@njit()
def draw(sheet: Sheet, slab: Slab, p: int, view: View) -> int:
    """Find the standing region of a posture and draw its outline, shifted; -1: too many pieces."""
    region, arcs, out = sheet.region, sheet.arcs, sheet.pieces
    stand(sheet.table, region, slab.primitives[p], slab.acceptance)
    segments = _enter_arcs(sheet, slab, p, view.slack)
    total = 0
    for face in range(len(view.basis)):
        begin = total
        for b in range(segments):
            a, along, normal = row(arcs, b), row(arcs[:, 3:], b), row(arcs[:, 6:], b)
            arc, delta = arcs[b, 9], arcs[b, 10]
            gap = region.contacts[b, 0] == region.contacts[b, 1]
            longer = delta if gap else min(SWAY * delta, LONGEST)
            whole = arc + 2.0 * longer
            steps = math.ceil(whole / LONGEST)
            half = 0.5 * whole / steps
            lean = math.atan(math.tan(arcs[b, 12]) / math.cos(half))
            for step in range(steps):
                mid = -longer + (2 * step + 1) * half
                c = _blend(a, math.cos(mid), along, math.sin(mid))
                inner = _blend(normal, math.cos(lean), c, -math.sin(lean))
                c = _blend(c, math.cos(lean), normal, math.sin(lean))
                side = cross(inner, c)
                start = _blend(c, math.cos(half * 1.02), side, -math.sin(half * 1.02))
                stop = _blend(c, math.cos(half * 1.02), side, math.sin(half * 1.02))
                if total >= len(out):
                    return -1
                total = _clip(start, stop, view.basis[face], view.reach, out, total)
        sheet.counts[face] = total - begin
    return total


@njit(inline=True)
def may_tip(sheet: Sheet, g: Vector) -> bool:
    """Tell whether a unit direction tips in the posture drawn, or is within its outline's shift."""
    region, arcs = sheet.region, sheet.arcs
    k = supporting_facet(region.facet, facets_in(region.tally), g)
    convex = is_convex(region.tally)
    if k < 0 or (not convex and status_of(region, k, g) == TIPS):
        return True
    for b in range(segments_in(region.tally)):
        inside = arcs[b, 6] * g[0] + arcs[b, 7] * g[1] + arcs[b, 8] * g[2]
        if convex and inside < 0.0:
            return True
        if abs(inside) <= arcs[b, 11]:
            ahead = arcs[b, 3] * g[0] + arcs[b, 4] * g[1] + arcs[b, 5] * g[2]
            here = arcs[b, 0] * g[0] + arcs[b, 1] * g[1] + arcs[b, 2] * g[2]
            delta = arcs[b, 10]
            if -1.5 * delta <= math.atan2(ahead, here) <= arcs[b, 9] + 1.5 * delta:
                return True
    return False
