"""A map's bytes taken apart as the runtime takes them apart, and what they are off the truth.

Two things of each coordinate: the stored position in real numbers, beside the true one, over a
cell; and how far single precision or whole numbers are from real numbers, anywhere.
"""

import math
import struct
from typing import Any

import numpy as np
from flint import arb
from numpy.typing import NDArray

from proofs.prove.balls import ONE, ZERO, Jet, vector
from proofs.prove.motion import Factor, Monomial, Polynomial, Postures
from proofs.prove.rounding import FURTHEST, NEAREST, SINE, SINE_NEAR, Off, U, exact

HEAD, AXIS = 32, 14
POINTS, TABLES = 1, 3
COMMON, RATED, ROUND, NEAR, BY_SERIES = 1, 2, 4, 8, 16
EITHER_WAY = 128
# Rates of angles that are one and the same but for rounding.
SAME_RATE = 1e-6


class CannotProveError(ValueError):
    """A map or a robot that the lemmas say nothing about; tells why."""


class Map:
    """What every map of three points has.

    `guard` (rad), `guard_i` (1/32767); `low`, `high`, `slack` of each parameter; `box`: the values
    that are read; `lag`: how far off a value is when it comes to the tables; `order` of the
    recipe's contacts, and whether they may run `either` way; `limits`: lowest height, steepest
    normal and least width that are asked for.
    """

    def __init__(self, blob: bytes, integer: bool) -> None:
        self.codec, parameters, contacts = blob[9], blob[10], blob[13]
        if self.codec not in (POINTS, TABLES) or contacts != 3:
            raise CannotProveError("the map is not one of three points")
        self.blob, self.integer = blob, integer
        self.guard, _, self.guard_i = struct.unpack_from("<ffH", blob, 20)
        rows = [struct.unpack_from("<fffH", blob, HEAD + AXIS * at) for at in range(parameters)]
        self.low, self.high, self.slack, self.slack_i = (
            [row[at] for row in rows] for at in range(4)
        )
        if any(slack < 0.0 for slack in self.slack):
            raise CannotProveError("a joint turns all the way round")
        self.at = HEAD + AXIS * parameters
        code = blob[self.at + 7]
        self.order = [code >> 2 * at & 3 for at in range(3)]
        self.either = self.codec == POINTS and bool(code & EITHER_WAY)
        self.limits = [0.0, -2.0, 0.0]
        self.reach, self.hair, self.lag, self.box = [], [], [], []
        for low, high, slack in zip(self.low, self.high, self.slack, strict=True):
            reach = max(abs(low), abs(high)) + slack
            hair = float((8 * U * reach).upper())
            # Steps become floats with some rounding; tables end where the box does.
            lag = 4 * U * (high - low) + 2 * U * reach + (hair if self.codec == TABLES else 0.0)
            self.reach.append(arb(reach) + hair)
            self.hair.append(hair)
            self.lag.append(lag)
            self.box.append((low - slack - hair, high + slack + hair))

    def read(self, kind: str, count: int) -> list[Any]:
        """Return the next numbers of a kind of `struct`."""
        found = struct.unpack_from(f"<{count}{kind}", self.blob, self.at)
        self.at += struct.calcsize(f"<{count}{kind}")
        return list(found)


