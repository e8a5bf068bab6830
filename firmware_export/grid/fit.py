"""Tables of more than three contacts, trained: the sample, the nodes of each axis, the fit.

A table is trained on random configurations.  Then it is lowered where it calls safe what tips: at
fresh ones, and at those to which a search climbs from the worst of them.
This does not prove that it is safe: that is tested afterwards, on the C that ships.
"""

import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.certify.answers import Reader
from firmware_export.certify.attack import clearance, climb, starts
from firmware_export.grid import train
from firmware_export.grid.ground import WHOLE, Ground, bends, ground_of, spread_knots
from firmware_export.grid.train import Course, Lattice, Points
from firmware_export.model import Model, Sample, biased, on_chart, uniform, uniform_directions
from lutgen.arrays import Floats, Singles
from lutgen.errors import ExportError, reject
from lutgen.support import TIPS

# Points of the sample; directions of a posture, postures that share them.
POINTS, PER_POSTURE, AT_ONCE = 6_000_000, 60, 500
# Steps of Adam for a table of 16,000 nodes (they grow with the root of these) and for lengths; its
# rate in codes.
STEPS, STEPS_LENGTHS, RATE = 600, 600, 10.0
# Times that a lowered table is trained a little again; by how many codes points that tip are
# brought below STANDS, those of the sample and fresh ones.
AGAIN, BELOW, FURTHER = 2, 1.5, 1.0
# Fresh points of a round, anywhere and beside the boundary; from how many of each kind it climbs,
# how often, and the first step (rad, and in shares of the box).
ANYWHERE, BESIDE, STARTS, CLIMBED, STEP = 500_000, 200_000, 500, 15, 0.003
# Rounds at most, and the false safes of one below which the next is left to the certificate.
ROUNDS, FEW = 12, 2
# Share of what stands that may be given up, and of points with which it is found.
USELESS, JUDGED = 0.25, 400_000
# Places of the chart beyond those where something stood.
SPARE = 256.0
FEWEST, MOST_BYTES = 3, 65_000
SEED = 71


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

    def shape(self, size: int) -> tuple[int, ...]:
        """Return the nodes of each axis of a table that has so many bytes, its knots included.

        There are more along an axis that bends more.
        """
        weight, blocks = self.bend.mean(axis=1), int(self.block.max(initial=0)) + 1

        def fits(shape: Sequence[int]) -> bool:
            return blocks * math.prod(shape) + 2 * sum(shape) <= size and max(shape) < train.LARGEST

        shape = [FEWEST] * len(weight)
        while able := [
            i for i, n in enumerate(shape) if fits([*shape[:i], n + 1, *shape[i + 1 :]])
        ]:
            shape[max(able, key=lambda i: weight[i] / shape[i])] += 1
        return tuple(shape)

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
    sine = np.sin(np.clip(tip, 0.0, math.asin((train.MOST - train.STANDS) / train.SCALE)))
    return np.where(tip < 0.0, 0.0, train.STANDS + train.SCALE * sine).astype(np.float32)


