"""The tables of positions: entries, products of entries, and the terms of every coordinate.

The layout is that of runtime/smap_joints.h.  This also bounds how far single precision misplaces a
contact.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from firmware_export.contacts.closed import Sum, closed_form
from firmware_export.model import sensor_tolerance
from firmware_export.protocol import CArray
from lutgen.errors import InputError
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# Flags of the runtime.
COMMON, RATED, ROUND, NEAR = 1, 2, 4, 8
# Largest angle (rad) of its shorter sine.
NEAREST = 1.05
MOST_ENTRIES, MOST_COORDINATES = 255, 252
NO_AXIS = 255
# Weights smaller than this part of the robot's size are left out.
NEGLIGIBLE = 1e-9
# Errors of a sine or cosine of the runtime, and of one rounding.
SINE_ERROR, HALF_UNIT = 2.5e-7, 2.0**-24


# A weight and the entry that it multiplies.
Term = tuple[float, int]


@dataclass(frozen=True, eq=False)
class Terms:
    """The tables of a robot's positions.

    `angles`: (parameter, rate) of each angle; `travels`: parameters; `products`: pairs of entries;
    `coordinates`: the terms of each; `axes`: how many distinct axes of discs; `error`: how far
    (length) a contact of the runtime is from the real one; `knots`: where axes of parameters are
    cut, nowhere.
    """

    angles: tuple[tuple[int, float], ...]
    travels: tuple[int, ...]
    products: tuple[tuple[int, int], ...]
    coordinates: tuple[tuple[Term, ...], ...]
    axis_of: tuple[int, ...]
    axes: int
    common: bool
    near: bool
    radii: Floats
    error: float
    knots: tuple[Floats, ...] = ()

    @property
    def entries(self) -> int:
        """How many entries the runtime computes."""
        return 1 + 2 * len(self.angles) + len(self.travels) + len(self.products)

    @property
    def width(self) -> int:
        """How many coordinates the runtime computes."""
        return len(self.coordinates)

    def head(self) -> tuple[list[int], int, int]:
        """Return how many angles, travels, products and axes there are, and terms, and flags."""
        rated, round_ = any(rate != 1.0 for _, rate in self.angles), bool(self.radii.any())
        flags = COMMON * self.common | RATED * rated | ROUND * round_ | NEAR * self.near
        sizes = [len(self.angles), len(self.travels), len(self.products), self.axes]
        return sizes, sum(map(len, self.coordinates)), flags

    def arrays(self) -> Iterator[CArray]:
        """Yield the tables."""
        terms = [term for coordinate in self.coordinates for term in coordinate]
        _, _, flags = self.head()
        radii: Sequence[float] | Floats = self.radii if flags & ROUND else []
        rates = [rate for _, rate in self.angles] if flags & RATED else []
        joints = [parameter for parameter, _ in self.angles] + list(self.travels)
        axis_of, counts = self.axis_of if self.axes else [], [len(one) for one in self.coordinates]
        yield CArray("weights", "float", [one for one, _ in terms], "weight of each term, length")
        yield CArray("rates", "float", rates, "of each angle: rad for each rad of its parameter")
        yield CArray("radii", "float", radii, "radius of each contact")
        yield CArray("joints", "uint8_t", joints, "parameter of each angle and travel")
        yield CArray("products", "uint8_t", self.products, "pairs of entries")
        yield CArray("axes", "uint8_t", axis_of, "axis of each contact")
        yield CArray("counts", "uint8_t", counts, "terms of each coordinate")
        yield CArray("entries", "uint8_t", [entry for _, entry in terms], "entry of each term")


def terms_of(recipe: Recipe, radius: Floats, order: Sequence[int], turning: bool = False) -> Terms:
    """Return the tables of a robot whose contacts (and axles) stand in an order of our own.

    Axes of discs are there only if `turning`; what the runtime has no room for is refused.
    """
    closed = closed_form(recipe)
    moving = any(monomial for monomial in closed.com.terms)
    shift = closed.com.scaled(-1.0)
    centres = [closed.centres[at] for at in order]
    axes, axis_of = _axes([closed.axes[at] if turning else None for at in order])
    vectors = [shift, *centres] if moving else [one + shift for one in centres]
    # Coefficients that are small beside the largest of any position are dropped.
    largest = [float(np.abs(v).max()) for one in closed.centres for v in one.terms.values()]
    size = max([*largest, float(radius.max(initial=0.0)), 1e-12])
    scales = [size] * len(vectors) + [1.0] * len(axes)
    kept = [
        {m: np.where(np.abs(v) < NEGLIGIBLE * scale, 0.0, v) for m, v in one.terms.items()}
        for one, scale in zip([*vectors, *axes], scales, strict=True)
    ]
    sums = [Sum({m: v for m, v in one.items() if v.any()}) for one in kept]
    found = {factor for one in sums for monomial in one.terms for factor in monomial}
    factors = sorted(found, key=lambda one: (one[0] == "t", one[1], one[2], one[0]))
    angles = list(dict.fromkeys((p, rate) for kind, p, rate in factors if kind != "t"))
    travels = [p for kind, p, _ in factors if kind == "t"]
    names = [(kind, p, rate) for p, rate in angles for kind in "sc"]
    entry = {one: at for at, one in enumerate([*names, *(("t", p, 1.0) for p in travels)], 1)}
    table = Products(1 + len(entry))
    coordinates = [
        tuple(
            (float(v[i]), table.of(tuple(entry[one] for one in m)))
            for m, v in one.terms.items()
            if v[i] != 0.0
        )
        for one in sums
        for i in range(3)
    ]
    if table.count > MOST_ENTRIES or len(coordinates) > MOST_COORDINATES:
        raise InputError(
            f"the positions need {table.count} functions and {len(coordinates)} coordinates, more "
            f"than the {MOST_ENTRIES} and {MOST_COORDINATES} of the runtime; use --codec grid"
        )
    ends = [(recipe.parameters[p], rate) for p, rate in angles]
    reach = max(
        (rate * (max(-p.minimum, p.maximum) + sensor_tolerance(p)) for p, rate in ends), default=0.0
    )
    return Terms(
        tuple(angles),
        tuple(travels),
        tuple(table.pairs),
        tuple(coordinates),
        tuple(axis_of),
        len(axes),
        moving,
        reach <= NEAREST,
        np.array([*radius, *(one for share in closed.shares for one in (0.0, share))])[list(order)],
        _error(recipe, sums[: len(vectors)], moving) + NEGLIGIBLE * size * len(table.pairs),
    )


class Products:
    """Numbers products of entries: each is one that is known times one entry more.

    `first` is the number of the first product, `pairs` has the two entries of each.
    """

    def __init__(self, first: int) -> None:
        self.first = first
        self.pairs: list[tuple[int, int]] = []
        self._known: dict[tuple[int, ...], int] = {}

    @property
    def count(self) -> int:
        """Entries before the products and the products."""
        return self.first + len(self.pairs)

    def of(self, factors: tuple[int, ...]) -> int:
        """Return the entry of a product of entries; of none it is the number 1."""
        if len(factors) < 2:
            return factors[0] if factors else 0
        if factors not in self._known:
            self.pairs.append((self.of(factors[:-1]), factors[-1]))
            self._known[factors] = self.count - 1
        return self._known[factors]


def _axes(axes: Sequence[Sum | None]) -> tuple[list[Sum], list[int]]:
    """Return the distinct axes of discs, and which of them each contact has."""
    found, of = list[Sum](), list[int]()
    for axis in axes:
        at = NO_AXIS
        if axis is not None:
            same = (at for at, one in enumerate(found) if _parallel(axis, one))
            at = next(same, len(found))
            found += [axis] if at == len(found) else []
        of.append(at)
    return found, of


def _parallel(one: Sum, other: Sum) -> bool:
    """Return True if unit vectors are alike, or opposite, wherever the joints are."""
    apart = [(one + other.scaled(sign)).terms.values() for sign in (-1.0, 1.0)]
    return any(all(float(np.abs(v).max()) < NEGLIGIBLE for v in values) for values in apart)


def _error(recipe: Recipe, sums: Sequence[Sum], moving: bool) -> float:
    """Return how far (length) rounding and sines may misplace any contact."""

    def one(positions: Sum) -> float:
        total = 0.0
        count = len(positions.terms)
        for monomial, value in positions.terms.items():
            bound = 1.0
            for kind, p, _ in monomial:
                if kind == "t":
                    parameter = recipe.parameters[p]
                    ends = abs(parameter.minimum), abs(parameter.maximum)
                    bound *= max(ends) + sensor_tolerance(parameter)
            off = sum(SINE_ERROR for kind, *_ in monomial if kind != "t")
            off += HALF_UNIT * (count + 2 * len(monomial) + 3)
            total += float(np.sqrt((value**2).sum())) * bound * off
        return total

    common = one(sums[0]) if moving else 0.0
    return common + max(one(positions) for positions in sums[int(moving) :])
