"""What the C has for the contacts, beside where they truly are.

Owns two bounds for each coordinate: how far the stored positions are from the true ones in real
numbers, over cells of postures, and how far single precision is from real numbers, anywhere.
Closed forms differ from the truth in the last digits of their weights alone, so their difference is
added up term by term; polynomials and tables differ as functions.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from firmware_export.prove.blob import Held, Points, Poly, Tables
from firmware_export.prove.intervals import Interval, stack
from firmware_export.prove.motion import Monomial, Sum, Waves
from firmware_export.prove.rounding import (
    FURTHEST,
    HAIR,
    HALF_UNIT,
    NEAREST,
    SINE,
    SINE_NEAR,
    Off,
)
from lutgen.vector import Floats

# Rates of angles that are one and the same but for rounding.
SAME_RATE = 1e-6


class Stored(NamedTuple):
    """The positions of a map beside the true ones.

    `off` (cells without length) -> stored minus true (9, n), in real numbers; `slope` (cells,
    parameter) -> its derivative over cells; `errors` (9,): what rounding adds; `cuts`: places of
    each parameter that no cell may straddle.
    """

    off: Callable[[Waves], Interval]
    slope: Callable[[Waves, int], Interval]
    errors: Floats
    cuts: list[Floats]


def stored(held: Held, truth: list[Sum], box: Floats, lag: Floats, integer: bool) -> Stored:
    """Compare a map's positions with the true ones.

    Parameters
    ----------
    held : Held
    truth : list of three Sum
        In the order of the map.
    box : (k, 2) float64
        Least and largest value of each parameter.
    lag : (k,) float64
        How far off a parameter is when it comes to the tables.
    integer : bool
        Whether the map is read without floats.

    Raises
    ------
    ValueError
        Where the lemmas about single precision do not reach so far; tells why.
    """
    if isinstance(held.body, Points):
        return _points(held.body, truth, box, lag)
    if isinstance(held.body, Poly):
        return _poly(held.body, truth, box, lag)
    return _tables(held, held.body, truth, lag, integer)


def _reach(box: Floats) -> Floats:
    return np.asarray(np.abs(box).max(axis=1))


def _points(body: Points, truth: list[Sum], box: Floats, lag: Floats) -> Stored:
    reach = _reach(box)
    known = {factor for one in truth for monomial in one for factor in monomial}
    entries: list[Monomial] = [()]
    offs = [Off(1.0, 0.0)]
    for parameter, held_rate in body.angles:
        alike = [r for kind, p, r in known if p == parameter and kind != "t"]
        rate = min(alike, key=lambda r: abs(r - held_rate), default=held_rate)
        rate = rate if abs(rate - held_rate) <= SAME_RATE * rate else held_rate
        widest = reach[parameter] * max(rate, held_rate) * HAIR
        limit = NEAREST if body.near else FURTHEST
        if widest > limit:
            raise ValueError(f"an angle of {widest:.4g} rad is beyond {limit} rad")
        error = rate * lag[parameter] + abs(rate - held_rate) * reach[parameter]
        error += HALF_UNIT * widest if held_rate != 1.0 else 0.0
        error = (error + (SINE_NEAR if body.near else SINE)) * HAIR
        entries += [(("s", parameter, rate),), (("c", parameter, rate),)]
        offs += [Off(1.0, error)] * 2
    for parameter in body.travels:
        entries.append((("t", parameter, 1.0),))
        offs.append(Off(float(reach[parameter]), float(lag[parameter])))
    for one, other in body.products:
        entries.append(tuple(sorted((*entries[one], *entries[other]))))
        offs.append(offs[one].times(offs[other]))
    sums: list[dict[Monomial, Interval]] = []
    errors: list[Off] = []
    for terms in body.coordinates:
        total: dict[Monomial, Interval] = {}
        added = Off(0.0, 0.0)
        for at, (weight, entry) in enumerate(terms):
            monomial = entries[entry]
            total[monomial] = total.get(monomial, Interval.of(0.0)) + weight
            part = Off(abs(weight), 0.0).times(offs[entry])
            added = part if at == 0 else added.plus(part)
        sums.append(total)
        errors.append(added)
    if len(sums) == 12:
        shared = sums[:3]
        for at in range(9):
            for monomial, value in shared[at % 3].items():
                own = sums[3 + at]
                own[monomial] = own.get(monomial, Interval.of(0.0)) + value
        errors = [errors[3 + at].plus(errors[at % 3]) for at in range(9)]
        sums = sums[3:]
    differences = [_minus(sums[3 * at : 3 * at + 3], true) for at, true in enumerate(truth)]

    def off(waves: Waves) -> Interval:
        return _side_by_side([waves.value(one) for one in differences])

    def slope(waves: Waves, parameter: int) -> Interval:
        return _side_by_side([waves.slope(one, parameter) for one in differences])

    return Stored(off, slope, np.array([one.error for one in errors]), [np.zeros(0)] * len(box))


def _minus(stored_: list[dict[Monomial, Interval]], true: Sum) -> Sum:
    """Return three sums of one number as one of vectors, less the true one."""
    zero = Interval.of(0.0)
    monomials = dict.fromkeys([m for one in stored_ for m in one] + list(true))
    return {
        monomial: stack([one.get(monomial, zero) for one in stored_])
        - true.get(monomial, Interval.of(np.zeros(3)))
        for monomial in monomials
    }


def _side_by_side(parts: list[Interval]) -> Interval:
    """Return coordinates (9, n) of contacts one after the other."""
    return Interval(
        np.concatenate([part.low for part in parts]),
        np.concatenate([part.high for part in parts]),
    )


def _beside(
    truth: list[Sum],
    over: Callable[[Interval, int | None], list[Interval]],
    errors: list[float],
    cuts: list[Floats],
) -> Stored:
    """Return functions beside the truth.

    `over` gives the three stored positions over cells, or their derivatives along a parameter.
    """

    def off(waves: Waves) -> Interval:
        true = _side_by_side([waves.value(one) for one in truth])
        return _side_by_side(over(waves.box, None)) - true

    def slope(waves: Waves, parameter: int) -> Interval:
        true = _side_by_side([waves.slope(one, parameter) for one in truth])
        return _side_by_side(over(waves.box, parameter)) - true

    return Stored(off, slope, np.array(errors), cuts)


def _series(s: Interval, most: int, turn: int) -> list[Interval]:
    """Return T_0 ... T_most (turn 0) or their derivatives (1) over intervals of s, |s| <= 1.01.

    In the middle by their recurrences, and to the ends by the largest next derivative there is
    where |s| is largest.
    """
    middle = Interval.of(0.5 * s.low + 0.5 * s.high)
    edge = Interval.of(np.maximum(s.most, 1.0))
    half = (s - middle).most
    here, there = _recurrence(middle, most), _recurrence(edge, most)
    return [
        Interval.of(np.zeros_like(half)) + one[turn].widened(up_to[turn + 1].high * half)
        for one, up_to in zip(here, there, strict=True)
    ]


def _recurrence(s: Interval, most: int) -> list[tuple[Interval, Interval, Interval]]:
    """Return T_n, T_n' and T_n'' at places s."""
    one, zero = Interval.of(np.ones_like(s.low)), Interval.of(np.zeros_like(s.low))
    rows = [(one, zero, zero), (s, one, zero)]
    for _ in range(2, most + 1):
        (a, b, c), (d, e, f) = rows[-1], rows[-2]
        rows.append((s * a * 2.0 - d, a * 2.0 + s * b * 2.0 - e, b * 4.0 + s * c * 2.0 - f))
    return rows[: most + 1]


