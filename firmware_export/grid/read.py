"""Reads the codec `grid` as the C runtime does, bit for bit (`grid_read` in smap.c).

Owns the single-precision twin.  A corner of the cell is reached from the one before by one jump and
merged at once, innermost axis first; a + (b - a) f with f = 0 or 1 returns the node.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.tables import Tables, U
from firmware_export.twin import F1, arcsine, njit, prange, root

SINGLE = NDArray[np.float32]
MIDDLE, WHOLE = np.float32(32767.0), np.float32(65534.0)


@njit()
def _value(
    codes: NDArray[Any],
    axes: NDArray[np.uint16],
    knots: NDArray[np.uint16],
    first: int,
    width: int,
    half: np.float32,
    t: SINGLE,
    u: np.float32,
    v: np.float32,
    component: int,
) -> np.float32:
    """Interpolate one component; `first` is the index of the face's first code."""
    dims = len(axes)
    frac = np.empty(dims + 1, np.float32)
    below = np.empty(dims + 1, np.float32)
    jump = np.empty(dims + 1, np.int64)
    at, stride, back = np.int64(first + component), np.int64(width), np.int64(0)
    for i in range(dims):
        coordinate, nodes, begin = np.int64(axes[i, 0]), np.int64(axes[i, 1]), np.int64(axes[i, 2])
        if coordinate >= U:
            x = (u if coordinate == U else v) * half + MIDDLE
        else:
            x = t[coordinate] * WHOLE
        lower, upper = np.int64(0), nodes - np.int64(1)
        while upper - lower > 1:
            middle = (lower + upper) >> 1
            if x >= np.float32(knots[begin + middle]):
                lower = middle
            else:
                upper = middle
        width_of = np.float32(np.int64(knots[begin + upper]) - np.int64(knots[begin + lower]))
        frac[i] = (x - np.float32(knots[begin + lower])) / width_of
        at += lower * stride
        jump[i] = stride - back
        back += stride
        stride *= nodes
    corner = 0
    while True:
        value = np.float32(codes[at])
        level = 0
        while (corner >> level) & 1:
            value = below[level] + (value - below[level]) * frac[level]
            level += 1
        if level == dims:
            return value
        below[level] = value
        at += jump[level]
        corner += 1


@njit(parallel=True)
def interpolate(
    codes: NDArray[Any],
    axes: NDArray[np.uint16],
    knots: NDArray[np.uint16],
    face_stride: int,
    width: int,
    half: np.float32,
    t: SINGLE,
    face: NDArray[np.uint8],
    u: SINGLE,
    v: SINGLE,
) -> SINGLE:
    """Return the codes (m, width), not yet scaled, at m places."""
    out = np.empty((len(u), width), np.float32)
    for m in prange(len(u)):
        for w in range(width):
            first = int(face[m]) * face_stride
            out[m, w] = _value(codes, axes, knots, first, width, half, t[m], u[m], v[m], w)
    return out


@njit()
def _angle(mu: SINGLE, u: SINGLE, v: SINGLE) -> SINGLE:
    out = np.empty_like(mu)
    for m in range(len(mu)):
        out[m] = arcsine(mu[m] / root(F1 + u[m] * u[m] + v[m] * v[m]))
    return out


@njit()
def _length(along: SINGLE, aside: SINGLE) -> SINGLE:
    out = np.empty_like(along)
    for m in range(len(along)):
        out[m] = root(along[m] * along[m] + aside[m] * aside[m])
    return out


def read(tables: Tables, t: SINGLE, face: NDArray[np.uint8], u: SINGLE, v: SINGLE) -> SINGLE:
    """Read m places.

    Parameters
    ----------
    tables : Tables
        From `grid.encode`.
    t : (m, k) float32
        Parameters over their axes, 0 to 1.
    face : (m,) uint8
        Face of the chart.
    u, v : (m,) float32
        Place on the face.

    Returns
    -------
    (m, 3) float32
        sdg, tip angle (rad) before the guard, height; NaN for what is not held.
    """
    out = np.full((len(u), 3), np.nan, np.float32)
    knots, axes = tables.shared_knots()
    for part, axis in zip(tables.parts, axes, strict=True):
        code = interpolate(
            *(part.codes.reshape(-1), axis, knots, part.face_stride, part.width),
            *(tables.half, t, face, u, v),
        )
        value = part.offset[None, : part.width] + part.step * code
        if part.name == "tip":
            out[:, 1] = _angle(np.ascontiguousarray(value[:, 0]), u, v)
        elif part.name == "sdg":
            along, aside = np.ascontiguousarray(value.T)
            out[:, 0] = _length(along, aside)
        else:
            out[:, 2] = value[:, 0]
    return out
