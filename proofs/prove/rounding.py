"""How far single precision is off: every operation rounds once, and errors are carried on.

The errors of sine, cosine and arcsine are known from trying all floats: proofs/exhaustive.c.
"""

from typing import NamedTuple

from flint import arb

from proofs.prove.balls import ZERO

# A rounding moves a number by no more than this part of it, or by half of the least number.
U, LEAST = arb(2) ** -24, arb(2) ** -149
# Largest errors of smap_sine_cosine_near up to NEAREST rad, of smap_sine_cosine up to FURTHEST rad,
# and of smap_asin (rad).
SINE_NEAR, SINE, ARCSINE = 8.4e-8, 9.4e-8, 1.7e-7
NEAREST, FURTHEST = 1.0501, 16.0
# A read from the edge normals on: the scalar product (3 roundings of |E| |d|), direction (1), and
# of the sine itself scale (4.5), product (1), length of the direction (2.5) and quotient (1).
READ = 16 * U
# The guard is subtracted from an angle of at most a quarter turn, and was rounded itself.
LAST = U * arb.pi()
# By how many 1/32767 the whole numbers of runtime/smap_three.h read a sine too high: each part of
# 16383 m is rounded to a whole number (0.501, and 0.007 for all that m itself is off).
WHOLE = 2 * (arb("0.501") * arb(3).sqrt() + arb("0.007"))
# The same of runtime/smap_tables_i.c: normals cut off twice, and their length.
WHOLE_TABLES = 32767 * (arb(3).sqrt() * (1 / arb(16383) + 1 / arb(16384)) + 1 / arb(16383))
WHOLE_TABLES += arb("0.01")


class Off(NamedTuple):
    """A number that single precision has: at most `size` in truth, and `error` off."""

    size: arb
    error: arb

    def times(self, other: "Off") -> "Off":
        """Return the rounded product."""
        error = self.size * other.error + self.error * other.size + self.error * other.error
        return _rounded(self.size * other.size, error)

    def plus(self, other: "Off") -> "Off":
        """Return the rounded sum."""
        return _rounded(self.size + other.size, self.error + other.error)


def exact(size: arb) -> Off:
    """Return a number that is a single."""
    return Off(abs(size).upper(), ZERO)


def _rounded(size: arb, error: arb) -> Off:
    return Off(size.upper(), (error + U * (size + error) + LEAST).upper())