def _poly(body: Poly, truth: list[Sum], box: Floats, lag: Floats) -> Stored:
    most = [max(d[axis] for row in body.degrees for d in row) for axis in range(len(box))]

    def place(cells: Interval, axis: int) -> Interval:
        middle, inverse = body.places[axis]
        return (cells[axis] - middle) * inverse

    def over(cells: Interval, along: int | None) -> list[Interval]:
        parts = [
            _series(place(cells, axis), count, int(axis == along))
            for axis, count in enumerate(most)
        ]
        factor = body.unit if along is None else Interval.of(body.unit) * body.places[along][1]
        rows = []
        for degrees, codes in zip(body.degrees, body.codes, strict=True):
            total = Interval.of(np.zeros((3, cells.low.shape[1])))
            for degree, code in zip(degrees, codes, strict=True):
                term = Interval.of(np.ones(cells.low.shape[1]))
                for axis, n in enumerate(degree):
                    term = term * parts[axis][n]
                total = total + Interval.of(code[:, None]) * term[None, :]
            rows.append(total * factor)
        return rows

    waves: list[list[Off]] = []
    for axis, (middle, inverse) in enumerate(body.places):
        far = float(np.abs(box[axis] - middle).max())
        if far * abs(inverse) > 1.01:
            raise ValueError("the polynomials do not reach over the axis")
        s = Off(far, float(lag[axis])).plus(Off(0.0, 0.0)).times(Off(abs(inverse), 0.0))
        rows = [Off(1.0, 0.0), s]
        for _ in range(2, most[axis] + 1):
            twice = Off(2.0 * s.size, 2.0 * s.error).times(rows[-1])
            # What the recurrence makes is T_n again, however large its parts are.
            rows.append(twice.plus(rows[-2])._replace(size=_greatest(s.size, len(rows))))
        waves.append(rows)
    errors = []
    for degrees, codes in zip(body.degrees, body.codes, strict=True):
        for column in range(3):
            total = Off(0.0, 0.0)
            for degree, code in zip(degrees, codes, strict=True):
                term = Off(abs(float(code[column])), 0.0)
                for axis, n in enumerate(degree):
                    term = term.times(waves[axis][n])
                total = total.plus(term)
            errors.append(total.times(Off(body.unit, 0.0)).error)
    return _beside(truth, over, errors, [np.zeros(0)] * len(box))


