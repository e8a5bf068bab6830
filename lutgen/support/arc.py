"""Rolling over two contacts: the arc of normals between two facets, and what the weight does on it.

Owns one arc.  While primitives i and j carry, the plane's normal keeps their support functions
equal.  The robot rolls without slipping and without turning about the vertical, so gravity, fixed
on the ground, turns in the body as the normal does: by the least rotation from one normal to the
next.
"""

import math

from lutgen.jit import njit
from lutgen.support.primitive import support_contact
from lutgen.vector import Floats, Vector, cross, dot, length, scale, subtract, unit

# Longest step (rad) of a rolling plane: to 1e-4 rad of gravity and 2e-5 of the size of a rise.
STEP = 0.2


@njit()
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


@njit(inline=True)
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


@njit(inline=True)
def angle_between(a: Vector, b: Vector) -> float:
    """Return the angle (rad) between two unit vectors."""
    return 2.0 * math.asin(min(0.5 * length(subtract(a, b)), 1.0))


@njit()
def roll_along(
    primitives: Floats, i: int, j: int, begin: Vector, end: Vector, g: Vector
) -> tuple[Vector, float, float]:
    """Roll over contacts i and j from one normal to another.

    Returns gravity as the body sees it at the end, how far the com has risen (length, negative
    where it has sunk), and the length of the arc (rad).
    """
    steps = 1 + int(angle_between(begin, end) / STEP)
    rise = turn = 0.0
    here = begin
    contact = support_contact(primitives, i, here)
    for step in range(steps):
        there = (
            end
            if step + 1 == steps
            else arc_normal(primitives, i, j, begin, end, (step + 1.0) / steps)
        )
        beyond = support_contact(primitives, i, there)
        about = cross(here, there)
        sine = length(about)
        angle = angle_between(here, there)
        if sine > 0.0:
            half = unit((here[0] + there[0], here[1] + there[1], here[2] + there[2]))
            middle = turned_along(here, half, g)
            # The com moves as the body turns about the axis of contact: by about x arm.  Simpson's
            # rule, since gravity turns with the body and the contact runs along its rim.
            amid = support_contact(primitives, i, half)
            seen = turned_along(here, there, g)
            pull = dot(g, cross(about, contact)) + dot(seen, cross(about, beyond))
            pull += 4.0 * dot(middle, cross(about, amid))
            rise -= pull * angle / (6.0 * sine)
            g = seen
        turn += angle
        here, contact = there, beyond
    return g, rise, turn


@njit(inline=True)
def rise_over(p: Vector, q: Vector, g: Vector) -> float:
    """Return how far the com rises until it is above the axis from p to q (length)."""
    along = unit(subtract(q, p))
    arm = subtract(scale(along, dot(p, along)), p)
    up = subtract(scale(along, dot(g, along)), g)
    top = length(arm) * length(up)
    now = dot(arm, up)
    aside = dot(cross(along, arm), up)
    if now > 0.0:
        return float(aside * aside / (top + now))
    return float(top - now)
