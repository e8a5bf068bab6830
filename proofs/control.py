"""Attacks on on-board control: random ways, damaged tables, fixed slopes, budgets, bits.

`python -m proofs.control [SCALE [ROBOT ...]]` runs them at length over the gallery and prints a
table, the tests run a sample.  Truth is the program's own evaluation of the recipe, which shares no
code with the C.
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from lutgen.errors import InputError
from lutgen.recipe import gallery_names
from lutgen.vector import Floats
from proofs.steered import BLIND, ESCAPES, Steered, robot

G0 = 9.80665
# Cycles on a fixed slope: joints that move alone, by small steps, take thousands.
LONG = 8000
# rad: what singles may round of a tip angle.
ROUNDED = 2e-5


class Count(NamedTuple):
    """Of an attack: cases, those in which something is promised, and faults.

    `below`, of ways: those that stand all along, but with less than was promised.
    """

    cases: int
    promised: int
    faults: int
    below: int = 0


def directions(one: Steered, rng: np.random.Generator, count: int, tilt: float = 1.0) -> Floats:
    """Return directions (m, 3) around down, up to so many rad."""
    u = np.cos(tilt * np.sqrt(rng.random(count)))
    turn = rng.uniform(0.0, 2.0 * np.pi, count)
    across = np.sqrt(1.0 - u**2)
    return np.stack([across * np.cos(turn), across * np.sin(turn), -u], axis=1)


def _turned(g: Floats, angle: Floats, rng: np.random.Generator) -> Floats:
    """Return directions (m, 3) turned anywhere by up to some angles (m,)."""
    aside = np.cross(g, rng.normal(size=g.shape))
    aside /= np.linalg.norm(aside, axis=1, keepdims=True)
    by = (angle * rng.random(len(g)))[:, None]
    return np.asarray(g * np.cos(by) + aside * np.sin(by))


def transits(
    one: Steered, count: int, inside: int = 24, seed: int = 1, largest: float = 1.0
) -> Count:
    """Attack certified ways: a posture of the box whose tip angle is below what is promised.

    `largest`: of changes, in cycles of the policy's rates.  Of each way `inside` postures are
    looked at: corners, and random ones.
    """
    rng, model, k = np.random.default_rng(seed), one.model, one.model.k
    start = model.at(rng.random((count, k)))
    rates = np.array([joint.rate for joint in one.policy.joints])
    end = (
        start + rng.uniform(-1.0, 1.0, (count, k)) * rates * largest * rng.random((count, 1)) ** 0.3
    )
    end = np.clip(end, model.lower, model.upper)
    start, end = start.astype(np.float32).astype(float), end.astype(np.float32).astype(float)
    slopes = directions(one, rng, count)
    down = one.down(start, slopes).astype(np.float32).astype(float)
    least = one.controller().transit(start, end, down).astype(float)
    lean = np.array([joint.lean for joint in one.policy.joints])
    near = np.array([joint.near for joint in one.policy.joints])
    turned = ((np.abs(end - start) + 2.0 * near) * lean).sum(axis=1)
    sure = np.flatnonzero(least >= 0.0)
    faults, below = np.zeros(count, bool), np.zeros(count, bool)
    for _ in range(inside):
        part = rng.random((len(sure), k))
        part = np.where(rng.random((len(sure), k)) < 0.5, np.round(part), part)
        at = start[sure] + part * (end - start)[sure]
        if one.tripod:
            slope, _ = one.controller().ground(start[sure], -down[sure])
            g = one.down(at, slope)
        else:
            g = _turned(down[sure], turned[sure] * (rng.random(len(sure)) < 0.7), rng)
        tip = one.tip(at, g)
        faults[sure] |= tip < -ROUNDED
        below[sure] |= tip < least[sure] - ROUNDED
    return Count(count, len(sure), int(faults.sum()), int((below & ~faults).sum()))


def damaged(one: Steered, count: int, cycles: int = 12, seed: int = 2) -> Count:
    """Attack with tables of random codes: commands whose way tips though staying does not."""
    rng, model = np.random.default_rng(seed), one.model
    faults = promised = 0
    for _ in range(count):
        codes = rng.integers(0, 256, one.policy.codes.shape).astype(np.uint8)
        low = one.policy.codes.copy()
        broken = replace(one.policy, codes=np.where(rng.random() < 0.5, codes, low ^ codes))
        robots = 8
        c = one.controller(robots, broken)
        q = model.at(rng.random((robots, model.k)))
        slopes = directions(one, rng, robots, 0.8)
        for _ in range(cycles):
            down = one.down(q, slopes)
            stay = one.tip(q, down)
            command, cycle, _ = c.step(q, -G0 * down)
            moved = (
                (cycle["move"] != BLIND)
                & (cycle["move"] != ESCAPES)
                & (np.abs(command - q).max(axis=1) > 0)
            )
            part = rng.random((robots, model.k))
            way = q + part * (command - q)
            g = one.down(way, slopes) if one.tripod else down
            there = one.tip(
                command.astype(float),
                one.down(command.astype(float), slopes) if one.tripod else down,
            )
            tips = (one.tip(way, g) < -ROUNDED) | (there < -ROUNDED)
            faults += int((moved & tips & (stay >= 0.0)).sum())
            promised += int(moved.sum())
            q = np.clip(command.astype(float), model.lower, model.upper)
    return Count(count, promised, faults)


def fixed_slopes(
    one: Steered, count: int, cycles: int = 1500, tail: int = 100, seed: int = 3
) -> Count:
    """Attack with slopes that stay: robots that are still on the move in the end.

    The gyroscope feels them lean while their joints move.
    """
    rng, model = np.random.default_rng(seed), one.model
    slopes = directions(one, rng, count, 0.6)
    q = model.at(rng.random((count, model.k)))
    stands = one.tip(q, one.down(q, slopes)) >= 0.0
    c = one.controller(count)
    moved, before = np.zeros(count), one.down(q, slopes)
    for at in range(cycles):
        down = one.down(q, slopes)
        command, _, _ = c.step(q, -G0 * down, np.cross(down, before) / one.policy.cycle)
        before = down
        after = np.clip(command.astype(float), model.lower, model.upper)
        if at >= cycles - tail:
            moved = np.maximum(moved, np.abs(after - q).max(axis=1))
        q = after
    rate = min(joint.rate for joint in one.policy.joints)
    return Count(count, int(stands.sum()), int((moved > 0.05 * rate).sum()))


class Budget(NamedTuple):
    """Of budgets: cases that stand, those that are too large, the median share of the exact one."""

    cases: int
    faults: int
    share: float


def budgets(one: Steered, count: int, reads: int = 4, seed: int = 4) -> Budget:
    """Attack budgets: accelerations at which the robot tips, or any on the way to them."""
    rng, model = np.random.default_rng(seed), one.model
    q = model.at(rng.random((count, model.k))).astype(np.float32)
    down = directions(one, rng, count, 0.8)
    turn = rng.uniform(0.0, 2.0 * np.pi, count)
    ahead = np.stack([np.cos(turn), np.sin(turn), np.zeros(count)], axis=1)
    found = one.controller().budget(q, down, ahead, reads)
    stands = one.tip(q.astype(float), down) >= 0.0

    def tips(acceleration: Floats) -> Any:
        g = down - ahead * (acceleration / G0)[:, None]
        return one.tip(q.astype(float), g) < -ROUNDED

    faults = np.zeros(count, bool)
    for part in (1.0, 0.9, 0.6, 0.3):
        faults |= tips(part * found.astype(float)) & (found > 0.0)
    low, high = np.zeros(count), np.full(count, 50.0)
    for _ in range(24):
        middle = 0.5 * (low + high)
        over = tips(middle)
        low, high = np.where(over, low, middle), np.where(over, middle, high)
    known = stands & (low > 0.1)
    share = float(np.median(found[known] / low[known])) if known.any() else 1.0
    return Budget(int(stands.sum()), int((faults & stands).sum()), share)


def bits(one: Steered, count: int, seed: int = 5) -> Count:
    """Attack with random bits as input: commands off the axes or beyond the rates."""
    rng, model, k = np.random.default_rng(seed), one.model, one.model.k
    c = one.controller(count)
    rates = np.array([joint.rate for joint in one.policy.joints])
    faults = known = 0

    def noise(shape: tuple[int, ...], share: float) -> Any:
        plain = rng.normal(size=shape).astype(np.float32)
        wild = rng.integers(0, 2**32, shape, np.uint32).view(np.float32)
        return np.where(rng.random(shape) < share, wild, plain)

    for at, wild in enumerate((0.0, 0.1, 0.1, 0.1)):  # from the second on a few off their axes
        q = model.at(rng.random((count, k))).astype(np.float32)
        q = np.where(rng.random((count, k)) < 0.05 * at, noise((count, k), wild), q)
        up, rate, own = (noise((count, 3), wild) for _ in range(3))
        with np.errstate(all="ignore"):
            up[:, 2] += np.float32(G0)
        command, cycle, _ = c.step(q, up, rate, own, noise((count, k), wild))
        off = (command < model.lower.astype(np.float32)) | (
            command > model.upper.astype(np.float32)
        )
        seen = cycle["move"] != BLIND
        known += int(seen.sum())
        inside = np.clip(q, model.lower, model.upper)
        with np.errstate(invalid="ignore"):
            fast = np.abs(command - inside) > rates * 1.0001 + 1e-5
        faults += int((~np.isfinite(command) | off | (fast & seen[:, None])).any(axis=1).sum())
        faults += int((~seen & (cycle["alarm"] != 3)).sum())
    return Count(4 * count, known, faults)


# Cases in all of each attack; a part of them for each recipe.
CASES = {"transits": 1_000_000, "damaged": 10_000, "slopes": 1_000, "budgets": 100_000}
CASES["bits"] = 400_000
HEAD = (
    "| robot | ways certified | tip | less than promised | damaged tables, moves | tip | "
    "fixed slopes | still moving | budgets | too large | share, median | random bits | faults |"
)


def attacked(name: str, part: float) -> tuple[str, int]:
    """Run a part of all attacks on a recipe of the gallery; return its row, and all faults."""
    one = robot(name)
    ways = transits(one, round(part * CASES["transits"]))
    broken = damaged(one, round(part * CASES["damaged"]))
    fixed = fixed_slopes(one, round(part * CASES["slopes"]), LONG)
    hard = budgets(one, round(part * CASES["budgets"]))
    wild = bits(one, round(part * CASES["bits"] / 4))
    numbers = [
        f"{ways.promised:,} of {ways.cases:,}",
        *(f"{ways.faults}", f"{ways.below}"),
        *(f"{broken.cases:,}, {broken.promised:,}", f"{broken.faults}"),
        *(f"{fixed.cases:,}", f"{fixed.faults}"),
        *(f"{hard.cases:,}", f"{hard.faults}", f"{100.0 * hard.share:.1f} %"),
        *(f"{wild.cases:,}", f"{wild.faults}"),
    ]
    row = f"| {name} | {' | '.join(numbers)} |"
    return row, ways.faults + broken.faults + hard.faults + wild.faults


def main(arguments: Sequence[str]) -> int:
    """Attack and print the table; return 1 where a fault was found."""
    names = gallery_names()
    scale = float(arguments[0]) if arguments else 1.0
    print("\n".join([HEAD, "|---" * (HEAD.count("|") - 1) + "|"]), flush=True)
    every = 0
    for name in arguments[1:] or names:
        try:
            row, faults = attacked(name, scale / len(names))
        except InputError as error:
            row, faults = f"| {name} | none: {error} |", 0
        print(row, flush=True)
        every += faults
    return int(every > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
