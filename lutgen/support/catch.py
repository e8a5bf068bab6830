"""A robot that is let go where it balances on two contacts: does it come to rest.

Owns the facets' kinds and one roll with all its ways.  The robot rolls to the next facet with
gravity turning along and no energy lost.  There it goes on over each edge beyond which gravity lies
and over each edge that is no higher than the com has been; all ways that it may take must end where
it has not the energy to go on, on a rest, and all of them together must not turn it by more than
`rock_angle`.  A stage holds nothing: where the energy does not suffice to leave one, the least
nudge does.

A balance is a place w on the segment between the two contacts, from 0 to 1, and gravity points at
it.  Gravity, without being scaled to length 1, is linear in w, and so is all that rolling does to
it: every question that a roll decides is the sign of a linear or a quadratic function of w.  So a
roll is worked out for one w, together with the next place at which any of its answers changes.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.arc import TURN, Arc, enter_roll, risen_after, seen_after
from lutgen.support.table import (
    BACK,
    FIRST,
    NEIGHBOUR,
    VERTEX,
    VISITS,
    WAYS,
    Hull,
    corner_after,
    put,
    vector_at,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract

REFUSED, STAGE, REST = 0, 1, 2
# rad; rests whose normals are nearer than this may be one but for noise.
ONE_REST = 0.01
# rad; a turn from rest to rest that is none but for noise: those that such turns join are gone over
# once.  From a balance it sets free no more than takes the com over another edge that is as near.
NO_ROLL = 2e-4
# rad; after a turn of less the line that the robot came over is still that of the turn before.
ONE_LINE = 0.003
# First columns of a brink: an edge's start, the unit inward normal of the plane through it and the
# com, the unit vector along it, that from its line to the com, and the length of that.
CORNER, WALL, ALONG, ARM, REACH = 0, 3, 6, 9, 12
# Columns of a way: gravity for w = 0 and w = 1, how far the com has risen for both, less the root
# of a quadratic in w; the turn so far; up to which w it is so; the facet that it has come to and
# the corner of the edge that it came over, and that of the last edge over which it turned; which
# turn of the roll that was, as a number of its own.
G, RAISED, ROOT, TURNED, UNTIL, FACET, CAME, LINE, SINCE = 0, 6, 8, 11, 12, 13, 14, 15, 16
# Columns of a roll's answer: up to which w it is so, the largest sum of turns.
SURE, MOST = 9, 10
# Where a question is not quadratic in w its sign is asked for at this step, and its change sought
# by so many halvings.
STRIDE, HALVINGS = 0.0625, 40
# Part of its size up to which such a function counts as zero: contacts in a row are equally easy.
LEVEL = 1e-12


class Rolling(NamedTuple):
    """A posture as far as rolls over its hull go.

    `primitives` (n, 8): rows of `primitive.pack`.  `kind` (F,): REFUSED, STAGE or REST of each
    facet of `hull`.  Per edge: `brink` (E, 13), see `enter_brink`, and `roll` (E, 13), see
    `arc.enter_roll`; its turn is negative where nobody has asked for it yet.
    """

    hull: Hull
    primitives: NDArray[np.float64]
    kind: NDArray[np.int64]
    brink: NDArray[np.float64]
    roll: NDArray[np.float64]


@njit(inline=True, bare=True)
def enter_brink(brink: Floats, at: int, p: Vector, q: Vector) -> None:
    """Fill the row of the edge from p to q."""
    apart = subtract(q, p)
    along = scale(apart, 1.0 / length(apart))
    arm = subtract(scale(along, dot(p, along)), p)
    reach = length(arm)
    wall = scale(cross(along, arm), 1.0 / reach)
    put(brink, at, CORNER, p)
    put(brink, at, WALL, wall)
    put(brink, at, ALONG, along)
    put(brink, at, ARM, arm)
    brink[at, REACH] = reach


@njit(inline=True, bare=True)
def is_on_line(brink: Floats, at: int, following: int, line: int, band: float) -> bool:
    """Tell whether an edge lies within `band` (length) of the line of another one."""
    along, arm = vector_at(brink, line, ALONG), vector_at(brink, line, ARM)
    for end in range(2):
        p = row(brink, at if end == 0 else following)
        slant = dot(p, along)
        x, y, z = (
            p[0] - slant * along[0] + arm[0],
            p[1] - slant * along[1] + arm[1],
            p[2] - slant * along[2] + arm[2],
        )
        if x * x + y * y + z * z > band * band:
            return False
    return True


@njit(inline=True, bare=True)
def leads_back(brink: Floats, at: int, following: int, line: int, band: float, rests: bool) -> bool:
    """Tell whether an edge is one with the line that the robot came over, which noise cut in two.

    It lies within `band` of that line and runs the same way: one that runs back is the way on, over
    a facet that is a sliver, though it be a rest with the contacts near its plane.  On a rest such
    an edge is longer than `band`; a shorter one is what noise makes of a corner.
    """
    if dot(vector_at(brink, at, ALONG), vector_at(brink, line, ALONG)) <= 0.0:
        apart = subtract(row(brink, following), row(brink, at))
        if not rests or dot(apart, apart) > band * band:
            return False
    return is_on_line(brink, at, following, line, band)


@njit(inline=True, bare=True)
def _next_root(d0: float, d1: float, d2: float, w: float) -> float:
    """Return the first root above w of d0 + d1 w + d2 w^2, infinity if there is none."""
    rest = d1 * d1 - 4.0 * d0 * d2
    if not rest > 0.0:
        return math.inf
    half = -0.5 * (d1 + math.copysign(math.sqrt(rest), d1))
    a, b = half / d2, d0 / half
    first = a if a > w else math.inf
    return b if w < b < first else first


@njit(inline=True, bare=True)
def _quadratic(c: Vector, w: float) -> float:
    return c[0] + w * (c[1] + w * c[2])


@njit(bare=True)
def _changes(top: Vector, root: Vector, k0: float, k1: float, w: float) -> float:
    """Return the next place, or one before it, where sqrt(top) - sqrt(root) - k changes its sign.

    `top` and `root` are quadratics, k is linear.
    """
    high = w + STRIDE
    low = w
    sign = 0.0
    for step in range(HALVINGS + 2):
        at = w if step == 0 else high if step == 1 else 0.5 * (low + high)
        root_here = math.sqrt(max(_quadratic(root, at), 0.0))
        here = math.sqrt(max(_quadratic(top, at), 0.0)) - root_here - (k0 + at * (k1 - k0))
        side = -1.0 if here < -LEVEL * root_here else 1.0
        if step == 0:
            sign = side
        elif step == 1:
            if side == sign:
                return high
        elif side == sign:
            low = at
        else:
            high = at
    return high


@njit(inline=True, bare=True)
def _gravity_squared(a: Vector, b: Vector) -> Vector:
    """Return the squared length of gravity, (1 - w) a + w b, as a quadratic in w."""
    aa, ab, bb = dot(a, a), dot(a, b), dot(b, b)
    return aa, 2.0 * (ab - aa), aa - 2.0 * ab + bb


@njit(inline=True, bare=True)
def _top_squared(brink: Floats, at: int, a: Vector, b: Vector, squared: Vector) -> Vector:
    """Return the square of how high above an edge's line the com can be, as a quadratic in w."""
    along = vector_at(brink, at, ALONG)
    p = dot(along, a)
    q = dot(along, b) - p
    reach = brink[at, REACH] * brink[at, REACH]
    return (
        reach * (squared[0] - p * p),
        reach * (squared[1] - 2.0 * p * q),
        reach * (squared[2] - q * q),
    )


