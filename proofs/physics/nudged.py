"""A robot let go in balance and pushed out of it, both ways, until it lies still.

Owns what *fell* means: gravity in the body frame turns with the robot, so that "it rocks" promises
that it comes to rest not far from where it was.  The engine is kinder than the definition, which
lets no energy be lost; a fall here is a fall on any ground.
"""

import math
from dataclasses import dataclass

import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture
from proofs.physics.pierced import Pierced, heights
from proofs.physics.release import Run

# Far above the engine's softness (0.003 deg), far below every gap that is tried (1 deg); its
# energy, h x push^2 / 2, is that of a rise of a ten-thousandth of a millimetre.
PUSH = math.radians(0.05)
# Whoever rocks ends within `rock_angle` of where it began.  A foot sinks in by 1e-5 m, and a robot
# that rests on an edge of its polygon leans by some tenths of a degree on small balls.
SPARE = math.radians(0.5)
# A swing so wide goes on to a fall: no gap and no rest is as wide, and it saves watching the rest.
OVER = math.radians(90.0)
# A swing loses little energy; what has not come to rest after this (s) is judged as it is.
SECONDS = 6.0


@dataclass(frozen=True)
class Fate:
    """What came of a release: whether it fell, the turn (rad) at the end, and the time (s).

    `rests` tells of one that fell that it lies still again upright, only too far away.
    """

    fell: bool
    rests: bool
    turned: float
    seconds: float


def turning(axis: Floats, angle: float) -> Floats:
    """Return the rotation (3, 3) about a unit axis."""
    x, y, z = axis
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * skew + (1.0 - math.cos(angle)) * skew @ skew)


def watched(posture: Posture, begin: Start, gravity_dir: Floats) -> Fate:
    """Let a robot go at rest and watch it until it lies still."""
    run = Run(posture, begin, gravity_dir)
    while run.data.time < SECONDS and run.turned <= OVER and not run.resting:
        run.step()
    lying = -run.normals[-1][2] < math.cos(min(math.pi, posture.upright + SPARE))
    fell = run.turned > posture.rock_angle + SPARE or bool(lying)
    rests = fell and run.turned <= OVER and not lying
    return Fate(fell, rests, run.turned, float(run.data.time))


def line_of(place: Pierced) -> Floats:
    """Return the unit direction of the longest side of what carries."""
    sides = place.points - np.roll(place.points, 1, axis=0)
    longest = sides[int(np.argmax(np.linalg.norm(sides, axis=1)))]
    return np.asarray(longest / np.linalg.norm(longest))


def pushed(
    posture: Posture, place: Pierced, gravity_dir: Floats, angle: float
) -> tuple[Start, Floats]:
    """Return a start, and gravity there, with the robot turned about the line that carries it."""
    turn = turning(line_of(place), angle)
    normal = turn @ place.normal
    height = float(heights(posture, normal[None]).max())
    return Start(normal, height, place.points, True), turn @ gravity_dir


def fates(posture: Posture, place: Pierced, gravity_dir: Floats) -> list[Fate]:
    """Return what comes of a robot let go: on a facet once, in balance pushed both ways."""
    if not place.is_line(posture):
        return [watched(posture, place.start(posture), gravity_dir)]
    return [
        watched(posture, *pushed(posture, place, gravity_dir, angle)) for angle in (-PUSH, PUSH)
    ]
