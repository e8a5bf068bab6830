"""Random queries for comparing C and twin: inside, outside, edges, and what is no number."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.model import Model

# Zeros of both signs, what is no number, denormals, huge, and plain values.
ODD = (0.0, -0.0, np.nan, np.inf, -np.inf, 1e-42, -1e-42, 3e38, -3e38, 1.0, -1.0)


def random_queries(
    model: Model, count: int, seed: int = 7
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Return params (count, k) and gravity (count, 3), of which four tenths are odd in some way."""
    rng = np.random.default_rng(seed)
    span = model.upper - model.lower
    params = model.lower + span * rng.uniform(-0.05, 1.05, (count, model.k))
    u, v = rng.uniform(-1.05, 1.05, (2, count)) * model.chart_limit
    gravity = model.uv_to_gravity(rng.integers(0, model.faces, count), u, v)
    gravity *= 10.0 ** rng.uniform(-3.0, 3.0, (count, 1))
    some = count // 10

    def rows() -> NDArray[np.int64]:
        return rng.integers(0, count, some)

    params, gravity = params.astype(np.float32), gravity.astype(np.float32)
    gravity[rows()] = rng.choice(ODD, (some, 3))
    gravity[rows()] = rng.integers(-1, 2, (some, 3))  # axes, diagonals and seams, and no gravity
    if model.k:
        params[rows(), rng.integers(0, model.k, some)] = rng.choice(ODD, some)
        ends = np.stack([model.lower, (model.lower + model.upper) / 2.0, model.upper])
        params[rows()] = ends[rng.integers(0, 3, (some, model.k)), np.arange(model.k)]
    return params, gravity


def integer_queries(
    model: Model, count: int, seed: int = 7
) -> tuple[NDArray[np.int16], NDArray[np.int16]]:
    """Return params_q (count, k) and gravity_q (count, 3) of all sizes, zero and the extremes."""
    rng = np.random.default_rng(seed)
    params = rng.integers(-3000, 32768, (count, model.k))
    u, v = rng.uniform(-1.05, 1.05, (2, count)) * model.chart_limit
    gravity = model.uv_to_gravity(rng.integers(0, model.faces, count), u, v)
    gravity *= (2.0 ** rng.uniform(0.0, 15.0, count) / np.abs(gravity).max(axis=1))[:, None]
    gravity = np.clip(np.rint(gravity), -32768, 32767).astype(np.int64)
    some = count // 10
    gravity[rng.integers(0, count, some)] = rng.choice([-32768, -32767, -1, 0, 1, 32767], (some, 3))
    if model.k:
        ends = [-32768, -1, 0, 1, 16384, 32766, 32767]
        params[rng.integers(0, count, some)] = rng.choice(ends, (some, model.k))
    return params.astype(np.int16), gravity.astype(np.int16)
