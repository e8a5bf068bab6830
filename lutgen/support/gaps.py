"""Gaps: over which part of an edge the robot rocks.

Owns the part of the segment between two contacts over which a balance is caught, see `catch`.  At
its ends gravity goes on over another edge of the rest that it comes to, so the ends are places
where something is zero; where two rests do all the holding, what is zero is known in closed form or
smooth, and only beyond that is the robot let go again and again.
"""

import math

import numpy as np

from lutgen.jit import njit
from lutgen.support.arc import angle_between, rise_over, roll_along
from lutgen.support.catch import REFUSED, REST, WAYS, beside, is_caught
from lutgen.support.table import BACK, FIRST, NEIGHBOUR, VERTEX, corner_after
from lutgen.vector import Floats, Ints, cross, dot, length, row, subtract

# Columns of a gap: the part of the segment between its two contacts over which it holds.
LOW, HIGH = 0, 1
# Nearer to an end of the segment than this part of it the balance is not looked at.
END = 1e-4
# Halvings of the place from which on the robot is caught, and how far apart (in parts of the edge)
# are the places where it is let go to find it.
HALVINGS, STRIDE = 20, 0.0625
# Where the robot is let go first.
TRIALS = (0.5, 0.25, 0.75, 0.1, 0.9)


@njit()
def find_gaps(
    primitives: Floats,
    facets: int,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    kind: Ints,
    limits: tuple[float, float],
    gap: Floats,
) -> None:
    """Fill `gap` (E, 2) for every edge: from which part of it to which the robot is caught beyond.

    An edge without a gap has LOW 1 and HIGH 0.  `limits`: the largest sum of turns (rad), and half
    the least width of a rest.
    """
    room = np.empty(facets, np.int64), np.empty((WAYS, 2), np.int64), np.empty((WAYS, 5))
    for at in range(span[facets, FIRST]):
        gap[at, LOW], gap[at, HIGH] = 1.0, 0.0
    for f in range(facets):
        if kind[f] == REFUSED:
            continue
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            other, back = link[at, NEIGHBOUR], link[at, BACK]
            if other <= f or back < 0 or kind[other] == REFUSED:
                continue
            if dot(row(facet, f), row(facet, other)) < math.cos(min(limits[0], math.pi)) - 1e-12:
                continue
            low, high = _interval(primitives, facet, span, corner, link, kind, f, at, limits, room)
            if low < high:
                gap[at, LOW], gap[at, HIGH] = low, high
                gap[back, LOW], gap[back, HIGH] = 1.0 - high, 1.0 - low


@njit()
def _lay_out_roll(
    primitives: Floats,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    near: int,
    edge: int,
    out: Floats,
) -> float:
    """Fill `out` (4, 4) for a roll over an edge of facet `near`; return the turn (rad).

    Rolling turns gravity linearly, so what happens to each balance over the edge follows from its
    two ends: rows 0 and 1 are the ends before, rows 2 and 3 after, each with the com's rise.
    """
    following = corner_after(span, near, edge)
    far = link[edge, NEIGHBOUR]
    turn = 0.0
    for end in range(2):
        g = row(corner, edge if end == 0 else following)
        seen, rise, turn = roll_along(
            primitives,
            link[edge, VERTEX],
            link[following, VERTEX],
            row(facet, near),
            row(facet, far),
            g,
        )
        out[end, 0], out[end, 1], out[end, 2] = g
        out[2 + end, 0], out[2 + end, 1], out[2 + end, 2] = seen
        out[end, 3], out[2 + end, 3] = 0.0, rise
    return turn


