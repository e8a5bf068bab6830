"""How far single precision can be off: every operation rounds once, and errors are carried on.

Owns the constants that hold for all floats, which `proofs/exhaustive.c` finds by trying all of
them, and the arithmetic of bounds.  All in doubles, with a hair on top.
"""

import math
from typing import NamedTuple

# A rounding moves a number by no more than this part of it, or by half of the least number.
HALF_UNIT, LEAST = 2.0**-24, 2.0**-149
# Largest errors of smap_sine_cosine_near up to 1.05 rad, of smap_sine_cosine up to 16 rad, and of
# smap_asin (rad): proved by trying all floats, see proofs/exhaustive.c.
SINE_NEAR, SINE, ARCSINE = 8.4e-8, 9.4e-8, 1.7e-7
NEAREST, FURTHEST = 1.0501, 16.0
# Of the bounds themselves, which are sums of a few hundred positive doubles.
HAIR = 1.0 + 1e-10
# A read from the edge normals on: the scalar product (3 roundings of |E| |d|), direction (1), and
# of the sine itself scale (4.5), product (1), length of the direction (2.5) and quotient (1).
READ = 16.0 * HALF_UNIT
# Of an angle at most: the quotient's guard is subtracted, and stored.
LAST = 2.0 * HALF_UNIT * math.pi / 2.0
# How many 1/32767 the whole numbers of runtime/three.c read a sine too high: each part of 16383 m
# is rounded to a whole number (0.501, and 0.007 for all that m itself is off).
WHOLE = 2.0 * (0.501 * math.sqrt(3.0) + 0.007)
# The same of runtime/tables.c without floats: normals cut off twice, and their length.
WHOLE_TABLES = (
    32767.0 * (math.sqrt(3.0) / 16383.0 + math.sqrt(3.0) / 16384.0 + 1.0 / 16383.0) + 0.01
)
# Turns that smap_unwind takes off at most.
TURNS = 1000.0


class Off(NamedTuple):
    """A number that single precision has: at most `size` in truth, and `error` off."""

    size: float
    error: float

    def times(self, other: "Off") -> "Off":
        """Return the rounded product."""
        size = self.size * other.size * HAIR
        error = self.size * other.error + self.error * other.size + self.error * other.error
        return _rounded(size, error)

    def plus(self, other: "Off") -> "Off":
        """Return the rounded sum."""
        return _rounded((self.size + other.size) * HAIR, self.error + other.error)


def _rounded(size: float, error: float) -> Off:
    return Off(size, (error + HALF_UNIT * (size + error) + LEAST) * HAIR)


def unwound(reach: float) -> float:
    """Return how far (rad) off smap_unwind brings a joint whose axis has ends up to `reach`.

    Whether a turn more or less is taken is told by a float of up to 1000 turns, so that a joint at
    the seam is kept at the wrong end of its axis.
    """
    far = 2.0 * math.pi * TURNS
    seam = far * 2.0**-24 + 2.0 * math.pi * TURNS * 2.0**-24 + far * 2.0**-25
    return (seam + HALF_UNIT * (2.0 * reach + 22.0) + 2e-5) * HAIR
