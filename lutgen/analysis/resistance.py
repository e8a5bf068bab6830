"""What friction takes from a robot that moves on the ground, some of its contacts rolling.

Owns the planar limit analysis: the motion of the contact plane that resists gravity least.  It is a
convex problem in two unknowns.  Its minimum is closed in on between planes that touch the
resistance from below, which bound it, and the least resistance found so far.
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
# The least resistance is known to this, some hundred roundings.
KNOWN = 2e-14
# Of heights, and of slopes, which are 1 at most: far away they make planes too high by this share.
ROUNDING = 1e-15
# Brackets grow by this until they hold the minimum.
WIDER = 32.0
# Turning about a point nearer to the com than this share of the robot's size is not tried.
NEAREST = 1e-9
# Looks in one direction; a tenth is what they take, and more would mean that rounding ends them.
LOOKS = 200


@njit()
def _resistance(
    motion: Floats,
    loads: Floats,
    arm: Floats,
    roll: Floats,
    aside: float,
    turn: float,
    part: Floats,
) -> tuple[float, float, float]:
    """Return the power, per unit of friction, that a motion costs at most, and its two slopes.

    The com moves by 1 downhill (x) and `aside` across (y), and the robot turns by `turn`.  The
    slopes are those of a plane that touches the power from below there: over `aside`, and over
    `turn`.  `part` (k, 3) is room for what each contact costs.
    """
    for i in range(len(motion)):
        x = 1.0 - turn * arm[i, 1]
        y = aside + turn * arm[i, 0]
        if motion[i] == DISC:
            along = x * roll[i, 0] + y * roll[i, 1]
            across = y * roll[i, 0] - x * roll[i, 1]
            cost = math.hypot(across, RESISTANCE * along)
            little = RESISTANCE * RESISTANCE * along
            over_x = little * roll[i, 0] - across * roll[i, 1]
            over_y = across * roll[i, 0] + little * roll[i, 1]
            share = 1.0
        else:
            cost, over_x, over_y = math.hypot(x, y), x, y
            share = RESISTANCE if motion[i] == SPHERE else 1.0
        # Where it costs nothing the level plane touches it.
        steep = share / cost if cost > 0.0 else 0.0
        part[i, 0] = share * cost
        part[i, 1] = steep * over_y
        part[i, 2] = steep * (over_y * arm[i, 0] - over_x * arm[i, 1])
    most, over_aside, over_turn = -1.0, 0.0, 0.0
    for c in range(len(loads)):
        total, first, second = 0.0, 0.0, 0.0
        for i in range(len(motion)):
            total += loads[c, i] * part[i, 0]
            first += loads[c, i] * part[i, 1]
            second += loads[c, i] * part[i, 2]
        if total > most:
            most, over_aside, over_turn = total, first, second
    return most, over_aside, over_turn


@njit()
def _between(
    low: float, low_slope: float, high: float, high_slope: float, kink: float, look: int
) -> float:
    """Return where to look next between two places whose slopes have opposite signs.

    In turn: where their tangents meet (`kink`), which is the minimum if there is an edge; where a
    straight line between the slopes is 0, which is near it if there is none; and in the middle.
    """
    # Of any size while the minimum is near 0, so that a middle is that of their logarithms.
    middle = math.sinh((math.asinh(low) + math.asinh(high)) / 2.0)
    place = middle if low < middle < high else (low + high) / 2.0
    if look % 3 == 0:
        place = kink
    elif look % 3 == 1:
        place = low + (high - low) * low_slope / (low_slope - high_slope)
    return place if low < place < high else (low + high) / 2.0


@njit()
def _best_aside(
    motion: Floats, loads: Floats, arm: Floats, roll: Floats, turn: float, part: Floats
) -> tuple[float, float, float]:
    """Return the least resistance over all `aside` at one `turn`, and a line below it.

    The line is its height at `turn` and its slope over `turn`: at no turn is the least resistance
    below it.
    """
    low, high = math.inf, -math.inf
    for i in range(len(motion)):
        # Where this contact alone costs least.
        place = -turn * arm[i, 0]
        if motion[i] == DISC:
            x = 1.0 - turn * arm[i, 1]
            a, b, little = roll[i, 0], roll[i, 1], RESISTANCE * RESISTANCE
            place += x * a * b * (1.0 - little) / (a * a + little * b * b)
        low, high = min(low, place), max(high, place)
    left, left_slope, left_turn = _resistance(motion, loads, arm, roll, low, turn, part)
    right, right_slope, right_turn = _resistance(motion, loads, arm, roll, high, turn, part)
    step = 1e-12 * (1.0 + abs(low) + abs(high))
    while left_slope > 0.0:
        # Rounding put it on the wrong side.
        low, step = low - step, 2.0 * step
        left, left_slope, left_turn = _resistance(motion, loads, arm, roll, low, turn, part)
    while right_slope < 0.0:
        high, step = high + step, 2.0 * step
        right, right_slope, right_turn = _resistance(motion, loads, arm, roll, high, turn, part)
    if left_slope == 0.0:
        return left, left, left_turn
    if right_slope == 0.0:
        return right, right, right_turn
    for look in range(LOOKS):
        share = right_slope / (right_slope - left_slope)
        # Where the two planes below meet, as a line over the turns.
        kink = (right - left + left_slope * low - right_slope * high) / (left_slope - right_slope)
        below = left + left_slope * (kink - low)
        below -= ROUNDING * (left + right + high - low)
        least = min(left, right)
        if least - below <= KNOWN * (1.0 + least):
            break
        place = _between(low, left_slope, high, right_slope, kink, look)
        if not low < place < high:
            break
        here, slope, over_turn = _resistance(motion, loads, arm, roll, place, turn, part)
        if slope == 0.0:
            return here, here, over_turn
        if slope < 0.0:
            low, left, left_slope, left_turn = place, here, slope, over_turn
        else:
            high, right, right_slope, right_turn = place, here, slope, over_turn
    return least, below, share * left_turn + (1.0 - share) * right_turn


@njit()
def least_resistance(
    motion: Floats, loads: Floats, arm: Floats, roll: Floats, enough: float = math.inf
) -> float:
    """Return the least resistance, per unit of friction, of all motions that go 1 downhill.

    Of several loads each motion meets the one that resists it most.  That is the largest resistance
    of all their mixtures: by the minimax theorem it does not matter whether the motion or the load
    is chosen first, as power is linear in the load and convex in the motion.  `motion` (k,) is
    BRAKED, DISC (rolling along) or SPHERE (rolling in every direction), `loads` (c, k) the shares
    of the normal force, `arm` (k, 2) leads from below the com to the contact points, x downhill, in
    units of the robot's size, and `roll` (k, 2) are the unit rolling directions of the discs.  In
    [0, 1] but for rounding: 1 where all contacts are braked, 0 where gravity finds a motion in
    which all contacts that carry load roll.  Where it is at least `enough`, so is what is returned.
    """
    part = np.empty((len(motion), 3))
    low, high = -1.0, 1.0
    left, left_below, left_slope = _best_aside(motion, loads, arm, roll, low, part)
    while left_slope >= 0.0 and low > -1.0 / NEAREST:
        low *= WIDER
        left, left_below, left_slope = _best_aside(motion, loads, arm, roll, low, part)
    right, right_below, right_slope = _best_aside(motion, loads, arm, roll, high, part)
    while right_slope <= 0.0 and high < 1.0 / NEAREST:
        high *= WIDER
        right, right_below, right_slope = _best_aside(motion, loads, arm, roll, high, part)
    least = min(left, right)
    if left_slope >= 0.0 or right_slope <= 0.0:
        return least
    for look in range(LOOKS):
        kink = (right_below - left_below + left_slope * low - right_slope * high) / (
            left_slope - right_slope
        )
        below = left_below + left_slope * (kink - low)
        below -= ROUNDING * (abs(left_below) + abs(right_below) + high - low)
        if below >= enough or least - below <= KNOWN * (1.0 + least):
            break
        place = _between(low, left_slope, high, right_slope, kink, look)
        if not low < place < high:
            break
        here, here_below, slope = _best_aside(motion, loads, arm, roll, place, part)
        least = min(least, here)
        if slope == 0.0:
            break
        if slope < 0.0:
            low, left_below, left_slope = place, here_below, slope
        else:
            high, right_below, right_slope = place, here_below, slope
    return least


@njit()
def least_of_each(motion: Floats, loads: Floats, arm: Floats, roll: Floats) -> float:
    """Return the least resistance under the worst of some loads (c, k), 1 at most.

    Of each load only the contacts that carry some of it count.  The load that rests least on
    braked contacts comes first, so that of most others a bound is enough.
    """
    weight = np.zeros(len(loads))
    for c in range(len(loads)):
        for i in range(len(motion)):
            if motion[i] == BRAKED:
                weight[c] += loads[c, i]
    least = 1.0
    for c in np.argsort(weight):
        able = np.flatnonzero(loads[c] > 0.0)
        if (motion[able] == BRAKED).all():
            continue
        load = np.empty((1, len(able)))
        load[0] = loads[c][able]
        least = min(least, least_resistance(motion[able], load, arm[able], roll[able], least))
    return least
