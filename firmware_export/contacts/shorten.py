"""The polynomials of the codec `poly`: how long each contact's series is, and its codes.

Owns the spec, the tables and the shortening.  A Chebyshev series cut off is within a few per cent
of the minimax polynomial of the same terms when its coefficients fall as fast as these do (each
a tenth of the one before, or less), so nothing is fitted.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from firmware_export.protocol import Tables as AnyTables
from firmware_export.truth import Model, expand, polynomial_guard, rounds, widened
from lutgen.errors import InputError
from lutgen.vector import Floats

LARGEST_CODE = 32767
# A contact's number of terms is one byte; the runtime counts degrees in 4 bits of a word.
MOST_TERMS = 255
MOST_DEGREE = 15
MOST_PARAMETERS = 8


@dataclass(frozen=True)
class Spec:
    """Lengths of the series.

    Parameters
    ----------
    degrees : tuple of three tuples of k int
        For each contact the highest degree in each parameter; its terms are those in which no
        degree is above its own limit and the sum of all is not above the greatest limit.
    """

    degrees: tuple[tuple[int, ...], ...]

    @property
    def label(self) -> str:
        """Short text for tables and reports."""
        return "poly " + " ".join("x".join(str(n) for n in one) or "0" for one in self.degrees)

    @classmethod
    def of_label(cls, label: str) -> "Spec":
        """Return the size with a label.

        Examples
        --------
        >>> Spec.of_label("poly 0x2 2x0 0x0").degrees
        ((0, 2), (2, 0), (0, 0))
        """
        return cls(tuple(tuple(map(int, one.split("x"))) for one in label.split()[1:]))


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """An encoded robot.

    Parameters
    ----------
    spec : Spec
    channels : tuple of str
    contacts : tuple of three str
        Names of the contacts in the order of the tables.
    codes : (terms, 3) int16
        Coefficients of x, y, z in units of `unit`; the three contacts' terms one after the
        other, each in the order of `exponents`.
    shape : (3, k + 1) uint8
        Per contact its degrees, and its number of terms.
    places : (k, 2) float64
        Middle of each parameter's axis, slack and all, and 2 over its length.
    order : int
        The recipe's contacts in the order of the tables, two bits each.
    reach : float
        How far (length) a contact can be from the com at most.
    unit : float32
        Length of one code.
    """

    spec: Spec
    channels: tuple[str, ...]
    contacts: tuple[str, ...]
    codes: NDArray[np.int16]
    shape: NDArray[np.uint8]
    places: Floats
    order: int
    reach: float
    unit: np.float32
    guard: float
    guard_text: str

    @property
    def bytes(self) -> int:
        """Bytes of all tables."""
        return self.codes.nbytes + self.shape.nbytes


def exponents(degrees: tuple[int, ...]) -> list[tuple[int, ...]]:
    """Return the degrees of every term, in the order in which the runtime counts: first fastest.

    Examples
    --------
    >>> exponents((2, 1))
    [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1)]
    """
    most = max(degrees, default=0)
    counted = product(*(range(n + 1) for n in reversed(degrees)))
    return [a[::-1] for a in counted if sum(a) <= most]


def series_of(model: Model) -> tuple[Floats, ...]:
    """Return the exact series, for a model that the codec has not refused."""
    series = expand(widened(model))
    if series is None:
        raise InputError(
            f"{model.recipe.source}: codec poly was given a robot that it refuses (got no short "
            "series of its contacts); ask `poly.refusal` first."
        )
    return series


def shortened(series: Floats, degrees: tuple[int, ...]) -> Floats:
    """Return a series with only the terms of `degrees`, of the shape (degree + 1, ..., 3)."""
    result = np.zeros((*(n + 1 for n in degrees), 3))
    for a in exponents(degrees):
        if all(i < n for i, n in zip(a, series.shape, strict=False)):
            result[a] = series[a]
    return result


def residual(series: Floats, degrees: tuple[int, ...]) -> float:
    """Return a bound of how far (length) a contact moves when its series is shortened."""
    sizes = np.linalg.norm(series, axis=-1)
    kept = sum(
        float(sizes[a])
        for a in exponents(degrees)
        if all(i < n for i, n in zip(a, series.shape, strict=False))
    )
    return float(sizes.sum()) - kept


def start(model: Model, channels: tuple[str, ...], arithmetic: str) -> list[Spec]:
    """Return the smallest sensible spec: linear in whatever a contact depends on."""
    series = series_of(model)
    return [Spec(tuple(tuple(min(n - 1, 1) for n in one.shape[:-1]) for one in series))]


def grow(model: Model, spec: Spec) -> list[Spec]:
    """Return the next larger spec, or nothing where all is as exact as the codes are.

    The contact that is furthest off gets one more degree, in the parameter in which that helps
    most; contacts as far off as it, as those of a symmetric robot are, go with it.
    """
    series = series_of(model)
    off = [residual(one, n) for one, n in zip(series, spec.degrees, strict=True)]
    # A step is worth its bytes while the ends of the series are above the codes' rounding.
    fine = max(float(np.abs(one).max()) for one in series) / LARGEST_CODE / 2.0
    if max(off) <= fine:
        return []
    degrees = list(spec.degrees)
    for i, one in enumerate(series):
        if off[i] < 0.9 * max(off):
            continue
        steps = [
            (*degrees[i][:axis], degrees[i][axis] + 1, *degrees[i][axis + 1 :])
            for axis in range(model.k)
            if degrees[i][axis] + 1 < min(one.shape[axis], MOST_DEGREE + 1)
        ]
        steps = [n for n in steps if len(exponents(n)) <= MOST_TERMS]
        if steps:
            degrees[i] = min(steps, key=lambda n: residual(one, n))
    grown = Spec(tuple(degrees))
    return [] if grown == spec else [grown]


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Shorten and quantise the series, and bound what that does to the verdict."""
    series = series_of(model)
    short = [shortened(one, n) for one, n in zip(series, spec.degrees, strict=True)]
    unit = np.float32(max(float(np.abs(one).max()) for one in short) / LARGEST_CODE)
    terms = [exponents(n) for n in spec.degrees]
    rows = np.vstack([[one[a] for a in which] for one, which in zip(short, terms, strict=True)])
    codes = np.clip(np.rint(rows / float(unit)), -LARGEST_CODE, LARGEST_CODE).astype(np.int16)
    first = 0
    for one, which in zip(short, terms, strict=True):
        for a in which:
            one[a] = codes[first] * float(unit)
            first += 1
    shape = [(*n, len(which)) for n, which in zip(spec.degrees, terms, strict=True)]
    wide = widened(model)
    places = np.stack([(wide.upper + wide.lower) / 2.0, 2.0 / (wide.upper - wide.lower)], axis=1)
    order = rounds(model)
    return Tables(
        spec,
        tuple(channels),
        tuple(model.recipe.contact_names[i] for i in rounds(model)),
        codes,
        np.array(shape, np.uint8),
        places.reshape(-1, 2),
        order[0] | order[1] << 2 | order[2] << 4,
        max(float(np.abs(one).sum(axis=tuple(range(model.k))).max()) for one in short) * 1.8,
        unit,
        polynomial_guard(wide, series, short),
        "greatest angle between the exact and the polynomials' tip-over planes: their largest "
        "distance at the middles of the cells of a dense grid over the parameters, a Lipschitz "
        "bound of its change within a cell, and an allowance for single precision",
    )
