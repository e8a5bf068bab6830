"""One roll over one arc, from a rest to the next: gravity on arrival, and the energy set free.

The robot is balanced on two contacts under gravity g.  It rolls; gravity turns along in the body,
never about the plane's normal, and the com sinks by the integral of -contact . dg.  Both are linear
in g.
"""

import math

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.primitive import support_contact, tangent_plane
from lutgen.vector import add, along, between, cross, dot, scale, subtract, unit

Places = tuple[Vector, Vector, Vector, Vector, Vector]
# The integral of p dg for quartics through five even places is p_i BOOLE_ij g_j.
BOOLE = (
    (-945.0 / 1890.0, 1472.0 / 1890.0, -804.0 / 1890.0, 384.0 / 1890.0, -107.0 / 1890.0),
    (-1472.0 / 1890.0, 0.0, 2112.0 / 1890.0, -1024.0 / 1890.0, 384.0 / 1890.0),
    (804.0 / 1890.0, -2112.0 / 1890.0, 0.0, 2112.0 / 1890.0, -804.0 / 1890.0),
    (-384.0 / 1890.0, 1024.0 / 1890.0, -2112.0 / 1890.0, 0.0, 1472.0 / 1890.0),
    (107.0 / 1890.0, -384.0 / 1890.0, 804.0 / 1890.0, -1472.0 / 1890.0, 945.0 / 1890.0),
)
# The twist of two chords is this part of that of their pieces of an arc, if they are short; and the
# first half of a piece has this part of its twist.
CHORDS, HALF = 0.75, 0.125


@njit(inline=True, bare=True)
def turned(start: Vector, stop: Vector, twist: float, g: Vector) -> Vector:
    """Return g after a rotation from one unit vector to another, not opposite one.

    It is the least one and then one about `stop`; `twist` is tan of half the second's angle (rad).
    """
    axis = along(cross(start, stop), add(start, stop), twist)
    axis = scale(axis, 1.0 / (1.0 + dot(start, stop)))
    moved = cross(axis, g)
    return along(g, add(moved, cross(axis, moved)), 2.0 / (1.0 + dot(axis, axis)))


@njit(bare=True)
def arc_between(
    primitives: Floats, pair: tuple[int, int], normals: tuple[Vector, Vector]
) -> tuple[Places, Places, Places]:
    """Return normals of a plane that rolls over two primitives, and where it touches each of them.

    Five of each: at even shares of the way between the two normals.
    """
    first, last = normals
    middle = _plane_amid(primitives, pair, normals, unit(add(first, last)))
    # A parabola through the three is near to the planes between.
    bent = scale(subtract(scale(middle, 2.0), add(first, last)), 0.125)
    path = (
        first,
        _plane_amid(primitives, pair, normals, unit(add(between(first, middle, 0.5), bent))),
        middle,
        _plane_amid(primitives, pair, normals, unit(add(between(middle, last, 0.5), bent))),
        last,
    )
    return path, _touched(primitives, pair[0], path), _touched(primitives, pair[1], path)


@njit(bare=True)
def _plane_amid(
    primitives: Floats, pair: tuple[int, int], normals: tuple[Vector, Vector], near: Vector
) -> Vector:
    """Return the normal of a plane on a pair that is near to one between two normals."""
    side = subtract(normals[1], normals[0])
    across = along(side, near, -dot(side, near))
    return tangent_plane(primitives, pair[0], pair[1], -1, across, near)[0]


@njit(bare=True)
def _touched(primitives: Floats, i: int, path: Places) -> Places:
    """Return where five planes touch primitive i."""
    return (
        support_contact(primitives, i, path[0]),
        support_contact(primitives, i, path[1]),
        support_contact(primitives, i, path[2]),
        support_contact(primitives, i, path[3]),
        support_contact(primitives, i, path[4]),
    )


@njit(inline=True, bare=True)
def _twist(a: Vector, b: Vector, c: Vector) -> float:
    """Return tan of half the angle between the least rotations from a to b to c and from a to c."""
    return dot(a, cross(b, c)) / (1.0 + dot(a, b) + dot(b, c) + dot(c, a))


@njit(bare=True)
def roll_over(normals: Places, places: Places) -> tuple[float, Vector]:
    """Return how a robot rolls over an arc: the twist of gravity, and how far the com sinks.

    Under gravity g it sinks by the second . g, which is the integral for polynomials through the
    five places (BOOLE) at which the planes touch one primitive.  The angle about the normal is the
    area between the arc and its chord on the sphere.
    """
    a, b, c, d, e = normals
    half, rest = _twist(a, b, c) / CHORDS, _twist(c, d, e) / CHORDS
    twist = _twist(a, c, e) + half + rest
    twists = 0.0, HALF * half, half, _twist(a, c, d) + half + HALF * rest, twist
    sunk = (0.0, 0.0, 0.0)
    for j in range(5):
        share = (0.0, 0.0, 0.0)
        for i in range(5):
            share = along(share, places[i], BOOLE[i][j])
        sunk = subtract(sunk, turned(normals[j], a, -twists[j], share))
    return twist, sunk


@njit(inline=True, bare=True)
def _stays(inside: float, above: float, sunk: float) -> bool:
    """Return True if a robot stays behind an edge, see `held_by`."""
    return inside >= 0.0 and (above + sunk <= 0.0 or inside * inside >= sunk * (2.0 * above + sunk))


@njit(bare=True)
def held_by(
    inside: tuple[float, float], above: tuple[float, float], sunk: tuple[float, float]
) -> tuple[float, float]:
    """Return the longest part [low, high] of [0, 1] on which one edge holds a robot that lands.

    How far gravity points inside the edge, how far the com is above it, and how far it has sunk
    (lengths) are linear between the two values given of each.  The robot stays if turning over the
    edge takes more energy than the roll has set free: sqrt(inside^2 + above^2) >= above + sunk.
    low >= high for none.
    """
    s0, n0, e0 = inside[0], above[0], sunk[0]
    s, n, e = inside[1] - s0, above[1] - n0, sunk[1] - e0
    if s0 < 0.0 and s0 + s < 0.0:
        return 1.0, 0.0
    # The verdict changes at roots of s, of n + e, and of s^2 - e (2 n + e).
    a = s * s - e * (2.0 * n + e)
    b = s0 * s - 0.5 * (e0 * (2.0 * n + e) + e * (2.0 * n0 + e0))
    c = s0 * s0 - e0 * (2.0 * n0 + e0)
    square = b * b - a * c
    root = math.sqrt(square) if square >= 0.0 else math.nan
    q = -(b + math.copysign(root, b))
    places = (s0 / -s, (n0 + e0) / -(n + e), q / a, c / q)
    low, high, at = 1.0, 0.0, 0.0
    best_low, best_high = 1.0, 0.0
    while at < 1.0:
        to = 1.0
        for k in range(4):
            if at < places[k] < to:
                to = places[k]
        half = 0.5 * (at + to)
        if _stays(s0 + half * s, n0 + half * n, e0 + half * e):
            low, high = (at if low > high else low), to
            if high - low > best_high - best_low:
                best_low, best_high = low, high
        else:
            low, high = 1.0, 0.0
        at = to
    return best_low, best_high
