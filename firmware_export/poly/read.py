"""Twin of `poly_read` (runtime/smap.c): the same operations in the same order, in float32."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.poly.fit import Tables
from firmware_export.twin import F0, F1, PI, njit, prange, read_three
from lutgen.chart import FACE_NORMAL, FACE_SIGN, FACE_U, FACE_V

Singles = NDArray[np.float32]
Bytes = NDArray[np.uint8]
Codes = NDArray[np.int16]

F2 = np.float32(2.0)
ANY_NORMAL = np.float32(-2.0)
NORMAL = np.array(FACE_NORMAL, np.uint8)
FIRST = np.array(FACE_U, np.uint8)
SECOND = np.array(FACE_V, np.uint8)
SIGN = np.array(FACE_SIGN, np.float32)


def read(tables: Tables, t: Singles, face: Bytes, u: Singles, v: Singles) -> Singles:
    """Return the readings (m, 3) of m queries: sdg, tip angle (rad) before the guard, height.

    Parameters
    ----------
    tables : Tables
    t : (m, k) float32
        Parameters over their axes, 0 to 1.
    face : (m,) uint8
    u, v : (m,) float32
    """
    out = np.empty((len(t), 3), np.float32)
    shape = np.ascontiguousarray(tables.shape)
    _read(tables.codes, shape, tables.unit, np.ascontiguousarray(t), face, u, v, out)
    return out


@njit()
def _point(codes: Codes, shape: Bytes, t: Singles, first: int, point: Singles) -> int:
    """Fill `point` with one contact in codes; return the row of the next contact's first code."""
    k = len(t)
    value, before = np.empty(k + 1, np.float32), np.empty(k + 1, np.float32)
    degree = np.zeros(k + 1, np.int64)
    most = total = 0
    for j in range(k):
        value[j] = F1
        before[j] = t[j] + t[j] - F1
        most = max(most, int(shape[j]))
    point[0] = point[1] = point[2] = F0
    for _ in range(shape[k]):
        weight = F1
        for j in range(k):
            weight = weight * value[j]
        for c in range(3):
            point[c] = point[c] + weight * np.float32(codes[first, c])
        first += 1
        for j in range(k):
            s = t[j] + t[j] - F1
            if degree[j] < shape[j] and total < most:
                following = F2 * s * value[j] - before[j]
                before[j] = value[j]
                value[j] = following
                degree[j] += 1
                total += 1
                break
            total -= degree[j]
            degree[j] = 0
            value[j] = F1
            before[j] = s
    return first


@njit(parallel=True)
def _read(
    codes: Codes,
    shape: Bytes,
    unit: np.float32,
    t: Singles,
    face: Bytes,
    u: Singles,
    v: Singles,
    out: Singles,
) -> None:
    """Fill `out` (m, 3)."""
    for m in prange(len(t)):
        p = np.empty(9, np.float32)
        d = np.empty(3, np.float32)
        d[NORMAL[face[m]]] = SIGN[face[m]]
        d[FIRST[face[m]]] = u[m]
        d[SECOND[face[m]]] = v[m]
        first = 0
        for i in range(3):
            first = _point(codes, shape[i], t[m], first, p[3 * i : 3 * i + 3])
        for i in range(9):
            p[i] = p[i] * unit
        out[m, 0] = out[m, 2] = np.float32(np.nan)
        out[m, 1] = -PI
        read_three(p, F0, ANY_NORMAL, (d[0], d[1], d[2]), out[m])
