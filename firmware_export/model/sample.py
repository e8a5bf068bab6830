"""Choose where an export is measured: postures of the box and directions of the chart.

`uniform` stands for the configurations that a robot meets; `biased` goes where tables err most:
faces, edges and corners of the box, the rim of the chart, the middles of a table's cells, and both
sides of the tip-over boundary.  The same seed gives the same points.
"""

import itertools
import math
from concurrent.futures import ThreadPoolExecutor
from typing import NamedTuple

import numpy as np

from firmware_export.model.crossing import cross_boundary, unit
from firmware_export.model.exact import Model
from lutgen.arrays import Bools, Floats

# A direction of the rim comes back from its unit vector within a few 1e-16.
ROUNDING = 1e-12
# Directions that are added at a time where a posture's own may all be alike.
POOL = 12
# Decades (rad) of the distance to the boundary: float32 resolves 1e-7.
NEAREST, FARTHEST = -7.0, -1.0


def on_chart(model: Model, gravity: Floats) -> Bools:
    """Return True for directions (..., 3) that the chart covers."""
    if model.faces == 6:
        return np.ones(gravity.shape[:-1], np.bool_)
    reach = np.abs(gravity[..., :2]).max(axis=-1)
    rim = model.chart_limit * (1.0 + ROUNDING)
    return np.asarray((gravity[..., 2] < 0.0) & (reach <= -gravity[..., 2] * rim))


def _wider(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats
) -> tuple[Floats, Floats]:
    """Return the directions (m, d, 3) and 3 POOL more, drawn where a posture may stand.

    Only postures whose directions all stand or all tip need more: first round about, then, twice,
    round the direction that is nearest to standing, no further away than the region can be.  The
    others get that direction again.  With them their tip angles.
    """
    m = np.arange(len(params))
    shown, tip = gravity, model.tip_angle(model.postures(params), gravity)
    for turn in range(3):
        at = tip.argmax(axis=1)
        new = np.repeat(shown[m, at][:, None], POOL, axis=1)
        angle = np.repeat(tip[m, at][:, None], POOL, axis=1)
        stands = (tip >= 0.0).sum(axis=1)
        rows = np.flatnonzero((stands == 0) | (stands == tip.shape[1]))
        if len(rows):
            here = tip[rows]
            reach = np.abs(here).max(axis=1) if turn == 0 else np.abs(here.max(axis=1))
            tried = rng.normal(size=(len(rows), POOL, 3)) * reach[:, None, None]
            tried = unit(new[rows] + tried)
            # Off the chart a direction is no use; the one that it was to improve is.
            new[rows] = np.where(on_chart(model, tried)[..., None], tried, new[rows])
            angle[rows] = model.tip_angle(model.postures(params[rows]), new[rows])
        shown = np.concatenate([shown, new], axis=1)
        tip = np.concatenate([tip, angle], axis=1)
    return shown, tip


def arcs(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats
) -> tuple[Floats, Floats, Bools]:
    """Pair directions of each posture: one that stands with one that tips.

    Returns the ends (m, d, 3) of as many arcs as there are directions, each of which is one of
    them if the posture has any of the other verdict, the standing ones first; and if (m, d)
    directions of both kinds were found on the chart.
    """
    pool, tip = _wider(model, rng, params, gravity)
    stands = tip >= 0.0
    m, d = gravity.shape[:2]
    row, turn = np.arange(m)[:, None], np.arange(d)[None, :]
    key = rng.random(stands.shape)
    count = stands.sum(axis=1, keepdims=True)
    other = []
    for kind, number in ((stands, count), (~stands, stands.shape[1] - count)):
        # All of a kind, shuffled, in front.
        order = np.argsort(np.where(kind, key, 2.0), axis=1)
        pick = np.take_along_axis(order, turn % np.maximum(number, 1), axis=1)
        other.append(pool[row, pick])
    own = stands[:, :d, None]
    inside = np.where(own, gravity, other[0])
    outside = np.where(own, other[1], gravity)
    opposite = (inside * outside).sum(axis=-1) < -0.999
    both = (count > 0) & (count < stands.shape[1])
    return inside, outside, np.broadcast_to(both, opposite.shape) & ~opposite


def beside_boundary(
    model: Model, rng: np.random.Generator, params: Floats, gravity: Floats, count: int
) -> Floats:
    """Return directions (m, count, 3) close to the tip-over boundary: pairs, one on each side.

    A crossing takes longer to find than two pairs to measure.  The crossings are on arcs from the
    last of the directions (m, d, 3), which are returned as they are where a posture's directions
    all stand or all tip.
    """
    part = -(-count // 4)
    ins, outs, both = arcs(model, rng, params, gravity)
    inside, outside, given = (one[:, -part:] for one in (ins, outs, gravity))
    found = np.asarray(both[:, -part:, None])
    ends = cross_boundary(model, params, inside, np.where(found, outside, inside))
    along = outside - inside
    along -= (along * ends[0]).sum(axis=-1, keepdims=True) * ends[0]
    length = np.sqrt((along * along).sum(axis=-1, keepdims=True))
    along /= np.where(length > 0.0, length, 1.0)
    sides = []
    for sign, end in 2 * list(zip((-1.0, 1.0), ends, strict=True)):
        near = unit(end + sign * 10.0 ** rng.uniform(NEAREST, FARTHEST, found.shape) * along)
        good = found & on_chart(model, near)[..., None]
        sides.append(np.where(good, near, np.where(found, ends[0], given)))
    return np.concatenate(sides, axis=1)[:, :count]


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
    """Return postures (m, k): a half on faces, edges and corners of the box or just inside.

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

    Three in four of each posture's directions are beside the tip-over boundary, the others on the
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
        params, gravity = zip(*(job.result() for job in jobs), strict=True)
    return Sample(np.concatenate(params), np.concatenate(gravity))


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
