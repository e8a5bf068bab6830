"""Three-component vectors as plain tuples, for use inside compiled kernels.

Tuples of scalars stay in registers where small arrays would be allocated.
"""

import math

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit

Vector = tuple[float, float, float]
# The arrays that kernels hand to each other.
Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@njit(inline=True)
def row(array: Floats, index: int) -> Vector:
    """Return row `index` of an (n, 3) array as a tuple."""
    return array[index, 0], array[index, 1], array[index, 2]


@njit(inline=True)
def dot(a: Vector, b: Vector) -> float:
    """Return the scalar product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(inline=True)
def cross(a: Vector, b: Vector) -> Vector:
    """Return the vector product a x b."""
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@njit(inline=True)
def subtract(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(inline=True)
def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(inline=True)
def scale(a: Vector, factor: float) -> Vector:
    """Return factor * a."""
    return a[0] * factor, a[1] * factor, a[2] * factor


@njit(inline=True)
def length(a: Vector) -> float:
    """Return the Euclidean length of a."""
    return math.sqrt(dot(a, a))


@njit(inline=True)
def unit(a: Vector) -> Vector:
    """Return a / |a|, or the zero vector for the zero vector."""
    size = length(a)
    if size == 0.0:
        return 0.0, 0.0, 0.0
    return scale(a, 1.0 / size)


@njit(inline=True)
def along(a: Vector, b: Vector, way: float) -> Vector:
    """Return a + way * b."""
    return a[0] + way * b[0], a[1] + way * b[1], a[2] + way * b[2]


@njit(inline=True)
def between(a: Vector, b: Vector, share: float) -> Vector:
    """Return a + share * (b - a)."""
    return along(a, subtract(b, a), share)


@njit(inline=True, bare=True)
def read3(a: Floats) -> Vector:
    """Return an array of three numbers as a tuple."""
    return a[0], a[1], a[2]


@njit(inline=True, bare=True)
def write3(a: Floats, vector: Vector) -> None:
    """Write a tuple into an array of three numbers."""
    a[0], a[1], a[2] = vector
