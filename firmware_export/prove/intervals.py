"""Arrays of intervals of real numbers, rounded outward: what is computed holds what is true.

Owns the rounding.  Every operation of doubles is followed by a step to the next one outward, sines
and cosines by more than they can be off.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lutgen.vector import Floats

# Of NumPy's sine and cosine of |x| up to 1e4: at most 4 units in the last place of 1.
WAVE = 1e-15


def down(x: Any) -> Floats:
    """Return the next lower doubles."""
    return np.asarray(np.nextafter(x, -np.inf))


def up(x: Any) -> Floats:
    """Return the next higher doubles."""
    return np.asarray(np.nextafter(x, np.inf))


def root_up(x: Floats) -> Floats:
    """Return upper bounds of the square roots of x >= 0."""
    return up(np.sqrt(x))


def root_down(x: Floats) -> Floats:
    """Return lower bounds of the square roots of x, 0 where x is negative."""
    return np.maximum(down(np.sqrt(np.maximum(x, 0.0))), 0.0)


@dataclass(frozen=True, eq=False)
class Interval:
    """Intervals [low, high] of one shape; operations broadcast as NumPy's do."""

    low: Floats
    high: Floats
    # Arrays leave operations with intervals to these.
    __array_ufunc__ = None

    @classmethod
    def of(cls, value: Any) -> "Interval":
        """Return doubles as intervals without length; intervals as they are."""
        if isinstance(value, Interval):
            return value
        array = np.asarray(value, np.float64)
        return cls(array, array)

    def __add__(self, other: Any) -> "Interval":
        other = Interval.of(other)
        return Interval(down(self.low + other.low), up(self.high + other.high))

    def __neg__(self) -> "Interval":
        return Interval(-self.high, -self.low)

    def __sub__(self, other: Any) -> "Interval":
        return self + -Interval.of(other)

    def __mul__(self, other: Any) -> "Interval":
        other = Interval.of(other)
        a, b = self.low * other.low, self.low * other.high
        c, d = self.high * other.low, self.high * other.high
        low = np.minimum(np.minimum(a, b), np.minimum(c, d))
        high = np.maximum(np.maximum(a, b), np.maximum(c, d))
        return Interval(down(low), up(high))

    __radd__, __rmul__ = __add__, __mul__

    def __getitem__(self, at: Any) -> "Interval":
        return Interval(self.low[at], self.high[at])

    @property
    def most(self) -> Floats:
        """Upper bounds of the absolute values."""
        return np.maximum(-self.low, self.high)

    @property
    def least(self) -> Floats:
        """Lower bounds of the absolute values."""
        return np.maximum(np.maximum(self.low, -self.high), 0.0)

    def squared(self) -> "Interval":
        """Return the squares."""
        return Interval(np.maximum(down(self.least**2), 0.0), up(self.most**2))

    def widened(self, by: Any) -> "Interval":
        """Return the intervals longer by as much at both ends."""
        return Interval(down(self.low - by), up(self.high + by))

    def meet(self, other: "Interval") -> "Interval":
        """Return what two intervals that hold the same have in common."""
        return Interval(np.maximum(self.low, other.low), np.minimum(self.high, other.high))


def cosine(x: Interval) -> Interval:
    """Return the cosines of |x| up to 1e4."""
    a, b = np.cos(x.low), np.cos(x.high)
    low, high = np.minimum(a, b) - WAVE, np.maximum(a, b) + WAVE
    # Whole half turns within, or as near as rounding can tell.
    first = np.ceil(x.low / math.pi - 1e-11)
    last = np.floor(x.high / math.pi + 1e-11)
    some, more = last >= first, last > first
    even = np.mod(first, 2.0) == 0.0
    high = np.where(some & (even | more), 1.0, high)
    low = np.where(some & (~even | more), -1.0, low)
    return Interval(np.maximum(low, -1.0), np.minimum(high, 1.0))


# More than half of pi and less, as doubles have it.
QUARTER = Interval(down(math.pi / 2.0), up(math.pi / 2.0))


def sine(x: Interval) -> Interval:
    """Return the sines of |x| up to 1e4."""
    return cosine(x - QUARTER)


def dot(a: Interval, b: Interval) -> Interval:
    """Return scalar products of vectors (3, ...)."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def stack(parts: list[Interval]) -> Interval:
    """Return intervals of one shape, or that broadcast, along a new first axis."""
    lows = np.broadcast_arrays(*(part.low for part in parts))
    highs = np.broadcast_arrays(*(part.high for part in parts))
    return Interval(np.stack(lows), np.stack(highs))


def cross(a: Interval, b: Interval) -> Interval:
    """Return vector products of vectors (3, ...)."""
    turns = ((1, 2), (2, 0), (0, 1))
    return stack([a[i] * b[j] - a[j] * b[i] for i, j in turns])


def norm(a: Interval) -> Interval:
    """Return lengths of vectors (3, ...)."""
    square = a[0].squared() + a[1].squared() + a[2].squared()
    return Interval(root_down(square.low), root_up(square.high))
