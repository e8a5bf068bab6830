"""Vectors of balls, and functions over a cell of postures with their derivatives.

A ball of Arb holds a real number for certain; comparisons of balls are true where they are certain.
Vectors are NumPy arrays of objects.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, ctx

ctx.prec = 80

ZERO, ONE, INFINITE = arb(0), arb(1), arb("inf")
# What is between -1 and 1.
ABOUT = arb(0, 1)


def vector(items: Iterable[Any]) -> Any:
    """Return objects as an array."""
    return np.array(list(items), dtype=object)


@dataclass(slots=True, eq=False)
class Jet:
    """A function over a cell: in the cell's middle, over all of it, its slopes over all of it."""

    middle: arb
    whole: arb
    slopes: Any

    def __add__(self, other: "Jet") -> "Jet":
        return Jet(self.middle + other.middle, self.whole + other.whole, self.slopes + other.slopes)

    def __sub__(self, other: "Jet") -> "Jet":
        return self + other.scaled(-ONE)

    def __mul__(self, other: "Jet") -> "Jet":
        slopes = self.slopes * other.whole + other.slopes * self.whole
        return Jet(self.middle * other.middle, self.whole * other.whole, slopes)

    def scaled(self, by: arb) -> "Jet":
        """Return the function times a number."""
        return Jet(self.middle * by, self.whole * by, self.slopes * by)

    def over(self, half: Any) -> arb:
        """Return the range over the cell, `half` its half lengths: mean value form and values."""
        return sum(self.slopes * half * ABOUT, self.middle).intersection(self.whole)


def cross(a: Any, b: Any) -> Any:
    """Return the vector product, of numbers or functions."""
    return vector(a[i] * b[j] - a[j] * b[i] for i, j in ((1, 2), (2, 0), (0, 1)))


def root(x: arb) -> arb:
    """Return the square root of what is no less than 0, whatever the ball says."""
    return max(x.lower(), ZERO).sqrt().union(max(x.upper(), ZERO).sqrt())


def norm(a: Any) -> arb:
    """Return the length of a vector."""
    return root(a @ a)


def most(x: arb) -> arb:
    """Return the largest absolute value."""
    return abs(x).upper()
