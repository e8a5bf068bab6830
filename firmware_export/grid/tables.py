"""Tables of the codec `grid` as they stand in C: trees, knots, codes, and what these mean.

Owns the layout.  A tree for each face of the chart tells where the robot stands.  A table holds one
group of channels (the two components of D_g - s, or the height) over its own axes: those parameters
on which it depends, then v, then u.  Places on an axis are counted in 1/65534 of it, so that both
ends and the middle are whole numbers; on a tree's in 1/65536.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.spec import Spec
from firmware_export.protocol import CArray, CBody
from firmware_export.protocol import Tables as AnyTables
from firmware_export.truth import Cells, Model, slack

SPAN = 65534
# The end of an axis for the integer path, whose places fill 16 bits.
WHOLE = 65535
# Instead of an axis's first knot: its knots are even, and not held.
EVEN = 65535
# Coordinates above every parameter's index.
U, V = 254, 255
CTYPE = {8: "uint8_t", 16: "uint16_t"}
# Its number in runtime/blob.c; bytes of what grid.c knows of a parameter, of how v is folded, of a
# face and of a table; bytes that it may read behind a tree.
GRID, PLACE_BYTES, FOLD_BYTES, FACE_BYTES, PART_BYTES, BEHIND = 4, 12, 8, 6, 38, 16
# Places on a tree's axis, and of a rate those that v is moved by.
PLACES, RATE = 65536, 8192
MEANING = {
    "sdg": "components of D_g - s along two axes of the facet",
    "height": "height of the centre of mass over its facet",
}


def evenly(count: int) -> NDArray[np.uint16]:
    """Return evenly spaced knots, to the nearest place."""
    return np.rint(np.linspace(0.0, SPAN, count)).astype(np.uint16)


def is_even(knots: NDArray[np.uint16]) -> bool:
    """Tell whether knots are those of `evenly`, which the runtime computes."""
    return np.array_equal(knots, evenly(len(knots)))


class Place(NamedTuple):
    """How a parameter becomes a place on the tables' axis.

    `low` (rad or length) is where the axis begins, `inverse` its units for one rad or length;
    `first` and `rate` (times 2^14) the same of steps.
    """

    low: float
    inverse: float
    first: int
    rate: int


def places_of(model: Model) -> tuple[Place, ...]:
    """Return the places of a model's parameters: tables reach as far as sensors may say."""
    result = []
    for p in model.recipe.parameters:
        room, span = slack(p), p.maximum - p.minimum
        units, whole = SPAN / (span + 2.0 * room), WHOLE / (span + 2.0 * room)
        first, rate = round(room * whole), round(span * whole / 32767.0 * 2.0**14)
        result.append(Place(p.minimum - room, units, first, rate))
    return tuple(result)


class Fold(NamedTuple):
    """How v becomes a place: `base` + d rate / RATE of PLACES, d in 1/32768 of the chart's limit.

    `ahead` is the rate of v >= 0, `behind` of v < 0: folded, both sides share places.
    """

    base: int
    ahead: int
    behind: int


@dataclass(frozen=True, eq=False)
class Trees:
    """A tree for each face of the chart, as bytes; see runtime/grid.c for what they mean.

    `bits` of u and of v are told by the directory with which each begins; `levels`: boxes within
    each other at most, from its cells on.
    """

    fold: Fold
    bits: int
    levels: int
    held: tuple[bytes, ...]

    @property
    def bytes(self) -> int:
        """Bytes of all trees."""
        return sum(map(len, self.held))