def _greatest(s: float, degree: int) -> float:
    """Return the most that |T_n| is up to a place s, at most a little beyond 1."""
    return math.cosh(degree * math.acosh(max(s, 1.0))) * HAIR


def _tables(held: Held, body: Tables, truth: list[Sum], lag: Floats, integer: bool) -> Stored:
    cuts: list[list[float]] = [[] for _ in body.places]
    for axes, codes in zip(body.axes, body.codes, strict=True):
        for axis, nodes in zip(axes, codes.shape[:-1], strict=True):
            low, inverse = body.places[axis][:2]
            cuts[axis] += [low + at / (inverse * (nodes - 1)) for at in range(nodes)]

    def over(cells: Interval, along: int | None) -> list[Interval]:
        return [
            _looked_up(body, contact, cells, along) * body.unit
            if along is None or along in body.axes[contact]
            else Interval.of(np.zeros((3, cells.low.shape[1])))
            for contact in range(3)
        ]

    worst = _whole if integer else _single
    errors = [
        worst(held, body, contact, column, lag) for contact in range(3) for column in range(3)
    ]
    return _beside(truth, over, errors, [np.unique(one) for one in cuts])


def _looked_up(body: Tables, contact: int, cells: Interval, along: int | None) -> Interval:
    """Return a table's point (3, n) in units over cells that straddle no node, or a derivative."""
    axes, codes = body.axes[contact], body.codes[contact]
    middle = 0.5 * cells.low + 0.5 * cells.high
    count = cells.low.shape[1]
    parts, lower = [], []
    for axis, nodes in zip(axes, codes.shape[:-1], strict=True):
        low, inverse = body.places[axis][:2]
        at = np.clip(np.floor((middle[axis] - low) * inverse * (nodes - 1)), 0, nodes - 2)
        lower.append(at.astype(np.intp))
        parts.append((cells[axis] - low) * (Interval.of(inverse) * (nodes - 1.0)) - at)
    # Interpolate along one axis after the other: differences first, so that nothing cancels.
    corners = [()] if not axes else [tuple(c) for c in np.ndindex(*(2,) * len(axes))]
    values = {
        corner: Interval.of(
            codes[tuple(at + up for at, up in zip(lower, corner, strict=True))].reshape(-1, 3).T
            * np.ones(count)
        )
        for corner in corners
    }
    for place in reversed(range(len(axes))):
        axis, nodes = axes[place], codes.shape[place]
        rate = Interval.of(body.places[axis][1]) * (nodes - 1.0)
        for corner in {key[:place] for key in values}:
            below, above = values.pop((*corner, 0)), values.pop((*corner, 1))
            change = above - below
            values[corner] = change * rate if axis == along else below + change * parts[place]
    return values[()]


