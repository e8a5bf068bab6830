"""Robots over real gaps of 1 to 30 deg: whether one that lutgen calls safe is caught as it rocks.

Owns the robots and directions over gaps, and their count.  In a gap a robot is in balance over two
contacts; it is pushed out of it both ways.  *Safe but fell* must not happen; *tips but held* is
the price of a verdict that must hold without friction.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np

import lutgen
from proofs.physics.body import Floats, Posture, as_recipe, rigid_body, tip_angles
from proofs.physics.nudged import fates, turning
from proofs.physics.pierced import Ints, Pierced, heights, pierced, reach
from proofs.physics.release import STEEPEST
from proofs.physics.robots import (
    ROOT,
    SIDEWAYS,
    Maker,
    any_posture,
    balls,
    cap,
    flipper_recipe,
    flippers,
    thin_wheels,
    wide_wheels,
)

# The range of gaps (rad): narrower ones are slivers (`noisy`), wider ones never count as rocking.
NARROW, WIDE = math.radians(1.0), math.radians(30.0)
# Steps (rad) in which an arc is followed, how much further (m) another primitive must reach, and
# how level (share of the size) the two contacts are.
FINEST, COARSEST, BELOW, LEVEL = math.radians(0.25), math.radians(4.0), 1e-7, 1e-9
# Verdicts nearer to their limit than this (rad, 0.1 deg) are not judged: the push is half of it.
CLEAR = math.radians(0.1)
# Directions looked at per robot, the most that are tried with one, up to which tilt (deg), and the
# most balances that are followed, which takes time.
LOOKED, EACH, TILT, FOLLOWED = 200, 2, 70.0, 8
CHUNK, SEED = 15, 31


def chair(rng: np.random.Generator) -> Posture:
    """Return a rocking chair: two rails of 3 to 10 thin wheels each, on arcs, the com above."""
    count, step = int(rng.integers(3, 11)), math.radians(rng.uniform(2.0, 12.0))
    arc, radius = rng.uniform(0.25, 0.6), rng.uniform(0.01, 0.06)
    angle = step * (np.arange(count) - (count - 1) / 2.0)
    rail = np.stack([arc * np.sin(angle), 0.0 * angle, -arc * np.cos(angle)], axis=1)
    half = rng.uniform(0.1, 0.3)
    com = [rng.uniform(-0.03, 0.03), rng.uniform(-0.05, 0.05), -arc + rng.uniform(0.05, 0.5)]
    centres = np.concatenate([rail + side * SIDEWAYS for side in (-half, half)]) - com
    return rigid_body(centres, radius, SIDEWAYS, rng.uniform(1.0, 30.0))


def gallery(name: str) -> Maker:
    """Return a maker of a gallery robot's postures, anywhere in its ranges."""
    return any_posture(lutgen.load_recipe(ROOT / "maps" / f"{name}.toml"))


ROBOTS: dict[str, Maker] = {
    "3 to 8 balls": balls,
    "4 thin wheels": thin_wheels,
    "4 cylinders": wide_wheels,
    "4 flippers, thin": flippers(False),
    "4 flippers, cylinders": flippers(True),
    "rocking chairs": chair,
    "marv": gallery("marv"),
    "markhor, 4 angles": any_posture(flipper_recipe("markhor", True)),
    "absolem, 4 angles": any_posture(flipper_recipe("absolem", True)),
    "articulated": gallery("articulated"),
}


@dataclass(frozen=True)
class Trial:
    """One direction over a gap: tip angle (deg), turn of the arc (deg), the pushes and their falls.

    `rests` of those that fell lie still again upright, beyond `rock_angle`.
    """

    tip_angle: float
    turn: float
    pushes: int
    falls: int
    rests: int


@dataclass(frozen=True)
class Row:
    """Releases of one kind of robot: called safe and of these fell; called tipping, and held.

    `rests` of those that fell lie still again upright.
    """

    name: str
    safe: int
    fell: int
    rests: int
    tips: int
    held: int
    unclear: int


def arc_turn(posture: Posture, place: Pierced) -> float:
    """Return by how much (rad) the robot rolls over the two contacts until a third one touches.

    No more than `WIDE` is followed; the result is short by up to twice `FINEST`.
    """
    ends = np.linalg.norm(place.points - np.roll(place.points, 1, axis=0), axis=1)
    k = int(np.argmax(ends))
    pair = place.basis[[k, k - 1]]
    whole = 0.0
    for way in (1.0, -1.0):
        normal, step, ended = place.normal, FINEST, False
        while whole <= WIDE and step >= FINEST:
            edge = _edge(posture, pair, normal)
            turn = turning(edge / np.linalg.norm(edge), way * step)
            ahead = _levelled(posture, pair, turn @ normal)
            high = heights(posture, ahead[None])[0]
            if float(high.max() - high[pair].max()) > BELOW:
                step, ended = 0.5 * step, True
                continue
            normal, whole = ahead, whole + step
            step = 0.5 * step if ended else min(2.0 * step, COARSEST)
    return whole


