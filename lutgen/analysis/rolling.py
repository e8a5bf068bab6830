"""Whether the braked contacts hold a robot with freely rolling ones, and how it tips if not.

Owns the planar equilibrium of the contact plane.  A contact with ``rolling = true`` takes no force
along its rolling direction: a disc none along axis x normal, a sphere none at all.  The verdict on
tipping is that of the robot held in place and does not change.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.diagnosis import normal_forces
from lutgen.analysis.sliding import first_tilts
from lutgen.analysis.stance import Facet, Posture
from lutgen.analysis.tilt import tilt_limits
from lutgen.channels import checked_directions, evaluate
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
# Shares and slopes (rad) below these are rounding.
NOTHING, LEVEL = 1e-6, 1e-9
# For the limit of rolling: tilt (rad, 2 deg) between two looks, halved to 1e-7 deg.
STEP, HALVINGS = math.radians(2.0), 24


@njit()
def _resistance(
    motion: Floats, load: Floats, arm: Floats, roll: Floats, aside: float, turn: float
) -> float:
    """Return the power, per unit of friction, that a motion of the plane costs.

    The com moves by 1 downhill (x) and `aside` across (y), and the robot turns by `turn`.
    """
    total = 0.0
    for i in range(len(motion)):
        x = 1.0 - turn * arm[i, 1]
        y = aside + turn * arm[i, 0]
        if motion[i] == BRAKED:
            total += load[i] * math.hypot(x, y)
        elif motion[i] == SPHERE:
            total += load[i] * RESISTANCE * math.hypot(x, y)
        else:
            along = x * roll[i, 0] + y * roll[i, 1]
            across = y * roll[i, 0] - x * roll[i, 1]
            total += load[i] * math.hypot(across, RESISTANCE * along)
    return total


@njit()
def _best_aside(motion: Floats, load: Floats, arm: Floats, roll: Floats, turn: float) -> float:
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
    at_first = _resistance(motion, load, arm, roll, math.sinh(first), turn)
    at_second = _resistance(motion, load, arm, roll, math.sinh(second), turn)
    for _ in range(SECTIONS):
        if at_first <= at_second:
            high, second, at_second = second, first, at_first
            first = high - GOLDEN * (high - low)
            at_first = _resistance(motion, load, arm, roll, math.sinh(first), turn)
        else:
            low, first, at_first = first, second, at_second
            second = low + GOLDEN * (high - low)
            at_second = _resistance(motion, load, arm, roll, math.sinh(second), turn)
    return min(at_first, at_second)


@njit()
def least_resistance(motion: Floats, load: Floats, arm: Floats, roll: Floats) -> float:
    """Return the least resistance, per unit of friction, of all motions that go 1 downhill.

    `motion` (k,) is BRAKED, DISC (rolling along) or SPHERE (rolling in every direction), `load`
    (k,) the shares of the normal force, `arm` (k, 2) leads from below the com to the contact
    points, x downhill, in units of the robot's size, and `roll` (k, 2) are the unit rolling
    directions of the discs.  In [0, 1] but for rounding: 1 where all contacts are braked, 0 where
    gravity finds a motion in which all contacts that carry load roll.
    """
    high = math.asinh(1.0 / NEAREST)
    low = -high
    first, second = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    at_first = _best_aside(motion, load, arm, roll, math.sinh(first))
    at_second = _best_aside(motion, load, arm, roll, math.sinh(second))
    for _ in range(SECTIONS):
        if at_first <= at_second:
            high, second, at_second = second, first, at_first
            first = high - GOLDEN * (high - low)
            at_first = _best_aside(motion, load, arm, roll, math.sinh(first))
        else:
            low, first, at_first = first, second, at_second
            second = low + GOLDEN * (high - low)
            at_second = _best_aside(motion, load, arm, roll, math.sinh(second))
    return min(at_first, at_second)


def held_share(posture: Posture, facet: Facet, direction: Floats) -> float:
    """Return the share of friction that holds the robot against gravity's pull downhill.

    The robot holds its place while tan(slope) <= mu x share.  The share is the least, over all
    motions of the robot in its contact plane that go downhill (shifts and turns), of what friction
    takes from them, divided by what it would take with every contact braked: by the theorem of
    virtual power (limit analysis, exact for given normal forces) friction forces that balance
    gravity (3,), a unit vector, exist if and only if no motion gains more than it costs.  1 without
    a rolling contact among the facet's, and on level ground.
    """
    contacts = [posture.recipe.contacts[i] for i in facet.contacts]
    level = float(np.linalg.norm(facet.along(direction))) < LEVEL
    if level or not any(one.rolling for one in contacts):
        return 1.0
    frame = facet.frame(direction)
    load = np.maximum(normal_forces(facet.points, facet.pierced(direction)), 0.0)
    arm = facet.points @ frame.T
    roll = np.cross(posture.disc_axes[list(facet.contacts)], facet.normal) @ frame.T
    size = np.linalg.norm(roll, axis=1, keepdims=True)
    motion = [
        BRAKED if not one.rolling else DISC if one.kind == "disc" else SPHERE for one in contacts
    ]
    return float(
        least_resistance(
            np.array(motion),
            load / load.sum(),
            arm / np.abs(arm).max(),
            roll / np.where(size > 0.0, size, 1.0),
        )
    )


def rolls(posture: Posture, gravity_dir: ArrayLike) -> NDArray[np.bool_]:
    """Tell whether one posture rolls away from where it stands.

    Parameters
    ----------
    posture : Posture
        Without a friction coefficient braked contacts that carry load never slip.
    gravity_dir : (g, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.

    Returns
    -------
    (g,) bool
        True where the robot stands, some contact of its support facet rolls, and the braked ones
        cannot hold it: it rolls straight, turns about a braked contact, or both.  With mu that is
        where tan(slope) > mu x `held_share`, so it is true too where the robot slides first.
        False where it tips, and on level ground.
    """
    directions = checked_directions(gravity_dir)
    recipe, stance = posture.recipe, posture.stance_of_weight()
    angle = evaluate(recipe, posture.row, directions, ("tip_angle",))["tip_angle"][0]
    answer = np.zeros(len(directions), np.bool_)
    for d, k in enumerate(stance.under(directions)):
        if k < 0 or angle[d] < 0.0:
            continue
        facet = stance.facets[k]
        if any(recipe.contacts[i].rolling for i in facet.contacts):
            share = held_share(posture, facet, directions[d])
            slope = math.acos(min(1.0, float(facet.normal @ directions[d])))
            if recipe.friction is None:
                answer[d] = share < NOTHING
            else:
                answer[d] = slope > LEVEL and math.tan(slope) > recipe.friction * share
    return answer


def roll_limits(posture: Posture, headings: ArrayLike) -> Floats:
    """Return the tilt in each heading from which on the robot rolls away.

    Parameters
    ----------
    posture : Posture
    headings : (h,) array_like
        Headings of the tilt in rad.

    Returns
    -------
    (h,) float64
        Radians, by looking every 2 deg; NaN where it tips over before it rolls.
    """
    end = tilt_limits(posture.recipe, posture.params, headings)
    return first_tilts(lambda down, _: rolls(posture, down), headings, end, STEP, HALVINGS)


def rolling_gravity(posture: Posture, gravity_dir: ArrayLike) -> Floats | None:
    """Return the direction of gravity and inertia together while the robot rolls freely.

    With massless wheels nothing resists along the common rolling direction t: the robot gains
    speed at (g . t) t, and what remains to tip it is g - (g . t) t; on balls that roll in every
    direction, the part along the facet's normal.  Evaluate any channel there.

    Parameters
    ----------
    posture : Posture
    gravity_dir : (3,) array_like
        Direction in the body frame, pointing down, of any length > 0.

    Returns
    -------
    (3,) float64 or None
        Unit vector, body frame.  None where the robot does not roll freely and straight: a contact
        of its support facet is braked, the discs roll in different directions, or the slope also
        pulls sideways with all discs on one axle, so that the robot would turn.
    """
    down = checked_directions(gravity_dir)
    recipe, stance = posture.recipe, posture.stance_of_weight()
    k = int(stance.under(down)[0])
    if k < 0:
        return None
    facet, direction = stance.facets[k], down[0]
    if not all(recipe.contacts[i].rolling for i in facet.contacts):
        return None
    discs = [i for i in facet.contacts if recipe.contacts[i].kind == "disc"]
    remainder = float(facet.normal @ direction) * facet.normal
    if discs:
        roll = np.cross(posture.disc_axes[discs], facet.normal)
        roll /= np.linalg.norm(roll, axis=1, keepdims=True)
        aside = np.cross(facet.normal, roll[0])
        if np.abs(roll @ aside).max() > NOTHING:
            return None
        sideways = float(aside @ direction)
        places = facet.points[[facet.contacts.index(i) for i in discs]] @ roll[0]
        if abs(sideways) > LEVEL and np.ptp(places) < NOTHING * np.abs(facet.points).max():
            return None
        remainder = remainder + sideways * aside
    return np.asarray(remainder / np.linalg.norm(remainder))
