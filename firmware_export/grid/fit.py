"""Tables of more than three contacts, trained: the sample, the nodes of each axis, the fit.

A table is trained on random configurations.  Then it is lowered where it calls safe what tips, on
fresh ones: where it only just says that the robot stands, and beside the true boundary.
This does not prove that it is safe: that is tested afterwards, on the C that ships.
"""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import train
from firmware_export.grid.ground import WHOLE, Ground, bends, ground_of, spread_knots
from firmware_export.grid.train import (
    GUARD,
    LARGEST,
    MOST,
    SCALE,
    SQUARES,
    STANDS,
    Course,
    Lattice,
    Points,
)
from firmware_export.model import Model, Sample, biased, on_chart, uniform_directions, unit
from lutgen.arrays import Floats, Singles
from lutgen.errors import ExportError
from lutgen.mapping import TO_STAND

# Points of the sample; directions of a posture, postures that share them.
POINTS, PER_POSTURE, AT_ONCE = 6_000_000, 60, 500
# Steps of Adam for a table of 16,000 nodes (they grow with the root of these) and for lengths; its
# rate in codes.
STEPS, STEPS_LENGTHS, RATE = 600, 600, 10.0
# Times that a lowered table is trained a little again; by how many codes points that tip are
# brought below STANDS, those of the sample and fresh ones.
AGAIN, BELOW, FURTHER = 2, 1.5, 3.0
# Directions drawn for a posture; those used, which only just stand; points in a round.
POOL, ASKED, ROUND = 300, 30, 1_500_000
# Points around one that was falsely safe: postures, directions of each; how near they are at most
# (parts of an axis) and over how many decades; decades of the distance of directions (rad); how
# often others are drawn around those found there.
NEAR_POSTURES, NEAR_DIRECTIONS = 3_000, 30
NEAR, DECADES, ASIDE, CHAIN = 1 / 60, 2.5, (0.7, 4.0), 6
# Points of a round that lie beside the boundary.
BESIDE = 200_000
# Rounds at most, and the false safes of one below which the next is left to the certificate.
ROUNDS, FEW = 4, 2
# Share of what stands that may be given up, and of points with which it is found.
USELESS, JUDGED = 0.25, 400_000
# Places of the chart beyond those where something stood.
SPARE = 256.0
FEWEST, MOST_NODES = 3, 65_000
SEED = 71
# Postures (n, k) and the direction of each (n, 3).
Found = tuple[Floats, Floats]


@dataclass(frozen=True, eq=False)
class Lesson:
    """Samples from which the tables of a robot learn.

    It stands between the places `low` and `high` (2,) of v and u alone; `block` (6,) is the block
    that holds the codes of each face, -1 where nothing stands; `lengths` are the exact (n,)
    ``sdg`` and ``height`` at the `points`, which are in random order.
    """

    ground: Ground
    low: Floats
    high: Floats
    block: NDArray[np.int8]
    bend: Floats
    points: Points
    lengths: dict[str, Singles]

    def shape(self, nodes: int) -> tuple[int, ...]:
        """Return the nodes of each axis of a table of at most so many, by how much each bends."""
        weight, blocks = self.bend.mean(axis=1), int(self.block.max(initial=0)) + 1
        shape = [FEWEST] * len(weight)
        while True:
            total = blocks * math.prod(shape)
            able = [
                at
                for at, count in enumerate(shape)
                if total // count * (count + 1) <= nodes and count < LARGEST
            ]
            if not able:
                return tuple(shape)
            shape[max(able, key=lambda at: weight[at] / shape[at])] += 1

    def lattice(self, shape: tuple[int, ...]) -> Lattice:
        """Return the axes of a table with so many nodes."""
        k, comes = self.ground.model.k, (*self.ground.rounds, False, False)
        count = [n + int(round_) for n, round_ in zip(shape, comes, strict=True)]
        knots = np.zeros((k + 2, max(count)), np.float32)
        ends = [(0.0, WHOLE)] * k + list(zip(self.low, self.high, strict=True))
        for axis, (low, high) in enumerate(ends):
            knots[axis, : count[axis]] = spread_knots(self.bend[axis], low, high, count[axis])
        return Lattice(np.array(shape), np.array(count) - 1, knots)


def aims(tip: Floats) -> Singles:
    """Return the codes of tip angles (rad): 0 where the robot tips."""
    sine = np.sin(np.clip(tip, 0.0, math.asin((MOST - STANDS) / SCALE)))
    return np.where(tip < 0.0, 0.0, STANDS + SCALE * sine).astype(np.float32)


