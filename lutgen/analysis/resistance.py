"""What friction takes from a robot that moves on the ground, some of its contacts rolling.

Owns the planar limit analysis: the motion of the contact plane that resists gravity least.
"""

import math

import numpy as np

from lutgen.jit import njit
from lutgen.support import DISC, SPHERE
from lutgen.vector import Floats

# Contacts that roll are told apart by their kinds; a braked one counts as none of them.
BRAKED = -1.0
# What rolls resists by this share of its load, so that every motion costs something.
RESISTANCE = 1e-12
# Golden sections of each search: intervals shrink to 3e-13 of their lengths.
SECTIONS = 60
GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
# Turning about a point nearer to the com than this share of the robot's size is not tried.
NEAREST = 1e-9


@njit()
def _resistance(
    motion: Floats, loads: Floats, arm: Floats, roll: Floats, aside: float, turn: float
) -> float:
    """Return the power, per unit of friction, that a motion of the plane costs at most.

    The com moves by 1 downhill (x) and `aside` across (y), and the robot turns by `turn`.
    """
    cost = np.empty(len(motion))
    for i in range(len(motion)):
        x = 1.0 - turn * arm[i, 1]
        y = aside + turn * arm[i, 0]
        if motion[i] == BRAKED:
            cost[i] = math.hypot(x, y)
        elif motion[i] == SPHERE:
            cost[i] = RESISTANCE * math.hypot(x, y)
        else:
            along = x * roll[i, 0] + y * roll[i, 1]
            across = y * roll[i, 0] - x * roll[i, 1]
            cost[i] = math.hypot(across, RESISTANCE * along)
    most = 0.0
    for c in range(len(loads)):
        total = 0.0
        for i in range(len(motion)):
            total += loads[c, i] * cost[i]
        most = max(most, total)
    return most


@njit()
def _best_aside(motion: Floats, loads: Floats, arm: Floats, roll: Floats, turn: float) -> float:
    """Return the least resistance over all `aside` at one `turn`; it is convex in `aside`."""
    low, high = math.inf, -math.inf
    for i in range(len(motion)):
        # Where this contact alone costs least.
        place = -turn * arm[i, 0]
        if motion[i] == DISC:
            x = 1.0 - turn * arm[i, 1]
            a, b, little = roll[i, 0], roll[i, 1], RESISTANCE * RESISTANCE
            place += x * a * b * (1.0 - little) / (a * a + little * b * b)
        low, high = min(low, place), max(high, place)
    # Logarithmic, because the interval may be of any size while the minimum is near 0.
    low, high = math.asinh(low), math.asinh(high)
    first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_first = _resistance(motion, loads, arm, roll, math.sinh(first), turn)
    at_second = _resistance(motion, loads, arm, roll, math.sinh(second), turn)
    for _ in range(SECTIONS):
        if at_first <= at_second:
            high, second, at_second = second, first, at_first
            first = high - GOLDEN * (high - low)
            at_first = _resistance(motion, loads, arm, roll, math.sinh(first), turn)
        else:
            low, first, at_first = first, second, at_second
            second = low + GOLDEN * (high - low)
            at_second = _resistance(motion, loads, arm, roll, math.sinh(second), turn)
    return min(at_first, at_second)


@njit()
def least_resistance(motion: Floats, loads: Floats, arm: Floats, roll: Floats) -> float:
    """Return the least resistance, per unit of friction, of all motions that go 1 downhill.

    Of several loads each motion meets the one that resists it most.  That is the largest resistance
    of all their mixtures: by the minimax theorem it does not matter whether the motion or the load
    is chosen first, as power is linear in the load and convex in the motion.  `motion` (k,) is
    BRAKED, DISC (rolling along) or SPHERE (rolling in every direction), `loads` (c, k) the shares
    of the normal force, `arm` (k, 2) leads from below the com to the contact points, x downhill, in
    units of the robot's size, and `roll` (k, 2) are the unit rolling directions of the discs.  In
    [0, 1] but for rounding: 1 where all contacts are braked, 0 where gravity finds a motion in
    which all contacts that carry load roll.
    """
    high = math.asinh(1.0 / NEAREST)
    low = -high
    first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_first = _best_aside(motion, loads, arm, roll, math.sinh(first))
    at_second = _best_aside(motion, loads, arm, roll, math.sinh(second))
    for _ in range(SECTIONS):
        if at_first <= at_second:
            high, second, at_second = second, first, at_first
            first = high - GOLDEN * (high - low)
            at_first = _best_aside(motion, loads, arm, roll, math.sinh(first))
        else:
            low, first, at_first = first, second, at_second
            second = low + GOLDEN * (high - low)
            at_second = _best_aside(motion, loads, arm, roll, math.sinh(second))
    return min(at_first, at_second)
