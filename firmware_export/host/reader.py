"""The C runtime asked on this machine: many queries of a map that is in memory.

Owns the shapes and types of queries and answers, and the threads: C holds no lock of Python's.
"""

import ctypes
import os
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmware_export.host.layout import structs
from firmware_export.host.library import load_library
from firmware_export.host.memory import Memory
from firmware_export.protocol import Descriptor
from lutgen.errors import InputError

# Queries that a thread of its own is worth: a tenth of a millisecond of the fastest codec.
PIECE = 4096


class Host:
    """A map that is asked as a microcontroller asks it.

    Parameters
    ----------
    descriptor : Descriptor
        Of the map.
    """

    def __init__(self, descriptor: Descriptor) -> None:
        self._memory = Memory(descriptor)
        # Three points are read by other code, which the switch of the tables asks for.
        three = descriptor.config.get("SMAP_CONTACTS_MANY") == 0
        library = load_library()
        self._batch = library.batch_three if three else library.batch_many

    def read(
        self, params: ArrayLike, gravity: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[np.float32]]:
        """Ask smap_read.

        Parameters
        ----------
        params : (m, k) array_like
            rad or length.
        gravity : (m, 3) array_like
            Down, any length > 0.

        Returns
        -------
        status : (m,) int8
            See smap_status_t.
        reading : (m, 3) float32
            sdg, tip_angle (rad, guard subtracted), height.
        """
        status, reading = self._ask(self._batch, np.float32, "smap_reading_t", (params, gravity))
        return status, reading.view(np.float32).reshape(-1, 3)

    def read_i(
        self, params_q: ArrayLike, gravity_q: ArrayLike
    ) -> tuple[NDArray[np.int8], NDArray[np.int32]]:
        """Ask smap_read_i.

        Parameters
        ----------
        params_q : (m, k) array_like of int
            0 to 32767 between the ends of each axis.
        gravity_q : (m, 3) array_like of int
            Down, any length > 0.

        Returns
        -------
        status : (m,) int8
            See smap_status_t.
        reading : (m, 3) int32
            sdg and height in steps, tip in 1 / 32767.
        """
        asked = (params_q, gravity_q)
        status, reading = self._ask(
            load_library().batch_i_many, np.int16, "smap_reading_i_t", asked
        )
        columns = [reading[name].astype(np.int32) for name in ("sdg", "tip", "height")]
        return status, np.stack(columns, axis=1)

    def _ask(
        self, batch: Any, number: type[np.generic], answer: str, asked: tuple[ArrayLike, ArrayLike]
    ) -> tuple[NDArray[np.int8], NDArray[Any]]:
        """Ask a function of the library; large batches in as many threads as there are cores."""
        rows, downs = (np.ascontiguousarray(array, dtype=number) for array in asked)
        if rows.ndim != 2 or downs.shape != (len(rows), 3) or rows.shape[1] != self._memory.params:
            raise InputError(
                f"params and gravity must have the shapes (m, {self._memory.params}) and (m, 3) "
                f"(got {rows.shape} and {downs.shape}); give one row for each query."
            )
        status = np.empty(len(rows), np.int8)
        reading = np.empty(len(rows), _dtype(answer))

        def some(begin: int, end: int) -> None:
            part = [array[begin:end] for array in (rows, downs, status, reading)]
            batch(
                ctypes.c_void_p(self._memory.address),
                ctypes.c_int64(end - begin),
                *(ctypes.c_void_p(array.ctypes.data) for array in part),
            )

        pieces = max(1, min(os.cpu_count() or 1, len(rows) // PIECE))
        cuts = [len(rows) * piece // pieces for piece in range(pieces + 1)]
        if pieces == 1:
            some(0, len(rows))
        else:
            with ThreadPoolExecutor(pieces) as pool:
                list(pool.map(some, cuts[:-1], cuts[1:]))
        return status, reading


@cache
def _dtype(name: str) -> np.dtype[Any]:
    """Return the type of a struct of smap.h."""
    return np.dtype(structs()[name])