def _drawn(
    ground: Ground, seed: list[int], each: int
) -> tuple[Floats, Floats, Singles, NDArray[np.int8]]:
    """Return random postures' places (m, k), the directions (d, 3) of all, and what `enter` says.

    A robot of one posture has the directions of AT_ONCE.
    """
    model, rng = ground.model, np.random.default_rng(seed)
    postures = AT_ONCE if model.k else 1
    x = rng.random((postures, model.k)) * WHOLE
    gravity = uniform_directions(model, rng, (each * (AT_ONCE // postures),))
    return x, gravity, *ground.enter(x, gravity[None])


@lru_cache(maxsize=1)
def learn(model: Model) -> Lesson:
    """Return what the tables of a robot learn from."""
    ground = ground_of(model)
    parts = []
    for part in range(-(-POINTS // (PER_POSTURE * AT_ONCE))):
        x, gravity, place, face = _drawn(ground, [SEED, part], PER_POSTURE)
        exact = ground.model.exact(ground.params(x), gravity[None])
        lengths = (exact.sdg.astype(np.float32), exact.height.astype(np.float32))
        parts.append((place, face, aims(exact.tip_angle), *lengths))
    order = np.random.default_rng(SEED).permutation(sum(one[1].size for one in parts))
    place = np.concatenate([one[0].reshape(-1, model.k + 2) for one in parts])[order]
    face, aim, sdg, height = (
        np.concatenate([one[at].ravel() for one in parts])[order] for at in range(1, 5)
    )
    stands = aim >= STANDS
    if not stands.any():
        raise ExportError(
            f"{model.recipe.source}: key `robot.contact`: the export would only ever answer that "
            f"the robot tips (got none of {len(aim):,} postures and directions in which it "
            f"stands); {TO_STAND}."
        )
    chart = place[stands, -2:]
    low = np.maximum(np.floor(chart.min(axis=0)) - SPARE, 0.0).astype(np.float64)
    high = np.minimum(np.ceil(chart.max(axis=0)) + SPARE, WHOLE).astype(np.float64)
    block, faces = np.full(6, -1, np.int8), np.unique(face[stands])
    block[faces] = np.arange(len(faces))
    return Lesson(
        *(ground, low, high, block, bends(ground, low, high), Points(place, block[face], aim)),
        {"sdg": sdg, "height": height},
    )


def lowered(lesson: Lesson, values: Singles, lattice: Lattice, seed: list[int]) -> Found:
    """Lower codes in place on fresh points that only just stand; return those falsely safe."""
    ground, found = lesson.ground, list[Found]()
    for part in range(max(1, ROUND // (AT_ONCE * ASKED))):
        x, gravity, place, face = _drawn(ground, [*seed, part], POOL)
        place, block = place.reshape(-1, place.shape[2]), lesson.block[face].ravel()
        said = train.read(values, Points(place, block, place[:, 0]), lattice)
        least = np.where(said >= STANDS, said, np.inf).reshape(face.shape)
        chosen = ASKED * AT_ONCE // len(x)
        at = np.argpartition(least, chosen, axis=1)[:, :chosen]
        rows = (np.arange(len(x))[:, None] * len(gravity) + at).ravel()
        fresh = Points(place[rows], block[rows], place[rows, 0])
        found.append(_lower(lesson, values, lattice, ground.params(x), gravity[at], fresh))
    params, direction = (np.concatenate(one) for one in zip(*found, strict=True))
    return params, direction


def _lower(
    lesson: Lesson, values: Singles, lattice: Lattice, params: Floats, gravity: Floats, at: Points
) -> Found:
    """Lower codes in place at points, which have no exact answer yet; return those falsely safe."""
    tip = lesson.ground.model.tip_angle(lesson.ground.model.postures(params), gravity)
    said = train.read(values, at, lattice).reshape(tip.shape)
    tips = tip < 0.0
    row, column = np.nonzero(tips & (said >= STANDS))
    falling = Points(at.x[tips.ravel()], at.block[tips.ravel()], aims(tip[tips]))
    train.lower(values, falling, lattice, True, FURTHER)
    return params[row], gravity[row, column]


def train_verdict(lesson: Lesson, lattice: Lattice, blocks: int) -> Singles:
    """Return the codes of the tip angle, whole numbers; refuse a robot beyond them."""
    nodes, rng = blocks * int(np.prod(lattice.nodes)), np.random.default_rng([SEED, 1])
    points, steps = lesson.points, round(STEPS * max(1.0, math.sqrt(nodes / 16_000)))
    values = np.full(nodes, STANDS, np.float32)
    first = Course(steps, RATE, train.FIRST, train.LAST, 0.0)
    values = train.descend(values, points, lattice, first, rng)
    for again in range(1, AGAIN + 1):
        train.lower(values, points, lattice, False, BELOW)
        more = Course(steps // 3, 0.15 * RATE / again, train.LAST, train.LAST, 2.0 * GUARD)
        values = train.descend(values, points, lattice, more, rng)
    train.lower(values, points, lattice, False, BELOW)
    values = np.rint(values).astype(np.float32)
    train.lower(values, points, lattice, True, BELOW)
    some = points.some(JUDGED)
    stands = some.aim >= STANDS
    lost = float(np.mean(train.read(values, some, lattice)[stands] < STANDS))
    if lost > USELESS:
        source = lesson.ground.model.recipe.source
        raise ExportError(
            f"{source}: a table of {nodes:,} nodes would call {100.0 * lost:.3g} % of what stands "
            f"unsafe, more than {100.0 * USELESS:.0f} % (got {lesson.ground.model.k} parameters); "
            "choose the codec contacts, which computes where the contacts are."
        )
    return values


def train_length(lesson: Lesson, lattice: Lattice, blocks: int, name: str) -> tuple[Singles, float]:
    """Return the codes of a length, whole numbers, and the length of one."""
    expected, rng = lesson.lengths[name], np.random.default_rng([SEED, 2])
    known = np.flatnonzero(np.isfinite(expected))
    step = float(expected[known].max()) / LARGEST or 1.0
    x, block, _ = lesson.points
    points = Points(x[known], block[known], expected[known] / np.float32(step))
    values = np.full(blocks * int(np.prod(lattice.nodes)), points.aim.mean(), np.float32)
    course = Course(STEPS_LENGTHS, RATE, SQUARES, SQUARES, 0.0)
    values = train.descend(values, points, lattice, course, rng)
    return np.rint(values).astype(np.float32), step


def length_error(lesson: Lesson, lattice: Lattice) -> float:
    """Return p99 of the error of |SD_g| in percent of its range, of a table of this size."""
    values, step = train_length(lesson, lattice, int(lesson.block.max()) + 1, "sdg")
    some = lesson.points.some(JUDGED)
    expected = lesson.lengths["sdg"][:JUDGED]
    error = np.abs(train.read(values, some, lattice) * step - expected)
    return 100.0 * float(
        np.nanquantile(error, 0.99) / max(np.nanmax(expected) - np.nanmin(expected), 1e-300)
    )


@lru_cache(maxsize=2)
def fit(
    model: Model, shape: tuple[int, ...], lengths: tuple[str, ...]
) -> tuple[Lattice, Singles, dict[str, tuple[Singles, float]]]:
    """Return the axes of tables, the codes of the tip angle, and those of lengths with steps."""
    lesson = learn(model)
    lattice, blocks = lesson.lattice(shape), int(lesson.block.max()) + 1
    with ThreadPoolExecutor(max(1, len(lengths))) as pool:
        jobs = {name: pool.submit(train_length, lesson, lattice, blocks, name) for name in lengths}
        values = train_verdict(lesson, lattice, blocks)
    settle(lesson, lattice, values, 3, ROUNDS)
    return lattice, values, {name: job.result() for name, job in jobs.items()}


def settle(lesson: Lesson, lattice: Lattice, values: Singles, seed: int, rounds: int) -> None:
    """Lower codes in place, round after round, until at most `FEW` points were falsely safe."""
    for turn in range(rounds):
        found = [
            lowered(lesson, values, lattice, [SEED, seed, turn]),
            given(lesson, lattice, values, biased(lesson.ground.model, BESIDE, 1000 * seed + turn)),
        ]
        for one in found:
            around(lesson, lattice, values, one, [SEED, seed, turn])
        if sum(len(one[0]) for one in found) <= FEW:
            break


def given(lesson: Lesson, lattice: Lattice, values: Singles, sample: Sample) -> Found:
    """Lower codes in place on given points; return those that were falsely safe."""
    ground = lesson.ground
    place, face = ground.enter(ground.places_of(sample.params), sample.gravity)
    on = on_chart(ground.model, sample.gravity)
    block = np.where(on, lesson.block[face], -1).astype(np.int8).ravel()
    place = place.reshape(-1, place.shape[2])
    return _lower(lesson, values, lattice, *sample, Points(place, block, place[:, 0]))


def around(
    lesson: Lesson, lattice: Lattice, values: Singles, found: Found, seed: list[int]
) -> None:
    """Lower codes in place around points that were falsely safe, then around those found there."""
    ground = lesson.ground
    for again in range(CHAIN):
        if not len(found[0]):
            break
        rng = np.random.default_rng([*seed, again])
        pick = rng.integers(0, len(found[0]), NEAR_POSTURES)
        reach = NEAR * 10.0 ** -rng.uniform(0.0, DECADES, (NEAR_POSTURES, 1))
        x = ground.places_of(found[0][pick])
        x = x + rng.normal(0.0, WHOLE, x.shape) * reach
        x = np.where(ground.rounds, x % (WHOLE + 1.0), np.clip(x, 0.0, WHOLE))
        aside = rng.normal(size=(NEAR_POSTURES, NEAR_DIRECTIONS, 3))
        aside *= 10.0 ** -rng.uniform(*ASIDE, (NEAR_POSTURES, NEAR_DIRECTIONS, 1))
        gravity = unit(found[1][pick][:, None] + aside)
        found = given(lesson, lattice, values, Sample(ground.params(x), gravity))