class Points:
    """Positions in closed form: they differ from the truth in the last digits of weights alone.

    `errors`: what rounding adds to each coordinate (length); `cuts`: places of each parameter that
    no cell may straddle.
    """

    def __init__(self, map_: Map, truth: list[Polynomial]) -> None:
        angles, travels, products, axes = map_.read("B", 4)
        (terms,) = map_.read("H", 1)
        flags, _ = map_.read("B", 2)
        map_.limits = map_.read("f", 3)
        (more,) = map_.read("H", 1)
        if flags & (BY_SERIES | ROUND) or axes or more:
            raise CannotProveError("the positions are not three points in closed form")
        weights = map_.read("f", terms)
        rates = map_.read("f", angles) if flags & RATED else [1.0] * angles
        joints = map_.read("B", angles + travels)
        pairs = map_.read("B", 2 * products)
        counts = map_.read("B", 12 if flags & COMMON else 9)
        which = map_.read("B", terms)
        entries: list[tuple[Monomial, Off]] = [((), exact(ONE))]
        known = {factor for one in truth for monomial in one for factor in monomial}
        for at, rate in zip(joints[:angles], rates, strict=True):
            entries += _waves(map_, known, at, rate, bool(flags & NEAR))
        for at in joints[angles:]:
            entries.append(((("t", at, 1.0),), Off(map_.reach[at], map_.lag[at])))
        for one, other in zip(pairs[::2], pairs[1::2], strict=True):
            (a, x), (b, y) = entries[one], entries[other]
            entries.append((tuple(sorted(a + b)), x.times(y)))
        parts = iter([(weight, *entries[at]) for weight, at in zip(weights, which, strict=True)])
        sums, offs = [], []
        for count in counts:
            total, off = Polynomial(), exact(ZERO)
            for term in range(count):
                weight, monomial, entry = next(parts)
                total = total + Polynomial({monomial: arb(weight)})
                part = exact(arb(weight)).times(entry)
                off = off.plus(part) if term else part
            sums.append(total)
            offs.append(off)
        if flags & COMMON:
            offs = [offs[3 + at].plus(offs[at % 3]) for at in range(9)]
            sums = [sums[3 + at] + sums[at % 3] for at in range(9)]
        self.errors = vector(off.error for off in offs)
        self.cuts: list[list[float]] = [[] for _ in map_.low]
        self._truth = truth
        self._off = [held - true for held, true in zip(sums, truth, strict=True)]

    def compared(self, here: Postures) -> tuple[Any, Any]:
        """Return the true coordinates over a cell, and stored minus true, term by term."""
        return here.values(self._truth), here.values(self._off)


def _waves(
    map_: Map, known: set[Factor], parameter: int, held: float, near: bool
) -> list[tuple[Monomial, Off]]:
    """Return sine and cosine of a stored rate times a parameter."""
    rates = [rate for kind, at, rate in known if at == parameter and kind != "t"]
    rate = min(rates, key=lambda one: abs(one - held), default=held)
    rate = rate if abs(rate - held) <= SAME_RATE * rate else held
    reach = map_.reach[parameter]
    widest = reach * max(rate, held)
    if not widest < (NEAREST if near else FURTHEST):
        raise CannotProveError(f"an angle of {float(widest):.4g} rad: sines were not tried so far")
    error = rate * map_.lag[parameter] + abs(arb(rate) - held) * reach
    error += U * widest if held != 1.0 else ZERO
    off = Off(ONE, (error + (SINE_NEAR if near else SINE)).upper())
    return [((("s", parameter, rate),), off), ((("c", parameter, rate),), off)]


