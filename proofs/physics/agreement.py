"""Random robots under random directions: whether lutgen and the engine say the same.

Owns what counts as a wrong verdict.  *Safe but fell* must not happen.  *Tips but held* must not
either where the robot stands on a facet; in balance over two contacts it is the price of a verdict
that must hold where no energy is lost.
"""

from collections import Counter
from collections.abc import Iterable
from math import radians

import numpy as np

from proofs.physics.body import Floats, Posture
from proofs.physics.release import STEEPEST, falls_either_way
from proofs.physics.robots import (
    Maker,
    any_posture,
    balls,
    cap,
    capsules,
    flippers,
    points,
    thin_wheels,
    wide_wheels,
)
from proofs.physics.start import DOWN, Start, start

# Each kind of robot, and the tilt (deg) up to which directions are uniform.
ROBOTS: dict[str, tuple[Maker, float]] = {
    "3 feet": (points((3, 3), 0.0), 45.0),
    "3 to 8 feet, one plane": (points((3, 8), 0.0), 60.0),
    "3 to 8 feet, +-1 cm": (points((3, 8), 0.01), 60.0),
    "3 to 8 feet, +-5 cm": (points((3, 8), 0.05), 60.0),
    "3 to 8 balls": (balls, 60.0),
    "3 or 4 capsules": (capsules, 60.0),
    "4 thin wheels": (thin_wheels, 60.0),
    "4 cylinders": (wide_wheels, 60.0),
    "4 flippers, thin": (flippers(False), 75.0),
    "4 flippers, cylinders": (flippers(True), 75.0),
    "absolem": (any_posture("absolem"), 80.0),
    "marv": (any_posture("marv"), 80.0),
}
COLUMNS = ("safe", "fell where safe", "tips", "held on a facet", "held in balance", "near a limit")
NEVER = ("fell where safe", "held on a facet")
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
        upright = abs(begin.slope(DOWN) - posture.upright)
        if min(abs(angle), upright) < CLEAR:
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


def judged(name: str, chunk: int) -> Counter[str]:
    """Count `CHUNK` robots under one direction each, the same in every run."""
    make, tilt = ROBOTS[name]
    rng = np.random.default_rng([SEED, list(ROBOTS).index(name), chunk])
    found: Counter[str] = Counter()
    while found["safe"] + found["tips"] + found["near a limit"] < CHUNK:
        posture, gravity_dir = make(rng), cap(rng, tilt)
        begin = start(posture, gravity_dir)
        # On a steeper slope friction would be the limit.
        if begin is not None and begin.slope(gravity_dir) < STEEPEST:
            found += counted(posture, [(gravity_dir, begin)])
    return found
