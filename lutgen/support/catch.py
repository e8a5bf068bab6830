"""Gaps: where the robot rolls over two contacts from rest to rest, and is caught at both ends.

Owns the facets' kinds and what happens to a robot that is let go where it balances on two contacts
of a gap.  It rolls to the next facet with gravity turning along and no energy lost.  There it goes
on over each edge beyond which gravity lies, and over each edge that is no higher than the com has
been; all ways that it may take must end where it has not the energy to go on, on a rest, and all of
them together must not turn it by more than `rock_angle`.  A stage holds nothing: where the energy
does not suffice to leave one, the least nudge does.
"""

import math

from lutgen.jit import njit
from lutgen.support.arc import angle_between, rise_over, roll_along
from lutgen.support.table import BACK, FIRST, NEIGHBOUR, VERTEX, corner_after
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, subtract, unit

REFUSED, STAGE, REST = 0, 1, 2
# Ways that one roll may branch into, and facets that it may come to, until it counts as lost.
WAYS, VISITS = 32, 48
# rad; rests whose normals are nearer than this may be one but for noise.
ONE_REST = 0.01


@njit(inline=True)
def beside(p: Vector, q: Vector, begin: Vector, end: Vector, band: float) -> bool:
    """Tell whether an edge from p to q lies within `band` of the line through two points."""
    along = unit(subtract(end, begin))
    return (
        length(cross(subtract(p, begin), along)) <= band
        and length(cross(subtract(q, begin), along)) <= band
    )


@njit()
def comes_to_rest(
    primitives: Floats,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    kind: Ints,
    start: tuple[int, int, Vector, float, float],
    limits: tuple[float, float],
    mark: int,
    room: tuple[Ints, Ints, Floats],
) -> float:
    """Return the largest sum of turns (rad) of a roll that ends on rests whatever way it takes.

    `start`: the facet that it has come to, the corner of the edge that it came over, gravity, how
    far the com is above where it was let go (length), and the turn so far.  Infinity where it may
    tip over, or turn by more than the first of `limits`.  Rests that it ends on get the bit `mark`
    in `ends`.  Back over the edge that it came over it does not go; on a rest that is all edges
    within the second limit (length) of that one.
    """
    budget, band = limits
    ends, where, state = room
    where[0, 0], where[0, 1] = start[0], start[1]
    state[0, 0], state[0, 1], state[0, 2] = start[2]
    state[0, 3], state[0, 4] = start[3], start[4]
    waiting, most = 1, start[4]
    for _ in range(VISITS):
        if waiting == 0:
            return float(most)
        waiting -= 1
        f, came = where[waiting, 0], where[waiting, 1]
        g = row(state, waiting)
        raised, turned = state[waiting, 3], state[waiting, 4]
        begin, end = span[f, FIRST], span[f + 1, FIRST]
        lowest, easiest, leaves = math.inf, -1, False
        line = (row(corner, came), row(corner, corner_after(span, f, came)))
        for again in range(2):
            for at in range(begin, end):
                if at == came or (again == 1 and at != easiest):
                    continue
                following = corner_after(span, f, at)
                p, q = row(corner, at), row(corner, following)
                if kind[f] == REST and beside(p, q, line[0], line[1], band):
                    continue
                rise = rise_over(p, q, g)
                outside = dot(cross(p, q), g) < 0.0
                if again == 0 and rise < lowest:
                    lowest, easiest = rise, at
                if again == 0 and not outside and raised + rise >= 0.0:
                    continue
                leaves = True
                other, back = link[at, NEIGHBOUR], link[at, BACK]
                if other < 0 or back < 0 or kind[other] == REFUSED:
                    return math.inf
                i, j = link[at, VERTEX], link[following, VERTEX]
                seen, more, turn = roll_along(primitives, i, j, row(facet, f), row(facet, other), g)
                if turned + turn > budget or waiting == WAYS:
                    return math.inf
                most = max(most, turned + turn)
                where[waiting, 0], where[waiting, 1] = other, back
                state[waiting, 0], state[waiting, 1], state[waiting, 2] = seen
                state[waiting, 3] = (raised if again == 0 else min(raised, -rise)) + more
                state[waiting, 4] = turned + turn
                waiting += 1
            if leaves or kind[f] == REST:
                break
        if not leaves:
            if kind[f] != REST:
                return math.inf
            ends[f] |= mark
    return math.inf


@njit()
def is_caught(
    primitives: Floats,
    facet: Floats,
    span: Ints,
    corner: Floats,
    link: Ints,
    kind: Ints,
    f: int,
    at: int,
    part: float,
    limits: tuple[float, float],
    room: tuple[Ints, Ints, Floats],
) -> bool:
    """Tell whether a robot that balances on a gap is caught whichever way it is nudged.

    The gap begins at corner `at` of facet f; the balance is over the point at `part` of the segment
    between its two contacts, once where the gap begins and once where it ends.  The two ways must
    not end on one and the same rest.
    """
    other, back = link[at, NEIGHBOUR], link[at, BACK]
    ends = room[0]
    for turn in range(2):
        near, edge, far, far_edge = (f, at, other, back) if turn == 0 else (other, back, f, at)
        following = corner_after(span, near, edge)
        p, q = row(corner, edge), row(corner, following)
        w = part if turn == 0 else 1.0 - part
        g = unit(
            (
                p[0] + w * (q[0] - p[0]),
                p[1] + w * (q[1] - p[1]),
                p[2] + w * (q[2] - p[2]),
            )
        )
        ends[:] = 0
        i, j = link[edge, VERTEX], link[following, VERTEX]
        seen, rise, rolled = roll_along(primitives, i, j, row(facet, near), row(facet, far), g)
        ahead = comes_to_rest(
            *(primitives, facet, span, corner, link, kind),
            *((far, far_edge, seen, rise, rolled), limits, 1, room),
        )
        if ahead > limits[0]:
            return False
        behind = comes_to_rest(
            *(primitives, facet, span, corner, link, kind),
            *((near, edge, g, 0.0, 0.0), limits, 2, room),
        )
        if ahead + behind > limits[0]:
            return False
        if _comes_back(facet, ends, ahead + behind):
            return False
    return True


@njit()
def _comes_back(facet: Floats, ends: Ints, turned: float) -> bool:
    """Tell whether both ways end on what is one rest, though they turn the robot by some angle.

    Noise makes one rest two, all but parallel.  Two rests that are joined by a turn as small as the
    angle between them are two, however near.
    """
    for a in range(ends.shape[0]):
        if ends[a] & 1 == 0:
            continue
        for b in range(ends.shape[0]):
            apart = angle_between(row(facet, a), row(facet, b))
            if ends[b] & 2 and (a == b or (apart < ONE_REST and turned > apart + ONE_REST)):
                return True
    return False
