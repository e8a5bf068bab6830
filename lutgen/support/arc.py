"""Rolling over two contacts: the arc of normals between two facets, and what the weight does on it.

Owns one arc.  While primitives i and j carry, the plane's normal keeps their support functions
equal.  The robot rolls without slipping and without turning about the vertical, so gravity, fixed
on the ground, turns in the body as the normal does: by the least rotation from one normal to the
next.
"""

import math
from typing import NamedTuple

from lutgen.jit import njit
from lutgen.support.primitive import KIND, POINT, RADIUS, sine_to_axle, support_contact
from lutgen.vector import Floats, Vector, cross, dot, length, scale, subtract, unit

# Columns of the rows of a roll.
SEEN, RISE, TURN = 0, 9, 12
# Longest pair of steps (rad) of a rolling plane, and of what a contact goes along its rim beyond
# that: gravity is right to 1e-4 rad, a rise to 1e-4 of a radius.
PAIR = 0.4
# From which ratio of a disc's paces along its rim on pairs are shorter, and the most that counts.
UNEVEN, MOST_UNEVEN = 1.5, 16.0


class Arc(NamedTuple):
    """The arc of normals at which primitives i and j carry, between two facets.

    `begin` and `end` are the facets' unit normals, outward, body frame.
    """

    i: int
    j: int
    begin: Vector
    end: Vector


@njit(bare=True)
def arc_normal(primitives: Floats, arc: Arc, fraction: float) -> Vector:
    """Return the unit normal at a fraction of an arc."""
    i, j, begin, end = arc
    normal = unit(
        (
            begin[0] + fraction * (end[0] - begin[0]),
            begin[1] + fraction * (end[1] - begin[1]),
            begin[2] + fraction * (end[2] - begin[2]),
        )
    )
    for _ in range(2):
        apart = subtract(
            support_contact(primitives, i, normal), support_contact(primitives, j, normal)
        )
        higher = dot(apart, normal)
        flat = subtract(apart, scale(normal, higher))
        size = dot(flat, flat)
        if not size > 1e-30:
            break
        normal = unit(subtract(normal, scale(flat, higher / size)))
    return normal


@njit(inline=True, bare=True)
def turned_along(begin: Vector, end: Vector, vector: Vector) -> Vector:
    """Return a vector turned by the least rotation that turns one unit normal into another."""
    about = cross(begin, end)
    once = cross(about, vector)
    twice = scale(cross(about, once), 1.0 / (1.0 + dot(begin, end)))
    return (
        vector[0] + once[0] + twice[0],
        vector[1] + once[1] + twice[1],
        vector[2] + once[2] + twice[2],
    )


@njit(inline=True, bare=True)
def angle_between(a: Vector, b: Vector) -> float:
    """Return the angle (rad) between two unit vectors."""
    return 2.0 * math.asin(min(0.5 * length(subtract(a, b)), 1.0))


@njit(inline=True, bare=True)
def _plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(inline=True, bare=True)
def _weighed(p: Vector, a: float, q: Vector, b: float, r: Vector, c: float) -> Vector:
    return (
        a * p[0] + b * q[0] + c * r[0],
        a * p[1] + b * q[1] + c * r[1],
        a * p[2] + b * q[2] + c * r[2],
    )


@njit(inline=True, bare=True)
def _solid_angle(a: Vector, b: Vector, c: Vector) -> float:
    """Return the solid angle of a narrow triangle, positive where a, b, c go counter-clockwise."""
    return 2.0 * dot(a, cross(b, c)) / (1.0 + dot(a, b) + dot(b, c) + dot(c, a))


@njit(inline=True, bare=True)
def _spun(normal: Vector, angle: float, vector: Vector) -> Vector:
    """Return a vector turned about a unit normal by a small angle (rad)."""
    once = scale(cross(normal, vector), angle)
    twice = scale(cross(normal, once), 0.5 * angle)
    return _plus(_plus(vector, once), twice)


@njit(inline=True, bare=True)
def _arc_length(a: Vector, b: Vector, c: Vector) -> float:
    """Return the length (rad) of an arc from a over its middle b to c."""
    steps, chord = angle_between(a, b) + angle_between(b, c), angle_between(a, c)
    return steps + (steps - chord) / 3.0


@njit(inline=True, bare=True)
def seen_after(roll: Floats, at: int, g: Vector) -> Vector:
    """Return gravity as the body sees it after a roll."""
    return (
        roll[at, 0] * g[0] + roll[at, 1] * g[1] + roll[at, 2] * g[2],
        roll[at, 3] * g[0] + roll[at, 4] * g[1] + roll[at, 5] * g[2],
        roll[at, 6] * g[0] + roll[at, 7] * g[1] + roll[at, 8] * g[2],
    )


@njit(inline=True, bare=True)
def risen_after(roll: Floats, at: int, g: Vector) -> float:
    """Return how far the com has risen after a roll (length)."""
    rise: float = roll[at, RISE] * g[0] + roll[at, RISE + 1] * g[1] + roll[at, RISE + 2] * g[2]
    return rise


