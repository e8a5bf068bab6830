"""What on-board control gains: on slopes that change all the time, against holding still.

Owns the rides and what is counted of them; `python -m proofs.gain` runs them at length and prints
tables, the tests a sample.  The best posture of each slope is that of a lattice, at once and with
nothing in between, which no robot reaches.  There are three rides: over slopes on which flippers
stand still well enough, and it is told what of the best is captured; over steeper ones, on which
they tip that hold still; and, with legs, over slopes that turn fast, on which commands come late.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.control.objective import lattice, measured
from firmware_export.host import HELD
from lutgen.recipe import load_recipe
from lutgen.vector import Floats
from proofs.control import G0, GALLERY, PAGE, Steered, robot

# deg: slopes are no steeper; s: how long the ground takes from one to another.
STEEPEST, STEEPER, PERIODS = 42.0, 60.0, (8.0, 40.0)
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
# Cycles before a robot tips in which it tells why.
BEFORE = 10
HEADS = {
    "gains": "| robot | bytes of table | runs | captured | asked for | tip, still | with control |",
    "steep": "| robot | runs | that tip, still | with control | only with control | of these no "
    "posture stands | held | on the way | cycles that tip, still | with control |",
    "late": "| robot | runs | turns, mean and most | least of the best postures | times that tip, "
    "still | 0.2 s late, not predicted | predicted |",
}


class Ridden(NamedTuple):
    """Of a ride: tip angles (cycles, runs), rad; moves of those that are steered."""

    tips: Floats
    moves: NDArray[np.uint8]


class Steep(NamedTuple):
    """Of runs over steep slopes: how many tip, still and steered, and only when steered.

    Of these at the moment in which they tip: `none`, no posture of the lattice stands; `held`, ways
    were not certified in half of the cycles before; `under_way`, any other, the ground being faster
    than the joints.  `still`, `steered`: parts of all cycles that tip.
    """

    runs: int
    still_runs: int
    steered_runs: int
    only: int
    none: int
    held: int
    under_way: int
    still: float
    steered: float


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


def steered_over(one: Steered, slopes: Floats, start: Floats, every: int = 1) -> Ridden:
    """Ride with control, in one of so many rows of `slopes`; in all of them joints move.

    A sample is of one moment; its command is reached when the next one is taken.
    """
    rows, runs, _ = slopes.shape
    controller, short = one.controller(runs), one.policy.cycle / every
    most = np.array([joint.rate for joint in one.policy.joints]) / every
    posture, tips = np.tile(start, (runs, 1)), np.empty((rows, runs))
    moves, goal = np.empty((rows, runs), np.uint8), posture
    before = one.down(posture, slopes[0])
    for i in range(rows):
        down = one.down(posture, slopes[i])
        tips[i] = one.tip(posture, down)
        if i % every == 0:
            # The body turns about this, as far as anyone can tell by gravity.
            rate = np.cross(down, before) / short
            command, told, _ = controller.step(posture, -G0 * down, rate)
            goal = np.clip(command.astype(float), one.model.lower, one.model.upper)
        before, moves[i] = down, told["move"]
        posture = posture + np.clip(goal - posture, -most, most)
    return Ridden(tips, moves)


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


def steep(one: Steered, runs: int, cycles: int = 600, seed: int = 13) -> Steep:
    """Ride over steep slopes, and tell why those tip that tip only with control."""
    slopes, home = ground(runs, cycles, CYCLE, seed, STEEPER), home_of(one)
    still, (tips, moves) = still_over(one, slopes, home), steered_over(one, slopes, home)
    fallen, fell = (tips < 0.0).any(axis=0), (still < 0.0).any(axis=0)
    only = np.flatnonzero(fallen & ~fell)
    when = (tips < 0.0).argmax(axis=0)
    none = held = 0
    for run in only:
        at = int(when[run])
        best = measured(one.model, lattice(one.model), slopes[at, run][None, :], "plane")[0].max()
        waited = (moves[max(at - BEFORE, 0) : at, run] == HELD).mean() if at else 0.0
        none += int(best < 0.0)
        held += int(best >= 0.0 and waited >= 0.5)
    return Steep(
        runs,
        *(int(fell.sum()), int(fallen.sum())),
        *(len(only), none, held, len(only) - none - held),
        *(float((part < 0.0).mean()) for part in (still, tips)),
    )


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
    rides = [steered_over(each, slopes, home, every).tips for each in (unaware, one)]
    parts = [(tips[begun:] < 0.0).mean() for tips in (still_over(one, slopes, home), *rides)]
    return Late(turned.mean(), turned.max(), float(np.degrees(best.min())), *map(float, parts))


def flippers(name: str) -> Steered:
    """Return a robot with flippers, and its policy."""
    joints = [p.name for p in load_recipe(GALLERY / f"{name}.toml").parameters]
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
    joints = [p.name for p in load_recipe(GALLERY / f"{LATE}.toml").parameters]
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


def rows(runs: int) -> dict[str, list[str]]:
    """Ride; return the rows of each table."""
    found: dict[str, list[str]] = {key: [head, _rule(head)] for key, head in HEADS.items()}

    def add(key: str, *cells: str) -> None:
        found[key].append(f"| {' | '.join(cells)} |")
        print(found[key][-1], flush=True)

    for name, asked in CASES.items():
        one = flippers(name)
        slopes, home = ground(runs, 600, CYCLE, 11), home_of(one)
        still, tips = still_over(one, slopes, home), steered_over(one, slopes, home).tips
        share = f"{100.0 * captured(one, slopes, still, tips):.1f} %"
        shares = (_share(float((part < 0.0).mean())) for part in (still, tips))
        add("gains", name, f"{one.policy.table_bytes}", f"{runs:,}", share, f"{asked:g} %", *shares)
        hard = steep(one, runs)
        add("steep", name, *(f"{x:,}" for x in hard[:-2]), *(_share(x) for x in hard[-2:]))
    mean, most, best, *tip = late(legs(), runs)
    turns = f"{mean:.0f}, {most:.0f} deg/s"
    add("late", LATE, f"{runs:,}", turns, f"{best:.0f} deg", *(_share(part) for part in tip))
    return found


def _rule(head: str) -> str:
    return "|---" * (head.count("|") - 1) + "|"


def main(arguments: Sequence[str]) -> int:
    """Ride, print the tables, and with --update write them into the page; return an exit code."""
    words = [a for a in arguments if a != "--update"]
    found = rows(int(words[0]) if words else 500)
    for key, lines in found.items():
        if "--update" in arguments:
            begin, end = f"<!-- {key} -->\n", f"<!-- end of {key} -->"
            head, _, rest = PAGE.read_text("utf-8").partition(begin)
            _, _, tail = rest.partition(end)
            PAGE.write_text(head + begin + "\n".join(lines) + "\n" + end + tail, "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
