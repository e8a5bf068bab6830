"""Vectors of three singles for the twins; each rounds as its namesake in runtime/smap.c."""

import numpy as np
from numpy.typing import NDArray

from firmware_export.twin.strict import F0, F1, njit, root

Vector = tuple[np.float32, np.float32, np.float32]


@njit()
def at(array: NDArray[np.float32], index: int) -> Vector:
    """Return three components that begin at an index."""
    return array[index], array[index + 1], array[index + 2]


@njit()
def dot(a: Vector, b: Vector) -> np.float32:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit()
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@njit()
def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit()
def normalise(a: Vector) -> tuple[np.float32, Vector]:
    """Return what the length was, and the vector with length 1; a zero vector stays."""
    size = root(dot(a, a))
    if size > F0:
        inverse = F1 / size
        return size, (a[0] * inverse, a[1] * inverse, a[2] * inverse)
    return size, a
