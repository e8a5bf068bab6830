"""One roll over one arc, from a rest to the next: gravity on arrival, and the energy set free.

The robot is balanced on two contacts under gravity g.  It rolls; gravity turns along in the body by
the least rotation between the two normals, and the com sinks by the integral of -contact . dg.
"""

import math

from lutgen.jit import njit
from lutgen.support.primitive import support_contact, tangent_plane
from lutgen.vector import Floats, Vector, add, along, between, cross, dot, scale, subtract, unit

Normals = tuple[Vector, Vector, Vector, Vector, Vector]
Places = Normals
# Where along an arc its contacts are looked at, between its ends.
SHARES = (0.25, 0.5, 0.75)
# The integral of p dg for quartics through five even places is p_i BOOLE_ij g_j.
BOOLE = (
    (-945.0 / 1890.0, 1472.0 / 1890.0, -804.0 / 1890.0, 384.0 / 1890.0, -107.0 / 1890.0),
    (-1472.0 / 1890.0, 0.0, 2112.0 / 1890.0, -1024.0 / 1890.0, 384.0 / 1890.0),
    (804.0 / 1890.0, -2112.0 / 1890.0, 0.0, 2112.0 / 1890.0, -804.0 / 1890.0),
    (-384.0 / 1890.0, 1024.0 / 1890.0, -2112.0 / 1890.0, 0.0, 1472.0 / 1890.0),
    (107.0 / 1890.0, -384.0 / 1890.0, 804.0 / 1890.0, -1472.0 / 1890.0, 945.0 / 1890.0),
)


@njit(inline=True, bare=True)
def turned(start: Vector, stop: Vector, g: Vector) -> Vector:
    """Return g after the least rotation from one unit vector to another, not opposite one."""
    axis = cross(start, stop)
    moved = cross(axis, g)
    return along(add(g, moved), cross(axis, moved), 1.0 / (1.0 + dot(start, stop)))


@njit(bare=True)
def arc_between(
    primitives: Floats, pair: tuple[int, int], normals: tuple[Vector, Vector]
) -> tuple[Normals, Places, Places]:
    """Return normals of a plane that rolls over two primitives, and where it touches each of them.

    Five of each: at the beginning, at the end, and at `SHARES` between.
    """
    path = (
        normals[0],
        _plane_amid(primitives, pair, normals, SHARES[0]),
        _plane_amid(primitives, pair, normals, SHARES[1]),
        _plane_amid(primitives, pair, normals, SHARES[2]),
        normals[1],
    )
    return path, _touched(primitives, pair[0], path), _touched(primitives, pair[1], path)


@njit(bare=True)
def _plane_amid(
    primitives: Floats, pair: tuple[int, int], normals: tuple[Vector, Vector], share: float
) -> Vector:
    """Return the normal of a plane on a pair at a share of the way between two normals."""
    normal, side = unit(between(normals[0], normals[1], share)), subtract(normals[1], normals[0])
    across = along(side, normal, -dot(side, normal))
    return tangent_plane(primitives, pair[0], pair[1], -1, across, normal)[0]


@njit(bare=True)
def _touched(primitives: Floats, i: int, path: Normals) -> Places:
    """Return where five planes touch primitive i."""
    return (
        support_contact(primitives, i, path[0]),
        support_contact(primitives, i, path[1]),
        support_contact(primitives, i, path[2]),
        support_contact(primitives, i, path[3]),
        support_contact(primitives, i, path[4]),
    )


@njit(inline=True, bare=True)
def balances(first: Places, second: Places, w: float) -> Places:
    """Return where a robot is balanced along an arc, at place w between its two contacts."""
    return (
        between(first[0], second[0], w),
        between(first[1], second[1], w),
        between(first[2], second[2], w),
        between(first[3], second[3], w),
        between(first[4], second[4], w),
    )


@njit(inline=True, bare=True)
def back(path: Places) -> Places:
    """Return the arc the other way."""
    return path[4], path[3], path[2], path[1], path[0]


@njit(bare=True)
def roll(normals: Normals, path: Places, g: Vector) -> tuple[Vector, float]:
    """Return gravity after a roll, and how far the com has sunk (length).

    Gravity turns from normal to normal, and the sunk height is the integral of -contact . dg, both
    taken for polynomials through the five places (BOOLE).
    """
    one = turned(normals[0], normals[1], g)
    two = turned(normals[1], normals[2], one)
    three = turned(normals[2], normals[3], two)
    last = turned(normals[3], normals[4], three)
    sunk = 0.0
    for k in range(5):
        w = BOOLE[k]
        change = scale(g, w[0])
        change = along(along(change, one, w[1]), two, w[2])
        change = along(along(change, three, w[3]), last, w[4])
        sunk -= dot(path[k], change)
    return last, sunk


@njit(inline=True, bare=True)
def _stays(inside: float, above: float, sunk: float) -> bool:
    """Tell whether a robot stays behind an edge, see `held_by`."""
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
