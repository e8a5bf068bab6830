"""Gaps: over which part of an edge the robot rocks.

Owns the part of the segment between two contacts over which a balance is caught, see `catch`.  The
places where an answer changes are known from the answers themselves, so a segment is gone through
from change to change, and no part of it is passed over.
"""

import math

from lutgen.jit import njit
from lutgen.support.arc import TURN, Arc, angle_between, enter_roll, risen_after, seen_after
from lutgen.support.catch import (
    ALONG,
    CAME,
    FACET,
    LINE,
    MOST,
    NO_ROLL,
    ONE_REST,
    REFUSED,
    REST,
    ROOT,
    STAGE,
    SURE,
    TURNED,
    UNTIL,
    Rolling,
    comes_to_rest,
    enter_brink,
    is_on_line,
)
from lutgen.support.table import (
    BACK,
    FIRST,
    FOUND,
    NEIGHBOUR,
    VERTEX,
    Hull,
    Workspace,
    corner_after,
    put,
    vector_at,
)
from lutgen.support.tiles import leads_out
from lutgen.vector import Floats, Ints, dot, row, subtract

# Columns of a gap: the part of the segment between its two contacts over which it holds.
LOW, HIGH = 0, 1
# Nearer to an end of the segment than this part of it the balance is not looked at; and by so much
# beyond a change it is looked at again.
END, HAIR = 1e-4, 1e-9
# Changes on a segment; what lies beyond so many is not held.
MOST_CHANGES = 128
# Times that what slivers join is gone through: as often as they may cut one line.
SLIVERS = 3
# The first row of `Workspace.counts` in which a roll lists the rests that it ends on.
ENDS = 4


@njit(bare=True)
def find_gaps(
    hull: Hull,
    primitives: Floats,
    kind: Ints,
    limits: tuple[float, float],
    gap: Floats,
    work: Workspace,
) -> None:
    """Fill `gap` (E, 2) for every edge: from which part of it to which the robot is caught beyond.

    An edge without a gap has LOW 1 and HIGH 0.  `limits`: the largest sum of turns (rad), and half
    the least width of a rest.
    """
    facets, facet, span = hull.tally[FOUND], hull.facet, hull.span
    corner, link = hull.corner, hull.link
    brink, roll = work.brink, work.roll
    rolling = Rolling(hull, primitives, kind, brink, roll)
    for f in range(facets):
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            gap[at, LOW], gap[at, HIGH] = 1.0, 0.0
            if kind[f] != REFUSED:
                following = corner_after(span, f, at)
                enter_brink(brink, at, row(corner, at), row(corner, following))
                roll[at, TURN] = -1.0
    least = math.cos(min(limits[0], math.pi)) - 1e-12
    for f in range(facets):
        if kind[f] == REFUSED:
            continue
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            other, back = link[at, NEIGHBOUR], link[at, BACK]
            if other <= f or back < 0 or kind[other] == REFUSED:
                continue
            if dot(row(facet, f), row(facet, other)) < least:
                continue
            if roll[at, TURN] < 0.0:
                i, j = link[at, VERTEX], link[corner_after(span, f, at), VERTEX]
                arc = Arc(i, j, row(facet, f), row(facet, other))
                enter_roll(primitives, arc, at, back, roll)
            if roll[at, TURN] > limits[0]:
                continue
            low, high = 0.0, 1.0
            if roll[at, TURN] > NO_ROLL or kind[f] != REST or kind[other] != REST:
                _lay_out(rolling, f, at, work.begin)
                low, high = _held(rolling, f, at, limits, work.begin, work.way, work.counts)
            if low < high:
                here = at, corner_after(span, f, at)
                there = corner_after(span, other, back), back
                if leads_out(corner, here, there, low, high):
                    _enter(link, gap, at, low, high)
    for _ in range(SLIVERS):
        for f in range(facets):
            if kind[f] == STAGE and span[f + 1, FIRST] - span[f, FIRST] == 3:
                for at in range(span[f, FIRST], span[f + 1, FIRST]):
                    _join(span, link, brink, f, at, limits[1], gap)


@njit(inline=True, bare=True)
def _enter(link: Ints, gap: Floats, at: int, low: float, high: float) -> None:
    """Enter what an edge holds, for both its facets."""
    gap[at, LOW], gap[at, HIGH] = (low, high) if low < high else (1.0, 0.0)
    back = link[at, BACK]
    if back >= 0:
        gap[back, LOW], gap[back, HIGH] = 1.0 - gap[at, HIGH], 1.0 - gap[at, LOW]


