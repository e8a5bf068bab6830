"""The C runtime, in Python.

In reading order: `strict`, `vector32`, `three_points`.
"""

from firmware_export.twin.strict import F0, F1, PI, arcsine, njit, prange, root
from firmware_export.twin.three_points import read_three
from firmware_export.twin.vector32 import Vector, at, cross, dot, normalise, subtract

__all__ = [
    "F0",
    "F1",
    "PI",
    "Vector",
    "arcsine",
    "at",
    "cross",
    "dot",
    "integers",
    "njit",
    "normalise",
    "prange",
    "read",
    "read_three",
    "root",
    "subtract",
]
