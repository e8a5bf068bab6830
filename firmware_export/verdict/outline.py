"""Outlines of the standing region at a lattice of postures, drawn so that they hold around them.

Owns the argument by which a table is safe for any robot: round contacts, gaps over which it rocks,
facets that `upright` or `rock_angle` refuse, so that the region jumps with the parameters.

The box of parameters is cut into sub-cells, none of which a knot crosses, so that in a sub-cell the
table is multilinear in the parameters.  It is below zero at a direction throughout a sub-cell if it
is at the sub-cell's corners.  There it is below zero wherever any node of the lattice says that a
direction may tip, of those from which the corner is one sub-cell away or none along each axis.  So
a direction that the table calls safe in a sub-cell stands at all of its corners:

- Each segment of a node's outline runs between two contact points.  From the nearest node to a
  posture they move by at most D (half a sub-cell along each axis, measured on the contacts'
  centres, plus the radius times the turn of the facet), so the segment, at the distance d from the
  com, turns by at most delta = asin(D / d).  It is shifted inwards by delta, and made longer by
  delta at both ends.
- Where a facet is accepted or the robot rocks at the nodes but not between them, the region jumps.
  What decides that, an angle or a width, is all but linear over a sub-cell: if it suffices at all
  corners it does between them, but for `BENT` of how far it changes.  Normals turn by at most about
  D / w over a facet of width w, so the region is computed with `upright` and `rock_angle` tightened
  by that part of it for w a quarter of the robot's size, and rests are wider by the same part of
  2 D and of what rims roll.  Contacts near a facet's plane may have left it, so none but those on
  it count.  No angle tells how near a roll is to going over an edge that it does not go over: of
  3.2 million configurations of Absolem the nearest node alone missed nine, all corners none.
- The part of an edge that a gap holds ends where a wall of a rest meets it, which moves faster than
  the wall itself: a segment on the side of a gap is shifted by `SWAY` delta, and every segment is
  made longer by as much.

At one posture the table is bilinear in (u, v) within a cell: on the part of a cell that tips its
maximum is on the outline, where it is a quadratic along straight pieces, or at a corner that tips.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import SPAN
from firmware_export.truth import Model, combinations
from lutgen.channels import acceptance_of
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import in_threads, njit
from lutgen.support import (
    TIPS,
    Acceptance,
    Region,
    empty_region,
    facet_table,
    facets_in,
    is_convex,
    pack,
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
from lutgen.vector import Bools, Floats, Ints, Vector, cross, dot, length, row, scale

# Pieces of outline that a posture can have, and the longest arc of one (rad).
MOST_PIECES, LONGEST = 160, 0.35
# Width of facets that the limits are tightened for, in robot sizes.
WIDTH = 0.25
# Part of how far contacts move by which what decides a jump may be off a line between two nodes.
BENT = 0.2
# How much faster than a wall the end of a gap moves along its edge: the rests beyond it, whose
# walls cut it off, lean as the robot's contacts move, and gravity has turned with the roll.
SWAY = 3.0
# Contacts move a little further to a corner than along each axis by itself.
CURVED = 1.02
CHUNK = 4096
# By how many units of an axis the runtime may misplace a parameter: 1/16384 of a cell.
MISPLACED = 4.0
# By how much (rad) it may misplace gravity, the integer path most: u and v by 1/16384 of a cell and
# the rounding of two divisions, each relative to the distance from the middle; at least, and per
# unit of the chart's limit.
ASTRAY, ASTRAY_SHARE = 4e-4, 1.1e-4


class Outlines(NamedTuple):
    """Outlines of a lattice of postures, and which directions may tip.

    `axes`: per parameter the nodes, 0 to 1, at which sub-cells end; the P postures are all of their
    combinations.  `pieces` (total, 4) float32: straight pieces u0, v0, u1, v1, each 0 to 1 over the
    chart; those of a posture on a face begin at `first` (P faces + 1,).  `tips` (P, J) bool:
    whether each direction asked for tips, or is within the shift of the outline.  `tighter` (rad):
    by how much limits are tightened.
    """

    axes: tuple[NDArray[np.float64], ...]
    pieces: NDArray[np.float32]
    first: Ints
    tips: Bools
    tighter: float


class _View(NamedTuple):
    """What is the same for all postures.

    `basis` (faces, 3, 3) and `reach`: the chart.  `gravity` (J, 3): directions to be judged.
    `slack` (rad): added to every shift.
    """

    basis: Floats
    reach: float
    gravity: Floats
    slack: float


class _Filled(NamedTuple):
    """What is found of m postures.

    `pieces` (m, MOST_PIECES, 4) float32: as in `Outlines`, `counts` (m, faces) of each face, or -1
    where there are too many, and `tips` (m, J).
    """

    pieces: NDArray[np.float32]
    counts: Ints
    tips: Bools


@njit(inline=True)
def _blend(a: Vector, wa: float, b: Vector, wb: float) -> Vector:
    return a[0] * wa + b[0] * wb, a[1] * wa + b[1] * wb, a[2] * wa + b[2] * wb


@njit()
def _clip(
    p: Vector, q: Vector, basis: Floats, limit: float, out: NDArray[np.float32], at: int
) -> int:
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
        out[at, 2 * end] = min(max((dot(across, x) / depth / limit + 1.0) / 2.0, 0.0), 1.0)
        out[at, 2 * end + 1] = min(max((dot(upward, x) / depth / limit + 1.0) / 2.0, 0.0), 1.0)
    return at + 1


@njit()
def _flag(
    tips: Bools, gravity: Floats, a: Vector, along: Vector, normal: Vector, arc: float, delta: float
) -> None:
    """Mark the directions within `delta` of an arc that runs from `a` the way `along`."""
    reach = math.sin(delta)
    for d in range(len(gravity)):
        g = row(gravity, d)
        if abs(dot(normal, g)) <= reach:
            place = math.atan2(dot(along, g), dot(a, g))
            if -1.5 * delta <= place <= arc + 1.5 * delta:
                tips[d] = True


@njit(inline=True)
def _stands(region: Region, g: Vector) -> bool:
    """Tell whether a robot stands, or rocks, under a direction."""
    k = supporting_facet(region.facet, facets_in(region.tally), g)
    if not is_convex(region.tally):
        return status_of(region, k, g) != TIPS
    standing = k >= 0
    for b in range(segments_in(region.tally)):
        standing = standing and dot(tip_plane_at(region.segment, b), g) >= 0.0
    return standing


@njit()
def _outline(
    primitives: Floats,
    moved: Floats,
    acceptance: Acceptance,
    view: _View,
    out: NDArray[np.float32],
    count: Ints,
    tips: Bools,
) -> None:
    """Fill one posture: pieces and their number per face (-1: too many), and what tips."""
    basis, reach, gravity, slack = view
    n = primitives.shape[0]
    table, region = facet_table(n), empty_region(n)
    stand(table, region, primitives, acceptance)
    size = robot_size(primitives)
    farthest = 0.0
    for i in range(n):
        farthest = max(farthest, moved[i])
    for d in range(len(gravity)):
        tips[d] = not _stands(region, row(gravity, d))
    turn = farthest / (WIDTH * size)
    everywhere = farthest
    for i in range(n):
        everywhere = max(everywhere, moved[i] + radius_at(primitives, i) * turn)
    total = 0
    for face in range(len(basis)):
        begin = total
        for b in range(segments_in(region.tally)):
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
            a = scale(start, 1.0 / length(start))
            along = cross(normal, a)
            arc = math.atan2(dot(along, stop), dot(a, stop))
            if face == 0:
                _flag(tips, gravity, a, along, normal, arc, delta)
            longer = delta if i == j else min(SWAY * delta, LONGEST)
            whole = arc + 2.0 * longer
            steps = math.ceil(whole / LONGEST)
            half = 0.5 * whole / steps
            lean = math.atan(math.tan(delta) / math.cos(half))
            for step in range(steps):
                mid = -longer + (2 * step + 1) * half
                c = _blend(a, math.cos(mid), along, math.sin(mid))
                inner = _blend(normal, math.cos(lean), c, -math.sin(lean))
                c = _blend(c, math.cos(lean), normal, math.sin(lean))
                side = cross(inner, c)
                p = _blend(c, math.cos(half * 1.02), side, -math.sin(half * 1.02))
                q = _blend(c, math.cos(half * 1.02), side, math.sin(half * 1.02))
                if total >= len(out):
                    count[face] = -1
                    return
                total = _clip(p, q, basis[face], reach, out, total)
        count[face] = total - begin


@njit()
def _outline_some(
    begin: int,
    end: int,
    primitives: Floats,
    moved: Floats,
    acceptance: Acceptance,
    view: _View,
    filled: _Filled,
) -> int:
    """Fill postures [begin, end); returns how many of them have too many pieces."""
    too_many = 0
    for p in range(begin, end):
        out, count, tips = filled.pieces[p], filled.counts[p], filled.tips[p]
        _outline(primitives[p], moved[p], acceptance, view, out, count, tips)
        too_many += count.min() < 0
    return too_many


def outlines(model: Model, per_axis: int, gravity: NDArray[np.float64]) -> Outlines:
    """Return the outlines at the ends of `per_axis` sub-cells along each parameter.

    `gravity` (J, 3): directions to be judged.
    """
    k = model.k
    axis = np.rint(np.linspace(0.0, 1.0, per_axis + 1) * SPAN) / SPAN
    axes = (axis,) * k
    place = combinations([axis] * k)
    where = model.postures(model.at(place))
    moved = np.zeros(where.centres.shape[:2])
    beyond = MISPLACED / SPAN
    reach = 0.5 / per_axis + beyond
    slack = max(ASTRAY, ASTRAY_SHARE * model.chart_limit)
    # Summed over the axes: a corner differs along all of them.
    for a in range(k):
        away = []
        for half in (-reach, reach):
            beside = np.clip(place + half * np.eye(k)[a], -beyond, 1.0 + beyond)
            apart = model.postures(model.at(beside)).centres - where.centres
            away.append(np.sqrt((apart**2).sum(axis=2)))
        moved += CURVED * np.maximum(*away)
    size = float(np.sqrt((where.centres**2).sum(axis=2)).max())
    between = BENT * float(moved.max(initial=0.0))
    tighter = between / (WIDTH * size)
    primitives = pack(where.centres, where.axes, model.radius, model.kind)
    accept = acceptance_of(model.recipe, tighter)
    wider = 2.0 * (between + tighter * float(model.radius.max(initial=0.0)))
    accept = accept._replace(rest_width=accept.rest_width + wider, contact_tolerance=0.0)
    directions = np.ascontiguousarray(unit_directions(gravity))
    view = _View(model.recipe.chart.basis(), model.chart_limit, directions, slack)
    kept, counts, flags = [], [], []
    for begin in range(0, len(place), CHUNK):
        part = primitives[begin : begin + CHUNK]
        m = len(part)
        out = np.empty((m, MOST_PIECES, 4), np.float32)
        count, tips = np.zeros((m, len(view.basis)), np.int64), np.empty((m, len(directions)), bool)
        filled = _Filled(out, count, tips)
        if in_threads(_outline_some, m, part, moved[begin:], accept, view, filled, least=32):
            raise InputError(
                f"{model.recipe.source}: a standing region has more than {MOST_PIECES} pieces of "
                "outline; choose the codec `contacts`."
            )
        kept.append(out[np.arange(MOST_PIECES)[None, :] < count.sum(axis=1, keepdims=True)])
        counts.append(count.ravel())
        flags.append(tips)
    first = np.concatenate([[0], np.cumsum(np.concatenate(counts))])
    return Outlines(axes, np.concatenate(kept), first, np.concatenate(flags), tighter)