@njit(bare=True)
def _easiest(
    brink: Floats,
    f: int,
    span: Ints,
    came: tuple[int, int, float],
    ends: tuple[Vector, Vector],
    w: float,
) -> tuple[int, float]:
    """Return the edge of a stage over which the com rises least, and up to which w it does.

    `came`: the edge that it came over, the line of it, and how near to that edges lead back.
    """
    a, b = ends
    edge, line, band = came
    squared = _gravity_squared(a, b)
    best, lowest, until = -1, math.inf, math.inf
    root, r0, r1 = (0.0, 0.0, 0.0), 0.0, 0.0
    for again in range(2):
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            following = corner_after(span, f, at)
            if at in (edge, best) or leads_back(brink, at, following, line, band, False):
                continue
            arm = vector_at(brink, at, ARM)
            top = _top_squared(brink, at, a, b, squared)
            n0, n1 = -dot(arm, a), -dot(arm, b)
            if again == 1:
                until = min(until, _changes(top, root, n0 - r0, n1 - r1, w))
                continue
            rise = math.sqrt(max(_quadratic(top, w), 0.0)) - (n0 + w * (n1 - n0))
            if rise < lowest:
                lowest, best = rise, at
        if again == 0 and best >= 0:
            arm = vector_at(brink, best, ARM)
            root, r0, r1 = (
                _top_squared(brink, best, a, b, squared),
                -dot(arm, a),
                -dot(arm, b),
            )
    return best, until


@njit(inline=True, bare=True)
def _was_at(way: Floats, visited: int, facet: int, since: float) -> bool:
    """Tell whether a roll has come to a facet since its last turn that was one."""
    for row_of in range(WAYS, WAYS + visited):
        if way[row_of, FACET] == facet and way[row_of, SINCE] == since:
            return True
    return False


