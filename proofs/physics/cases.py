"""Seeded cases for the physics engine: what is tried, and how often."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture
from proofs.physics.release import STEEPEST
from proofs.physics.robots import (
    Maker,
    any_of,
    any_posture,
    balls,
    cap,
    capsules,
    flipper_recipe,
    flippers,
    points,
    thin_wheels,
    wide_wheels,
)
from proofs.physics.start import accepted, balance, gaps, is_free, on_one, start

Director = Callable[[np.random.Generator, Posture], Floats | None]


def any_direction(tilt: float) -> Director:
    """Return a director that ignores the robot: uniform on the cap up to a tilt (deg)."""

    def direct(rng: np.random.Generator, _: Posture) -> Floats | None:
        return cap(rng, tilt)

    return direct


def near_gap(rng: np.random.Generator, posture: Posture) -> Floats | None:
    """Return a direction over one of the robot's gaps or up to a tenth of it beyond its ends."""
    wide = [gap for gap in gaps(posture, accepted(posture)) if posture.radius[list(gap.pair)].all()]
    if not wide:
        return None
    plane = balance(posture, wide[int(rng.integers(len(wide)))], rng.uniform())
    if not is_free(posture, plane):
        return None
    share = rng.uniform(-0.1, 1.1)
    direction = (1.0 - share) * plane.points[0] + share * plane.points[1]
    return np.asarray(direction / np.linalg.norm(direction))


@dataclass(frozen=True)
class Case:
    """A kind of robot, the directions it is tried under, and how often."""

    make: Maker
    direct: Director
    number: int


CASES = {
    "3 feet": Case(points((3, 3), 0.0), any_direction(45.0), 500),
    "3 to 8 feet, one plane": Case(points((3, 8), 0.0), any_direction(60.0), 500),
    "3 to 8 feet, +-1 cm": Case(points((3, 8), 0.01), any_direction(60.0), 500),
    "3 to 8 feet, +-5 cm": Case(points((3, 8), 0.05), any_direction(60.0), 500),
    "3 to 8 balls, +-3 cm": Case(balls, any_direction(60.0), 500),
    "3 or 4 capsules": Case(capsules, any_direction(60.0), 500),
    "4 thin wheels, +-3 cm": Case(thin_wheels, any_direction(60.0), 500),
    "4 cylinders, +-3 cm": Case(wide_wheels, any_direction(60.0), 500),
    "4 flippers, thin": Case(flippers(False), any_direction(75.0), 500),
    "4 flippers, cylinders": Case(flippers(True), any_direction(75.0), 500),
    "Absolem, 2 angles": Case(
        any_posture(flipper_recipe("absolem", False)), any_direction(80.0), 500
    ),
    "Absolem, 4 angles": Case(
        any_posture(flipper_recipe("absolem", True)), any_direction(80.0), 500
    ),
    "over gaps": Case(
        any_of((balls, thin_wheels, wide_wheels, flippers(False), flippers(True))), near_gap, 500
    ),
}


def drawn(case: Case, rng: np.random.Generator) -> tuple[Posture, Floats, Start]:
    """Return a robot, a direction of gravity, and where it is under it.

    Drawn again: robots without a facet, slopes on which friction would be the limit, and
    directions under which the robot balances on one ball.
    """
    while True:
        posture = case.make(rng)
        gravity_dir = case.direct(rng, posture)
        begin = None if gravity_dir is None else start(posture, gravity_dir)
        if gravity_dir is None or begin is None or begin.slope(gravity_dir) >= STEEPEST:
            continue
        if begin.balanced and on_one(posture, gravity_dir):
            continue
        return posture, gravity_dir, begin
