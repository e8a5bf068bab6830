"""A map's bytes taken apart again, as the runtime takes them apart.

Owns the reading.  Nothing of what wrote the bytes is asked, so what is proved is proved of what
stands in flash.
"""

import struct
from dataclasses import dataclass

import numpy as np

from lutgen.vector import Floats

HEAD, AXIS = 32, 14
POINTS, POLY, TABLES = 1, 2, 3
COMMON, RATED, ROUND, NEAR, BY_SERIES = 1, 2, 4, 8, 16
EITHER_WAY = 128


class Bytes:
    """A place in the bytes that moves on as numbers are read."""

    def __init__(self, held: bytes, at: int) -> None:
        self.held, self.at = held, at

    def read(self, kind: str, count: int) -> list[float]:
        """Return numbers of a kind of `struct`."""
        layout = f"<{count}{kind}"
        found = struct.unpack_from(layout, self.held, self.at)
        self.at += struct.calcsize(layout)
        return list(found)

    def whole(self, kind: str, count: int) -> list[int]:
        """Return whole numbers."""
        return [int(one) for one in self.read(kind, count)]


@dataclass(frozen=True, eq=False)
class Points:
    """Positions as terms: weight and entry of each, coordinate by coordinate.

    `angles`: (parameter, rate) of each; `travels`: parameters; `products`: pairs of entries.
    `thresholds`: the lowest height, the steepest normal, the least width.
    """

    angles: list[tuple[int, float]]
    travels: list[int]
    products: list[tuple[int, int]]
    coordinates: list[list[tuple[float, int]]]
    near: bool
    thresholds: tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Poly:
    """Positions as Chebyshev series: per parameter middle and 2 / span, per contact its codes.

    `codes` has three arrays (terms, 3), `degrees` the degrees of their terms.
    """

    unit: float
    places: list[tuple[float, float]]
    degrees: list[list[tuple[int, ...]]]
    codes: list[Floats]


@dataclass(frozen=True, eq=False)
class Tables:
    """Positions as tables: per contact its parameters, and codes (nodes..., 3) in units.

    `places`: where an axis begins, 1 / span, and the same of steps.
    """

    unit: float
    places: list[tuple[float, float, int, int]]
    axes: list[list[int]]
    codes: list[Floats]


@dataclass(frozen=True, eq=False)
class Held:
    """A map of three points.

    `low`, `high`, `slack` (k,): its axes (slack below 0: it turns all the way round), `slack_i` the
    same in steps; `guard` (rad), `guard_i` (1/32767); `order` of the recipe's contacts, and whether
    they may run `either` way round.
    """

    codec: int
    low: Floats
    high: Floats
    slack: Floats
    slack_i: Floats
    guard: float
    guard_i: int
    order: tuple[int, int, int]
    either: bool
    body: Points | Poly | Tables


def held(blob: bytes) -> Held:
    """Take a map apart.

    Raises
    ------
    ValueError
        For a map that is not of three points in closed form, polynomials or tables.
    struct.error
        For one that ends early.
    """
    codec, params = blob[9], blob[10]
    guard, _, guard_i, _ = struct.unpack_from("<ffHH", blob, 20)
    rows = [struct.unpack_from("<fffH", blob, HEAD + AXIS * at) for at in range(params)]
    axes = np.array(rows, np.float64).reshape(params, 4).T
    source = Bytes(blob, HEAD + AXIS * params)
    code = blob[source.at + 7]
    body: Points | Poly | Tables
    if codec == POINTS:
        body = _points(source, blob[13])
    elif codec == POLY:
        body = _poly(source, params)
    elif codec == TABLES:
        body = _tables(source, params)
    else:
        raise ValueError("not of three points")
    if source.at != len(blob):
        raise ValueError(f"ends at byte {source.at} of {len(blob)}")
    order = (code & 3, code >> 2 & 3, code >> 4 & 3)
    either = codec != TABLES and bool(code & EITHER_WAY)
    low, high, slack, slack_i = axes
    return Held(codec, low, high, slack, slack_i, guard, int(guard_i), order, either, body)


def _points(source: Bytes, contacts: int) -> Points:
    angles, travels, products, axes = source.whole("B", 4)
    (terms,) = source.whole("H", 1)
    flags, _ = source.whole("B", 2)
    lowest, steepest, width = source.read("f", 3)
    (more,) = source.whole("H", 1)
    if flags & BY_SERIES:
        raise ValueError("by series")
    if contacts != 3 or axes or flags & ROUND or more:
        raise ValueError("not of three points")
    weights = source.read("f", terms)
    rates = source.read("f", angles) if flags & RATED else [1.0] * angles
    joints = source.whole("B", angles + travels)
    pairs = source.whole("B", 2 * products)
    counts = source.whole("B", 12 if flags & COMMON else 9)
    entries = source.whole("B", terms)
    pairs_of = iter(zip(weights, entries, strict=True))
    return Points(
        list(zip(joints[:angles], rates, strict=True)),
        joints[angles:],
        list(zip(pairs[::2], pairs[1::2], strict=True)),
        [[next(pairs_of) for _ in range(count)] for count in counts],
        bool(flags & NEAR),
        (lowest, steepest, width),
    )


def _counted(most: list[int], terms: int) -> list[tuple[int, ...]]:
    """Return the degrees of terms in the runtime's order: the first parameter fastest."""
    now, found = [0] * len(most), []
    for _ in range(terms):
        found.append(tuple(now))
        for axis, degree in enumerate(most):
            if now[axis] < degree and sum(now) < max(most):
                now[axis] += 1
                break
            now[axis] = 0
    return found


def _poly(source: Bytes, params: int) -> Poly:
    (unit,) = source.read("f", 1)
    source.whole("B", 4)
    places = source.read("f", 2 * params)
    shape = [source.whole("B", params + 1) for _ in range(3)]
    codes = [np.array(source.read("h", 3 * row[-1])).reshape(-1, 3) for row in shape]
    degrees = [_counted(row[:-1], row[-1]) for row in shape]
    return Poly(unit, list(zip(places[::2], places[1::2], strict=True)), degrees, codes)


def _tables(source: Bytes, params: int) -> Tables:
    (unit,) = source.read("f", 1)
    wide = source.whole("B", 4)[0]
    places = []
    for _ in range(params):
        low, inverse = source.read("f", 2)
        first, rate = source.whole("H", 2)
        places.append((low, inverse, first, rate))
    axes, shapes = [], []
    for _ in range(3):
        (count,) = source.whole("B", 1)
        numbers = source.whole("B", 2 * count)
        axes.append(numbers[::2])
        shapes.append((*numbers[1::2], 3))
    codes = []
    for shape in shapes:
        flat = np.array(source.read("h" if wide else "b", int(np.prod(shape))))
        codes.append(flat.reshape(shape) * (1.0 if wide else 128.0))
    return Tables(unit, places, axes, codes)
