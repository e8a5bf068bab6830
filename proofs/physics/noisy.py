"""Cars on four wheels of two rims each, off by noise: the limit is 45 deg, whatever the noise.

Owns the cars, the tilts at which they are let go, and the count.  Noise makes facets a few
micrometres wide between the rims of one wheel or axle.  A verdict that lets a robot stand on one
finds its way from sliver to sliver round the wheel, and promises degrees that are not there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture, as_recipe, rigid_body, tip_angles
from proofs.physics.nudged import fates
from proofs.physics.pierced import pierced
from proofs.physics.release import DOWN
from proofs.physics.slow import UNTIL, slope_at_fall

SIGMAS = (1e-6, 1e-5, 1e-4, 1e-3, 5e-3)
# Axles at +-HALF and outer rims at +-HALF, the com as high: 45 deg to all four sides.  (m)
HALF, RADIUS, WIDTH = 0.25, 0.1, 0.06
TRUTH = math.radians(45.0)
HEADINGS = {"nose down": 0.0, "left down": 0.5 * math.pi, "nose up": math.pi}
# Tilts, from the truth (deg), at which the cars are let go.
AROUND = (-3.0, -1.0, -0.3, 0.3, 1.0, 3.0, 6.0)
# Verdicts nearer to their limit than this (rad) are not judged: the engine's own accuracy.
CLEAR = math.radians(0.1)
# A car whose ground is steeper to its body (cosine of 80 deg) lies on the faces of its wheels, and
# lies well: that is no matter of slivers.
LYING = math.cos(math.radians(80.0))
# Noise of sigma moves the truth by some sigma / HALF: at most 0.2 deg, with four sigmas of it, up
# to this sigma.  Up to there the slow tilt and lutgen's limit must both be 45.0 +- 0.2 deg.
# Lutgen's is the tilt of the body, the slow one that of the ground: where the wheels' outer rims
# are the smaller ones the body leans before it tips, by some sigma / WIDTH, and the slope is that
# much less.
EXACT, FINE = math.radians(0.2), 1e-4
# Steps (rad) of the walk to lutgen's limit: slivers are looked for, so its own are not trusted.
WALK = math.radians(0.05)
CARS, SEED = 10, 32


@dataclass(frozen=True)
class Row:
    """What came of the cars of one sigma.

    Limits of lutgen and slopes of the slow tilt (deg), the least and the largest; releases called
    safe and of these fell, called tipping and of these held.
    """

    sigma: float
    cars: int
    limits: tuple[float, float]
    slopes: tuple[float, float]
    safe: int
    fell: int
    tips: int
    held: int


def car(rng: np.random.Generator, sigma: float) -> Posture:
    """Return a car whose rims' places (m), axles (rad) and radii (m) are off by noise."""
    sides = np.array([-HALF, -HALF + WIDTH, HALF - WIDTH, HALF])
    centres = np.array([[x, y, RADIUS - HALF] for x in (HALF, -HALF) for y in sides])
    centres += rng.normal(0.0, sigma, centres.shape)
    axes = np.array([0.0, 1.0, 0.0]) + rng.normal(0.0, sigma, centres.shape) * [1.0, 0.0, 1.0]
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    return rigid_body(centres, RADIUS + rng.normal(0.0, sigma, len(centres)), axes)


def leaning(tilt: float, heading: float) -> Floats:
    """Return the direction of gravity at a tilt in a heading, body frame."""
    across = math.sin(tilt)
    return np.array([across * math.cos(heading), across * math.sin(heading), -math.cos(tilt)])


def first_tip(angles: Floats, tilts: Floats) -> float:
    """Return the tilt before the first that tips."""
    fallen = np.flatnonzero(angles < 0.0)
    return float(tilts[max(int(fallen[0]) - 1, 0)] if len(fallen) else tilts[-1])


def judged(sigma: float, chunk: int, cars: int = CARS) -> Row:
    """Return one row, the same in every run."""
    rng = np.random.default_rng([SEED, SIGMAS.index(sigma), chunk])
    limits: list[float] = []
    slopes: list[float] = []
    safe = fell = tips = held = 0
    for _ in range(cars):
        posture = car(rng, sigma)
        recipe = as_recipe(posture)
        posture = replace(posture, upright=recipe.upright, rock_angle=recipe.rock_angle)
        for heading in HEADINGS.values():
            tilts = np.arange(0.0, math.radians(75.0), WALK)
            walk = np.array([leaning(tilt, heading) for tilt in tilts])
            limits.append(math.degrees(first_tip(tip_angles(recipe, walk), tilts)))
            level = pierced(posture, DOWN[None])[0]
            assert level is not None
            begin = Start(level.normal, level.height, level.points)
            slopes.append(math.degrees(slope_at_fall(posture, begin, heading, UNTIL * TRUTH)))
            tried = np.array([leaning(TRUTH + math.radians(off), heading) for off in AROUND])
            angles = tip_angles(recipe, tried)
            for down, angle, place in zip(tried, angles, pierced(posture, tried), strict=True):
                if place is None or abs(angle) < CLEAR or -place.normal[2] < LYING:
                    continue
                fallen = any(fate.fell for fate in fates(posture, place, down))
                safe += int(angle >= 0.0)
                fell += int(angle >= 0.0 and fallen)
                tips += int(angle < 0.0)
                held += int(angle < 0.0 and not fallen)
    return Row(
        *(sigma, cars, (min(limits), max(limits)), (min(slopes), max(slopes))),
        *(safe, fell, tips, held),
    )


def merged(rows: Sequence[Row]) -> list[Row]:
    """Return the rows with those of one sigma added up."""
    found = []
    for sigma in SIGMAS:
        same = [r for r in rows if r.sigma == sigma]
        if same:
            limits, slopes = (
                (min(p[0] for p in pairs), max(p[1] for p in pairs))
                for pairs in ([r.limits for r in same], [r.slopes for r in same])
            )
            names = ("cars", "safe", "fell", "tips", "held")
            cars, *counts = (sum(getattr(r, name) for r in same) for name in names)
            found.append(Row(sigma, cars, limits, slopes, *counts))
    return found


def table(rows: Sequence[Row]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| noise | cars | lutgen's limits | slow tilt | releases called safe | of these fell "
        "| releases called tipping | of these held |",
        "|---|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.sigma:.0e} | {r.cars} | {r.limits[0]:.2f} to {r.limits[1]:.2f} deg "
        f"| {r.slopes[0]:.2f} to {r.slopes[1]:.2f} deg "
        f"| {r.safe} | {r.fell} | {r.tips} | {r.held} |"
        for r in rows
    ]
    return "\n".join(lines) + "\n"


def missed(rows: Sequence[Row], late: float) -> list[str]:
    """Return what must not be, one line each; `late` (deg) is the lag of the slow tilt."""
    faults = [f"noise {r.sigma:.0e}: {r.fell} of {r.safe} fell where safe" for r in rows if r.fell]
    truth, spare = math.degrees(TRUTH), math.degrees(EXACT)
    for r in rows:
        if r.sigma <= FINE:
            lean = math.degrees(4.0 * r.sigma / WIDTH)
            for what, (low, high), less, lag in (
                ("limit", r.limits, 0.0, 0.0),
                ("slow tilt", r.slopes, lean, late),
            ):
                if not truth - spare - less <= low <= high <= truth + spare + lag:
                    faults.append(f"noise {r.sigma:.0e}: a {what} of {low:.2f} to {high:.2f} deg")
    return faults
