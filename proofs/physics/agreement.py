"""Compare the verdicts of lutgen and of the engine on random robots under random directions.

*Safe but fell* must not happen.  *Tips but held* must not either where the robot stands on a facet;
in balance over two contacts it is the price of a verdict that must hold if no energy is lost.
"""

from collections import Counter
from collections.abc import Iterable
from functools import partial
from math import radians

import numpy as np

from proofs.physics import robots
from proofs.physics.body import Floats, Posture
from proofs.physics.release import STEEPEST, falls_either_way
from proofs.physics.robots import Maker, cap
from proofs.physics.start import Start, start

# Each kind of robot, and the tilt (deg) up to which directions are uniform.
ROBOTS: dict[str, tuple[Maker, float]] = {
    "3 feet": (robots.points(3, 0.0), 45.0),
    "3 to 8 feet, one plane": (robots.points(8, 0.0), 60.0),
    "3 to 8 feet, +-1 cm": (robots.points(8, 0.01), 60.0),
    "3 to 8 feet, +-5 cm": (robots.points(8, 0.05), 60.0),
    "3 to 8 balls": (robots.balls, 60.0),
    "3 or 4 capsules": (robots.capsules, 60.0),
    "4 thin wheels": (robots.thin_wheels, 60.0),
    "4 cylinders": (robots.wide_wheels, 60.0),
    "4 flippers, thin": (partial(robots.flippers, False), 75.0),
    "4 flippers, cylinders": (partial(robots.flippers, True), 75.0),
    "absolem": (robots.any_posture("absolem"), 80.0),
    "marv": (robots.any_posture("marv"), 80.0),
}
COLUMNS = ("safe", "fell where safe", "tips", "held on a facet", "held in balance", "near a limit")
NEVER, CASES = ("fell where safe", "held on a facet"), ("safe", "tips", "near a limit")
# Verdicts nearer to their limit than this (rad) are beyond the engine's own accuracy.
CLEAR = radians(0.1)
# A robot less wide than this share of its size counts as in balance: the default `rest_width`.
WIDTH = 0.01
CHUNK, SEED = 25, 20


def counted(posture: Posture, tried: Iterable[tuple[Floats, Start]]) -> Counter[str]:
    """Return what came of a robot under directions: counts of `COLUMNS`."""
    found: Counter[str] = Counter()
    places = list(tried)
    angles = posture.tip_angles(np.array([gravity_dir for gravity_dir, _ in places]))
    for (gravity_dir, begin), angle in zip(places, angles, strict=True):
        if abs(angle) < CLEAR:
            found["near a limit"] += 1
            continue
        fell = falls_either_way(posture, begin, gravity_dir)
        found["safe" if angle >= 0.0 else "tips"] += 1
        if angle >= 0.0 and fell:
            found["fell where safe"] += 1
        elif angle < 0.0 and not fell:
            narrow = begin.width < WIDTH * posture.size
            found["held in balance" if narrow else "held on a facet"] += 1
    return found


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Count a robot under a direction; nothing where friction would be the limit."""
    make, tilt = ROBOTS[name]
    posture, gravity_dir = make(rng), cap(rng, tilt)
    begin = start(posture, gravity_dir)
    if begin is None or begin.slope(gravity_dir) >= STEEPEST:
        return Counter()
    return counted(posture, [(gravity_dir, begin)])
