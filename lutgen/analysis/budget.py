"""How hard a robot may brake, speed up and turn before it tips over: its budgets.

A robot that accelerates feels gravity and inertia together, g - a; it tips
where that direction leaves the standing region.  The tip-over angle changes by no more than the
direction turns, so a direction that is turned by as much as was read, and read again, comes to the
limit and never beyond it, whatever robot it is.
"""

import numpy as np
from numpy.typing import ArrayLike

from lutgen.channels import evaluate_each
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# m/s^2.
GRAVITY = 9.80665
# No robot accelerates more, m/s^2; where it does not tip before that, nothing is said.
MOST = 50.0
# Reads at most, and the tip-over angle (rad) that is left where the limit is reached.
READS, LEFT = 400, 1e-6


def budgets(recipe: Recipe, params: ArrayLike, gravity: ArrayLike, direction: ArrayLike) -> Floats:
    """Return the largest accelerations before postures tip over, (m,), m/s^2, rounded down.

    0 where a posture (m, k) tips anyway, `MOST` where it would not tip below that.  `gravity`
    (m, 3) is down and `direction` (m, 3) where the robot accelerates, body frame, any length > 0:
    braking is backward, turning to the left is to the left.
    """
    rows = np.asarray(params, dtype=np.float64)
    both = np.array([gravity, direction], dtype=np.float64)
    force, to = both / np.linalg.norm(both, axis=-1, keepdims=True)
    found, at = np.zeros(len(rows)), np.arange(len(rows))
    for _ in range(READS):
        tip = evaluate_each(recipe, rows[at], force[at], ("tip_angle",))["tip_angle"]
        goes_on = tip > LEFT
        at, tip = at[goes_on], tip[goes_on]
        if not at.size:
            break
        size = np.linalg.norm(force[at], axis=1)
        # Between the acceleration and what is felt now; it may turn as far as against the first.
        left = np.arccos(np.clip(-(force[at] * to[at]).sum(axis=1) / size, -1.0, 1.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(tip < left, size * np.sin(tip) / np.sin(left - tip), np.inf)
        step = np.minimum(step, MOST / GRAVITY - found[at])
        found[at] += step
        force[at] -= step[:, None] * to[at]
        at = at[found[at] < MOST / GRAVITY * (1.0 - 1e-12)]
    return np.asarray(found * GRAVITY)


def turn_speed(acceleration: ArrayLike, radius: float) -> Floats:
    """Return the speeds (m/s) at which turns of a radius (m) take accelerations (m/s^2)."""
    return np.asarray(np.sqrt(np.maximum(np.asarray(acceleration) * radius, 0.0)))