@njit()
def _holds(
    span: Ints, corner: Floats, far: int, came: int, ends: Floats, band: float, w: float
) -> tuple[float, int]:
    """Return by how much a rest holds a robot that has rolled onto it, and its weakest edge.

    The least over its edges of how far gravity lies inside and how much energy is missing, both
    over the distance of the edge; negative where it goes on.
    """
    v = 1.0 - w
    x, y, z = (
        v * ends[0, 0] + w * ends[1, 0],
        v * ends[0, 1] + w * ends[1, 1],
        v * ends[0, 2] + w * ends[1, 2],
    )
    size = 1.0 / math.sqrt(x * x + y * y + z * z)
    g = (
        (v * ends[2, 0] + w * ends[3, 0]) * size,
        (v * ends[2, 1] + w * ends[3, 1]) * size,
        (v * ends[2, 2] + w * ends[3, 2]) * size,
    )
    raised = (v * ends[2, 3] + w * ends[3, 3]) * size
    least, weakest = math.inf, -1
    begin, end = row(corner, came), row(corner, corner_after(span, far, came))
    for at in range(span[far, FIRST], span[far + 1, FIRST]):
        if at == came:
            continue
        p, q = row(corner, at), row(corner, corner_after(span, far, at))
        if beside(p, q, begin, end, band):
            continue
        wall = cross(p, q)
        along = subtract(q, p)
        reach = length(wall)
        side = dot(wall, g) / reach
        here = min(side, (raised + rise_over(p, q, g)) * length(along) / reach)
        if here < least:
            least, weakest = here, at
    return least, weakest


@njit()
def _goes_on(
    facet: Floats, link: Ints, kind: Ints, f: int, at: int, turned: float, budget: float
) -> bool:
    """Tell whether a robot that leaves facet f over an edge may come to another one."""
    other = link[at, NEIGHBOUR]
    if other < 0 or link[at, BACK] < 0 or kind[other] == REFUSED:
        return False
    return turned + angle_between(row(facet, f), row(facet, other)) <= budget


@njit()
def _interval(
    primitives: Floats,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    kind: Ints,
    f: int,
    at: int,
    limits: tuple[float, float],
    room: tuple[Ints, Ints, Floats],
) -> tuple[float, float]:
    """Return the part of an edge beyond which the robot is caught, (1, 0) if nowhere.

    Where both ends are rests and each holds what comes, that is told by what `_holds`; only beyond
    that need each way be followed.
    """
    budget, band = limits
    other, back = link[at, NEIGHBOUR], link[at, BACK]
    there, here = np.empty((4, 4)), np.empty((4, 4))
    turn = _lay_out_roll(primitives, facet, span, corner, link, f, at, there)
    if turn > budget:
        return 1.0, 0.0
    plain = kind[f] == REST and kind[other] == REST
    inside = -1.0
    if plain:
        _lay_out_roll(primitives, facet, span, corner, link, other, back, here)
        hopeless = True
        for trial in range(len(TRIALS)):
            part = TRIALS[trial]
            ahead, edge = _holds(span, corner, other, back, there, band, part)
            behind, reverse = _holds(span, corner, f, at, here, band, 1.0 - part)
            if ahead >= 0.0 and behind >= 0.0:
                inside = part
                break
            if (ahead >= 0.0 or _goes_on(facet, link, kind, other, edge, turn, budget)) and (
                behind >= 0.0 or _goes_on(facet, link, kind, f, reverse, turn, budget)
            ):
                hopeless = False
        if inside < 0.0 and hopeless:
            return 1.0, 0.0
    held = inside >= 0.0
    if not held:
        for trial in range(len(TRIALS)):
            part = TRIALS[trial]
            if is_caught(primitives, facet, span, corner, link, kind, f, at, part, limits, room):
                inside = part
                break
        if inside < 0.0:
            return 1.0, 0.0
    low = high = inside
    for end in range(2):
        outer = END if end == 0 else 1.0 - END
        inner, follow = inside, True
        if held:
            inner, follow = _held_until(
                facet, span, corner, link, kind, f, at, there, here, turn, limits, inside, outer
            )
        if follow:
            # Beyond that a third facet may take over.
            inner = _caught_until(
                *(primitives, facet, span, corner, link, kind, f, at, limits, room, inner, outer)
            )
        if end == 0:
            low = inner
        else:
            high = inner
    return low, high


