"""Choose where an export is measured: postures of the box and directions of the chart.

`uniform` stands for the configurations that a robot meets; `biased` goes where tables err most:
faces, edges and corners of the box, the rim of the chart, the middles of a table's cells, and both
sides of the tip-over boundary.  The same seed gives the same points.
"""

import itertools
import math
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from firmware_export.truth.crossing import unit
from firmware_export.truth.model import Model
from firmware_export.truth.tip_boundary import beside_boundary
from lutgen.vector import Floats

# Directions per posture: exact evaluation costs by the posture where facets have to be searched.
FEW, MANY = 10, 40
# Parts of a sample, each with random numbers of its own: the same points for any number of cores.
PARTS = 2


class Sample(NamedTuple):
    """Points: m postures `params` (m, k) under `gravity` (m, d, 3), unit vectors on the chart."""

    params: Floats
    gravity: Floats

    @property
    def points(self) -> int:
        """Number of points, m d."""
        return int(self.gravity.shape[0] * self.gravity.shape[1])


# Knots (n,) of a table along each parameter, normalised to 0..1.
Cells = tuple[Floats, ...]


def per_posture(model: Model) -> int:
    """Return how many directions each posture should be given."""
    return FEW if model.is_tripod else MANY


def join(samples: Sequence[Sample]) -> Sample:
    """Return the points of several samples with equally many directions per posture."""
    return Sample(
        np.concatenate([sample.params for sample in samples]),
        np.concatenate([sample.gravity for sample in samples]),
    )


def _spread(rng: np.random.Generator, count: int, dimensions: int) -> Floats:
    """Return points (count, dimensions) spread over the unit cube: a randomly shifted lattice.

    Its generator is the generalised golden ratio, the root of x^(n + 1) = x + 1, whose powers
    leave small gaps for any number of points.
    """
    if dimensions == 0:
        return np.zeros((count, 0))
    ratio = 2.0
    for _ in range(60):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    steps = ratio ** -np.arange(1.0, dimensions + 1)
    index = np.arange(count, dtype=np.float64)[:, None]
    return np.asarray((rng.random(dimensions) + index * steps) % 1.0)


def to_box(model: Model, t: Floats) -> Floats:
    """Turn normalised parameters into the recipe's; the ends are met exactly."""
    return np.asarray(np.where(t >= 1.0, model.upper, model.at(t)))


def uniform_directions(model: Model, rng: np.random.Generator, shape: tuple[int, ...]) -> Floats:
    """Return directions (*shape, 3), uniform in solid angle over the chart.

    The solid angle of a rectangle seen from distance 1 has a closed form, whose inverse gives u
    from one uniform number and v from another.
    """
    limit = model.chart_limit
    whole = math.atan(limit * limit / math.sqrt(1.0 + 2.0 * limit * limit))
    tangent = np.tan(whole * rng.uniform(-1.0, 1.0, shape))
    u = tangent * np.sqrt((1.0 + limit * limit) / (limit * limit - tangent * tangent))
    sine = rng.uniform(-1.0, 1.0, shape) * limit / np.sqrt(1.0 + u * u + limit * limit)
    v = sine * np.sqrt((1.0 + u * u) / (1.0 - sine * sine))
    face = rng.integers(0, model.faces, shape)
    return unit(model.uv_to_gravity(face, np.clip(u, -limit, limit), np.clip(v, -limit, limit)))


def uniform_params(model: Model, rng: np.random.Generator, count: int) -> Floats:
    """Return postures (count, k), uniform in the parameters; the first of more are the same."""
    return to_box(model, _spread(rng, count, model.k))


def uniform(model: Model, points: int, seed: int) -> Sample:
    """Return at least `points` points, uniform in the parameters and in solid angle."""
    rng = np.random.default_rng(seed)
    d = per_posture(model)
    m = -(-points // d)
    return Sample(uniform_params(model, rng, m), uniform_directions(model, rng, (m, d)))


def _middles(knots: Floats, rng: np.random.Generator, count: int) -> Floats:
    """Return middles of random cells, and a third of the time a random knot instead."""
    cell = rng.integers(0, len(knots) - 1, count)
    middle = 0.5 * (knots[cell] + knots[cell + 1])
    return np.asarray(np.where(rng.random(count) < 1 / 3, rng.choice(knots, count), middle))


def _biased_params(model: Model, rng: np.random.Generator, m: int, cells: Cells | None) -> Floats:
    """Return postures (m, k): a half on faces, edges and corners of the box or within a hair.

    The other half lies on the middles and knots of the table's cells, or anywhere.
    """
    t = _spread(rng, m, model.k)
    side = rng.integers(0, 2, t.shape).astype(np.float64)
    # How many coordinates are at an end: each number from 1 to k is as frequent.
    share = rng.integers(1, model.k + 1, (m, 1)) / model.k if model.k else np.zeros((m, 1))
    hair = np.where(rng.random(t.shape) < 0.7, 0.0, 10.0 ** rng.uniform(-6.0, -2.0, t.shape))
    ends = np.where(rng.random(t.shape) < share, np.abs(side - hair), t)
    for column, knots in enumerate(cells or ()):
        t[:, column] = _middles(knots, rng, m)
    return to_box(model, np.where(np.arange(m)[:, None] % 2 == 0, ends, t))


def _rim_directions(
    model: Model, rng: np.random.Generator, shape: tuple[int, int], cells: Cells | None
) -> Floats:
    """Return directions on the rim of the chart (or the seams of its faces), or of cells."""
    limit = model.chart_limit
    u, v = rng.uniform(-limit, limit, (2, *shape))
    kind = rng.integers(0, 3, shape)
    if cells is not None:
        rim = np.array([-limit, limit])
        middles = [_middles(rim, rng, u.size).reshape(shape) for _ in range(2)]
        u, v = np.where(kind == 2, middles, (u, v))
    u = np.where(kind != 2, np.copysign(limit, u), u)
    v = np.where(kind == 1, np.copysign(limit, v), v)
    swap = rng.random(shape) < 0.5
    u, v = np.where(swap, v, u), np.where(swap, u, v)
    return unit(model.uv_to_gravity(rng.integers(0, model.faces, shape), u, v))


def biased(model: Model, points: int, seed: int, cells: Cells | None = None) -> Sample:
    """Return at least `points` points where tables err most.

    Of each posture's directions three in four are beside the tip-over boundary, the others on the
    rim of the chart or on the middles of the table's cells.
    """
    m = -(-points // per_posture(model))
    cuts = [m * part // PARTS for part in range(PARTS + 1)]
    with ThreadPoolExecutor(PARTS) as pool:
        jobs = [
            pool.submit(_biased_part, model, after - before, [seed, 1, part], cells)
            for part, (before, after) in enumerate(itertools.pairwise(cuts))
            if before < after
        ]
        return join([job.result() for job in jobs])


def _biased_part(model: Model, m: int, seed: list[int], cells: Cells | None) -> Sample:
    """Return m postures of `biased`."""
    rng = np.random.default_rng(seed)
    d = per_posture(model)
    params = _biased_params(model, rng, m, cells)
    gravity = uniform_directions(model, rng, (m, d))
    rims = -(-d // 4)
    gravity[:, :rims] = _rim_directions(model, rng, (m, rims), cells)
    gravity[:, rims:] = beside_boundary(model, rng, params, gravity, d - rims)
    return Sample(params, gravity)
