"""Arithmetic of the C runtime, in Python: single precision, one rounding for each operation.

Owns the decorator with which the twins of the C functions are compiled, and the twins of the
runtime's own square root and arcsine.  Numba's fast-math flags are all off: a fused multiply-add
would round once where C (built with -ffp-contract=off) rounds twice.

Rule for a twin: every scalar is np.float32.  An int or a Python float beside one silently makes a
float64.
"""

import functools
import hashlib
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import numba
import numpy as np
from numba import prange

from lutgen.jit import cache_folder

__all__ = ["F0", "F1", "PI", "arcsine", "njit", "prange", "root"]

_Function = TypeVar("_Function", bound=Callable[..., Any])

F0, F1, HALF = np.float32(0.0), np.float32(1.0), np.float32(0.5)
PI = np.float32(3.14159265)
HALF_PI = np.float32(1.57079633)
# Minimax coefficients of (asin(x) - x) / x^3 in x^2, |x| <= 0.5 (Cephes, asinf).
C1 = np.float32(1.6666752422e-1)
C2 = np.float32(7.4953002686e-2)
C3 = np.float32(4.5470025998e-2)
C4 = np.float32(2.4181311049e-2)
C5 = np.float32(4.2163199048e-2)


@functools.cache
def _folder() -> str | None:
    """Return the folder of the compiled twins: a new one whenever a file that holds twins changes.

    numba notices a change in a function's own file only, not in those of the functions it calls.
    """
    here = Path(__file__).resolve()
    base = cache_folder(str(here.parent))
    if base is None:
        return None
    digest = hashlib.sha256()
    for path in sorted(here.parent.parent.rglob("*.py")):
        text = path.read_bytes()
        if path == here or b"firmware_export.twin.strict" in text:
            digest.update(
                path.relative_to(here.parent.parent).as_posix().encode() + b"\0" + text + b"\0"
            )
    return str(Path(base) / f"twins-{digest.hexdigest()[:16]}")


def njit(*, parallel: bool = False) -> Callable[[_Function], _Function]:
    """Compile a twin: no fast-math, so that each operation rounds as in C."""

    def compile_later(function: _Function) -> _Function:
        folder = _folder()
        before = numba.config.CACHE_DIR
        numba.config.CACHE_DIR = folder or before
        try:
            compiled: _Function = numba.njit(
                error_model="numpy",
                fastmath=False,
                nogil=True,
                cache=folder is not None,
                parallel=parallel,
            )(function)
        finally:
            numba.config.CACHE_DIR = before
        return compiled

    return compile_later


@njit()
def root(x: np.float32) -> np.float32:
    """Return the square root of a finite x >= 0, correctly rounded."""
    return np.float32(math.sqrt(x))


@njit()
def arcsine(x: np.float32) -> np.float32:
    """Return asin(x) in rad to 3e-7; arguments beyond 1 count as 1."""
    a = abs(x)
    if a > F1:
        a = F1
    z = HALF * (F1 - a) if a > HALF else a * a
    s = root(z) if a > HALF else a
    y = s + s * z * ((((C5 * z + C4) * z + C3) * z + C2) * z + C1)
    if a > HALF:
        y = HALF_PI - (y + y)
    return -y if x < F0 else y
