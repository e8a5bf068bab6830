"""Fine rockers: robots on soles of many small wheels, where rests are narrow and turns add up.

Owns the soles and their two limits, which are plane geometry.  Both rails are arcs of equal wheels
with the com below the arc's centre.  The robot stands until gravity passes the last wheel: a
direction, and on the ground a slope, less steep by the angle of the last facet.  A verdict that
finds each facet too narrow tips everywhere; one that adds up all turns as if nothing lay still
between them, too.  On ground that tilts slowly, fine soles get as far as that slope.  Coarse ones
do not: like a rimless wheel the robot leaves its facet only half a step later than a smooth sole
would roll, and does not stop on the next one.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lutgen.errors import RecipeError
from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture, as_recipe, rigid_body, tip_angles
from proofs.physics.ground import guaranteed, said_limits
from proofs.physics.noisy import leaning
from proofs.physics.nudged import fates
from proofs.physics.pierced import pierced
from proofs.physics.release import DOWN
from proofs.physics.robots import SIDEWAYS
from proofs.physics.slow import slope_at_fall

# Half the width between the rails, the wheels' radius, and how far their sole's centre is above
# the com (m): with 0.5 m arcs of +-33 deg the limits are 40.5 deg (body) and 7.5 deg (ground).
HALF, RADIUS, BELOW = 0.25, 0.02, 0.1
# A sole swings for long: it is tilted at this rate (rad/s) from level ground on.
SLOW = math.radians(0.1)
# Steps (rad) of the walk to lutgen's limit, and the tilts that are let go: shares of the limit, and
# tilts from it (deg).
WALK, SHARES, AROUND = math.radians(0.05), np.linspace(0.05, 0.95, 13), (-0.3, 0.3, 1.0, 3.0)
# Verdicts nearer to their limit than this (rad) are not judged.
CLEAR = math.radians(0.1)
# Soles of steps up to this (deg) are fine: the engine falls at most so much (deg) before the
# geometry's slope, for the robot still swings a little, and after its lag at most so much later.
FINE, EARLY, LATE = 1.2, 1.0, 0.3
# Between two facets are the wheels' arcs, 4 % of the sole, over which a verdict may well say that
# the robot tips; where it says so more often, it finds facets too narrow.
MOST = 0.9


@dataclass(frozen=True)
class Sole:
    """Wheels on each of two rails, the angle between them (deg), the radius of the sole (m)."""

    count: int
    step: float
    radius: float

    @property
    def angles(self) -> Floats:
        """Where the wheels are on the arc (rad), from the tail to the nose."""
        return np.asarray(
            math.radians(self.step) * (np.arange(self.count) - (self.count - 1) / 2.0)
        )

    @property
    def centres(self) -> Floats:
        """Centres (n, 2) of one rail's wheels, x and z, relative to the com."""
        arc = self.radius - RADIUS
        return np.stack([arc * np.sin(self.angles), BELOW - arc * np.cos(self.angles)], axis=1)

    @property
    def posture(self) -> Posture:
        """The robot."""
        rail = np.insert(self.centres, 1, 0.0, axis=1)
        centres = np.concatenate([rail + side * SIDEWAYS for side in (-HALF, HALF)])
        return rigid_body(centres, RADIUS, SIDEWAYS)

    @property
    def limits(self) -> tuple[float, float]:
        """The tilt of the body and the slope of the ground (rad) at which it goes over."""
        last = float(self.angles[-2:].mean())
        edge = self.centres[-1] + RADIUS * np.array([math.sin(last), -math.cos(last)])
        tilt = math.atan2(edge[0], -edge[1])
        return tilt, tilt - last


SOLES = {
    "2 x 60 wheels, 1.12 deg apart": Sole(60, 66.0 / 59.0, 0.5),
    "2 x 31 wheels, 2.2 deg apart": Sole(31, 2.2, 0.5),
    "2 x 20 wheels, 1 deg apart": Sole(20, 1.0, 0.5),
    "2 x 16 wheels, 4.4 deg apart": Sole(16, 4.4, 0.5),
    "2 x 16 wheels, 2 deg apart": Sole(16, 2.0, 0.5),
    "2 x 16 wheels, 1 deg apart": Sole(16, 1.0, 0.5),
    "2 x 16 wheels, 0.3 deg apart": Sole(16, 0.3, 0.5),
}