@njit(bare=True)
def _join(span: Ints, link: Ints, brink: Floats, f: int, at: int, band: float, gap: Floats) -> None:
    """Hold over a line what both halves of its arc hold, where a sliver of a stage cuts it in two.

    A third wheel on an axle carries for a moment, which moment is noise: before it the line of the
    edge is one, after it the edge's other two make up the same line.
    """
    ahead = corner_after(span, f, at)
    last = corner_after(span, f, ahead)
    for part in (ahead, last):
        # Both run back along the line of the first.
        if dot(vector_at(brink, part, ALONG), vector_at(brink, at, ALONG)) >= 0.0:
            return
        if not is_on_line(brink, part, corner_after(span, f, part), at, band):
            return
    p, q, k = row(brink, at), row(brink, ahead), row(brink, last)
    whole, here = subtract(q, p), subtract(k, p)
    middle = dot(here, whole) / dot(whole, whole)
    low, high = gap[at, LOW], gap[at, HIGH]
    # What the others hold, from q to k and from k to p, in parts of the whole.
    rest = 1.0 - middle
    near = max(low, middle * (1.0 - gap[last, HIGH])), min(high, middle * (1.0 - gap[last, LOW]))
    far = max(low, 1.0 - gap[ahead, HIGH] * rest), min(high, 1.0 - gap[ahead, LOW] * rest)
    _enter(link, gap, ahead, (1.0 - far[1]) / rest, (1.0 - far[0]) / rest)
    _enter(link, gap, last, 1.0 - near[1] / middle, 1.0 - near[0] / middle)
    longer = near if near[1] - near[0] > far[1] - far[0] else far
    if near[0] < near[1] and far[0] < far[1] and far[0] - near[1] <= END:
        longer = near[0], far[1]
    _enter(link, gap, at, longer[0], longer[1])


@njit(bare=True)
def _lay_out(rolling: Rolling, f: int, at: int, begin: Floats) -> None:
    """Fill `begin` (4, 11) with how the four rolls from a balance begin.

    Rows 0 and 1 are the ways on and back from where the gap begins, 2 and 3 from where it ends;
    each holds gravity and rise for both ends of the edge, and the turn; its answer comes after.
    """
    hull, roll = rolling.hull, rolling.roll
    span, corner, link = hull.span, hull.corner, hull.link
    other, back = link[at, NEIGHBOUR], link[at, BACK]
    for turn in range(2):
        near, edge = (f, at) if turn == 0 else (other, back)
        ahead = corner_after(span, near, edge)
        p = row(corner, edge if turn == 0 else ahead)
        q = row(corner, ahead if turn == 0 else edge)
        on, rest = 2 * turn, 2 * turn + 1
        put(begin, on, 0, seen_after(roll, edge, p))
        put(begin, on, 3, seen_after(roll, edge, q))
        begin[on, 6], begin[on, 7] = risen_after(roll, edge, p), risen_after(roll, edge, q)
        begin[on, 8] = roll[edge, TURN]
        put(begin, rest, 0, p)
        put(begin, rest, 3, q)
        put(begin, rest, 6, (0.0, 0.0, 0.0))


@njit(bare=True)
def _held(
    rolling: Rolling,
    f: int,
    at: int,
    limits: tuple[float, float],
    begin: Floats,
    way: Floats,
    ends: Ints,
) -> tuple[float, float]:
    """Return the longest part of an edge beyond which the robot is caught, (1, 0) if there is none.

    A robot that balances on a gap is caught if it comes to rest whichever way it is nudged, both
    where the gap begins and where it ends, and the two ways do not end on one and the same rest.
    """
    link = rolling.hull.link
    other, back = link[at, NEIGHBOUR], link[at, BACK]
    for t in range(4):
        begin[t, SURE] = -1.0
    low, high, since = 1.0, 0.0, -1.0
    w = END
    for _ in range(MOST_CHANGES):
        caught, until = True, math.inf
        for t in range(4):
            if begin[t, MOST] == math.inf and begin[t, SURE] > w:
                caught, until = False, max(begin[t, SURE], until if not caught else 0.0)
        if caught:
            for t in range(4):
                if begin[t, SURE] <= w:
                    away = t == 0 or t == 3
                    way[0, FACET], way[0, CAME] = (other, back) if away else (f, at)
                    way[0, LINE] = way[0, CAME]
                    for c in range(8):
                        way[0, c] = begin[t, c]
                    put(way, 0, ROOT, (0.0, 0.0, 0.0))
                    way[0, TURNED], way[0, UNTIL] = begin[t, 8], math.inf
                    begin[t, MOST], begin[t, SURE] = comes_to_rest(
                        rolling, w, limits, way, ends[ENDS + t]
                    )
                if begin[t, MOST] == math.inf:
                    caught, until = False, begin[t, SURE]
                    break
                until = min(until, begin[t, SURE])
        if caught:
            for t in range(0, 4, 2):
                turned = begin[t, MOST] + begin[t + 1, MOST]
                if turned > limits[0] or _comes_back(
                    rolling.hull.facet, ends[ENDS + t], ends[ENDS + t + 1], turned
                ):
                    caught = False
                    until = min(begin[t, SURE], begin[t + 1, SURE])
                    break
        if caught and since < 0.0:
            since = w - HAIR if w > END else 0.0
        if not caught and since >= 0.0:
            if w - HAIR - since > high - low:
                low, high = since, w - HAIR
            since = -1.0
        if until + HAIR >= 1.0 - END:
            if since >= 0.0 and 1.0 - since > high - low:
                low, high = since, 1.0
            return low, high
        w = max(until, w) + HAIR
    return low, high


@njit(bare=True)
def _comes_back(facet: Floats, some: Ints, others: Ints, turned: float) -> bool:
    """Tell whether both ways end on what is one rest, though they turn the robot by some angle.

    Noise makes one rest two, all but parallel.  Two rests that are joined by a turn as small as the
    angle between them are two, however near.
    """
    for a in range(1, some[0] + 1):
        for b in range(1, others[0] + 1):
            apart = angle_between(row(facet, some[a]), row(facet, others[b]))
            if some[a] == others[b] or (apart < ONE_REST and turned > apart + ONE_REST):
                return True
    return False
