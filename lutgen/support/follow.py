"""Following an arc: over two primitives (or one) until another one touches.

Owns the general search's step.  Along an arc the height of each other primitive is smooth, so
between two places it is bounded by a cubic; where that crosses zero, or has its top above it, the
place where the primitive first touches is solved for.
"""

import math
from typing import NamedTuple

from lutgen.jit import njit
from lutgen.support.primitive import sine_to_axle, support_contact, support_height
from lutgen.vector import Floats, Vector, cross, dot, length, scale, subtract, unit

# Steps along an arc (rad): between them a height is a cubic to 2e-6 of a radius.
STEP = 0.15
# Part of the size to which heights are right, a thousandth of what tells primitives apart.
LEVEL = 1e-14
# Where all others stay this part of the size lower, steps this many times longer will do: a cubic
# is then good to 2e-4 of a radius, unless a disc all but lies on its face.
FREE, STRIDES = 0.03, 3.0
MOST_STEPS = 48
# Of a wheel whose axle is nearer than 30 deg to the normal steps are shorter, as its contact runs
# along the rim that much faster than the plane turns; and the shortest of them, in parts of a step.
LEANING, SHORTEST = 2.0, 0.1
# Part of the distance between two contacts by which they may differ in height before the last step
# of Newton.
CLOSE = 1e-8
# Times that a step is halved where Newton does not find its end: where the two contacts differ in
# height by more than so many levels.
HALVINGS, SETTLED = 8, 1e5
# An arc is followed until the normal is this far beyond what is asked for.
FURTHER = 0.3


class OpenArc(NamedTuple):
    """An arc of normals at which primitives i and j carry (i alone where j is -1), end unknown.

    It leaves the unit normal `start` along the unit tangent `along`; outward, body frame.
    """

    i: int
    j: int
    start: Vector
    along: Vector


@njit(bare=True)
def _on_arc(primitives: Floats, arc: OpenArc, angle: float) -> Vector:
    """Return the normal at an angle from `start`, put back to where i and j are equally low."""
    i, j, start, along = arc
    c, s = math.cos(angle), math.sin(angle)
    n = (
        c * start[0] + s * along[0],
        c * start[1] + s * along[1],
        c * start[2] + s * along[2],
    )
    if j < 0:
        return n
    for _ in range(8):
        apart = subtract(support_contact(primitives, i, n), support_contact(primitives, j, n))
        higher = dot(apart, n)
        flat = subtract(apart, scale(n, higher))
        size = dot(flat, flat)
        if not size > 0.0:
            break
        n = unit(subtract(n, scale(flat, higher / size)))
        # Newton squares the error: what is left is a rounding.
        if abs(higher) <= CLOSE * math.sqrt(size):
            break
    return n


@njit(inline=True, bare=True)
def _share(primitives: Floats, m: int, normal: Vector) -> float:
    """Return which part of a step is as good on primitive m as a whole one on an upright wheel."""
    return min(max(LEANING * sine_to_axle(primitives, m, normal), SHORTEST), 1.0)


@njit(inline=True, bare=True)
def excess(primitives: Floats, m: int, i: int, normal: Vector) -> float:
    """Return how much lower primitive m reaches than i."""
    return support_height(primitives, m, normal) - support_height(primitives, i, normal)


@njit(bare=True)
def _touches_at(
    primitives: Floats, arc: OpenArc, m: int, bounds: tuple[float, float], level: float
) -> float:
    """Return the angle within bounds at which m touches: it is lower at the last of them."""
    i = arc.i
    low, high = bounds
    under = excess(primitives, m, i, _on_arc(primitives, arc, low))
    over = excess(primitives, m, i, _on_arc(primitives, arc, high))
    under = min(under, -0.01 * level)
    side = 0
    for _ in range(80):
        if over <= 0.0 or high - low < 1e-15:
            break
        there = low - under * (high - low) / (over - under)
        if not low < there < high:
            there = 0.5 * (low + high)
        value = excess(primitives, m, i, _on_arc(primitives, arc, there))
        if abs(value) < 0.01 * level:
            return there
        # Illinois: an end that stays counts half.
        if value > 0.0:
            high, over = there, value
            if side == 1:
                under *= 0.5
            side = 1
        else:
            low, under = there, value
            if side == -1:
                over *= 0.5
            side = -1
    return high


@njit(inline=True, bare=True)
def _highest_between(a: float, b: float, from_slope: float, to_slope: float) -> tuple[float, float]:
    """Return where, in [0, 1], the cubic with these values and slopes is highest, and how high."""
    c2 = 3.0 * (b - a) - 2.0 * from_slope - to_slope
    c3 = 2.0 * (a - b) + from_slope + to_slope
    # Its slope is from_slope + 2 c2 t + 3 c3 t^2, first positive and last negative.
    root = math.sqrt(max(c2 * c2 - 3.0 * c3 * from_slope, 0.0))
    t = from_slope / (root - c2) if root - c2 > 0.0 else 0.5
    t = min(max(t, 0.0), 1.0)
    return t, a + t * (from_slope + t * (c2 + t * c3))