class Tables:
    """Positions looked up: linear between nodes along each axis; see `Points`."""

    def __init__(self, map_: Map, truth: list[Polynomial]) -> None:
        self._map, self._truth = map_, truth
        (unit,) = map_.read("f", 1)
        wide = map_.read("B", 4)[0]
        self._unit = arb(unit)
        # Where each axis begins, 1 / span, and the same of steps.
        self._places = [(*map_.read("f", 2), *map_.read("H", 2)) for _ in map_.low]
        rows = [map_.read("B", 2 * map_.read("B", 1)[0]) for _ in range(3)]
        self._tables: list[tuple[list[int], NDArray[np.int64]]] = []
        self.cuts: list[list[float]] = [[] for _ in map_.low]
        for row in rows:
            axes, nodes = row[::2], row[1::2]
            flat = map_.read("h" if wide else "b", 3 * math.prod(nodes))
            codes = np.array(flat, np.int64).reshape(*nodes, 3) * (1 if wide else 128)
            self._tables.append((axes, codes))
            for axis, count in zip(axes, nodes, strict=True):
                low, inverse = self._places[axis][:2]
                self.cuts[axis] += [low + at / (inverse * (count - 1)) for at in range(count)]
        error = self._whole if map_.integer else self._single
        self.errors = vector(
            (error(axes, codes[..., column]) * self._unit).upper()
            for axes, codes in self._tables
            for column in range(3)
        )

    def compared(self, here: Postures) -> tuple[Any, Any]:
        """Return the true coordinates over a cell that straddles no node, and stored minus true."""
        truth = here.values(self._truth)
        return truth, vector(x for row in self._tables for x in self._looked_up(row, here)) - truth

    def _looked_up(self, table: tuple[list[int], NDArray[np.int64]], here: Postures) -> list[Jet]:
        axes, codes = table
        cell, parts = [], []
        for axis, nodes in zip(axes, codes.shape, strict=False):
            low, inverse = self._places[axis][:2]
            at = math.floor((sum(here.box[axis]) / 2.0 - low) * inverse * (nodes - 1))
            cell.append(min(max(at, 0), nodes - 2))
            part = here.linear(axis, arb(low), arb(inverse) * (nodes - 1))
            parts.append(part - here.constant(arb(cell[-1])))
        found = []
        for column in range(3):
            near = codes[(*(slice(at, at + 2) for at in cell), column)]
            values = [here.constant(arb(int(one))) for one in near.ravel()]
            # Along one axis after the other, the last first: differences, so that nothing cancels.
            for part in reversed(parts):
                values = [
                    low + (high - low) * part
                    for low, high in zip(values[::2], values[1::2], strict=True)
                ]
            found.append(values[0].scaled(self._unit))
        return found

    def _single(self, axes: list[int], codes: NDArray[np.int64]) -> arb:
        """Return the error (units) of a coordinate that floats look up."""
        largest, error, weight = arb(int(np.abs(codes).max())), ZERO, exact(ONE)
        for axis, nodes, step in zip(axes, codes.shape, _steps(codes), strict=True):
            inverse = arb(self._places[axis][1])
            place = Off((1 / inverse).upper(), self._map.lag[axis]).plus(exact(ZERO))
            error += step * place.times(exact(inverse)).times(exact(arb(nodes - 1))).error
            weight = weight.times(Off(ONE, U))
        term = total = exact(largest).times(weight)
        for _ in range(2 ** len(axes) - 1):
            total = total.plus(term)
        # All terms together are as large as one: their weights add up to 1.  Nodes are where
        # doubles have them, so a cell may straddle one by a hair.
        found = Off(largest, error + total.error).times(exact(self._unit))
        return found.error / self._unit + arb("1e-12") * largest

    def _whole(self, axes: list[int], codes: NDArray[np.int64]) -> arb:
        """Return the error (units) of a coordinate that whole numbers look up."""
        count, error, map_ = len(axes), arb("1e-9"), self._map
        for axis, nodes, step in zip(axes, codes.shape, _steps(codes), strict=True):
            low, inverse, first, rate = self._places[axis]
            begin, span = map_.low[axis], arb(map_.high[axis]) - map_.low[axis]
            # Rounded to the nearest place, then cut off to 1 / 16384 of a cell; both ends tell how
            # far the line of places is from the true one, and the last place is one short.
            line = max(
                abs(
                    first
                    + rate * arb(q) / 16384
                    - 65536 * arb(inverse) * (begin + span * q / 32767 - low)
                ).upper()
                for q in (-map_.slack_i[axis], 32767)
            )
            away = (line + arb("1.5")) / 65536 * (nodes - 1) + ONE / 16384
            error += step * (away + map_.lag[axis] * inverse * (nodes - 1))
        if count == 1:
            error += 1
        elif count:
            largest = arb(int(np.abs(codes).max()))
            error += 2**count * (1 + largest * (count - 1) / 16384)
        return error


def _steps(codes: NDArray[np.int64]) -> list[int]:
    """Return the largest difference of neighbours along each axis."""
    return [int(np.abs(np.diff(codes, axis=axis)).max()) for axis in range(codes.ndim)]
