"""Twin of smap_read: an export's answers, bit for bit those of its C code.

Owns what comes before and after the codec: validation, clamping, the chart, the guard, the status.
"""

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmware_export.protocol import Export, axis_numbers
from firmware_export.truth import Model
from firmware_export.twin import PI
from lutgen.chart import FACE_NORMAL, FACE_SIGN, FACE_U, FACE_V
from lutgen.errors import InputError

Singles = NDArray[np.float32]

OK, CLAMPED, TIPS, OFF_CHART, INVALID = 0, 1, 2, 3, -1
RIM = np.float32(1.000001)


def read(export: Export, params: ArrayLike, gravity: ArrayLike) -> tuple[NDArray[np.int8], Singles]:
    """Read an export as smap_read does.

    Parameters
    ----------
    export : Export
        Of float arithmetic.
    params : (m, k) float32
        rad or length.
    gravity : (m, 3) float32
        Down, any length above 0.

    Returns
    -------
    status : (m,) int8
        smap_status_t.
    reading : (m, 3) float32
        sdg, tip_angle (rad, guard subtracted), height.
    """
    model = export.model
    values = np.ascontiguousarray(params, np.float32)
    down = np.ascontiguousarray(gravity, np.float32)
    if down.ndim != 2 or down.shape[1] != 3 or values.shape != (len(down), model.k):
        raise InputError(
            f"params must have the shape (m, {model.k}) and gravity (m, 3) (got "
            f"{values.shape} and {down.shape}); give one row per query"
        )
    reading = np.full((len(down), 3), np.nan, np.float32)
    reading[:, 1] = -PI
    finite = np.isfinite(values).all(axis=1) & np.isfinite(down).all(axis=1)
    finite &= (down != 0.0).any(axis=1)
    axes = axis_numbers(model)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        place = (values - axes[:, 0]) * axes[:, 2]
        t = np.clip(place, np.float32(0.0), np.float32(1.0))
        face, u, v, on_chart = _locate(model, down)
    status = np.where((t != place).any(axis=1), CLAMPED, OK).astype(np.int8)
    status[~on_chart] = OFF_CHART
    status[~finite] = INVALID
    ask = np.flatnonzero(finite & on_chart)
    found = codec_read(export, t[ask], face[ask], u[ask], v[ask])
    found[:, 1] -= np.float32(export.tables.guard)
    tips = ~(found[:, 1] >= 0.0)
    for column, name in ((0, "sdg"), (2, "height")):
        found[tips | (name not in export.channels), column] = np.nan
    status[ask[tips]] = TIPS
    reading[ask] = found
    return status, reading


def codec_read(
    export: Export, t: Singles, face: NDArray[np.uint8], u: Singles, v: Singles
) -> Singles:
    """Return the codec's own reading, before the guard."""
    module: Any = import_module(f"firmware_export.{export.codec}.codec")
    if export.codec == "contacts":
        answer = module.read(export.tables, t, _direction(face, u, v))
    else:
        answer = module.read(export.tables, t, face, u, v)
    return np.array(answer, np.float32)


def _direction(face: NDArray[np.uint8], u: Singles, v: Singles) -> Singles:
    """Return directions with 1 along the normal of their face, (m, 3)."""
    result = np.empty((len(face), 3), np.float32)
    row = np.arange(len(face))
    for column, value in ((FACE_NORMAL, np.take(FACE_SIGN, face)), (FACE_U, u), (FACE_V, v)):
        result[row, np.take(column, face)] = value
    return result


def _locate(
    model: Model, down: Singles
) -> tuple[NDArray[np.uint8], Singles, Singles, NDArray[np.bool_]]:
    """Return face, u, v and whether the chart holds the direction."""
    row = np.arange(len(down))
    limit = np.float32(model.chart_limit)
    if model.faces == 6:
        depths = down[:, FACE_NORMAL] * np.array(FACE_SIGN, np.float32)
        face = np.argmax(np.where(np.isnan(depths), -np.inf, depths), axis=1).astype(np.uint8)
    else:
        face = np.zeros(len(down), np.uint8)
    depth = down[row, np.take(FACE_NORMAL, face)] * np.take(FACE_SIGN, face).astype(np.float32)
    held = depth > 0.0
    places = []
    for column in (FACE_U, FACE_V):
        place = down[row, np.take(column, face)] / np.where(held, depth, np.float32(np.nan))
        held &= np.abs(place) <= limit * RIM
        places.append(np.clip(place, -limit, limit))
    return face, places[0], places[1], held


def integers(export: Export) -> tuple[Any, dict[str, float]]:
    """Return what answers as smap_read_i does, and the value of one step of each channel."""
    module: Any = import_module(f"firmware_export.{export.codec}.codec")

    def ask(params: NDArray[Any], gravity: NDArray[Any]) -> Any:
        return module.read_i(export.tables, params, gravity, export.model.faces)

    return ask, dict(module.c_body(export.tables).steps)
