"""Gains of on-board control: on slopes that change all the time, against holding still.

`python -m proofs.gain [RUNS]` prints the gains.  Flippers ride over slopes on which they stand
still well enough, and the table tells the share of the best possible gain that is captured.  Legs
ride over slopes that turn fast, on which commands come late.  The best posture of each slope is
that of a lattice, at once and with nothing in between, which no robot reaches.
"""

import math
import sys
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from firmware_export.control.maker import lattice, measured
from lutgen.recipe import load_recipe
from lutgen.vector import Floats
from proofs.control import G0
from proofs.steered import Steered, robot

# deg: slopes are no steeper; s: how long the ground takes from one to another.
STEEPEST, PERIODS = 42.0, (8.0, 40.0)
RATE, CYCLE, HOME = math.radians(45.0), 0.1, math.radians(60.0)
# Late commands: a robot on three points, the rate of its legs (deg/s), the time from sample to the
# end of the motion (s), the tip angle that it keeps (deg), how steep and how fast the ground is.
LATE, SWIFT, LATENCY, KEPT, TILTED, QUICK = "paper_two", 120.0, 0.2, 10.0, 55.0, (1.4, 2.8)
# s: the ground turns, the gyroscope reads and robots are looked at so often; before a time they
# are not counted, since they begin anywhere.
FINE, BEGUN = 0.02, 1.0
# Table of that policy: nodes a side, deg; rad that `up` may turn in a cycle without a gyroscope.
NODES, TABLE, SWERVE = 17, 58.0, 2.5
CASES = {"absolem": 85.0, "marv": 90.0}


def home_of(one: Steered) -> Floats:
    """Return the posture in which robots begin, and hold still: flippers 60 deg up."""
    return np.full(one.model.k, HOME)


def ground(
    runs: int,
    cycles: int,
    cycle: float,
    seed: int,
    steepest: float = STEEPEST,
    periods: tuple[float, float] = PERIODS,
) -> Floats:
    """Return slopes (cycles, runs, 3) that wander, each the sum of three waves along and across."""
    rng = np.random.default_rng(seed)
    t = np.arange(cycles)[:, None, None, None] * cycle
    period = rng.uniform(*periods, (runs, 2, 3))
    waves = np.sin(2.0 * np.pi * (t / period + rng.random((runs, 2, 3)))).mean(axis=3)
    most = math.tan(math.radians(steepest))
    uv = most * waves * rng.uniform(0.5, 1.5, (runs, 1))
    length = np.maximum(np.hypot(*np.moveaxis(uv, 2, 0)) / most, 1.0)
    rows = np.concatenate([uv / length[..., None], -np.ones((cycles, runs, 1))], axis=2)
    return np.asarray(rows / np.linalg.norm(rows, axis=2, keepdims=True))


def steered_over(one: Steered, slopes: Floats, start: Floats, every: int = 1) -> Floats:
    """Return the tip angles (rows, runs) of robots with control, in one of so many rows.

    A sample is of one moment; its command is reached when the next one is taken.
    """
    rows, runs, _ = slopes.shape
    controller, short = one.controller(runs), one.policy.cycle / every
    most = np.array([joint.rate for joint in one.policy.joints]) / every
    posture, tips = np.tile(start, (runs, 1)), np.empty((rows, runs))
    goal, before = posture, one.down(posture, slopes[0])
    for i in range(rows):
        down = one.down(posture, slopes[i])
        tips[i] = one.tip(posture, down)
        if i % every == 0:
            # The body turns about this, as far as anyone can tell by gravity.
            rate = np.cross(down, before) / short
            command, _, _ = controller.step(posture, -G0 * down, rate)
            goal = np.clip(command.astype(float), one.model.lower, one.model.upper)
        before = down
        posture = posture + np.clip(goal - posture, -most, most)
    return tips


def still_over(one: Steered, slopes: Floats, home: Floats) -> Floats:
    """Return the tip angles (cycles, runs) of robots that hold still."""
    rows = np.tile(home, (slopes.shape[1], 1))
    return np.stack([one.tip(rows, one.down(rows, s)) for s in slopes])


