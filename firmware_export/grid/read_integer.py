"""Reads the codec `grid` without floats, as `smap_read_i` in smap.c does, number by number.

Owns the whole integer path: clamping, chart, cells and the guard.  Every rounding lowers the tip
angle: fractions of cells and merged values are rounded down, the length of gravity up.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.tables import Tables, U
from firmware_export.twin import njit, prange

INVALID, OK, CLAMPED, TIPS, OFF_CHART = -1, 0, 1, 2, 3
# Entries of a part's numbers.
STRIDE, WIDTH, ZERO, ZERO_ASIDE, GAIN, SHIFT, BITS = 0, 1, 2, 3, 4, 5, 6
ABSENT = 65535

Ints = NDArray[np.int64]


@njit()
def whole_root(x: int) -> int:
    """Return the square root of a 32-bit number, rounded down."""
    result = 0
    digit = 1 << 30
    while digit:
        if x >= result + digit:
            x -= result + digit
            result = (result >> 1) + digit
        else:
            result >>= 1
        digit >>= 2
    return result


@njit()
def _value(
    codes: NDArray[Any],
    axes: NDArray[np.uint16],
    knots: NDArray[np.uint16],
    numbers: Ints,
    place: Ints,
    params: int,
    face: int,
    component: int,
) -> int:
    """Interpolate one component, in 1/65536 of the codes' range, rounded down."""
    dims = len(axes)
    frac = np.empty(dims + 1, np.int64)
    below = np.empty(dims + 1, np.int64)
    jump = np.empty(dims + 1, np.int64)
    at = face * numbers[STRIDE] + component
    stride = numbers[WIDTH]
    back = 0
    for i in range(dims):
        coordinate, nodes, begin = np.int64(axes[i, 0]), np.int64(axes[i, 1]), np.int64(axes[i, 2])
        x = place[params + coordinate - U if coordinate >= U else coordinate]
        lower, upper = np.int64(0), nodes - np.int64(1)
        while upper - lower > 1:
            middle = (lower + upper) >> 1
            if x >= np.int64(knots[begin + middle]):
                lower = middle
            else:
                upper = middle
        low = np.int64(knots[begin + lower])
        frac[i] = ((x - low) << 14) // (np.int64(knots[begin + upper]) - low)
        at += lower * stride
        jump[i] = stride - back
        back += stride
        stride *= nodes
    corner = 0
    while True:
        value = np.int64(codes[at]) << (16 - numbers[BITS])
        level = 0
        while (corner >> level) & 1:
            value = (below[level] * (16384 - frac[level]) + value * frac[level]) >> 14
            level += 1
        if level == dims:
            return int(value)
        below[level] = value
        at += jump[level]
        corner += 1


@njit(parallel=True)
def _interpolate(
    codes: NDArray[Any],
    axes: NDArray[np.uint16],
    knots: NDArray[np.uint16],
    numbers: Ints,
    place: Ints,
    params: int,
    face: Ints,
) -> Ints:
    out = np.empty((len(place), numbers[WIDTH]), np.int64)
    for m in prange(len(place)):
        for w in range(numbers[WIDTH]):
            out[m, w] = _value(codes, axes, knots, numbers, place[m], params, face[m], w)
    return out


