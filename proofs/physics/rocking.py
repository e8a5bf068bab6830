"""Push robots over gaps of 1 to 30 deg, and see whether one that lutgen calls safe is caught.

In a gap a robot is in balance over two contacts; it is pushed out of it both ways.  How verdicts
are counted is in `agreement`.
"""

import math
from collections import Counter
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from proofs.physics import robots
from proofs.physics.agreement import counted
from proofs.physics.body import Floats, Posture
from proofs.physics.release import STEEPEST
from proofs.physics.robots import Maker, cap
from proofs.physics.start import Ints, Start, heights, pierced, reach

ROBOTS: dict[str, Maker] = {
    "3 to 8 balls": robots.balls,
    "4 thin wheels": robots.thin_wheels,
    "4 cylinders": robots.wide_wheels,
    "4 flippers, thin": partial(robots.flippers, False),
    "4 flippers, cylinders": partial(robots.flippers, True),
    "rocking chairs": robots.chair,
    **{name: robots.any_posture(name) for name in ("marv", "markhor", "absolem", "articulated")},
}
COLUMNS = ("safe", "fell where safe", "tips", "held in balance", "near a limit")
NEVER, CASES = ("fell where safe",), ("safe", "tips", "near a limit")
# The range of gaps (rad): narrower ones are slivers, wider ones never count as rocking.
NARROW, WIDE = math.radians(1.0), math.radians(30.0)
# The step (rad) in which a roll is followed, how much further (m) another primitive must reach to
# end it, and how level (share of the size) the two contacts are.
STEP, BELOW, LEVEL = math.radians(0.5), 1e-7, 1e-9
# Directions looked at per robot, and up to which tilt (deg).
LOOKED, TILT = 100, 70.0
CHUNK, SEED = 10, 31


def gap_width(posture: Posture, begin: Start) -> float:
    """Return by how much (rad) the robot rolls over the two contacts until a third one touches.

    It is short by up to twice `STEP`, and no more than `WIDE` is followed.
    """
    sides = np.linalg.norm(begin.points - np.roll(begin.points, 1, axis=0), axis=1)
    k = int(np.argmax(sides))
    pair = begin.basis[[k, k - 1]]
    whole = 0.0
    for step in (STEP, -STEP):
        normal = begin.normal
        while whole <= WIDE:
            normal = rolled(posture, pair, normal, step)
            high = heights(posture, normal[None])[0]
            if float(high.max() - high[pair].max()) > BELOW:
                break
            whole += STEP
    return whole


def rolled(posture: Posture, pair: Ints, normal: Floats, step: float) -> Floats:
    """Return the normal of the plane that both contacts touch after a roll by a small angle."""
    edge = _edge(posture, pair, normal)
    normal = Rotation.from_rotvec(step * edge / np.linalg.norm(edge)).as_matrix() @ normal
    for _ in range(20):
        edge = _edge(posture, pair, normal)
        lean = float(edge @ normal)
        if abs(lean) < LEVEL * posture.size:
            break
        normal = normal - edge * lean / float(edge @ edge)
        normal /= np.linalg.norm(normal)
    return normal


def _edge(posture: Posture, pair: Ints, normal: Floats) -> Floats:
    return np.asarray(np.diff(reach(posture, normal[None])[0, pair], axis=0)[0])


def over_gaps(rng: np.random.Generator, posture: Posture) -> list[tuple[Floats, Start]]:
    """Return directions over gaps of a robot, one a gap, and where it is under them."""
    directions = np.array([cap(rng, TILT) for _ in range(LOOKED)])
    places = zip(directions, pierced(posture, directions), strict=True)
    # One direction over each pair of contacts, as most are over pairs that are too far apart.
    balances = {
        frozenset(begin.basis.tolist()): (gravity_dir, begin)
        for gravity_dir, begin in places
        if begin and begin.balanced(posture) and begin.slope(gravity_dir) < STEEPEST
    }
    return [
        one
        for pair, one in balances.items()
        if len(pair) > 1 and NARROW <= gap_width(posture, one[1]) <= WIDE
    ]


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Count a robot under all its directions over gaps."""
    posture = ROBOTS[name](rng)
    places = over_gaps(rng, posture)
    return counted(posture, places) if places else Counter()
