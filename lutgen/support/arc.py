"""Rolling over two contacts: the arc of normals between two facets, and what the weight does on it.

Owns one arc.  While primitives i and j carry, the plane's normal keeps their support functions
equal.  The robot rolls without slipping and without turning about the vertical, so gravity, fixed
on the ground, turns in the body as the normal does: by the least rotation from one normal to the
next.
"""

import math

from lutgen.jit import njit
from lutgen.support.primitive import KIND, POINT, support_contact
from lutgen.vector import Floats, Vector, cross, dot, length, scale, subtract, unit

# Columns of the rows of a roll.
SEEN, RISE, TURN = 0, 9, 12
# Longest step (rad) of a rolling plane: to 1e-4 rad of gravity and 2e-5 of the size of a rise.
STEP = 0.2


@njit(bare=True)
def arc_normal(
    primitives: Floats, i: int, j: int, begin: Vector, end: Vector, fraction: float
) -> Vector:
    """Return the unit normal at a fraction of the arc over i and j between two normals."""
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


@njit(bare=True)
def enter_roll(
    primitives: Floats,
    i: int,
    j: int,
    begin: Vector,
    end: Vector,
    at: int,
    back: int,
    roll: Floats,
) -> float:
    """Fill rows `at` and `back` of `roll` (E, 13): rolling over i and j, and rolling back.

    What rolling does is linear in gravity.  A row holds the matrix (row by row) that gives gravity
    as the body sees it at the end, the vector whose product with gravity at the start is how far
    the com has risen (length, negative where it has sunk), and the turn (rad), which is returned.
    """
    moves = primitives[i, KIND] != POINT or primitives[j, KIND] != POINT
    steps = 1 + int(angle_between(begin, end) / STEP) if moves else 1
    x, y, z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
    rise = (0.0, 0.0, 0.0)
    turn = 0.0
    here = begin
    contact = support_contact(primitives, i, here)
    for step in range(steps):
        there = (
            end
            if step + 1 == steps
            else arc_normal(primitives, i, j, begin, end, (step + 1.0) / steps)
        )
        angle = angle_between(here, there)
        about = cross(here, there)
        sine = length(about)
        beyond = contact
        if not moves:
            more = subtract(turned_along(there, here, contact), contact)
            rise = _plus(rise, more)
        elif sine > 0.0:
            # The com moves as the body turns about the axis of contact: by about x arm.  Simpson's
            # rule, since gravity turns with the body and the contact runs along its rim.
            beyond = support_contact(primitives, i, there)
            about = scale(about, angle / (6.0 * sine))
            half = unit((here[0] + there[0], here[1] + there[1], here[2] + there[2]))
            amid = cross(support_contact(primitives, i, half), about)
            amid = scale(turned_along(half, here, amid), 4.0)
            last = turned_along(there, here, cross(beyond, about))
            pull = _plus(_plus(cross(contact, about), amid), last)
            rise = _plus(rise, (dot(x, pull), dot(y, pull), dot(z, pull)))
        if sine > 0.0:
            x = turned_along(here, there, x)
            y = turned_along(here, there, y)
            z = turned_along(here, there, z)
        turn += angle
        here, contact = there, beyond
    for c in range(3):
        roll[at, SEEN + 3 * c], roll[back, SEEN + c] = x[c], x[c]
        roll[at, SEEN + 3 * c + 1], roll[back, SEEN + 3 + c] = y[c], y[c]
        roll[at, SEEN + 3 * c + 2], roll[back, SEEN + 6 + c] = z[c], z[c]
        roll[at, RISE + c] = rise[c]
        roll[back, RISE + c] = -(x[c] * rise[0] + y[c] * rise[1] + z[c] * rise[2])
    roll[at, TURN], roll[back, TURN] = turn, turn
    return turn