@lru_cache(maxsize=1)
def learn(model: Model) -> Lesson:
    """Return what the tables of a robot learn from."""
    ground, parts = ground_of(model), []
    # A robot of one posture has the directions of AT_ONCE.
    postures = AT_ONCE if model.k else 1
    for part in range(-(-POINTS // (PER_POSTURE * AT_ONCE))):
        rng = np.random.default_rng([SEED, part])
        x = rng.random((postures, model.k)) * WHOLE
        gravity = uniform_directions(ground.model, rng, (PER_POSTURE * (AT_ONCE // postures),))
        place, face = ground.enter(x, gravity[None])
        exact = ground.model.exact(ground.params(x), gravity[None])
        lengths = (exact.sdg.astype(np.float32), exact.height.astype(np.float32))
        parts.append((place, face, aims(exact.tip_angle), *lengths))
    order = np.random.default_rng(SEED).permutation(sum(one[1].size for one in parts))
    place = np.concatenate([one[0].reshape(-1, model.k + 2) for one in parts])[order]
    face, aim, sdg, height = (
        np.concatenate([one[at].ravel() for one in parts])[order] for at in range(1, 5)
    )
    stands = aim >= train.STANDS
    chart = place[stands, -2:]
    low = np.maximum(np.floor(chart.min(axis=0)) - SPARE, 0.0).astype(np.float64)
    high = np.minimum(np.ceil(chart.max(axis=0)) + SPARE, WHOLE).astype(np.float64)
    block, faces = np.full(6, -1, np.int8), np.unique(face[stands])
    block[faces] = np.arange(len(faces))
    return Lesson(
        *(ground, low, high, block, bends(ground, low, high), Points(place, block[face], aim)),
        {"sdg": sdg, "height": height},
    )


def train_verdict(lesson: Lesson, lattice: Lattice, blocks: int) -> Singles:
    """Return the codes of the tip angle, whole numbers; refuse a robot beyond them."""
    nodes, rng = blocks * int(np.prod(lattice.nodes)), np.random.default_rng([SEED, 1])
    points, steps = lesson.points, round(STEPS * max(1.0, math.sqrt(nodes / 16_000)))
    values = np.full(nodes, train.STANDS, np.float32)
    first = Course(steps, RATE, train.FIRST, train.LAST, 0.0)
    values = train.descend(values, points, lattice, first, rng)
    for again in range(1, AGAIN + 1):
        train.lower(values, points, lattice, False, BELOW)
        more = Course(steps // 3, 0.15 * RATE / again, train.LAST, train.LAST, 2.0 * train.GUARD)
        values = train.descend(values, points, lattice, more, rng)
    train.lower(values, points, lattice, False, BELOW)
    values = np.rint(values).astype(np.float32)
    train.lower(values, points, lattice, True, BELOW)
    some = Points(points.x[:JUDGED], points.block[:JUDGED], points.aim[:JUDGED])
    stands = some.aim >= train.STANDS
    lost = float(np.mean(train.read(values, some, lattice)[stands] < train.STANDS))
    if lost > USELESS:
        model, most = lesson.ground.model, f"more than {100.0 * USELESS:.0f} %"
        share = f"{100.0 * lost:.3g} % of what stands unsafe, {most}"
        what = f"a table of {nodes:,} nodes would call {share}"
        way_out = "choose the codec contacts, which computes where the contacts are"
        reject(model.recipe.source, what, f"{model.k} parameters", way_out, ExportError)
    return values


def train_length(lesson: Lesson, lattice: Lattice, blocks: int, name: str) -> tuple[Singles, float]:
    """Return the codes of a length, whole numbers, and the length of one."""
    expected, rng = lesson.lengths[name], np.random.default_rng([SEED, 2])
    known = np.flatnonzero(np.isfinite(expected))
    step = float(expected[known].max()) / train.LARGEST or 1.0
    x, block, _ = lesson.points
    points = Points(x[known], block[known], expected[known] / np.float32(step))
    values = np.full(blocks * int(np.prod(lattice.nodes)), points.aim.mean(), np.float32)
    course = Course(STEPS_LENGTHS, RATE, train.SQUARES, train.SQUARES, 0.0)
    values = train.descend(values, points, lattice, course, rng)
    return np.rint(values).astype(np.float32), step


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
        settle(lesson, lattice, values, 3, ROUNDS, FURTHER)
    return lattice, values, {name: job.result() for name, job in jobs.items()}


def settle(
    lesson: Lesson,
    lattice: Lattice,
    values: Singles,
    seed: int,
    rounds: int,
    least: float,
    wrong: Sequence[Sample] = (),
) -> None:
    """Lower codes in place, round after round, until at most `FEW` points are falsely safe.

    Points that tip go to `least` below STANDS.
    The points of a round are fresh ones, and those to which a search climbs from the worst of them,
    of the round before and of those that were `wrong`: windows of a posture are narrow and long.
    """
    reader, near = _reader(lesson, lattice, values), wrong
    for turn in range(rounds):
        own = 1000 * seed + turn
        fresh = uniform(reader.model, ANYWHERE, own), biased(reader.model, BESIDE, own)
        seen = [reader.measure(one) for one in (*fresh, *near)]
        begin = starts(seen, (clearance,), STARTS)
        peaks = climb(reader, begin, clearance, CLIMBED, own, STEP)
        near = [Sample(peaks.params, peaks.gravity[:, None])]
        seen.append(reader.measure(near[0]))
        for one in seen:
            tips = (one.exact.tip_angle < 0.0).ravel()
            x, block, _ = _entered(lesson, *one.sample)
            falling = Points(x[tips], block[tips], np.zeros(tips.sum(), np.float32))
            train.lower(values, falling, lattice, True, least)
        if sum(int(one.false_safe.sum()) for one in seen) <= FEW:
            break


def _reader(lesson: Lesson, lattice: Lattice, values: Singles) -> Reader:
    """Return what reads codes as they are now; below `STANDS` it says by how much."""

    def read(params: NDArray[Any], gravity: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        points = _entered(lesson, params.astype(np.float64), gravity[:, None].astype(np.float64))
        code = train.read(values, points, lattice)
        angle = np.arcsin((code - train.STANDS) / train.SCALE)
        return np.where(code < train.STANDS, TIPS, 0), np.stack([angle] * 3, axis=1)

    return Reader(lesson.ground.model, read)


def _entered(lesson: Lesson, params: Floats, gravity: Floats) -> Points:
    """Return the points of directions (m, d, 3) of postures (m, k), with no code wanted there."""
    ground = lesson.ground
    place, face = ground.enter(ground.places_of(params), gravity)
    on = on_chart(ground.model, gravity)
    block = np.where(on, lesson.block[face], -1).astype(np.int8).ravel()
    place = place.reshape(-1, place.shape[2])
    return Points(place, block, place[:, 0])
