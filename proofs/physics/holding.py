"""Check whether wheels hold on a slope, where statics leaves the load on them open.

The robots have more contacts than three: six wheels whose middle pair rolls, or alone is braked;
three contacts in a line; contacts inside the polygon.  How they share the load is decided by
hundredths of a millimetre, so each robot is tried with a few sets of them.  Lutgen's *holds*, a
promise for every load, must not be given where the robot moves with one of them, and *rolls*, for
none, not where it stays with one; *may hold* is allowed both.
"""

import math
from collections import Counter
from dataclasses import replace

import numpy as np

from lutgen.analysis import Posture as Asked
from lutgen.analysis import holds, may_hold
from proofs.physics.body import Floats, Posture, Solid
from proofs.physics.release import Run
from proofs.physics.robots import SIDEWAYS, Maker
from proofs.physics.start import DOWN, on_plane

RADIUS, HALF = 0.1, 0.01
# Going so far (m) in this time (s) is moving: 2 % beyond its limit a robot goes some 10 cm.
GONE, WATCHED = 0.02, 1.5
# Before, it comes to rest on level ground, which is then tilted: let go on the slope from some
# 0.05 mm a robot may go on hopping from wheel to wheel, all the way down, where at rest it holds.
SETTLED, TILTED = 0.3, 1.0
# Slopes nearer to the limit than this factor are left out: soft contacts creep there.
BAND = 1.03
# Verdicts nearer to tipping than this (rad) are drawn again: wheels have a little mass.
NEAR_LIMIT = math.radians(1.0)
# Wheels are off by up to so much (m), a few times what they sink into the ground: any of them may
# then carry a lot or nothing, and the robot leans by 0.01 deg.
UNEVEN, SETS = 5e-5, 3
WRONG = {
    "holds": "moved where it holds",
    "may hold": "of these moved with some load",
    "rolls": "stayed where it rolls",
}
COLUMNS = tuple(column for pair in WRONG.items() for column in pair)
NEVER, CASES = (WRONG["holds"], WRONG["rolls"]), tuple(WRONG)
CHUNK, SEED = 10, 34


def standing(places: list[tuple[float, float]], braked: list[bool], height: float) -> Posture:
    """Return a robot on wheels at places on level ground, its com at a height."""
    centres = [np.array([*place, RADIUS - height]) for place in places]
    wheels = zip(centres, braked, strict=True)
    return Posture(tuple(Solid("cylinder", at, RADIUS, SIDEWAYS, HALF, on) for at, on in wheels))


def six(rng: np.random.Generator, middle: bool) -> Posture:
    """Return a six-wheeler whose middle wheels alone are braked, or alone roll."""
    off = rng.uniform(-0.3, 0.3)
    places = [(x + off, y) for x in (0.4, 0.0, -0.4) for y in (0.3, -0.3)]
    brakes = [brake for brake in (not middle, middle, not middle) for _ in range(2)]
    return standing(places, brakes, rng.uniform(0.15, 0.5))


def in_line(rng: np.random.Generator) -> Posture:
    """Return a robot on three wheels in a line and a fourth beside it, some braked."""
    middle, beside = rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1)
    places = [(0.4, 0.2), (middle, 0.2), (-0.4, 0.2), (beside, -0.4)]
    return standing(places, some(rng, 4), rng.uniform(0.15, 0.4))


def inside(rng: np.random.Generator) -> Posture:
    """Return a car with one or two wheels inside its polygon, some braked."""
    places = [(x, y) for x in (0.4, -0.4) for y in (0.3, -0.3)]
    places += [tuple(rng.uniform(-0.2, 0.2, 2)) for _ in range(int(rng.integers(1, 3)))]
    return standing(places, some(rng, len(places)), rng.uniform(0.15, 0.4))


def some(rng: np.random.Generator, count: int) -> list[bool]:
    """Return which wheels are braked: at least one, and not all."""
    return list(map(bool, rng.permutation(count) < rng.integers(1, count)))


ROBOTS: dict[str, Maker] = {
    "six wheels, the middle ones roll": lambda rng: six(rng, False),
    "six wheels, only the middle ones braked": lambda rng: six(rng, True),
    "three wheels in a line and one": in_line,
    "a car with wheels inside": inside,
}


def uneven(posture: Posture, rng: np.random.Generator) -> Posture:
    """Return the robot with every wheel a little higher or lower."""
    lift = -DOWN * rng.uniform(-UNEVEN, UNEVEN, len(posture.solids))[:, None]
    solids = map(lambda one, up: replace(one, centre=one.centre + up), posture.solids, lift)
    return replace(posture, solids=tuple(solids))


def moves(posture: Posture, gravity_dir: Floats, mu: float) -> bool:
    """Put it on level ground, tilt that, and tell whether the robot leaves its place."""
    run = Run(posture, on_plane(posture, DOWN), DOWN, mu)
    place = run.data.xpos[run.body].copy()
    while run.data.time < SETTLED + TILTED + WATCHED:
        part = min(max(run.data.time - SETTLED, 0.0) / TILTED, 1.0)
        way = DOWN + part * (gravity_dir - DOWN)
        run.tilt(way / np.linalg.norm(way))
        run.step()
        if np.linalg.norm(run.data.xpos[run.body] - place) > GONE:
            return True
    return False


def slope(tangent: float, heading: float) -> Floats:
    """Return the direction of gravity on a slope, body frame."""
    down = np.array([tangent * math.cos(heading), tangent * math.sin(heading), -1.0])
    return np.asarray(down / np.linalg.norm(down))


def said(posture: Posture, mu: float, tangent: float, heading: float) -> str:
    """Return lutgen's verdict: "holds", "may hold", "rolls", or "" near a limit."""
    asked = Asked(posture.recipe(f"friction = {mu!r}"), np.zeros(0))
    near = np.array([slope(tangent * factor, heading) for factor in (1.0 / BAND, BAND)])
    sure, maybe = holds(asked, near), may_hold(asked, near)
    if sure[0] != sure[1] or maybe[0] != maybe[1]:
        return ""
    return "holds" if sure[0] else "may hold" if maybe[0] else "rolls"


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Count a robot on a slope; nothing near a limit."""
    posture, mu = ROBOTS[name](rng), rng.uniform(0.4, 0.9)
    heading = rng.choice([0.0, math.pi, rng.uniform(0.0, 2.0 * math.pi)])
    tangent = mu * rng.uniform(0.05, 0.95)
    down = slope(tangent, heading)
    if posture.tip_angles(down[None])[0] < NEAR_LIMIT:
        return Counter()
    if not (verdict := said(posture, mu, tangent, heading)):
        return Counter()
    sets = [posture, *(uneven(posture, rng) for _ in range(SETS))]
    moved = [moves(one, down, mu) for one in sets]
    wrong = {"holds": any(moved), "may hold": any(moved), "rolls": not all(moved)}[verdict]
    return Counter({verdict: 1, WRONG[verdict]: int(wrong)})