def captured(one: Steered, slopes: Floats, still: Floats, tips: Floats, scored: int = 240) -> float:
    """Return the part of the mean tip angle that is to be gained, on some slopes of a ride."""
    cycles, runs = tips.shape
    rng = np.random.default_rng(11)
    some = rng.integers(cycles // 10, cycles, scored), rng.integers(0, runs, scored)
    best = measured(one.model, lattice(one.model), slopes[some], "plane")[0].max(axis=1)
    known = best >= 0.0
    had, got = still[some][known], tips[some][known]
    return float((got - had).mean() / (best[known] - had).mean())


class Late(NamedTuple):
    """Of late commands: parts of all times that tip, holding still and with control.

    `mean`, `most`: by how much (deg/s) the ground turns; `best`: the least tip angle (deg) that the
    best posture of any of some slopes has.
    """

    mean: float
    most: float
    best: float
    still: float
    blind: float
    predicted: float


def late(one: Steered, runs: int, seconds: float = 20.0, seed: int = 12) -> Late:
    """Ride with commands that are reached a cycle later, by a policy that knows it and not."""
    every, begun = round(one.policy.cycle / FINE), round(BEGUN / FINE)
    slopes = ground(runs, round(seconds / FINE), FINE, seed, TILTED, QUICK)
    home = np.array(one.model.recipe.home_params)
    turned = np.degrees(np.linalg.norm(np.diff(slopes, axis=0), axis=2)) / FINE
    some = slopes[::50].reshape(-1, 3)[:800]
    best = measured(one.model, lattice(one.model), some, "plane")[0].max(axis=1)
    unaware = Steered(one.model, one.blob, replace(one.policy, latency=1e-6))
    rides = [steered_over(each, slopes, home, every) for each in (unaware, one)]
    parts = [(tips[begun:] < 0.0).mean() for tips in (still_over(one, slopes, home), *rides)]
    return Late(turned.mean(), turned.max(), float(np.degrees(best.min())), *map(float, parts))


def flippers(name: str) -> Steered:
    """Return a robot with flippers, and its policy."""
    joints = [p.name for p in load_recipe(f"recipe:{name}").parameters]
    return robot(
        name,
        home=dict.fromkeys(joints, HOME),
        rate=dict.fromkeys(joints, RATE),
        within=math.radians(0.5),
        cycle=CYCLE,
        latency=CYCLE,
        poses=2,
    )


def legs() -> Steered:
    """Return the robot whose commands come late."""
    joints = [p.name for p in load_recipe(f"recipe:{LATE}").parameters]
    return robot(
        LATE,
        objective="move",
        margin=math.radians(KEPT),
        rate=dict.fromkeys(joints, math.radians(SWIFT)),
        nodes=NODES,
        slope=math.radians(TABLE),
        cycle=LATENCY,
        latency=LATENCY,
        swerve=SWERVE,
    )


def _share(part: float) -> str:
    return f"{100.0 * part:.3f} %"


def main(runs: int) -> int:
    """Ride and print the tables; return 1 where less is captured than is asked for."""
    head = "| robot | bytes of table | runs | captured | asked for | tip, still | with control |"
    print(head, "|---" * (head.count("|") - 1) + "|", sep="\n")
    missed = False
    for name, wanted in CASES.items():
        one = flippers(name)
        slopes, home = ground(runs, 600, CYCLE, 11), home_of(one)
        still, tips = still_over(one, slopes, home), steered_over(one, slopes, home)
        share = 100.0 * captured(one, slopes, still, tips)
        missed |= share < wanted
        parts = (_share(float((part < 0.0).mean())) for part in (still, tips))
        cells = [
            f"{one.policy.table_bytes}",
            f"{runs:,}",
            f"{share:.1f} %",
            f"{wanted:g} %",
            *parts,
        ]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
    mean, most, best, *tip = late(legs(), runs)
    print(f"{LATE}, {runs:,} runs: the ground turns by {mean:.0f} deg/s, at most {most:.0f} deg/s")
    print(f"the best posture has {best:.0f} deg or more; the robot tips in {_share(tip[0])}")
    print(f"standing still, {_share(tip[1])} with late commands, {_share(tip[2])} predicted")
    return int(missed)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if sys.argv[1:] else 500))
