"""The queries of every target: 1,000 for the hash, 256 for the counts.

They are the same in every run: a seeded generator makes them, and queries.bin holds their bits.
A query of an export with floats has the same posture and direction as whole numbers, too.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.certify.answers import device
from firmware_export.host import STANDS
from firmware_export.protocol import Export

CHECKED, COUNTED, OUTSIDE = 1000, 256, 32
KIND = CHECKED // 10  # queries of each kind
SEED = 2018
# Zeros of both signs, what is no number, denormals, huge, and plain values.
ODD = (0.0, -0.0, np.nan, np.inf, -np.inf, 1e-42, -1e-42, 3e38, -3e38, 1.0, -1.0)
ODD_WHOLE = (-32768, -32767, -1, 0, 1, 16384, 32766, 32767)
FULL_SCALE = 32767

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
    span = model.upper - model.lower
    return (model.lower + t * span).astype(np.float32), gravity.astype(np.float32)


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


def _lengths(export: Export, rng: np.random.Generator, gravity: Numbers) -> Numbers:
    """Give directions lengths of many sizes."""
    longest = np.abs(gravity).max(axis=1, keepdims=True)
    if export.integer:
        lengths: Numbers = 2.0 ** rng.uniform(0.0, 15.0, (len(gravity), 1))
    else:
        lengths = 10.0 ** rng.uniform(-3.0, 3.0, (len(gravity), 1))
    scaled: Numbers = gravity / longest * lengths
    return scaled


def _boundary(export: Export, rng: np.random.Generator) -> tuple[Numbers, Numbers]:
    """Return queries on both sides of where the answer changes to and from tipping, next to it.

    Bisects between a direction that stands and one that tips, of the same posture.
    """
    read = device(export).read
    scale = 20_000.0 if export.integer else 1.0
    t = rng.uniform(0.0, 1.0, (40 * KIND, export.model.k))
    gravity = _directions(export, rng, len(t), 1.0) * scale
    stands = np.isin(read(*_typed(export, t, gravity))[0], STANDS)
    first, second = np.flatnonzero(stands)[:KIND], np.flatnonzero(~stands)[:KIND]
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

    A hundred of each kind: inside; beyond the ends and the chart; odd numbers as gravity; axes,
    diagonals, seams and no gravity; odd parameters; ends and middles of the axes; the rim of the
    chart; the boundary of tipping (two hundred); lengths from tiny to huge.
    """
    rng = np.random.default_rng(SEED)
    model = export.model
    t = rng.uniform(0.0, 1.0, (CHECKED, model.k))
    gravity = _lengths(export, rng, _directions(export, rng, CHECKED, 1.0))

    def kind(at: int) -> slice:
        return slice(at * KIND, (at + 1) * KIND)

    t[kind(1)] = rng.uniform(-0.05, 1.05, (KIND, model.k))
    gravity[kind(1)] = _lengths(export, rng, _directions(export, rng, KIND, 1.05))
    t[kind(5)] = rng.choice([0.0, 0.5, 1.0], (KIND, model.k))
    gravity[kind(3)] = rng.integers(-1, 2, (KIND, 3)) * (1000.0 if export.integer else 9.81)
    rim = rng.choice([-1.0, 0.0, 1.0], (2, KIND)) * model.chart_limit
    rim *= rng.choice([1.0, 1.0 - 1e-6, 1.0 + 1e-6, 1.0 + 3e-6], (2, KIND))
    gravity[kind(6)] = model.uv_to_gravity(rng.integers(0, model.faces, KIND), *rim)
    gravity[kind(6)] *= 20_000.0 if export.integer else 1.0
    near_t, near = _boundary(export, rng)
    count = min(len(near), 2 * KIND)
    t[7 * KIND : 7 * KIND + count], gravity[7 * KIND : 7 * KIND + count] = (
        near_t[:count],
        near[:count],
    )
    if not export.integer:
        gravity[kind(9)] *= 10.0 ** rng.uniform(-38.0, 30.0, (KIND, 1))
    params, down = _typed(export, t, gravity)
    odd: Any = ODD_WHOLE if export.integer else ODD
    down[kind(2)] = rng.choice(odd, (KIND, 3))
    if model.k:
        rows = np.arange(4 * KIND, 5 * KIND)
        params[rows, rng.integers(0, model.k, KIND)] = rng.choice(odd, KIND)
    return params, down


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
