"""Tilt tractors slowly, whose front axle swings on a hinge, and compare with lutgen's limits.

The engine has the hinge, its stops and the axle's own mass.  Rear wheels are braked.  Front wheels
that turn freely push the axle to no side but across, and the model is exact; braked ones hold the
axle where it is, so that the chassis cannot turn about its pivot without skidding, and bear more.
With the nose far down braked ones carry what pulls forward, too, and the chassis rolls a little
sooner over the hinge.
"""

import math
from collections import Counter

import numpy as np

from lutgen.analysis import Posture as Asked
from lutgen.analysis import ground_tilt
from proofs.physics.body import Posture, Solid, Swing
from proofs.physics.release import STEEPEST, Run
from proofs.physics.start import DOWN, on_plane

ROBOTS = ("tractors",)
COLUMNS = (
    *("slow tilts", "slid first", "front wheels free", "of these rolled below their limit"),
    *("of these sideways", "bore over 2 deg more", "braked: rolled 1 deg below"),
)
NEVER, CASES = (COLUMNS[3], COLUMNS[5], COLUMNS[6]), ("slow tilts",)
# The engine is late by this much (rad), as the moment that tips grows from nothing; and what one
# with free wheels may bear beyond its limit.
LATE, SPARED, BRAKED = math.radians(0.25), math.radians(2.0), math.radians(1.0)
QUICK, SLOW, UNTIL = math.radians(4.0), math.radians(0.25), 0.8
LOOK, SETTLE = 10, 300
ROLLED = math.radians(1.0)  # turned so far, the chassis rolls on its axle
# A tractor whose rear wheels carry little slides down on its front wheels: this far (m) it has.
SLID = 0.02
ASIDE = 0.3  # cosine of a heading in which no tractor turns over its front or rear wheels
CHUNK, SEED = 20, 56


def tractor(rng: np.random.Generator) -> Posture:
    """Return a tractor of 3 t with its com at the origin, and a front axle of up to 500 kg."""
    base, rear, front = rng.uniform(1.8, 2.6), rng.uniform(0.6, 1.0), rng.uniform(0.6, 1.0)
    ahead, high = rng.uniform(0.25, 0.5) * base, rng.uniform(0.6, 1.1)
    low = rng.uniform(0.0, 0.85) * high
    places = [(0, rear), (0, -rear), (base, front), (base, -front)]
    radius, free = rng.uniform(0.2, 0.5), bool(rng.random() < 0.7)
    solids = tuple(
        Solid("disc", np.array([x - ahead, y, radius - high]), radius, braked=not (free and x))
        for x, y in places
    )
    pivot = np.array([base - ahead, 0.0, low - high])
    mass, com = rng.uniform(10.0, 500.0), np.array([base - ahead, 0.0, radius - high])
    swing = Swing((2, 3), pivot, np.array([1.0, 0.0, 0.0]), rng.uniform(0.087, 0.262), mass, com)
    return Posture(solids, 3000.0, swing=swing)


def slope_at_roll(posture: Posture, heading: float, slowly_from: float) -> float:
    """Return the slope (rad) of the ground at which a chassis begins to turn on it."""
    run = Run(posture, on_plane(posture, DOWN), DOWN)
    run.step(SETTLE)
    slope, calm = 0.0, 0.0
    while slope < STEEPEST and run.turned < ROLLED:
        if abs(float(run.data.qpos[0])) > SLID:
            return math.nan
        slope += LOOK / 1000.0 * (QUICK if slope < slowly_from else SLOW)
        across = [math.sin(slope) * math.cos(heading), math.sin(slope) * math.sin(heading)]
        run.tilt(np.array([*across, -math.cos(slope)]))
        before = run.turned
        run.step(LOOK)
        calm = slope if run.turned - before < 20.0 * SLOW * LOOK / 1000.0 else calm
    return calm


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Tilt one tractor in one heading."""
    posture, heading = tractor(rng), float(rng.uniform(0.0, 2.0 * math.pi))
    found = ground_tilt(Asked(posture.recipe(), np.zeros(0)))
    limit = float(found.limits(np.array([heading]))[0])
    slope = slope_at_roll(posture, heading, UNTIL * limit) - LATE
    free = not posture.solids[-1].braked
    aside = free and abs(math.cos(heading)) < ASIDE
    lower = slope < limit - (0.0 if free else BRAKED)
    numbers = (1, math.isnan(slope), free, free and lower, aside, aside and slope > limit + SPARED)
    return Counter(dict(zip(COLUMNS, map(int, (*numbers, not free and lower)), strict=True)))
