"""The queries of every target: 1,000 for the hash, 256 for the counts.

They are the same in every run: a seeded generator makes them, and queries.bin holds their bits.
A query of an export with floats has the same posture and direction as whole numbers, too.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.certify.answers import device
from firmware_export.host import FULL_SCALE, STANDS
from firmware_export.protocol import Export
from tests.fixtures.queries import integer_queries, random_queries

# How many queries are checked, and how many of them lie beside the boundary, on each side.
CHECKED, BESIDE = 1000, 100
COUNTED, OUTSIDE = 256, 32
SEED = 2018

Numbers = NDArray[Any]


def _directions(export: Export, rng: np.random.Generator, count: int, reach: float) -> Numbers:
    """Return directions (count, 3) spread over the chart, up to `reach` times its limit."""
    model = export.model
    u, v = rng.uniform(-reach, reach, (2, count)) * model.chart_limit
    found: Numbers = model.uv_to_gravity(rng.integers(0, model.faces, count), u, v)
    return found


def _typed(export: Export, t: Numbers, gravity: Numbers) -> tuple[Numbers, Numbers]:
    """Return shares of the axes and directions of any length as the C code takes them."""
    model = export.model
    if export.integer:
        return _whole(t, gravity)
    return model.at(t).astype(np.float32), gravity.astype(np.float32)


def _whole(t: Numbers, gravity: Numbers) -> tuple[Numbers, Numbers]:
    """Return them as whole numbers."""
    params = np.clip(np.rint(t * FULL_SCALE), -32768, 32767).astype(np.int16)
    return params, np.clip(np.rint(gravity), -32768, 32767).astype(np.int16)


def whole(export: Export, params: Numbers, gravity: Numbers) -> tuple[Numbers, Numbers]:
    """Return queries of floats as whole numbers: what is no number becomes an odd one.

    Directions are as long as the largest number that a component can be, half of them shorter.
    """
    if export.integer:
        return params, gravity
    model = export.model
    span = model.upper - model.lower
    with np.errstate(all="ignore"):
        t = (params.astype(np.float64) - model.lower) / span
        down = gravity.astype(np.float64)
        longest = np.abs(down).max(axis=1, keepdims=True)
        lengths = 2.0 ** np.random.default_rng(SEED + 2).uniform(0.0, 30.0, longest.shape)
        down = down / longest * np.minimum(lengths, FULL_SCALE)
    odd = np.where(np.signbit(down), -32768.0, 32767.0)
    return _whole(np.where(np.isfinite(t), t, -1.0), np.where(np.isfinite(down), down, odd))


def _boundary(export: Export, rng: np.random.Generator) -> tuple[Numbers, Numbers]:
    """Return queries on both sides of where the answer changes to and from tipping, next to it.

    Bisects between a direction that stands and one that tips, of the same posture.
    """
    read = device(export).read
    scale = 20_000.0 if export.integer else 1.0
    t = rng.uniform(0.0, 1.0, (40 * BESIDE, export.model.k))
    gravity = _directions(export, rng, len(t), 1.0) * scale
    stands = np.isin(read(*_typed(export, t, gravity))[0], STANDS)
    first, second = np.flatnonzero(stands)[:BESIDE], np.flatnonzero(~stands)[:BESIDE]
    count = min(len(first), len(second))
    first, second = first[:count], second[:count]
    t, good, bad = t[first], gravity[first], gravity[second]
    for _ in range(40):
        middle = (good + bad) / 2.0
        safe = np.isin(read(*_typed(export, t, middle))[0], STANDS)[:, None]
        good, bad = np.where(safe, middle, good), np.where(safe, bad, middle)
    return np.concatenate([t, t]), np.concatenate([good, bad])


def checked(export: Export) -> tuple[Numbers, Numbers]:
    """Return the queries of the hash: params (1000, k) and gravity (1000, 3).

    Eight in ten are drawn anywhere and odd in every way; the last lie beside the boundary.
    """
    draw = integer_queries if export.integer else random_queries
    near = _typed(export, *_boundary(export, np.random.default_rng(SEED)))
    params, gravity = draw(export.model, CHECKED - len(near[0]), SEED)
    return np.concatenate([params, near[0]]), np.concatenate([gravity, near[1]])


def counted(export: Export, count: int = COUNTED, outside: int = OUTSIDE) -> tuple[Any, Any]:
    """Return the queries of the counts: uniform in the box and over the chart.

    The last `outside` reach a tenth beyond the ends of the axes and a fifth beyond the chart.
    """
    rng = np.random.default_rng(SEED + 1)
    t = rng.uniform(0.0, 1.0, (count, export.model.k))
    gravity = _directions(export, rng, count, 1.0)
    if outside:
        t[-outside:] = rng.uniform(-0.1, 1.1, (outside, export.model.k))
        gravity[-outside:] = _directions(export, rng, outside, 1.2)
    gravity *= 1000.0 if export.integer else 9.81
    return _typed(export, t, gravity)


def as_bytes(export: Export, queries: tuple[Numbers, ...], order: str = "<") -> bytes:
    """Return queries row after row, in a byte order, as queries.bin holds them."""
    params, gravity = queries
    down = np.concatenate(whole(export, params, gravity), axis=1).astype(f"{order}i2")
    down = np.pad(down, ((0, 0), (0, down.shape[1] % 2)))
    parts = [down.view(np.uint8)]
    if not export.integer:
        real = np.concatenate([params, gravity], axis=1).astype(f"{order}f4")
        parts.insert(0, real.view(np.uint8))
    return np.concatenate([part.reshape(len(params), -1) for part in parts], axis=1).tobytes()