@njit()
def _inside_until(
    span: Ints,
    corner: Floats,
    far: int,
    came: int,
    ends: Floats,
    band: float,
    inside: float,
    outer: float,
) -> tuple[float, int]:
    """Return up to where gravity lies inside a rest that the robot has rolled onto, and whose edge.

    From `inside`, where it does, towards `outer`; gravity inside an edge is linear in the place.
    """
    place, weakest = outer, -1
    begin, end = row(corner, came), row(corner, corner_after(span, far, came))
    for at in range(span[far, FIRST], span[far + 1, FIRST]):
        p, q = row(corner, at), row(corner, corner_after(span, far, at))
        wall = cross(p, q)
        a = wall[0] * ends[2, 0] + wall[1] * ends[2, 1] + wall[2] * ends[2, 2]
        b = wall[0] * ends[3, 0] + wall[1] * ends[3, 1] + wall[2] * ends[3, 2]
        if (1.0 - place) * a + place * b < 0.0 and not beside(p, q, begin, end, band):
            there = a / (a - b)
            if abs(there - inside) < abs(place - inside):
                place, weakest = there, at
    return place, weakest


@njit()
def _held_until(
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    kind: Ints,
    f: int,
    at: int,
    there: Floats,
    here: Floats,
    turn: float,
    limits: tuple[float, float],
    inside: float,
    outer: float,
) -> tuple[float, bool]:
    """Return up to where both rests hold, and whether what lies beyond may lead to a third."""
    budget, band = limits
    other, back = link[at, NEIGHBOUR], link[at, BACK]
    low, edge = _inside_until(span, corner, other, back, there, band, inside, outer)
    place, reverse = _inside_until(span, corner, f, at, here, band, 1.0 - inside, 1.0 - low)
    if reverse >= 0:
        low, edge = 1.0 - place, -1
    # A hair inside, so that what limits gravity does not count as what limits the energy.
    low += 1e-9 * (inside - low)
    ahead, weak = _holds(span, corner, other, back, there, band, low)
    behind, weak_behind = _holds(span, corner, f, at, here, band, 1.0 - low)
    if min(ahead, behind) < 0.0:
        good = min(
            _holds(span, corner, other, back, there, band, inside)[0],
            _holds(span, corner, f, at, here, band, 1.0 - inside)[0],
        )
        bad, high, side = min(ahead, behind), low, 0
        low = inside
        for _ in range(60):
            if abs(high - low) < 1e-12 or good < 1e-13:
                break
            part = low + good * (high - low) / (good - bad)
            ahead, weak = _holds(span, corner, other, back, there, band, part)
            behind, weak_behind = _holds(span, corner, f, at, here, band, 1.0 - part)
            value = min(ahead, behind)
            # Illinois: an end that stays counts half.
            if value >= 0.0:
                low, good = part, value
                if side == 1:
                    bad *= 0.5
                side = 1
            else:
                high, bad = part, value
                if side == -1:
                    good *= 0.5
                side = -1
        edge, reverse = (weak, -1) if ahead < behind else (-1, weak_behind)
    elif edge < 0 and reverse < 0:
        return (0.0 if outer < 0.5 else 1.0), False
    return low, (
        _goes_on(facet, link, kind, other, edge, turn, budget)
        if edge >= 0
        else _goes_on(facet, link, kind, f, reverse, turn, budget)
    )


@njit()
def _caught_until(
    primitives: Floats,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    kind: Ints,
    f: int,
    at: int,
    limits: tuple[float, float],
    room: tuple[Ints, Ints, Floats],
    inner: float,
    outer: float,
) -> float:
    """Return up to where, from `inner` towards `outer`, the robot is caught at every place."""
    way = 1.0 if outer > inner else -1.0
    if not is_caught(
        *(primitives, facet, span, corner, link, kind, f, at),
        *(inner + 1e-6 * (outer - inner), limits, room),
    ):
        return inner
    beyond = inner
    while True:
        beyond = beyond + way * STRIDE
        beyond = max(beyond, outer) if way < 0.0 else min(beyond, outer)
        if not is_caught(primitives, facet, span, corner, link, kind, f, at, beyond, limits, room):
            break
        inner = beyond
        if beyond == outer:
            return 0.0 if way < 0.0 else 1.0
    for _ in range(HALVINGS):
        part = 0.5 * (inner + beyond)
        if is_caught(primitives, facet, span, corner, link, kind, f, at, part, limits, room):
            inner = part
        else:
            beyond = part
    return inner