@dataclass(frozen=True)
class Row:
    """One sole, in degrees: limits of body and ground, by geometry, lutgen and the slow tilt.

    `share` of the directions up to the limit stand, and `said_body` is the last one that does.
    `printed` is what `lutgen limits` guarantees on tilted ground, `nose` its limit nose down; they
    are NaN where it takes no robot of so many contacts.  Releases called safe and of these fell,
    called tipping and of these held.
    """

    name: str
    step: float
    share: float
    body: float
    said_body: float
    ground: float
    printed: float
    nose: float
    slow: float
    safe: int
    fell: int
    tips: int
    held: int


def judged(name: str) -> Row:
    """Return one row."""
    sole = SOLES[name]
    posture, (tilt, slope) = sole.posture, sole.limits
    level = pierced(posture, DOWN[None])[0]
    assert level is not None
    begin = Start(level.normal, level.height, level.points)
    slow = slope_at_fall(posture, begin, 0.0, 0.0, SLOW)
    said_body = share = printed = nose = math.nan
    safe = fell = tips = held = 0
    try:
        recipe = as_recipe(posture)
        tilts = np.arange(0.0, math.radians(80.0), WALK)
        walk = np.array([leaning(one, 0.0) for one in tilts])
        stands = tip_angles(recipe, walk) >= 0.0
        said_body = float(tilts[stands].max(initial=0.0))
        share = float(stands[tilts <= tilt].mean())
        nose = float(said_limits(recipe, np.zeros(0), np.zeros(1))[0])
        printed = guaranteed(recipe, np.zeros(0))[0]
        posture = replace(posture, upright=recipe.upright, rock_angle=recipe.rock_angle)
        off = np.concatenate([tilt * SHARES, tilt + np.radians(AROUND)])
        tried = np.array([leaning(one, 0.0) for one in off])
        answers = tip_angles(recipe, tried)
        for down, angle, place in zip(tried, answers, pierced(posture, tried), strict=True):
            if place is None or abs(angle) < CLEAR:
                continue
            fallen = any(fate.fell for fate in fates(posture, place, down))
            safe, fell = safe + (angle >= 0.0), fell + (angle >= 0.0 and fallen)
            tips, held = tips + (angle < 0.0), held + (angle < 0.0 and not fallen)
    except RecipeError:
        # More contacts than a recipe may have: the engine alone is held against geometry.
        pass
    limits = np.degrees([tilt, said_body, slope, printed, nose, slow]).tolist()
    counts = [int(count) for count in (safe, fell, tips, held)]
    return Row(name, sole.step, share, *limits, *counts)


def table(rows: Sequence[Row]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| sole | body, geometry | lutgen's last | of all up to there stand | ground, geometry "
        "| `lutgen limits` guarantees "
        "| its limit nose down | slow tilt | releases called safe | of these fell | called tipping "
        "| of these held |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        body, said, *ground = (
            "-" if math.isnan(x) else f"{x:.2f} deg"
            for x in (r.body, r.said_body, r.ground, r.printed, r.nose, r.slow)
        )
        share = "-" if math.isnan(r.share) else f"{100.0 * r.share:.0f} %"
        cells = (r.name, body, said, share, *ground, r.safe, r.fell, r.tips, r.held)
        lines.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(lines) + "\n"


def missed(rows: Sequence[Row], late: float) -> list[str]:
    """Return what must not be, one line each; `late` (deg) is the slow tilt's own lag."""
    faults = []
    step = math.degrees(WALK)
    for r in rows:
        if r.fell:
            faults.append(f"{r.name}: {r.fell} of {r.safe} fell where safe")
        if r.said_body > r.body + step:
            faults.append(
                f"{r.name}: lutgen stands to {r.said_body:.2f}, right is {r.body:.2f} deg"
            )
        if r.printed > r.slow - late + LATE:
            faults.append(f"{r.name}: lutgen guarantees {r.printed:.2f}, engine {r.slow:.2f} deg")
        if r.step > FINE:
            continue
        if r.share < MOST:
            faults.append(f"{r.name}: only {100.0 * r.share:.0f} % of what stands is said to stand")
        if not r.ground - EARLY < r.slow < r.ground + late + LATE:
            faults.append(f"{r.name}: the engine falls at {r.slow:.2f}, not {r.ground:.2f} deg")
    return faults