@njit()
def _locate(
    gravity: Ints, faces: int, limit: int, place: Ints, face: Ints, cosine: Ints, status: Ints
) -> None:
    """Fill the place on the chart (m, 2), the face, and depth over length in 1/16384."""
    for m in range(len(gravity)):
        size = np.abs(gravity[m])
        largest = size.max()
        if largest == 0:
            status[m] = INVALID
            continue
        while largest < 16384:
            largest <<= 1
            size <<= 1
        face[m], normal = 0, 2
        if faces == 6:
            most = size[2] if gravity[m, 2] < 0 else 0
            for i in range(1, 6):
                axis = 2 if i == 5 else (i - 1) >> 1
                if size[axis] > most and ((i & 1) != 0) == (gravity[m, axis] > 0):
                    most = size[axis]
                    face[m], normal = i, axis
        elif gravity[m, 2] >= 0:
            status[m] = OFF_CHART
            continue
        deep = size[normal] * limit >> 13
        if deep == 0:
            status[m] = OFF_CHART
            continue
        for i in range(2):
            axis = (1 if normal == 0 else 0) if i == 0 else (1 if normal == 2 else 2)
            if size[axis] > deep:
                if size[axis] > deep + 1:
                    status[m] = OFF_CHART
                    break
                size[axis] = deep
            away = min((size[axis] << 15) // deep, 32767)
            place[m, i] = 32767 - away if gravity[m, axis] < 0 else 32767 + away
        length = whole_root(size[0] * size[0] + size[1] * size[1] + size[2] * size[2]) + 1
        cosine[m] = (size[normal] << 14) // length


def read_i(
    tables: Tables, params_q: NDArray[np.int16], gravity_q: NDArray[np.int16], faces: int
) -> tuple[NDArray[np.int8], Ints]:
    """Read m queries as `smap_read_i` does.

    Parameters
    ----------
    tables : Tables
        From `grid.encode`.
    params_q : (m, k) int16
        0 is an axis's lower end, 32767 its upper end.
    gravity_q : (m, 3) int16
        Down, any length.
    faces : int
        Faces of the chart, 1 or 6.

    Returns
    -------
    status : (m,) int8
        A `smap_status_t`.
    reading : (m, 3) int64
        sdg, tip and height of `smap_reading_i_t`.
    """
    params = np.asarray(params_q, np.int64)
    gravity = np.asarray(gravity_q, np.int64)
    m, k = params.shape
    status = np.where((params < 0).any(axis=1), CLAMPED, OK)
    place = np.zeros((m, k + 2), np.int64)
    place[:, :k] = 2 * np.maximum(params, 0)
    face, cosine = np.zeros(m, np.int64), np.zeros(m, np.int64)
    uv = np.zeros((m, 2), np.int64)
    _locate(gravity, faces, tables.limit_q, uv, face, cosine, status)
    place[:, k:] = uv
    held = (status == OK) | (status == CLAMPED)
    reading = np.full((m, 3), ABSENT, np.int64)
    reading[:, 1] = -32767
    knots, axes = tables.shared_knots()
    for part, axis in zip(tables.parts, axes, strict=True):
        (zero, zero_aside), (gain, shift) = part.zero, part.gain
        numbers = np.array(
            [part.face_stride, part.width, zero, zero_aside, gain, shift, part.bits], np.int64
        )
        value = _interpolate(part.codes.reshape(-1), axis, knots, numbers, place, k, face)
        if part.name == "tip":
            size = np.abs(value[:, 0] - zero) * cosine >> 14
            sine = size * gain >> shift
            safe = held & (value[:, 0] >= zero)
            above = np.minimum(sine, 32767) - tables.guard_q
            below = -1 - np.minimum(sine, 32767)
            reading[:, 1] = np.where(held, np.where(safe, above, below), reading[:, 1])
            status = np.where(held & (reading[:, 1] < 0), TIPS, status)
            held = held & (reading[:, 1] >= 0)
        elif part.name == "sdg":
            along = np.trunc((value[:, 0] - zero) / 2).astype(np.int64)
            aside = np.trunc((value[:, 1] - zero_aside) / 2).astype(np.int64)
            reading[:, 0] = np.where(held, _roots(along * along + aside * aside), ABSENT)
        else:
            reading[:, 2] = np.where(held, zero + (value[:, 0] * gain >> shift), ABSENT)
    return status.astype(np.int8), reading


@njit()
def _roots(x: Ints) -> Ints:
    out = np.empty_like(x)
    for m in range(len(x)):
        out[m] = whole_root(x[m])
    return out
