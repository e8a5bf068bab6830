"""Answer by the C runtime on this machine many queries of a map in memory, with all its cores.

The library was built for this machine when lutgen was installed.  It lies beside the C files and
must have been built from them; see runtime/smap_host.c.
"""

import ctypes
import hashlib
import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmware_export.protocol import Blob
from lutgen.errors import ExportError, InputError, reject
from lutgen.vector import Floats

RUNTIME = Path(__file__).resolve().parent.parent / "runtime"
NAME = "_host.abi3.so"
WAY_OUT = (
    "install a C compiler, then lutgen again (in a checkout `python setup.py build_ext --inplace`)"
)


@cache
def load_library() -> ctypes.CDLL:
    """Return the library; ExportError is raised if it was not built, or from other files."""
    path = RUNTIME / NAME
    try:
        loaded = ctypes.CDLL(str(path))
    except OSError as error:
        what = "the C runtime, which certifies and reads exports, cannot be loaded"
        reject(path, what, error, WAY_OUT, ExportError)
    loaded.smap_points_host_sources.restype = ctypes.c_char_p
    built = loaded.smap_points_host_sources().decode("ascii")
    # As setup.py computes it.
    files = sorted(RUNTIME.glob("*.[ch]"))
    if built != hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest():
        what = "was built from other files than those beside it"
        reject(path, what, f"the digest {built[:12]}", WAY_OUT, ExportError)
    return loaded


def call(name: str, *given: Any) -> int:
    """Call a function that returns a status, if anything; arrays are given by address."""
    passed = [
        ctypes.c_void_p(None if one is None else one.ctypes.data)
        if one is None or isinstance(one, np.ndarray)
        else one
        for one in given
    ]
    return ctypes.c_int8(getattr(load_library(), name)(*passed)).value


# Queries that a thread of its own is worth: a tenth of a millisecond of the fastest codec.
PIECE = 4096
# smap_reading_t and smap_reading_i_t.
SINGLES = [(name, "<f4") for name in ("sdg", "tip_angle", "height")]
READING = np.dtype([*SINGLES, ("over", "u1", 2)], align=True)
READING_I = np.dtype([("sdg", "<u2"), ("tip", "<i2"), ("height", "<u2"), ("over", "u1", 2)])
# Status codes with which the robot is said not to tip: it stands, or rocks between rests.
STANDS = (0, 1)
# The family of the runtime that reads each codec, by its number in runtime/smap_map.h.
FAMILIES = {1: "points", 3: "tables", 4: "grid", 5: "rails", 6: "search"}
# Where a blob has the number of its contacts.
CONTACTS = 13
# The value of smap_read_i for a channel that is not stored, and its full scale.
NOT_HELD, FULL_SCALE = 65535, 32767


def family_of(codec: int, integer: bool) -> str:
    """Return the family of the runtime that reads a codec, with or without floats."""
    family = FAMILIES[codec]
    return f"{family}_i" if integer and family == "tables" else family


def stem_of(blob: Blob) -> str:
    """Return what the names of the functions begin with that read a map."""
    return f"smap_{family_of(blob.codec, blob.integer)}_host_"


def in_units(reading: NDArray[Any], steps: Mapping[str, float]) -> Floats:
    """Return what smap_read_i says (m, 3) in rad and in length; NaN where it holds nothing."""
    sdg, height = (
        np.where(reading[:, at] == NOT_HELD, np.nan, reading[:, at] * steps.get(name, np.nan))
        for at, name in ((0, "sdg"), (2, "height"))
    )
    sine = np.clip(reading[:, 1] / FULL_SCALE, -1.0, 1.0)
    return np.stack([sdg, np.arcsin(sine), height], axis=1)


class Host:
    """A map that is read as on a microcontroller."""

    def __init__(self, blob: Blob) -> None:
        self._blob = blob
        self._bytes = np.frombuffer(blob.bytes, np.uint8)
        self._stem = stem_of(blob)

    def read(
        self, params: ArrayLike, gravity: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
        """Run smap_read on postures (m, k) and gravity (m, 3), down, of any length > 0.

        Returns status (m,), and sdg, tip_angle (rad, guard subtracted) and height (m, 3).
        """
        status, reading = self.ask("read", params, gravity)
        return status, np.stack([reading[name] for name in ("sdg", "tip_angle", "height")], axis=1)

    def read_i(
        self, params_q: ArrayLike, gravity_q: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
        """Run smap_read_i on steps (m, k), 0 to 32767 on each axis, and whole gravity (m, 3).

        Returns status (m,), and sdg, tip (1 / 32767) and height (m, 3), lengths in steps.
        """
        status, reading = self.ask("read_i", params_q, gravity_q)
        columns = [reading[name].astype(np.int32) for name in ("sdg", "tip", "height")]
        return status, np.stack(columns, axis=1)

    def room(self, params: ArrayLike) -> NDArray[np.uint8]:
        """Return the most of each that poses of postures (m, k) have; see smap_host_region.h."""
        rows = np.ascontiguousarray(params, np.float32)
        most = np.zeros(5, np.uint8)
        self._call("room", len(rows), rows, most)
        return most

    def positions(self, params: ArrayLike) -> NDArray[np.float32]:
        """Return where the contacts (m, n, 3) of postures (m, k) are, in the order of the map.

        Relative to the com, as single precision has them; parameters are taken as they are.
        """
        rows = np.ascontiguousarray(params, np.float32)
        found = np.empty((len(rows), int(self._bytes[CONTACTS]), 3), np.float32)
        self._call("positions", len(rows), rows, found)
        return found

    def check(self) -> int:
        """Return the status of smap_check."""
        return call(f"{self._stem}check", self._bytes, ctypes.c_uint32(len(self._bytes)))

    def ask(
        self, what: str, params: ArrayLike, gravity: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[Any]]:
        """Run ``read`` or ``read_i``; large batches in as many threads as there are cores."""
        number = np.int16 if what == "read_i" else np.float32
        rows = np.ascontiguousarray(params, dtype=number)
        downs = np.ascontiguousarray(gravity, dtype=number)
        if rows.ndim != 2 or downs.shape != (len(rows), 3) or rows.shape[1] != self._blob.params:
            raise InputError(
                f"params and gravity must have the shapes (m, {self._blob.params}) and (m, 3) "
                f"(got {rows.shape} and {downs.shape}); give one row for each query."
            )
        status = np.empty(len(rows), np.int8)
        reading = np.empty(len(rows), READING_I if what == "read_i" else READING)

        def some(begin: int, end: int) -> None:
            part = (array[begin:end] for array in (rows, downs, status, reading))
            self._call(what, end - begin, *part)

        pieces = max(1, min(os.cpu_count() or 1, len(rows) // PIECE))
        cuts = [len(rows) * piece // pieces for piece in range(pieces + 1)]
        if pieces == 1:
            some(0, len(rows))
        else:
            with ThreadPoolExecutor(pieces) as pool:
                list(pool.map(some, cuts[:-1], cuts[1:]))
        return status, reading

    def _call(self, what: str, count: int, *arrays: NDArray[Any]) -> int:
        """Call a function of the library with the blob, a count, and arrays."""
        size = ctypes.c_uint32(len(self._bytes))
        return call(self._stem + what, self._bytes, size, ctypes.c_int64(count), *arrays)
