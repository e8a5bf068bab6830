"""Robots that accelerate: at 0.95 of the budget one stands, at 1.05 it tips.

Robots of the gallery in random postures on slopes accelerate anywhere along their own ground
plane.  A robot that accelerates by a feels g - a: the engine is given that as gravity.  Beyond the
budget it may still be caught over a gap, which is the price of a promise, so this is no fault.
"""

import math
from collections import Counter

import numpy as np

from lutgen.analysis import budgets
from proofs.physics.agreement import CLEAR
from proofs.physics.body import recipe_posture
from proofs.physics.release import STEEPEST, falls_either_way
from proofs.physics.robots import any_params, cap, gallery
from proofs.physics.rocking import gap_width
from proofs.physics.start import start

ROBOTS = ("three_leg_sphere", "excavator", "articulated", "absolem")
COLUMNS = ("cases", "tips at 0.95 of the budget", "over a gap at 1.05", "stands at 1.05")
NEVER, CASES = (COLUMNS[1], COLUMNS[3]), COLUMNS[:1]
PARTS = np.array([0.95, 1.05])
# deg and m/s^2: slopes of the ground, and budgets that are worth a case.
SLOPE, LEAST, MOST = 30.0, 0.5, 30.0
G0 = 9.80665
CHUNK, SEED = 5, 31


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Count a robot that accelerates; nothing near a limit."""
    recipe = gallery(name)
    params, down, turn = any_params(recipe, rng), cap(rng, SLOPE), rng.uniform(0.0, 2.0 * np.pi)
    way = np.array([math.cos(turn), math.sin(turn), 0.0])
    limit = float(budgets(recipe, params[None], down[None], way[None])[0])
    if not LEAST < limit < MOST:
        return Counter()
    felt = down - PARTS[:, None] * (limit / G0) * way
    felt /= np.linalg.norm(felt, axis=1, keepdims=True)
    posture = recipe_posture(recipe, params)
    begin, beyond = start(posture, felt[0]), start(posture, felt[1])
    if begin is None or beyond is None or begin.slope(felt[1]) >= STEEPEST:
        return Counter()
    if np.abs(posture.tip_angles(felt)).min() < CLEAR:
        return Counter()
    over = beyond.balanced(posture) and gap_width(posture, beyond) <= posture.rock_angle
    tips = falls_either_way(posture, begin, felt[0])
    stands = not over and not falls_either_way(posture, begin, felt[1])
    return Counter(dict(zip(COLUMNS, (1, int(tips), int(over), int(stands)), strict=True)))