@njit(bare=True)
def comes_to_rest(
    rolling: Rolling, w: float, limits: tuple[float, float], way: Floats, ends: Ints
) -> tuple[float, float]:
    """Return the largest sum of turns (rad) of a roll that ends on rests whatever way it takes.

    And up to which place of the balance that is so; from `w` on.

    The first row of `way` says where it has come to, and how.  Infinity where it may tip over, or
    turn by more than the first of `limits`.  `ends` receives the rests that it ends on, after their
    number.  Back over the edge that it came over it does not go: that is every edge within the
    second limit (length) of that line, which on a stage runs the same way; noise makes two edges
    of one.  Nor does it go round and round over rests that noise makes of one.  The rows of `way`
    from WAYS on receive the facets that it comes to.
    """
    hull, primitives, kind, brink, roll = rolling
    facet, span, link = hull.facet, hull.span, hull.link
    budget, band = limits
    waiting, most, sure = 1, way[0, TURNED], math.inf
    way[0, SINCE] = 0.0
    ends[0] = 0
    for visited in range(VISITS):
        if waiting == 0:
            return most, sure
        waiting -= 1
        since = way[waiting, SINCE]
        way[WAYS + visited, FACET], way[WAYS + visited, SINCE] = way[waiting, FACET], since
        f, came, line = int(way[waiting, FACET]), int(way[waiting, CAME]), int(way[waiting, LINE])
        a, b = vector_at(way, waiting, G), vector_at(way, waiting, G + 3)
        r0, r1 = way[waiting, RAISED], way[waiting, RAISED + 1]
        root = vector_at(way, waiting, ROOT)
        turned, until = way[waiting, TURNED], way[waiting, UNTIL]
        bent = root[0] != 0.0 or root[2] != 0.0
        squared = _gravity_squared(a, b)
        leaves, nudged = False, -1
        # Up to where all that is decided on this facet stays.
        stays = until
        begin, end = span[f, FIRST], span[f + 1, FIRST]
        at = begin - 1
        while True:
            at += 1
            if at == end:
                if leaves or kind[f] == REST:
                    break
                # A stage that it has not the energy to leave: it goes over the lowest edge.
                nudged, easy = _easiest(brink, f, span, (came, line, band), (a, b), w)
                if nudged < 0:
                    return math.inf, stays
                stays = min(stays, easy)
                at = nudged
            elif at == came:
                continue
            following = corner_after(span, f, at)
            if nudged < 0 and leads_back(brink, at, following, line, band, kind[f] == REST):
                continue
            top = _top_squared(brink, at, a, b, squared)
            arm = vector_at(brink, at, ARM)
            n0, n1 = -dot(arm, a), -dot(arm, b)
            k0, k1 = n0 - r0, n1 - r1
            here = stays
            if nudged < 0:
                wall = vector_at(brink, at, WALL)
                s0, s1 = dot(wall, a), dot(wall, b)
                outside = s0 + w * (s1 - s0) < 0.0
                crossing = s0 / (s0 - s1)
                here = crossing if crossing > w else math.inf
                goes = outside
                if not outside:
                    k = k0 + w * (k1 - k0)
                    if bent:
                        high = math.sqrt(max(_quadratic(top, w), 0.0))
                        low = math.sqrt(max(_quadratic(root, w), 0.0))
                        goes = high - low - k < 0.0
                        here = min(here, _changes(top, root, k0, k1, w))
                    else:
                        d = k1 - k0
                        d0 = top[0] - k0 * k0
                        d1 = top[1] - 2.0 * k0 * d
                        d2 = top[2] - d * d
                        goes = k > 0.0 and d0 + w * (d1 + w * d2) < 0.0
                        here = min(here, _next_root(d0, d1, d2, w))
                if not goes:
                    stays = min(stays, here)
                    continue
                here = min(until, here)
            other, back = link[at, NEIGHBOUR], link[at, BACK]
            if other < 0 or back < 0 or kind[other] == REFUSED:
                return math.inf, here
            turn = roll[at, TURN]
            if turn < 0.0:
                i, j = link[at, VERTEX], link[following, VERTEX]
                arc = Arc(i, j, row(facet, f), row(facet, other))
                turn = enter_roll(primitives, arc, at, back, roll)
            one = turn < NO_ROLL and kind[f] == REST and kind[other] == REST
            if one and _was_at(way, visited + 1, other, since):
                continue
            leaves = True
            if turned + turn > budget or waiting == WAYS:
                return math.inf, here
            stays = min(stays, here)
            most = max(most, turned + turn)
            more0, more1 = risen_after(roll, at, a), risen_after(roll, at, b)
            if nudged >= 0:
                more0, more1 = more0 + n0, more1 + n1
            else:
                more0, more1 = more0 + r0, more1 + r1
                top = root
            way[waiting, FACET], way[waiting, CAME] = other, back
            way[waiting, LINE] = back if turn > ONE_LINE else line
            way[waiting, SINCE] = since if one else 1.0 + at + visited * float(brink.shape[0])
            put(way, waiting, G, seen_after(roll, at, a))
            put(way, waiting, G + 3, seen_after(roll, at, b))
            way[waiting, RAISED], way[waiting, RAISED + 1] = more0, more1
            put(way, waiting, ROOT, top)
            way[waiting, TURNED], way[waiting, UNTIL] = turned + turn, here
            waiting += 1
            if nudged >= 0:
                break
        if not leaves:
            ends[0] += 1
            ends[ends[0]] = f
        sure = min(sure, stays)
    return math.inf, sure