def _steps(codes: Floats, column: int) -> list[float]:
    """Return the largest difference of neighbours along each axis of a table."""
    return [
        float(np.abs(np.diff(codes[..., column], axis=axis)).max())
        for axis in range(codes.ndim - 1)
    ]


def _single(held: Held, body: Tables, contact: int, column: int, lag: Floats) -> float:
    """Return the error (length) of a coordinate that floats look up."""
    axes, codes = body.axes[contact], body.codes[contact]
    error, weight = 0.0, Off(1.0, 0.0)
    for place, (axis, change) in enumerate(zip(axes, _steps(codes, column), strict=True)):
        inverse = body.places[axis][1]
        span = abs(1.0 / inverse)
        x = Off(span, float(lag[axis])).plus(Off(0.0, 0.0)).times(Off(abs(inverse), 0.0))
        x = x.times(Off(codes.shape[place] - 1.0, 0.0))
        error += change * x.error
        weight = weight.times(Off(1.0, HALF_UNIT))
    total = Off(0.0, 0.0)
    for at in range(2 ** len(axes)):
        term = Off(float(np.abs(codes[..., column]).max()), 0.0).times(weight)
        total = term if at == 0 else total.plus(term)
    # The sizes of all terms together are those of one: their weights add up to 1.
    sum_ = Off(float(np.abs(codes[..., column]).max()), error + total.error)
    return sum_.times(Off(body.unit, 0.0)).error + 1e-12 * sum_.size * body.unit


def _whole(held: Held, body: Tables, contact: int, column: int, lag: Floats) -> float:
    """Return the error (length) of a coordinate that whole numbers look up."""
    axes, codes = body.axes[contact], body.codes[contact]
    error = 1e-9
    for place, (axis, change) in enumerate(zip(axes, _steps(codes, column), strict=True)):
        low, inverse, first, rate = body.places[axis]
        last = codes.shape[place] - 1.0
        span = held.high[axis] - held.low[axis]
        # Rounded to the nearest place, then cut off to 1 / 16384 of a cell; both ends tell how far
        # the line of places is from the true one, and the last place is one short.
        ends = [0.0 if held.slack[axis] < 0.0 else -held.slack_i[axis], 32767.0]
        line = max(
            abs(
                first
                + rate * q / 16384.0
                - 65536.0 * inverse * (held.low[axis] + span * q / 32767.0 - low)
            )
            for q in ends
        )
        away = (line + 1.5) / 65536.0 * last + 1.0 / 16384.0
        error += change * (away + lag[axis] * abs(inverse) * last)
    if len(axes) == 1:
        error += 1.0
    elif axes:
        most = float(np.abs(codes[..., column]).max())
        error += 2.0 ** len(axes) * (1.0 + most * (len(axes) - 1.0) / 16384.0)
    return error * body.unit * HAIR
