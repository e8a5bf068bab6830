"""The tables of positions of a robot that is given by code: codes of series over pieces.

The layout is that of runtime/smap_series.h.  Small terms are left out, and the others rounded.

Nothing is known of the code but its values, so the bound of how far the positions of the C are off
is of what is seen.  On a dense grid of postures the very C computes, in single precision.  Between
two neighbours of the grid the difference rises by about half of what it changes from one to the
other; for every axis the whole of the largest such change is added to the largest difference.  That
holds for all that a grid as dense can show.  Ends, cuts and random postures are looked at beside.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from firmware_export.contacts.pieces import MOST_PARAMETERS, pieces_of
from firmware_export.contacts.terms import COMMON, MOST_ENTRIES, Products
from firmware_export.host import Host
from firmware_export.model import Model, combinations, widened
from firmware_export.protocol import CArray
from lutgen.errors import InputError
from lutgen.recipe import robot_size_of
from lutgen.vector import Floats

# Flags of the runtime, beside those of closed forms.
BY_SERIES, WIDE = 16, 32
# Shares of the error requested: what is left out, and what codes of two bytes may be off.
LEFT_OUT, ROUNDED = 0.4, 0.25
LARGEST = {2: 32767, 3: 8388607}
MOST_TERMS = 65535

Degrees = tuple[int, ...]
Pair = tuple[int, int]
Row = tuple[int, int, int, int]


@dataclass(frozen=True, eq=False)
class Series:
    """The tables of a robot's positions.

    `knots`: of each axis; `degrees`: the highest of each parameter; `masks`: of each group the
    parameters by which its pieces go; `products`: pairs of entries; `rows`: first term of each
    group and piece, and how many x, y and z have; `term_entries` and `codes` of the terms; `unit`:
    length of a code, of `code_bytes` each; `common`: True if the first group is minus the com;
    `axes`: how many axes of discs, which codes do not hold.
    """

    knots: tuple[Floats, ...]
    degrees: Degrees
    masks: tuple[int, ...]
    products: tuple[Pair, ...]
    rows: tuple[Row, ...]
    term_entries: NDArray[np.uint8]
    codes: NDArray[np.int64]
    unit: np.float32
    code_bytes: int
    common: bool
    axes: int = 0

    @property
    def entries(self) -> int:
        """How many entries the runtime computes."""
        return 1 + sum(self.degrees) + len(self.products)

    @property
    def width(self) -> int:
        """How many coordinates the runtime computes."""
        return 3 * (len(self.masks) - self.common)

    def head(self) -> tuple[list[int], int, int]:
        """Return nothing of what closed forms count, and flags; see `Terms.head`."""
        return [0] * 4, 0, BY_SERIES | COMMON * self.common | WIDE * (self.code_bytes == 3)

    def arrays(self) -> Iterator[CArray]:
        """Yield the tables."""
        axes = [(len(one) - 1, n) for one, n in zip(self.knots, self.degrees, strict=True)]
        knots = [(a, 2.0 / (b - a)) for one in self.knots for a, b in itertools.pairwise(one)]
        yield CArray("unit", "float", [self.unit], "length of one code", False)
        yield CArray("terms", "uint16_t", [len(self.codes)], "terms", False)
        yield CArray("counts", "uint8_t", [len(self.products)], "products", False)
        yield CArray("axes", "uint8_t", axes, "per parameter: pieces, highest degree")
        yield CArray("knots", "float", knots, "per piece: begin, 2 / length")
        yield CArray("masks", "uint8_t", self.masks, "per group: parameters of its pieces")
        rows = [(first & 255, first >> 8, *counts) for first, *counts in self.rows]
        yield CArray("rows", "uint8_t", rows, "per group and piece: first term, terms of x, y, z")
        yield CArray("products", "uint8_t", self.products, "pairs of entries")
        yield CArray("entries", "uint8_t", self.term_entries, "entry of each term")
        if self.code_bytes == 2:
            yield CArray("codes", "int16_t", self.codes, "coefficients")
        else:
            packed = self.codes.astype("<i4").view(np.uint8).reshape(-1, 4)[:, :3]
            yield CArray("codes", "uint8_t", packed, "coefficients, three bytes each")


def series_of(model: Model, order: tuple[int, ...], error: float) -> Series:
    """Return the smaller of the tables that are off by less than about `error` (length).

    `order` is that of the recipe's contacts in them; what has no such series is refused.
    """
    if model.k > MOST_PARAMETERS:
        raise InputError(
            f"the robot is given by code, whose positions are held as tables over at most "
            f"{MOST_PARAMETERS} parameters (got {model.k}); use --codec grid"
        )
    plain = _tables(model, order, error, False)
    com = model.postures(model.at(np.random.default_rng(SEED).random((500, model.k)))).com
    if np.ptp(com, axis=0).max() <= 1e-9 * robot_size_of(model.recipe):
        return plain
    # All contacts share a com that moves; both are off by half as much.
    both = plain, _tables(model, order, 0.5 * error, True)
    return min(both, key=lambda one: sum(array.bytes for array in one.arrays()))


def _tables(model: Model, order: tuple[int, ...], error: float, common: bool) -> Series:
    """Leave out what is small of a robot's series, and round the rest."""
    knots, series = pieces_of(model, order, error, common)
    k, shape = len(knots), [len(one) - 1 for one in knots]
    masks, kept = [], []
    for group in range(series.shape[-2]):
        own = series[..., group, :]
        moving = [
            j
            for j in range(k)
            if shape[j] > 1
            and (
                np.abs(np.delete(own, 0, axis=k + j)).max(initial=0.0) > 1e-9 * error
                or np.ptp(own, axis=j).max() > 1e-9 * error
            )
        ]
        masks.append(sum(1 << j for j in moving))
        for piece in itertools.product(*(range(shape[j]) for j in moving)):
            place = dict(zip(moving, piece, strict=True))
            here = own[tuple(place.get(j, 0) for j in range(k))]
            kept.append([_shortened(here[..., i], LEFT_OUT * error / 3**0.5) for i in range(3)])
    largest = max(float(np.abs(one).max(initial=0.0)) for row in kept for one in row)
    most = max(int(np.count_nonzero(one)) for row in kept for one in row)
    # Two bytes for a code if they will do.
    width = 2 if 0.5 * 3**0.5 * most * largest / LARGEST[2] <= ROUNDED * error else 3
    unit = np.float32(max(largest, 1e-30) / LARGEST[width] * (1.0 + 1e-6))
    codes = [[np.rint(one / float(unit)).astype(np.int64) for one in row] for row in kept]
    used = np.concatenate([np.argwhere(one) for row in codes for one in row])
    degrees = tuple(used.max(axis=0, initial=0).tolist())
    return Series(
        tuple(knots), degrees, tuple(masks), *_packed(codes, degrees), unit, width, common
    )


