"""Friction against a robot that moves on the ground, some of its contacts rolling.

The motion of the contact plane that resists gravity least is the minimum of a convex function of
two unknowns.  It lies between planes that touch the function from below.
"""

import math

import numpy as np

from lutgen.jit import njit
from lutgen.support import DISC, SPHERE
from lutgen.vector import Floats

# A contact that does not roll as a DISC or a SPHERE does.
BRAKED = -1.0
# The least resistance is known to this, some hundred roundings.
KNOWN = 2e-14
# Heights of planes, and slopes, are too high by this share at most.
ROUNDING = 1e-15
# Turning about a point nearer to the com than 1e-9 of the robot's size is not tried.
FASTEST = 1e9
# Brackets grow by this until they hold the minimum.
WIDER = 32.0
# Slopes, and rolling directions downhill of discs, below this are rounding.
LEVEL = 1e-12
# Looks along one unknown; a tenth is what they take, and more would mean that rounding ends them.
LOOKS = 200


@njit()
def _resistance(
    motion: Floats, loads: Floats, arm: Floats, roll: Floats, aside: float, turn: float
) -> tuple[float, float, float]:
    """Return the power, per unit of friction, that a motion costs at most, and its two slopes.

    The com moves by 1 downhill (x) and `aside` across (y), and the robot turns by `turn`.  The
    slopes, over `aside` and over `turn`, are those of a plane that touches the power from below.
    """
    part = np.zeros((len(motion), 3))
    for i in range(len(motion)):
        x = 1.0 - turn * arm[i, 1]
        y = aside + turn * arm[i, 0]
        if motion[i] == DISC:
            across = y * roll[i, 0] - x * roll[i, 1]
            cost, sign = abs(across), float(np.sign(across))
            over_x, over_y = -sign * roll[i, 1], sign * roll[i, 0]
        elif motion[i] == SPHERE:
            continue
        else:
            cost = math.hypot(x, y)
            over_x, over_y = (x / cost, y / cost) if cost > 0.0 else (0.0, 0.0)
        part[i, 0] = cost
        part[i, 1] = over_y
        part[i, 2] = over_y * arm[i, 0] - over_x * arm[i, 1]
    found = loads @ part
    c = np.argmax(found[:, 0])
    return found[c, 0], found[c, 1], found[c, 2]


@njit()
def _meeting(
    low: float, left: float, left_slope: float, high: float, right: float, right_slope: float
) -> tuple[float, float]:
    """Return where tangents at two places meet, their slopes of opposite signs, and how high."""
    fall = left_slope - right_slope
    place = (right - left + left_slope * low - right_slope * high) / fall
    height = left + left_slope * (place - low)
    return place, height - ROUNDING * (abs(left) + abs(right) + high - low)


@njit()
def _best_aside(
    motion: Floats, loads: Floats, arm: Floats, roll: Floats, turn: float
) -> tuple[float, float, float]:
    """Return the least resistance over all `aside` at one `turn`, and a line below it.

    The line is its height at `turn` and its slope over `turn`: at no turn is the least resistance
    below it.
    """
    low, high = math.inf, -math.inf
    for i in range(len(motion)):
        # Where this contact alone costs least.
        place = -turn * arm[i, 0]
        if motion[i] == SPHERE or (motion[i] == DISC and abs(roll[i, 0]) < LEVEL):
            continue
        if motion[i] == DISC:
            place += (1.0 - turn * arm[i, 1]) * roll[i, 1] / roll[i, 0]
        low, high = min(low, place), max(high, place)
    if low > high:
        least, _, left_turn = _resistance(motion, loads, arm, roll, 0.0, turn)
        return least, least, left_turn
    # A little wider, where every slope has its sign for certain.
    wider = 1e-9 * (1.0 + abs(low) + abs(high))
    low, high = low - wider, high + wider
    left, left_slope, left_turn = _resistance(motion, loads, arm, roll, low, turn)
    right, right_slope, right_turn = _resistance(motion, loads, arm, roll, high, turn)
    for look in range(LOOKS):
        share = right_slope / (right_slope - left_slope)
        least = min(left, right)
        place, below = _meeting(low, left, left_slope, high, right, right_slope)
        if look % 3 == 2:
            place = (low + high) / 2.0
        if least - below <= KNOWN * (1.0 + least) or not low < place < high:
            break
        here, slope, over_turn = _resistance(motion, loads, arm, roll, place, turn)
        if slope == 0.0:
            return here, here, over_turn
        if slope < 0.0:
            low, left, left_slope, left_turn = place, here, slope, over_turn
        else:
            high, right, right_slope, right_turn = place, here, slope, over_turn
    return least, below, share * left_turn + (1.0 - share) * right_turn


@njit()
def least_resistance(motion: Floats, loads: Floats, arm: Floats, roll: Floats) -> float:
    """Return the least resistance, per unit of friction, of all motions that go 1 downhill.

    Each motion meets the load, among several, that resists it most.  That is the largest resistance
    of all their mixtures: by the minimax theorem it does not matter if the motion or the load
    is chosen first, as power is linear in the load and convex in the motion.  `motion` (k,) is
    BRAKED, DISC (rolling along) or SPHERE (rolling in every direction), `loads` (c, k) the shares
    of the normal force, `arm` (k, 2) leads from below the com to the contact points, x downhill, in
    units of the robot's size, and `roll` (k, 2) are the unit rolling directions of the discs.  In
    [0, 1] but for rounding: 1 where all contacts are braked, 0 where gravity finds a motion in
    which all contacts that carry load roll.
    """
    low, high = -1.0, 1.0
    left, left_below, left_slope = _best_aside(motion, loads, arm, roll, low)
    while left_slope > LEVEL and low > -FASTEST:
        low *= WIDER
        left, left_below, left_slope = _best_aside(motion, loads, arm, roll, low)
    right, right_below, right_slope = _best_aside(motion, loads, arm, roll, high)
    while right_slope < -LEVEL and high < FASTEST:
        high *= WIDER
        right, right_below, right_slope = _best_aside(motion, loads, arm, roll, high)
    least = min(left, right)
    for look in range(LOOKS):
        if left_slope >= 0.0 or right_slope <= 0.0:
            break
        place, below = _meeting(low, left_below, left_slope, high, right_below, right_slope)
        if look % 3 == 2:
            # Places may have any size, so the middle is that of their logarithms.
            place = math.sinh((math.asinh(low) + math.asinh(high)) / 2.0)
        if least - below <= KNOWN * (1.0 + least) or not low < place < high:
            break
        here, here_below, slope = _best_aside(motion, loads, arm, roll, place)
        least = min(least, here)
        if slope == 0.0:
            break
        if slope < 0.0:
            low, left_below, left_slope = place, here_below, slope
        else:
            high, right_below, right_slope = place, here_below, slope
    return least