def _levelled(posture: Posture, pair: Ints, normal: Floats) -> Floats:
    """Return the normal nearby of a plane that both contacts of a pair touch."""
    for _ in range(20):
        edge = _edge(posture, pair, normal)
        lean = float(edge @ normal)
        if abs(lean) < LEVEL * posture.size:
            break
        normal = normal - edge * lean / float(edge @ edge)
        normal /= np.linalg.norm(normal)
    return normal


def _edge(posture: Posture, pair: Ints, normal: Floats) -> Floats:
    """Return the line from the first contact of a pair to the second."""
    points = reach(posture, normal[None])[0, pair]
    return np.asarray(points[1] - points[0])


def over_gaps(rng: np.random.Generator, posture: Posture) -> list[tuple[Floats, Pierced, float]]:
    """Return directions over gaps of a robot, at most `EACH`, and where it is under them."""
    directions = np.array([cap(rng, TILT) for _ in range(LOOKED)])
    found, followed = [], 0
    for gravity_dir, place in zip(directions, pierced(posture, directions), strict=True):
        if place is None or not place.is_line(posture) or len(set(place.basis.tolist())) < 2:
            continue
        # Below its friction limit a robot that slides would trip.
        if place.start(posture).slope(gravity_dir) >= STEEPEST:
            continue
        followed += 1
        turn = arc_turn(posture, place)
        if NARROW <= turn <= WIDE:
            found.append((gravity_dir, place, turn))
        if len(found) == EACH or followed == FOLLOWED:
            break
    return found


def judged(name: str, chunk: int) -> list[Trial]:
    """Return `CHUNK` trials, the same in every run."""
    rng = np.random.default_rng([SEED, list(ROBOTS).index(name), chunk])
    trials: list[Trial] = []
    while len(trials) < CHUNK:
        posture = ROBOTS[name](rng)
        found = over_gaps(rng, posture)
        if not found:
            continue
        recipe = as_recipe(posture)
        posture = replace(posture, upright=recipe.upright, rock_angle=recipe.rock_angle)
        angles = tip_angles(recipe, np.array([one[0] for one in found]))
        for (gravity_dir, place, turn), angle in zip(found, angles, strict=True):
            fate = fates(posture, place, gravity_dir)
            falls, rests = sum(one.fell for one in fate), sum(one.rests for one in fate)
            degrees = (math.degrees(angle), math.degrees(turn))
            trials.append(Trial(*degrees, len(fate), falls, rests))
    return trials[:CHUNK]


def row(name: str, trials: Sequence[Trial]) -> Row:
    """Count."""
    clear = [t for t in trials if abs(t.tip_angle) >= math.degrees(CLEAR)]
    safe = [t for t in clear if t.tip_angle >= 0.0]
    tips = [t for t in clear if t.tip_angle < 0.0]
    return Row(
        name,
        sum(t.pushes for t in safe),
        sum(t.falls for t in safe),
        sum(t.rests for t in safe),
        sum(t.pushes for t in tips),
        # Pushed one way it may well stay up; it holds where it does so both ways.
        sum(t.pushes for t in tips if not t.falls),
        len(trials) - len(clear),
    )


def total(rows: Sequence[Row]) -> Row:
    """Add up rows."""
    counts = {key: sum(getattr(r, key) for r in rows) for key in asdict(rows[0]) if key != "name"}
    return Row(name="all", **counts)


def table(rows: Sequence[Row]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| robots over gaps of 1 to 30 deg | releases called safe | of these fell "
        "| of which lie still again, beyond `rock_angle` | releases called tipping "
        "| of these held both ways | nearer than 0.1 deg |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {r.name} | {r.safe:,} | {r.fell} | {r.rests} | {r.tips:,} | {r.held} | {r.unclear} |"
        for r in rows
    ]
    return "\n".join(lines) + "\n"


def missed(rows: Sequence[Row]) -> list[str]:
    """Return the kinds of robot of which one fell where it was called safe, one line each."""
    return [f"{r.name}: {r.fell} of {r.safe} fell where safe" for r in rows if r.fell]