def _shortened(values: Floats, budget: float) -> Floats:
    """Return coefficients with 0 for the smallest, whose sum is at most `budget`."""
    size = np.abs(values).ravel()
    order = np.argsort(size, kind="stable")
    result = values.copy()
    result.flat[order[np.cumsum(size[order]) <= budget]] = 0.0
    return result


def _packed(
    codes: list[list[NDArray[np.int64]]], degrees: Degrees
) -> tuple[tuple[Pair, ...], tuple[Row, ...], NDArray[np.uint8], NDArray[np.int64]]:
    """Return products, rows, and entries and codes of the terms; rows alike are stored once."""
    begins = [1, *(1 + total for total in itertools.accumulate(degrees))]
    table, terms = Products(begins[-1]), list[tuple[int, int]]()
    known: dict[tuple[tuple[int, int], ...], Row] = {}
    rows = []
    for row in codes:
        own, counts = list[tuple[int, int]](), []
        for one in row:
            # The smallest first: rounding of the sum is least so.
            for _, n in sorted(
                (abs(int(one[n])), n) for n in map(tuple, np.argwhere(one).tolist())
            ):
                factors = tuple(b + d - 1 for b, d in zip(begins, n, strict=False) if d)
                own.append((table.of(factors), int(one[n])))
            counts.append(int(np.count_nonzero(one)))
        key = ((counts[0], counts[1]), *own)
        if key not in known:
            known[key] = (len(terms), counts[0], counts[1], counts[2])
            terms += own
        rows.append(known[key])
    most = max(max(row[1:]) for row in rows)
    if table.count > MOST_ENTRIES or len(terms) > MOST_TERMS or most > MOST_ENTRIES:
        raise InputError(
            f"its positions need {table.count} functions and {len(terms)} coefficients, more than "
            f"the {MOST_ENTRIES} and {MOST_TERMS} of the runtime"
        )
    entries, values = np.array(terms, np.int64).reshape(-1, 2).T
    return tuple(table.pairs), tuple(rows), entries.astype(np.uint8), values


# Places along each axis of the grid by the number of parameters, and other postures.
PLACES, POSTURES, SEED = (1, 20_001, 301, 46), 30_000, 13


def most_off(model: Model, host: Host, order: tuple[int, ...], knots: tuple[Floats, ...]) -> float:
    """Return a bound of how far (length) any contact of the C is from the real one.

    `host` reads the series, in which contacts have an `order`, and which are cut at `knots`.
    """
    box = widened(model)

    def off(params: Floats) -> Floats:
        centres = box.postures(_single(params)).centres[:, list(order)]
        return host.positions(params) - centres

    low, high = _single(box.lower), _single(box.upper)
    count = PLACES[model.k]
    grid = combinations([np.linspace(a, b, count) for a, b in zip(low, high, strict=True)])
    seen = off(grid).reshape(*(count,) * model.k, -1, 3)
    bound = float(np.sqrt((seen**2).sum(axis=-1)).max())
    for axis in range(model.k):
        between = np.diff(seen, axis=axis)
        bound += float(np.sqrt((between**2).sum(axis=-1)).max())
    others = off(_others(low, high, knots))
    return max(bound, float(np.sqrt((others**2).sum(axis=-1)).max()))


def _single(numbers: Floats) -> Floats:
    """Return numbers rounded to single precision."""
    return numbers.astype(np.float32).astype(np.float64)


def _others(low: Floats, high: Floats, knots: tuple[Floats, ...]) -> Floats:
    """Return random postures (m, k), and some on both sides of each end and cut."""
    rng = np.random.default_rng(SEED)
    params = (low + (high - low) * rng.random((POSTURES, len(low)))).astype(np.float32)
    for axis, cuts in enumerate(knots):
        single = cuts.astype(np.float32)
        beside = np.concatenate(
            [single, np.nextafter(single, low[axis]), np.nextafter(single, high[axis])]
        )
        some = slice(axis, POSTURES // 2, len(knots))
        params[some, axis] = np.clip(rng.choice(beside, len(params[some])), low[axis], high[axis])
    return params.astype(np.float64)