@dataclass(frozen=True, eq=False)
class Part:
    """One table.

    Parameters
    ----------
    name : str
        ``sdg`` or ``height``.
    coordinates : tuple of int
        Per axis, outermost first: index of a parameter, `V` or `U`.
    knots : tuple of (n,) uint16 arrays
        Per axis, from 0 to SPAN, ascending.
    codes : (faces, n..., width) uint8 or uint16
        One face where all are alike.
    offset : (2,) float32
        Value at code 0 of each component.
    step : float32
        Value of one code.
    """

    name: str
    coordinates: tuple[int, ...]
    knots: tuple[NDArray[np.uint16], ...]
    codes: NDArray[Any]
    offset: NDArray[np.float32]
    step: np.float32

    @property
    def bits(self) -> int:
        """Bits of a code."""
        return 8 * self.codes.itemsize

    @property
    def width(self) -> int:
        """Codes of a node."""
        return int(self.codes.shape[-1])

    @property
    def face_stride(self) -> int:
        """Codes of one face; 0 where all faces are alike."""
        return 0 if len(self.codes) == 1 else math.prod(self.codes.shape[1:])

    @property
    def fine_step(self) -> float:
        """Value of one unit of the integer path, 1/65536 of the codes' range."""
        return float(self.step) / (1 << (16 - self.bits))

    @property
    def zero(self) -> tuple[int, int]:
        """The integer path's units at which the value is 0; for the height its value at code 0."""
        at = [-float(value) / self.fine_step for value in self.offset]
        if self.name == "height":
            return max(round(float(self.offset[0]) / self.height_step), 0), 0
        return max(round(at[0]), 0), max(round(at[1]), 0)

    @property
    def height_step(self) -> float:
        """Value of one unit of the height that the integer path answers."""
        return (float(self.offset[0]) + self.fine_step * 65535.0) / 65000.0

    @property
    def gain(self) -> tuple[int, int]:
        """Output of one unit of the integer path, and by how many bits to shift it."""
        if self.name == "sdg":
            return 1, 0
        ratio = self.fine_step / self.height_step
        shift = max(0, min(31, 15 - math.floor(math.log2(ratio)))) if ratio > 0.0 else 0
        return min(math.floor(ratio * 2.0**shift), 65535), shift


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """An encoded grid.

    Parameters
    ----------
    spec : Spec
        What was asked for.
    channels : tuple of str
        What is held.
    trees : Trees
        Where the robot stands.
    parts : tuple of Part
        ``sdg`` and ``height`` if held.
    chart_limit : float
        Largest |u| and |v|.
    places : tuple of Place
        Per parameter, how a value becomes a place on the tables' axis.
    """

    spec: Spec
    channels: tuple[str, ...]
    trees: Trees
    parts: tuple[Part, ...]
    chart_limit: float
    places: tuple[Place, ...]
    guard_text: str
    guard: float = 0.0

    @property
    def verdict_only(self) -> bool:
        """Whether tip_angle is no angle: it is 0, or -pi."""
        return True

    @property
    def half(self) -> np.float32:
        """Units of an axis for one unit of u or v, rounded: the rim comes to SPAN at most."""
        limit, middle = np.float32(self.chart_limit), np.float32(SPAN // 2)
        half = np.float32(SPAN / 2 / self.chart_limit)
        while limit * half > middle:
            half = np.nextafter(half, np.float32(0.0))
        return half

    @property
    def steps(self) -> tuple[tuple[str, float], ...]:
        """Value of one unit of `smap_reading_i_t` for each length that is held."""
        steps = {
            part.name: part.height_step if part.name == "height" else 2.0 * part.fine_step
            for part in self.parts
        }
        return tuple((name, step) for name, step in steps.items() if step > 0.0)

    def shared_knots(self) -> tuple[NDArray[np.uint16], list[NDArray[np.uint16]]]:
        """Return the knots of all uneven axes, equal ones once, and per part (axes, 3) uint16.

        The latter are coordinate, nodes and first knot (or `EVEN`), innermost axis first.
        """
        seen: dict[bytes, int] = {}
        pool: list[int] = []
        rows = []
        for part in self.parts:
            row = []
            for coordinate, knots in zip(part.coordinates, part.knots, strict=True):
                key = knots.tobytes()
                if key not in seen:
                    seen[key] = EVEN if is_even(knots) else len(pool)
                    pool += [] if is_even(knots) else knots.tolist()
                row.append((coordinate, len(knots), seen[key]))
            rows.append(np.array(row[::-1], dtype=np.uint16).reshape(-1, 3))
        return np.array(pool, dtype=np.uint16), rows

    @property
    def bytes(self) -> int:
        """Bytes of all tables of numbers."""
        knots, axes = self.shared_knots()
        codes = sum(part.codes.nbytes for part in self.parts)
        return self.trees.bytes + codes + 2 * len(knots) + 6 * sum(map(len, axes))

    def body(self, integer: bool) -> CBody:
        """Return the tables for the emitter."""
        return c_body(self, integer)

    def cells(self, model: Model) -> Cells | None:
        """Return the knots of the tables: of |SD_g| where it is held, as that is bounded."""
        part = next(iter(self.parts), None)
        if part is None:
            return None
        knots = {
            coordinate: places.astype(np.float64) / places[-1]
            for coordinate, places in zip(part.coordinates, part.knots, strict=True)
        }
        for at, parameter in enumerate(model.recipe.parameters):
            if at in knots:  # the tables reach beyond the axis by what sensors may say
                room = slack(parameter) / (parameter.maximum - parameter.minimum)
                knots[at] = np.unique(np.clip(knots[at] * (1.0 + 2.0 * room) - room, 0.0, 1.0))
        ends = np.array([0.0, 1.0])
        v, u = ((2.0 * knots.get(at, ends) - 1.0) * model.chart_limit for at in (V, U))
        return Cells(tuple(knots.get(at, ends) for at in range(model.k)), u, v)


def c_body(tables: Tables, integer: bool) -> CBody:
    """Return the tables for the emitter, in the layout of runtime/grid.c."""
    knots, axes = tables.shared_knots()
    params, trees = len(tables.places), tables.trees
    head = 16 + PLACE_BYTES * params + FOLD_BYTES + FACE_BYTES * len(trees.held)
    axes_at = [head + PART_BYTES * len(tables.parts)]
    for one in axes:
        axes_at.append(axes_at[-1] + 6 * len(one))
    knots_at = axes_at[-1]
    # What may be read behind a tree is what follows it.
    trees_at = [knots_at + 2 * len(knots)]
    for tree in trees.held:
        trees_at.append(trees_at[-1] + len(tree))
    codes_at = [trees_at[-1]]
    for part in tables.parts:
        codes_at.append(codes_at[-1] + part.codes.nbytes)
    spare = max(0, BEHIND - (codes_at[-1] - trees_at[-1]))
    # Wider than the rounding of two divisions: so the rim is held.
    limit = math.ceil(tables.chart_limit * (8192.0 + 1.0))
    arrays = [
        CArray("half", "float", [tables.half], "units of an axis for one of u or v", False),
        CArray("reach", "uint32_t", [limit, knots_at], "chart limit, where the knots are", False),
        CArray("parts", "uint8_t", [len(tables.parts), 0, 0, 0], "tables", False),
    ]
    for low, inverse, first, rate in tables.places:
        arrays.append(
            CArray("place", "float", [low, inverse], "where an axis begins, 1 / unit", False)
        )
        arrays.append(
            CArray("place in steps", "uint16_t", [first, rate], "the same of steps", False)
        )
    arrays.append(CArray("fold", "uint16_t", [trees.fold.base], "place of v = 0", False))
    rates = [trees.fold.ahead, trees.fold.behind]
    arrays.append(CArray("fold", "int16_t", rates, "places for v ahead and behind", False))
    arrays.append(CArray("fold", "uint8_t", [trees.bits, 0], "bits of a directory", False))
    for at, tree in zip(trees_at, trees.held, strict=False):
        arrays.append(CArray("tree", "uint32_t", [at], "where it is", False))
        arrays.append(CArray("tree", "uint16_t", [len(tree)], "its bytes", False))
    for at, part in enumerate(tables.parts):
        offsets = [codes_at[at], axes_at[at], part.face_stride]
        gain, shift = part.gain
        values = [*map(float, part.offset), float(part.step)]
        wide = int(part.bits == 16)
        arrays += [
            CArray(part.name, "uint32_t", offsets, "codes, axes, codes of a face", False),
            CArray(part.name, "float", values, "values of code 0, step", False),
            CArray(part.name, "uint32_t", part.zero, "code of 0", False),
            CArray(part.name, "uint16_t", [gain], "output of 1/65536, scaled", False),
            CArray(
                *(part.name, "uint8_t", [shift, len(part.knots), part.width, wide]),
                *("shift, axes, codes of a node, 16 bits", False),
            ),
        ]
    for part, axis in zip(tables.parts, axes, strict=True):
        arrays.append(
            CArray(f"{part.name} axes", "uint16_t", axis, "coordinate, nodes, first knot")
        )
    arrays.append(CArray("knots", "uint16_t", knots, "0 to 65534 over an axis"))
    for tree in trees.held:
        arrays.append(CArray("tree", "uint8_t", list(tree), "where the robot stands"))
    for part in tables.parts:
        arrays.append(
            CArray(f"{part.name} codes", CTYPE[part.bits], part.codes, MEANING[part.name])
        )
    arrays.append(CArray("behind", "uint8_t", [0] * spare, "so that no tree ends the map", False))
    sizes = dict(tables.steps)
    forms = ("SMAP_INTEGERS" if integer else "SMAP_FLOATS", 1)
    lengths = (("SMAP_LENGTHS", 1),) if tables.parts else ()
    macros = (("SMAP_GRID", 1), *lengths, forms)
    held = max(params, 1)  # as SMAP_MAX_PARAMS
    places = (held + 1) // 2 if integer else held
    words = 1 + places + places % 2  # where pointers have 8 bytes a head fills two words behind it
    return CBody(GRID, tuple(arrays), 0, macros, (words, words), lengths=tuple(sizes.items()))
