"""Support facets of robots whose discs have parallel axes: the history of a hull over pitch.

Owns the closed form.  Take the common axis as y.  Every normal is n = (sin k, t, -cos k), but for
its length, with the pitch k.  Discs (and points, discs without a radius) at one y are a *rail*; its
level at a pitch is L = max of x sin k - z cos k + r.  The plane's height is L + t y for each rail
that it touches and at least that for the others: two rails carry where they are neighbours on the
upper hull of the points (y, L).  As the pitch grows from -90 to 90 deg that hull changes at
*events*, in the order of their pitch: a rail goes on to another disc, or leaves the hull, or enters
it.  Each event is a facet of three contacts, and the time between two events that have a pair of
rails in common is the arc between two facets.  What an event ends and what it begins is read off
the hull, so the complex has no cracks whatever rounding does to the pitches.

With u = tan(k / 2) the differences of levels are quadratic in u, so an event takes one square root.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.primitive import DISC, KIND, RADIUS, SPHERE
from lutgen.support.table import (
    FIRST,
    FOUND,
    NEIGHBOUR,
    OUTSIDE,
    OVERFLOW,
    UNKNOWN,
    Workspace,
    add_triangle,
    join,
)
from lutgen.vector import Floats, Ints, Vector, cross, length

# Axes this parallel (rad) are parallel: what is left of the sines and cosines of a joint.
PARALLEL = 1e-14
# Parts of the robot's size.  Primitives whose y differs by less lie on one rail; and an inner rail
# counts as at most this much higher than it is, the more the nearer to the middle, so that wheels
# on one straight axle have one order on the hull at every pitch instead of that of their rounding.
ONE_RAIL = 1e-12
RECESS = 1e-12
NEVER = 2.0
# What rounding does to a place (u).
ROUNDED = 1e-12


@njit(exact=True, bare=True)
def common_axis(primitives: Floats) -> Vector:
    """Return the level unit axis that all discs share, or the zero vector.

    Zero too where there is no disc, where a sphere is among them, and where the axis is not
    orthogonal to the body's z.
    """
    axis = (0.0, 0.0, 0.0)
    found = False
    for i in range(primitives.shape[0]):
        if primitives[i, KIND] == SPHERE:
            return 0.0, 0.0, 0.0
        if primitives[i, KIND] == DISC:
            axle = (primitives[i, 3], primitives[i, 4], primitives[i, 5])
            if not found:
                axis = axle
                found = True
            elif length(cross(axis, axle)) > PARALLEL:
                return 0.0, 0.0, 0.0
    if not found or abs(axis[2]) > PARALLEL:
        return 0.0, 0.0, 0.0
    level = math.sqrt(axis[0] * axis[0] + axis[1] * axis[1])
    return axis[0] / level, axis[1] / level, 0.0


@njit(inline=True, exact=True, bare=True)
def _crossing(x: float, z: float, q: float, u: float, way: float) -> float:
    """Return the first place from u on at which way (x sin k - z cos k + q) is above zero.

    NEVER where it is not above zero at u, nor grows through zero later; u where it is nowhere below
    zero but in a touch, as of a wheel over a point on its rim.  Whether it is above zero
    is told by its two roots and not by its value, so what ends at a root has ended there: the roots
    of a function and of its negative are the same numbers.
    """
    x, z, q = way * x, way * z, way * q
    rest = x * x + z * z - q * q
    if not rest > 0.0:
        return u if q > 0.0 else NEVER
    root = math.sqrt(rest)
    # (q + z) u^2 + 2 x u + (q - z): it grows at one root and sinks at the other.
    # Of a function and its negative one goes either way, also where one disc is above the other.
    if x < 0.0 or (x == 0.0 and z < 0.0):
        s = root - x
        grows, sinks = s / (q + z) if q + z != 0.0 else math.inf, (q - z) / s
    else:
        s = -(root + x)
        grows, sinks = (q - z) / s, s / (q + z) if q + z != 0.0 else math.inf
    above = grows <= u < sinks if grows <= sinks else u >= grows or u < sinks
    if above:
        return u
    return grows if u < grows <= 1.0 else NEVER


@njit(inline=True, exact=True, bare=True)
def _level(place: Floats, i: int, sine: float, cosine: float) -> float:
    level: float = place[i, 0] * sine - place[i, 2] * cosine + place[i, 3]
    return level


@njit(exact=True, bare=True)
def _next_bend(
    place: Floats, rail: Ints, order: Ints, k: int, i: int, u: float
) -> tuple[float, int]:
    """Return where rail k goes on from disc i and onto which: (NEVER, -1) if nowhere."""
    first, best = NEVER, -1
    for member in range(rail[k], rail[k + 1]):
        j = order[member]
        if j == i:
            continue
        x, z = place[j, 0] - place[i, 0], place[j, 2] - place[i, 2]
        # One that sinks is above by rounding alone: wheels of one size in a row would take turns.
        begin = u + ROUNDED if x * (1.0 - u * u) + 2.0 * z * u < 0.0 else u
        there = _crossing(x, z, place[j, 3] - place[i, 3], begin, 1.0)
        if there < first:
            first, best = there, j
        elif there == first and best >= 0 and there < NEVER:
            # Touched at once: the one that is further along goes on carrying.
            sine, cosine = 2.0 * there, 1.0 - there * there
            ahead = (place[j, 0] - place[best, 0]) * cosine
            if ahead + (place[j, 2] - place[best, 2]) * sine > 0.0:
                best = j
    return first, best


@njit(inline=True, exact=True, bare=True)
def _normal(axis: Vector, sine: float, cosine: float, slope: float) -> Vector:
    size = 1.0 / math.sqrt(1.0 + slope * slope)
    s, t, c = sine * size, slope * size, cosine * size
    return s * axis[1] + t * axis[0], t * axis[1] - s * axis[0], -c


@njit(exact=True, bare=True)
def _lay_out(primitives: Floats, axis: Vector, place: Floats, order: Ints) -> None:
    """Fill `place` (n, 4): x, y, z, radius in the frame of the axis; sort `order` by y."""
    n = primitives.shape[0]
    for i in range(n):
        place[i, 0] = primitives[i, 0] * axis[1] - primitives[i, 1] * axis[0]
        place[i, 1] = primitives[i, 0] * axis[0] + primitives[i, 1] * axis[1]
        place[i, 2] = primitives[i, 2]
        place[i, 3] = primitives[i, RADIUS]
        at = i
        while at > 0 and place[order[at - 1], 1] > place[i, 1]:
            order[at] = order[at - 1]
            at -= 1
        order[at] = i


@njit(exact=True, bare=True)
def _make_rails(place: Floats, order: Ints, size: float, rail: Ints, across: Floats) -> int:
    """Fill where each rail begins in `order` and its y; return the number of rails."""
    rails = 0
    for at in range(order.shape[0]):
        y = place[order[at], 1]
        if at == 0 or y - across[rails - 1] > ONE_RAIL * size:
            rail[rails] = at
            across[rails] = y
            rails += 1
    rail[rails] = order.shape[0]
    for k in range(1, rails - 1):
        # Most in the middle: of any three rails the middle one is the deepest.
        recess = (across[k] - across[0]) * (across[rails - 1] - across[k])
        recess *= 4.0 / (across[rails - 1] - across[0]) ** 2
        for at in range(rail[k], rail[k + 1]):
            place[order[at], 3] -= recess * RECESS * size
    return rails


@njit(exact=True, bare=True)
def _begin(
    place: Floats, rail: Ints, order: Ints, rails: int, across: Floats, disc: Ints, on: Ints
) -> None:
    """Find the disc of each rail, and which rails are on the hull, at a pitch of -90 deg."""
    for k in range(rails):
        best = order[rail[k]]
        for at in range(rail[k] + 1, rail[k + 1]):
            j = order[at]
            above = (place[j, 3] - place[j, 0]) - (place[best, 3] - place[best, 0])
            if above > 0.0 or (above == 0.0 and place[j, 2] < place[best, 2]):
                best = j
        disc[k] = best
        on[k] = 1
    # Upper hull of the points (y, L), from the left: what lies below a chord goes.
    for k in range(2, rails):
        b = k - 1
        while True:
            while b > 0 and on[b] == 0:
                b -= 1
            if b <= 0:
                break
            a = b - 1
            while on[a] == 0:
                a -= 1
            part = (across[b] - across[k]) / (across[a] - across[k])
            left = place[disc[a], 3] - place[disc[a], 0]
            right = place[disc[k], 3] - place[disc[k], 0]
            here = place[disc[b], 3] - place[disc[b], 0]
            if here > part * left + (1.0 - part) * right:
                break
            on[b] = 0


@njit(inline=True, exact=True, bare=True)
def _before(on: Ints, k: int) -> int:
    """Return the rail before k on the hull, or -1."""
    k -= 1
    while k >= 0 and on[k] == 0:
        k -= 1
    return k


@njit(inline=True, exact=True, bare=True)
def _after(on: Ints, rails: int, k: int) -> int:
    """Return the rail after k on the hull, or -1."""
    k += 1
    while k < rails and on[k] == 0:
        k += 1
    return k if k < rails else -1


@njit(exact=True, bare=True)
def _turns(
    place: Floats, across: Floats, disc: Ints, on: Ints, rails: int, k: int, u: float
) -> float:
    """Return where an inner rail k leaves the hull, or enters it."""
    a, b = _before(on, k), _after(on, rails, k)
    part = (across[k] - across[b]) / (across[a] - across[b])
    i, left, right = disc[k], disc[a], disc[b]
    x = place[i, 0] - part * place[left, 0] - (1.0 - part) * place[right, 0]
    z = place[i, 2] - part * place[left, 2] - (1.0 - part) * place[right, 2]
    q = place[i, 3] - part * place[left, 3] - (1.0 - part) * place[right, 3]
    return float(_crossing(x, z, q, u, -1.0 if on[k] == 1 else 1.0))


@njit(inline=True, exact=True, bare=True)
def _end_arc(link: Ints, own: Ints, a: int, f: int, at: int) -> None:
    """Join the edge of facet f at corner `at` to where the arc of rail a and the next one began."""
    if own[a, 0] >= 0:
        join(link, own[a, 0], own[a, 1], f, at)


@njit(inline=True, exact=True, bare=True)
def _begin_arc(own: Ints, a: int, f: int, at: int) -> None:
    own[a, 0], own[a, 1] = f, at


@njit(exact=True, bare=True)
def find_rail_facets(work: Workspace, primitives: NDArray[np.float64], size: float) -> bool:
    """Fill the pieces of `work` with the support facets of discs on parallel axes.

    Parameters
    ----------
    work : Workspace
        Overwritten; every facet has three corners, and facets that face up are left out.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    size : float
        Size of the robot (length).

    Returns
    -------
    bool
        Whether it is such a robot; if not, there are no facets.
    """
    hull, counts = work.pieces, work.counts
    count, facet, span, link = hull.tally, hull.facet, hull.span, hull.link
    count[FOUND] = count[OVERFLOW] = 0
    span[0, FIRST] = 0
    axis = common_axis(primitives)
    if axis[0] == 0.0 and axis[1] == 0.0:
        return False
    n = primitives.shape[0]
    place, across, own = work.place, work.across[0], work.own
    order, rail = counts[0, :n], counts[1]
    _lay_out(primitives, axis, place, order)
    rails = _make_rails(place, order, size, rail, across)
    disc, on, goes_to = counts[2], counts[3], counts[4]
    bend = work.across[1]
    # Where each rail entered or left the hull last, which it does not undo at the same pitch.
    changed = work.across[2]
    own[:], changed[:] = OUTSIDE, -NEVER
    _begin(place, rail, order, rails, across, disc, on)
    u = -1.0
    for k in range(rails):
        bend[k], goes_to[k] = _next_bend(place, rail, order, k, disc[k], u)
    # Each event but the changes of a disc's neighbours is a facet, and their number is bounded.
    for _ in range(4 * facet.shape[0]):
        first, which, bends = NEVER, -1, False
        for k in range(rails):
            if bend[k] < first:
                first, which, bends = bend[k], k, True
            if 0 < k < rails - 1:
                there = _turns(place, across, disc, on, rails, k, u)
                if there < first and there != changed[k]:
                    first, which, bends = there, k, False
        if which < 0 or first > 1.0:
            break
        u = first
        sine, cosine = 2.0 * u / (1.0 + u * u), (1.0 - u * u) / (1.0 + u * u)
        k, d = which, disc[which]
        level = _level(place, d, sine, cosine)
        a, b = _before(on, k), _after(on, rails, k)
        if bends:
            e = goes_to[k]
            disc[k] = e
            bend[k], goes_to[k] = _next_bend(place, rail, order, k, e, u)
            if on[k] == 0:
                continue
            f = g = OUTSIDE
            if a >= 0:
                slope = (_level(place, disc[a], sine, cosine) - level) / (across[k] - across[a])
                normal = _normal(axis, sine, cosine, slope)
                three = (disc[a], d, e)
                f = add_triangle(hull, primitives, normal, three)
                if f < 0:
                    break
                at = span[f, FIRST]
                _end_arc(link, own, a, f, at)
                _begin_arc(own, a, f, at + 2)
            if b >= 0:
                slope = (level - _level(place, disc[b], sine, cosine)) / (across[b] - across[k])
                normal = _normal(axis, sine, cosine, slope)
                three = (disc[b], e, d)
                g = add_triangle(hull, primitives, normal, three)
                if g < 0:
                    break
                at = span[g, FIRST]
                _end_arc(link, own, k, g, at + 2)
                _begin_arc(own, k, g, at)
            if f >= 0 and g >= 0:
                join(link, f, span[f, FIRST] + 1, g, span[g, FIRST] + 1)
            continue
        i, j = disc[a], disc[b]
        left, right = _level(place, i, sine, cosine), _level(place, j, sine, cosine)
        normal = _normal(axis, sine, cosine, (left - right) / (across[b] - across[a]))
        three = (i, d, j) if on[k] == 1 else (i, j, d)
        f = add_triangle(hull, primitives, normal, three)
        if f < 0:
            break
        at = span[f, FIRST]
        _end_arc(link, own, a, f, at)
        if on[k] == 1:
            _end_arc(link, own, k, f, at + 1)
            _begin_arc(own, a, f, at + 2)
        else:
            _begin_arc(own, k, f, at + 1)
            _begin_arc(own, a, f, at + 2)
        on[k] = 1 - on[k]
        changed[k] = u
    for at in range(span[count[FOUND], FIRST]):
        if link[at, NEIGHBOUR] == UNKNOWN:
            link[at, NEIGHBOUR] = OUTSIDE
    return True
