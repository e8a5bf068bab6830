"""Node values of the codec `grid` for the stability factor and the height: fitted, not sampled.

Owns the fit.  It sees the standing region only.  The error that counts is that of the length of
(along, aside), so the two components are free to turn a little: each round solves the linearised
least-squares problem (conjugate gradients, the exact values at the nodes as prior) with the errors
across the vector weighted down, then gives every point a weight that grows with its error
(Lawson), which leads to the minimax fit.  After some rounds the points of a larger pool that are
worst join the sample.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.lattice import Lattice, at_nodes, at_points, from_places, to_places
from firmware_export.truth import Model, Sample, biased, join, uniform
from lutgen.vector import Floats

Ints = NDArray[np.int32]

SEED = 41
# Postures cost by the number of facets to be searched: points of the sample, of the pool, and
# how many of the pool join after each turn.
POINTS, POOL, JOINING = 60_000, 600_000, 8_000
FEW_POINTS, FEW_POOL = 40_000, 200_000
TURNS, ROUNDS, STEPS = 4, 7, 25
# Share of the error across the vector that counts, and of the prior in each node.
ACROSS, PRIOR = 0.1, 1e-3
# Nodes beyond the standing region hold at most this many times the largest value.
CLIP = 1.25


def _standing(model: Model, sample: Sample, name: str) -> tuple[Floats, NDArray[np.int64], Floats]:
    """Return places, faces and values (m, w) of the points that stand."""
    exact = model.exact(sample.params, sample.gravity)
    stands = ~np.isnan(exact.sdg).ravel()
    place, face = to_places(model, sample)
    columns = [exact.height] if name == "height" else [exact.along, exact.aside]
    value = np.stack([column.ravel() for column in columns], axis=1)
    return place[stands], face[stands], value[stands]


def _prior(lattice: Lattice, name: str, largest: float) -> Floats:
    """Return the exact values at the nodes, continued and clipped beyond the standing region."""
    model = lattice.model
    exact = model.exact(*from_places(model, *lattice.places()))
    columns = [exact.height_beyond] if name == "height" else [exact.along, exact.aside]
    value = np.concatenate(columns, axis=1)
    shape = (lattice.faces, *lattice.shape)
    while np.isnan(value).any() and not np.isnan(value).all():
        # Nodes whose direction pierces no facet's plane take the mean of their neighbours.
        total, known = np.zeros_like(value), np.zeros((len(value), 1))
        grid = value.reshape(*shape, -1)
        for axis, count in list(enumerate(shape))[1:]:
            rim = [(int(at == axis),) * 2 for at in range(grid.ndim)]
            padded = np.pad(grid, rim, constant_values=np.nan)
            for first in (0, 2):
                moved = np.take(padded, range(first, first + count), axis)
                here = moved.reshape(value.shape)
                there = ~np.isnan(here).any(axis=1, keepdims=True)
                total += np.where(there, here, 0.0)
                known += there
        fill = np.isnan(value).any(axis=1, keepdims=True) & (known > 0)
        if not fill.any():
            break
        value = np.where(fill, total / np.maximum(known, 1.0), value)
    value = np.nan_to_num(value)
    length = np.sqrt((value * value).sum(axis=1, keepdims=True))
    return np.asarray(value * np.minimum(1.0, CLIP * largest / np.maximum(length, 1e-300)))


def conjugate(
    right: Floats, scale: Floats, image: Callable[[Floats], Floats], steps: int
) -> Floats:
    """Return what `image` turns into `right`, nearly: least squares by conjugate gradients.

    `scale` is the diagonal of `image`, which is linear, symmetric and positive.
    """
    change = np.zeros_like(right)
    left = right.copy()
    way = step = left / scale
    product = float((left * step).sum())
    for _ in range(steps):
        turned = image(way)
        curvature = float((way * turned).sum())
        if curvature <= 0.0 or product <= 0.0:
            break
        change += product / curvature * way
        left -= product / curvature * turned
        step = left / scale
        before, product = product, float((left * step).sum())
        way = step + product / before * way
    return change


def solve(
    at: tuple[Ints, Floats, NDArray[np.int64]],
    way: Floats,
    importance: Floats,
    residual: Floats,
    pull: Floats,
    prior: float,
) -> Floats:
    """Return the change of the nodes: weighted least squares along `way`, weaker across it.

    `at`: index, weight and first node of each point, see `Lattice.find`.
    """
    (index, weight, start), count = at, len(pull)

    def counted(value: Floats) -> Floats:
        along = (value * way).sum(axis=1, keepdims=True) * way
        return np.asarray(importance[:, None] * (along + ACROSS**2 * (value - along)))

    right = at_nodes(index, weight, residual, start, count) - prior * pull
    ones = np.ones((1, right.shape[1]))
    scale = at_nodes(index, weight * weight, importance[:, None] * ones, start, count) + prior

    def image(change: Floats) -> Floats:
        value = counted(at_points(index, weight, change, start))
        return at_nodes(index, weight, value, start, count) + prior * change

    return conjugate(right, scale, image, STEPS)


def fit(model: Model, lattice: Lattice, name: str) -> Floats:
    """Return the nodes (faces n..., w) of ``sdg`` (along, aside) or ``height``."""
    points, pool = (POINTS, POOL) if model.is_tripod else (FEW_POINTS, FEW_POOL)
    place, face, value = _cached(model, name, points, SEED)
    pool_place, pool_face, pool_value = _cached(model, name, pool, SEED + 1)
    length = np.sqrt((value * value).sum(axis=1))
    exact = _prior(lattice, name, float(length.max(initial=0.0)))
    if not len(value):
        return exact
    node = exact.copy()
    best, lowest = node, np.inf
    pool_at = lattice.find(pool_place, pool_face)
    pool_length = np.sqrt((pool_value * pool_value).sum(axis=1))
    for turn in range(TURNS):
        index, weight, start = lattice.find(place, face)
        length = np.sqrt((value * value).sum(axis=1))
        prior = PRIOR * len(value) / len(node)
        importance = np.ones(len(value))
        inner, inner_error = node, np.inf
        for _ in range(ROUNDS if turn else 3):
            here = at_points(index, weight, node, start)
            size = np.sqrt((here * here).sum(axis=1))
            way = here / np.maximum(size, 1e-12 * length.max() + 1e-300)[:, None]
            miss = value - here
            across = miss - (miss * way).sum(axis=1, keepdims=True) * way
            wanted = (length - size)[:, None] * way + ACROSS**2 * across
            node = node + solve(
                (index, weight, start),
                way,
                importance,
                importance[:, None] * wanted,
                node - exact,
                prior,
            )
            here = at_points(index, weight, node, start)
            error = np.abs(np.sqrt((here * here).sum(axis=1)) - length)
            if error.max() < inner_error:
                inner, inner_error = node, float(error.max())
            importance *= 0.05 + error / max(float(error.max()), 1e-300)
            importance /= importance.mean()
        node = inner
        here = at_points(*pool_at[:2], node, pool_at[2])
        error = np.abs(np.sqrt((here * here).sum(axis=1)) - pool_length)
        if error.max(initial=0.0) < lowest:
            best, lowest = node, float(error.max(initial=0.0))
        worst = np.argsort(error, kind="stable")[-JOINING:]
        place, face, value = (
            np.concatenate([mine, theirs[worst]])
            for mine, theirs in ((place, pool_place), (face, pool_face), (value, pool_value))
        )
    return best


@lru_cache(maxsize=8)
def _cached(
    model: Model, name: str, points: int, seed: int
) -> tuple[Floats, NDArray[np.int64], Floats]:
    """Return `_standing` of a sample: half of it uniform, half where tables err most."""
    sample = join([uniform(model, points // 2, seed), biased(model, points // 2, seed)])
    return _standing(model, sample, name)


def quantise(node: Floats, bits: int) -> tuple[NDArray[Any], list[float], float]:
    """Return codes, the offsets of the components and the step that they share."""
    lowest = node.min(axis=0)
    span = float((node.max(axis=0) - lowest).max())
    # Codes are read as offset + step * code in float32: keep the step's rounding out of range.
    step = float(np.float32(span / (2**bits - 1) * (1.0 + 1e-6))) or 1.0
    offset = np.float32(lowest).astype(np.float64)
    codes = np.clip(np.rint((node - offset) / step), 0, 2**bits - 1)
    return (
        codes.astype(np.uint8 if bits == 8 else np.uint16),
        list(map(float, np.atleast_1d(offset))),
        step,
    )
