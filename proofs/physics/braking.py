"""Robots that accelerate: at 0.95 of the budget one stands, at 1.05 it tips.

Robots of the gallery in random postures on slopes accelerate anywhere along their own ground
plane.  A robot that accelerates by a feels g - a: the engine is given that as gravity.
"""

import math
from collections import Counter

import numpy as np

from lutgen.analysis import budgets
from lutgen.channels import evaluate_each
from proofs.physics.body import recipe_postures
from proofs.physics.release import STEEPEST, falls
from proofs.physics.robots import any_params, cap, gallery
from proofs.physics.rocking import gap_width
from proofs.physics.start import start

ROBOTS = ("three_leg_sphere", "excavator", "articulated", "absolem")
COLUMNS = ("cases", "tips at 0.95 of the budget", "stands at 1.05")
NEVER = COLUMNS[1:]
PARTS = np.array([0.95, 1.05])
# deg and m/s^2: slopes of the ground, and budgets that are worth a case.
SLOPE, LEAST, MOST = 30.0, 0.5, 30.0
# Verdicts nearer to their limit than this (rad) are beyond the engine's own accuracy.
CLEAR = math.radians(0.1)
G0 = 9.80665
CHUNK, SEED = 5, 31


def judged(name: str, chunk: int) -> Counter[str]:
    """Count `CHUNK` cases, the same in every run."""
    recipe = gallery(name)
    rng = np.random.default_rng([SEED, ROBOTS.index(name), chunk])
    found: Counter[str] = Counter()
    while found["cases"] < CHUNK:
        params, down, turn = any_params(recipe, rng), cap(rng, SLOPE), rng.uniform(0.0, 2.0 * np.pi)
        way = np.array([math.cos(turn), math.sin(turn), 0.0])
        limit = float(budgets(recipe, params[None], down[None], way[None])[0])
        if not LEAST < limit < MOST:
            continue
        felt = down - PARTS[:, None] * (limit / G0) * way
        felt /= np.linalg.norm(felt, axis=1, keepdims=True)
        twice = np.repeat(params[None], 2, axis=0)
        angles = evaluate_each(recipe, twice, felt, ("tip_angle",))["tip_angle"]
        posture = recipe_postures(recipe, params[None])[0]
        begin, beyond = start(posture, felt[0]), start(posture, felt[1])
        if begin is None or beyond is None or np.abs(angles).min() < CLEAR:
            continue
        # Beyond its limit a robot may still be caught over a gap.
        caught = beyond.balanced(posture) and gap_width(posture, beyond) <= posture.rock_angle
        if caught or begin.balanced(posture) or begin.slope(felt[1]) >= STEEPEST:
            continue
        tips = [falls(posture, begin, one) for one in felt]
        found.update(dict(zip(COLUMNS, (1, int(tips[0]), int(not tips[1])), strict=True)))
    return found