@njit(inline=True, bare=True)
def _rim_chord(primitives: Floats, i: int, place: Vector, end: Vector) -> float:
    """Return how far a contact goes along its rim from a place, as a chord over the radius: 0 to 2.

    On a wheel that lies nearly flat that is many times as much as the plane turns.
    """
    moved = subtract(support_contact(primitives, i, end), place)
    radius = primitives[i, RADIUS]
    return length(moved) / radius if radius > 0.0 else 0.0


@njit(inline=True, bare=True)
def _unevenness(primitives: Floats, m: int, begin: Vector, half: Vector, end: Vector) -> float:
    """Return by how many times the pace of a contact along its rim changes between three normals.

    A disc's pace is that of the plane over the sine between the plane's normal and its axle.
    """
    first, amid = sine_to_axle(primitives, m, begin), sine_to_axle(primitives, m, half)
    last = sine_to_axle(primitives, m, end)
    ratio = max(first, amid, last) / max(min(first, amid, last), 1e-3)
    return min(ratio, MOST_UNEVEN) if ratio > UNEVEN else 1.0


@njit(bare=True)
def enter_roll(primitives: Floats, arc: Arc, at: int, back: int, roll: Floats) -> float:
    """Fill rows `at` and `back` of `roll` (E, 13): rolling along an arc, and rolling back.

    What rolling does is linear in gravity.  A row holds the matrix (row by row) that gives gravity
    as the body sees it at the end, the vector whose product with gravity at the start is how far
    the com has risen (length, negative where it has sunk), and the turn (rad), which is returned.
    """
    i, j, begin, end = arc
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    rise = (0.0, 0.0, 0.0)
    turn = 0.0
    p = support_contact(primitives, i, begin)
    if primitives[i, KIND] == POINT and primitives[j, KIND] == POINT:
        x, y, z = (
            turned_along(begin, end, x),
            turned_along(begin, end, y),
            turned_along(begin, end, z),
        )
        rise = subtract((dot(x, p), dot(y, p), dot(z, p)), p)
        turn = angle_between(begin, end)
    else:
        angle = angle_between(begin, end)
        q = support_contact(primitives, j, begin)
        own, other = _rim_chord(primitives, i, p, end), _rim_chord(primitives, j, q, end)
        half = arc_normal(primitives, arc, 0.5)
        uneven = max(
            _unevenness(primitives, i, begin, half, end),
            _unevenness(primitives, j, begin, half, end),
        )
        pairs = 1 + int(uneven * max(angle, max(own, other) - angle) / PAIR)
        if own * primitives[i, RADIUS] > other * primitives[j, RADIUS]:
            # Both tell how far the com rises; the other one's contact goes a shorter way.
            i, j, p = j, i, q
        arc = Arc(i, j, begin, end)
        here = begin
        for pair in range(pairs):
            half = arc_normal(primitives, arc, (pair + 0.5) / pairs)
            there = end if pair + 1 == pairs else arc_normal(primitives, arc, (pair + 1.0) / pairs)
            q, r = support_contact(primitives, i, half), support_contact(primitives, i, there)
            # The com's height over the contact is g . p; the ground's own changes by -g . dp.  The
            # integral of p . dg, both as parabolas through their three values.
            first = _weighed(p, -0.5, q, -2.0 / 3.0, r, 1.0 / 6.0)
            amid = scale(subtract(p, r), 2.0 / 3.0)
            last = _weighed(p, -1.0 / 6.0, q, 2.0 / 3.0, r, 0.5)
            spin = _solid_angle(here, half, there) / 6.0
            rise = _plus(rise, (dot(x, first), dot(y, first), dot(z, first)))
            x = _spun(half, spin, turned_along(here, half, x))
            y = _spun(half, spin, turned_along(here, half, y))
            z = _spun(half, spin, turned_along(here, half, z))
            rise = _plus(rise, (dot(x, amid), dot(y, amid), dot(z, amid)))
            x = _spun(there, spin, turned_along(half, there, x))
            y = _spun(there, spin, turned_along(half, there, y))
            z = _spun(there, spin, turned_along(half, there, z))
            rise = _plus(rise, (dot(x, last), dot(y, last), dot(z, last)))
            turn += _arc_length(here, half, there)
            here, p = there, r
    for c in range(3):
        roll[at, SEEN + 3 * c], roll[back, SEEN + c] = x[c], x[c]
        roll[at, SEEN + 3 * c + 1], roll[back, SEEN + 3 + c] = y[c], y[c]
        roll[at, SEEN + 3 * c + 2], roll[back, SEEN + 6 + c] = z[c], z[c]
        roll[at, RISE + c] = rise[c]
        roll[back, RISE + c] = -(x[c] * rise[0] + y[c] * rise[1] + z[c] * rise[2])
    roll[at, TURN], roll[back, TURN] = turn, turn
    return turn
