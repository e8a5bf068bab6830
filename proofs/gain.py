"""What on-board control gains: on slopes that change all the time, against holding still.

Owns the rides and what is counted of them; `python -m proofs.gain` runs them at length and prints
a table, the tests a sample.  The best posture of each slope is that of a lattice, at once and with
nothing in between, which no robot reaches.
"""

import math
import sys
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from firmware_export.control.objective import lattice, measured
from lutgen.recipe import load_recipe
from lutgen.vector import Floats
from proofs.control import G0, GALLERY, PAGE, Steered, robot

# deg: slopes are no steeper; s: how long the ground takes from one to another.
STEEPEST, PERIODS = 42.0, (8.0, 40.0)
RATE, CYCLE, LATENCY, HOME = math.radians(45.0), 0.1, 0.2, math.radians(60.0)
CASES = {"absolem": 85.0, "marv": 90.0}
BEGIN, END = "<!-- gains -->\n", "<!-- end of gains -->"
HEAD = (
    "| robot | bytes of table | runs | captured | cycles that tip, still | with control | "
    "runs that tip only with control | 0.2 s late, no gyroscope | 0.2 s late |"
)


class Gain(NamedTuple):
    """Of rides with and without control.

    `captured`: part of the mean tip angle that is to be gained; `still`, `steered`: part of all
    cycles that tip; `only`: runs in which only the steered robot tips; `runs`: how many there were.
    """

    runs: int
    captured: float
    still: float
    steered: float
    only: int


def home_of(one: Steered) -> Floats:
    """Return the posture in which robots begin, and hold still: flippers 60 deg up."""
    return np.full(one.model.k, HOME)


def ground(runs: int, cycles: int, cycle: float, seed: int) -> Floats:
    """Return slopes (cycles, runs, 3) that wander, each the sum of three waves along and across."""
    rng = np.random.default_rng(seed)
    t = np.arange(cycles)[:, None, None, None] * cycle
    period = rng.uniform(*PERIODS, (runs, 2, 3))
    waves = np.sin(2.0 * np.pi * (t / period + rng.random((runs, 2, 3)))).mean(axis=3)
    uv = math.tan(math.radians(STEEPEST)) * waves * rng.uniform(0.5, 1.5, (runs, 1))
    length = np.maximum(np.hypot(*np.moveaxis(uv, 2, 0)) / math.tan(math.radians(STEEPEST)), 1.0)
    rows = np.concatenate([uv / length[..., None], -np.ones((cycles, runs, 1))], axis=2)
    return np.asarray(rows / np.linalg.norm(rows, axis=2, keepdims=True))


def steered_tips(
    one: Steered, slopes: Floats, start: Floats, lag: int = 1, gyroscope: bool = True
) -> Floats:
    """Return the tip angles (cycles, runs) of robots that are steered; commands are late by `lag`.

    With `lag` above 1 the posture that is commanded for a cycle is that of `lag` cycles ago.
    """
    cycles, runs, _ = slopes.shape
    controller = one.controller(runs)
    posture, tips = np.tile(start, (runs, 1)), np.empty((cycles, runs))
    commands: list[Floats] = []
    before = one.down(posture, slopes[0])
    for i in range(cycles):
        down = one.down(posture, slopes[i])
        tips[i] = one.tip(posture, down)
        # The body turns about this, as far as anyone can tell by gravity.
        rate = np.cross(down, before) / CYCLE if gyroscope else None
        before = down
        command, _, _ = controller.step(posture, -G0 * down, rate)
        commands.append(np.clip(command.astype(float), one.model.lower, one.model.upper))
        if i + 1 >= lag:
            goal, most = commands[i + 1 - lag], [joint.rate for joint in one.policy.joints]
            posture = posture + np.clip(goal - posture, -np.array(most), most)
    return tips


def gain(one: Steered, runs: int, cycles: int = 600, scored: int = 240, seed: int = 11) -> Gain:
    """Ride, and compare with holding still at home and with the best posture of each slope."""
    slopes = ground(runs, cycles, CYCLE, seed)
    home = home_of(one)
    tips = steered_tips(one, slopes, home)
    still = np.stack([one.tip(rows, one.down(rows, s)) for s, rows in _same(home, slopes)])
    rng = np.random.default_rng(seed)
    some = rng.integers(cycles // 10, cycles, scored), rng.integers(0, runs, scored)
    best = measured(one.model, lattice(one.model), slopes[some], "plane")[0].max(axis=1)
    known = best >= 0.0
    had, got = still[some][known], tips[some][known]
    captured = float((got - had).mean() / (best[known] - had).mean())
    only = int(((tips < 0.0).any(axis=0) & ~(still < 0.0).any(axis=0)).sum())
    return Gain(runs, captured, float((still < 0.0).mean()), float((tips < 0.0).mean()), only)


def _same(home: Floats, slopes: Floats) -> list[tuple[Floats, Floats]]:
    """Return the slopes of each cycle, and home for each robot."""
    return [(s, np.tile(home, (len(s), 1))) for s in slopes]


def late(one: Steered, runs: int, cycles: int = 600, seed: int = 12) -> tuple[float, float, float]:
    """Return the parts of cycles that tip: still, and steered 0.2 s late without and with a gyro.

    The policy is to know the latency.
    """
    slopes = ground(runs, cycles, CYCLE, seed)
    home, lag = home_of(one), round(LATENCY / CYCLE)
    still = np.stack([one.tip(rows, one.down(rows, s)) for s, rows in _same(home, slopes)])
    tips = [steered_tips(one, slopes, home, lag, gyro) for gyro in (False, True)]
    return (float((still < 0.0).mean()), *(float((t < 0.0).mean()) for t in tips))  # type: ignore[return-value]


def row(name: str, runs: int) -> str:
    """Return a robot's row of the table."""
    joints = [p.name for p in load_recipe(GALLERY / f"{name}.toml").parameters]
    one = robot(
        name,
        home=dict.fromkeys(joints, HOME),
        rate=dict.fromkeys(joints, RATE),
        cycle=CYCLE,
        latency=LATENCY,
    )
    found, (_, blind, seen) = gain(one, runs), late(one, runs)
    cells = [
        *(name, f"{one.policy.table_bytes}", f"{runs:,}"),
        f"{100.0 * found.captured:.1f} % (asked for: {CASES[name]:g} %)",
        *(f"{100.0 * part:.3f} %" for part in (found.still, found.steered)),
        f"{found.only}",
        *(f"{100.0 * part:.3f} %" for part in (blind, seen)),
    ]
    return f"| {' | '.join(cells)} |"


def main(arguments: Sequence[str]) -> int:
    """Ride, print the table, and with --update write it into the page; return an exit code."""
    words = [a for a in arguments if a != "--update"]
    rows = [HEAD, "|---" * (HEAD.count("|") - 1) + "|"]
    rows += [row(name, int(words[0]) if words else 500) for name in CASES]
    print("\n".join(rows))
    if "--update" in arguments:
        head, _, rest = PAGE.read_text("utf-8").partition(BEGIN)
        _, _, tail = rest.partition(END)
        PAGE.write_text(head + BEGIN + "\n".join(rows) + "\n" + END + tail, "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
