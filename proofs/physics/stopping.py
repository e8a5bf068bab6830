"""Robots that stop dead: at the speed that `lutgen budget` gives for it none tips.

A robot on a slope moves along the ground, and all its contacts stop at once; or one of them does,
and the others slide without friction.  Every second one has a contact on a bump.  Each is tried
twice, with the inertia of a box and with next to none, which is the worst.  Over the least edge,
straight ahead, one of no inertia must tip at 1.05 times that speed: the answer is not too small.
"""

import math
from collections import Counter
from dataclasses import replace

import mujoco
import numpy as np

from lutgen import analysis
from lutgen.analysis.budget import leans, stop_speeds
from lutgen.analysis.ground import gravity_transform
from proofs.physics import robots
from proofs.physics.agreement import CLEAR
from proofs.physics.body import Floats, Posture
from proofs.physics.release import Run, fell
from proofs.physics.start import Start, heights, start

ROBOTS = {
    "3 feet": robots.points(3, 0.0),
    "3 to 8 feet, one plane": robots.points(8, 0.0),
    "3 to 8 balls": robots.balls,
    "4 thin wheels": robots.thin_wheels,
    "absolem": robots.any_posture("absolem"),
    "marv": robots.any_posture("marv"),
}
COLUMNS = ("stops", "tip at the speed", "tip on one contact", "straight", "stand at 1.05 of it")
NEVER, CASES = (*COLUMNS[1:3], COLUMNS[4]), COLUMNS[:1]
SLOPE, BUMP, SLOWEST, FASTEST, BEYOND, LIGHT = 20.0, 0.03, 0.1, 20.0, 1.05, 1e-3
CHUNK, SEED = 10, 56


def tips(
    posture: Posture, begin: Start, down: Floats, velocity: Floats, one: int | None = None
) -> bool:
    """Tell whether a robot tips that stops dead; on `one` contact, or on all."""
    found = []
    # The engine gives energy to thin discs on a body of a thousandth of its inertia.
    for part in (1.0, 0.1 if posture.primitives.axes.any() else LIGHT):
        run = Run(posture, begin, down)
        run.model.body_inertia[run.body] *= part
        # The engine's regularisation follows from inertia.
        mujoco.mj_setConst(run.model, mujoco.MjData(run.model))
        if one is not None:
            run.model.geom_friction[:, 0] *= np.arange(run.model.ngeom) == one + 1
        run.data.qvel[:3] = run.laid @ velocity
        found.append(fell(run, posture))
    return any(found)


def straight(asked: analysis.Posture, down: Floats, frame: Floats) -> float | None:
    """Return the heading straight over the least edge; None if the com is not behind its middle."""
    axes = analysis.diagnose(asked, down).tip_over_axes
    edge = min(axes, key=lambda axis: axis.energy_margin)
    start, stop = edge.start, edge.stop
    wall = np.cross(start, stop)
    x, y, _ = -wall @ frame
    ahead = frame @ [x, y, 0.0]
    inside = ahead @ np.cross(wall, start) > 0.0 and ahead @ np.cross(stop, wall) > 0.0
    return math.atan2(y, x) if asked.convex and inside else None


def tried(name: str, rng: np.random.Generator) -> Counter[str]:
    """Count a robot that stops; nothing near a limit."""
    posture, down, turn = ROBOTS[name](rng), robots.cap(rng, SLOPE), rng.uniform(-np.pi, np.pi)
    bump = rng.choice([0.0, rng.uniform(0.0, BUMP)])
    begin, asked = start(posture, down), analysis.Posture(posture.recipe(), [])
    facet = asked.under(down)
    if begin is None or facet is None or posture.tip_angles(down[None])[0] < CLEAR:
        return Counter()
    frame = gravity_transform(-begin.normal)
    speed = stop_speeds(asked, down, [turn], bump).all_at_once[0]
    if not SLOWEST < speed < FASTEST or begin.balanced(posture):
        return Counter()
    lean = list(leans(facet, down, bump))
    back = lean[rng.integers(len(lean))][0].T
    normal = back @ begin.normal
    leaned = replace(begin, normal=normal, height=float(heights(posture, normal[None]).max()))
    ahead = frame @ [math.cos(turn), math.sin(turn), 0.0]
    found = Counter(stops=1)
    found[COLUMNS[1]] += tips(posture, leaned, back @ down, speed * (back @ ahead))
    level = start(posture, begin.normal)
    least = stop_speeds(asked, begin.normal, []).anyhow
    if level is not None and np.allclose(level.normal, begin.normal) and least > SLOWEST:
        foremost = int(level.basis[np.argmax(level.points @ ahead)])
        found[COLUMNS[2]] += tips(posture, level, level.normal, least * ahead, foremost)
        heading = None if posture.primitives.radius.any() else straight(asked, level.normal, frame)
        if heading is not None:
            ahead = frame @ [math.cos(heading), math.sin(heading), 0.0]
            speed = BEYOND * stop_speeds(asked, level.normal, [heading]).all_at_once[0]
            found[COLUMNS[3]] += 1
            found[COLUMNS[4]] += not tips(posture, level, level.normal, speed * ahead)
    return found