@njit(bare=True)
def _first_touched(
    primitives: Floats, arc: OpenArc, third: int, step: float, level: float, clear: float
) -> tuple[int, float, Vector]:
    """Return the first primitive that touches within a step along an arc, the angle, the normal.

    -1 and the end of the step where none does.

    `third` touches at the start, and is let go.  With a `clear` length above 0 the answer is -2
    where another primitive comes nearer than that.
    """
    i, j, start, along = arc
    n = primitives.shape[0]
    end = _on_arc(primitives, arc, step)
    for _ in range(HALVINGS):
        if j < 0 or abs(excess(primitives, j, i, end)) <= SETTLED * level:
            break
        # A rim that lies nearly flat turns many times as fast as the plane.
        step *= 0.5
        end = _on_arc(primitives, arc, step)
    here, there = support_contact(primitives, i, start), support_contact(primitives, i, end)
    onward = subtract(scale(along, math.cos(step)), scale(start, math.sin(step)))
    onward = unit(subtract(onward, scale(end, dot(onward, end))))
    best, nearest = -1, step
    for m in range(n):
        if m in (i, j):
            continue
        p, q = support_contact(primitives, m, start), support_contact(primitives, m, end)
        a, b = dot(subtract(p, here), start), dot(subtract(q, there), end)
        from_slope = dot(subtract(p, here), along) * step
        to_slope = dot(subtract(q, there), onward) * step
        if clear > 0.0:
            top = max(b, min(a, a + from_slope))
            if from_slope > 0.0 and to_slope < 0.0:
                top = max(top, _highest_between(a, b, from_slope, to_slope)[1])
            if top > -clear:
                return -2, step, end
            continue
        if b > 0.0:
            low = 0.0
            if m == third:
                # It sinks first: find where it has.
                low = 0.5 * step
                for _ in range(40):
                    if excess(primitives, m, i, _on_arc(primitives, arc, low)) < 0.0:
                        break
                    low *= 0.5
            bounds = (low, step)
        elif from_slope > 0.0 and to_slope < 0.0 and m != third:
            part, height = _highest_between(a, b, from_slope, to_slope)
            if height <= 0.0:
                continue
            high = part * step
            if excess(primitives, m, i, _on_arc(primitives, arc, high)) <= 0.0:
                continue
            bounds = (0.0, high)
        else:
            continue
        angle = _touches_at(primitives, arc, m, bounds, level)
        if angle < nearest or best < 0:
            best, nearest = m, angle
    # Another one may be lower where the first is met: then it touches before.
    normal = end
    for _ in range(n + 1):
        if best < 0:
            break
        normal = _on_arc(primitives, arc, nearest)
        lower, furthest = -1, level
        for m in range(n):
            if m not in (i, j, best, third):
                over = excess(primitives, m, i, normal)
                if over > furthest:
                    lower, furthest = m, over
        if lower < 0:
            break
        best = lower
        nearest = _touches_at(primitives, arc, lower, (0.0, nearest), level)
    return best, nearest, normal


@njit(bare=True)
def follow(
    primitives: Floats, arc: OpenArc, third: int, lowest_up: float, size: float
) -> tuple[int, Vector]:
    """Follow an arc until another primitive touches.

    Returns it and the normal, or -1 where the arc leads up or all round.  `third` touches at the
    start; -1 for none.
    """
    i, j, here, along = arc
    level = LEVEL * size
    for _ in range(MOST_STEPS):
        best, angle, there = -2, 0.0, here
        step = STEP
        if j >= 0:
            step *= min(_share(primitives, i, here), _share(primitives, j, here))
        if third < 0:
            best, angle, there = _first_touched(
                primitives, arc, third, STRIDES * step, level, FREE * size
            )
        if best == -2:
            best, angle, there = _first_touched(primitives, arc, third, step, level, 0.0)
        if best >= 0:
            return best, there
        if there[2] > lowest_up + FURTHER:
            break
        third = -1
        if j >= 0:
            arm = subtract(
                support_contact(primitives, j, there), support_contact(primitives, i, there)
            )
            ahead = cross(arm, there)
            if not length(ahead) > 0.0:
                break
            along = unit(ahead)
        else:
            along = unit(subtract(scale(along, math.cos(angle)), scale(here, math.sin(angle))))
        here = there
        arc = OpenArc(i, j, here, along)
    return -1, here
