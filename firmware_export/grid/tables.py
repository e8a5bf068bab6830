"""Tables of the codec `grid` as they stand in C: knots, codes, and what turns codes into values.

Owns the layout.  A table holds one group of channels (the tip margin mu, the two components of
D_g - s, or the height) over its own axes: those parameters on which it depends, then v, then u.
Places on an axis are counted in 1/65534 of it, so that both ends and the middle are whole numbers.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.spec import Spec
from firmware_export.protocol import CArray, CBody
from firmware_export.protocol import Tables as AnyTables

SPAN = 65534
# Coordinates above every parameter's index.
U, V = 254, 255
CTYPE = {8: "uint8_t", 16: "uint16_t"}
# Codes of a chunk: SMAP_CHUNK_BITS of smap.h.
CHUNK = 8192
# Most bytes of codes that are not cut: avr-gcc makes no larger object, and half of the first 64 KiB
# of flash, which are all that it reads without far addresses, are left to others.
UNCUT = 32767


@dataclass(frozen=True, eq=False)
class Part:
    """One table.

    Parameters
    ----------
    name : str
        ``tip``, ``sdg`` or ``height``.
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
    remainder : int
        By how much the integer path may read too high, in 1/65536 of the codes' range.
    """

    name: str
    coordinates: tuple[int, ...]
    knots: tuple[NDArray[np.uint16], ...]
    codes: NDArray[Any]
    offset: NDArray[np.float32]
    step: np.float32
    remainder: int = 0

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
        if self.name == "tip":
            return max(math.ceil(at[0]) + self.remainder, 0), 0
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
        ratio = (
            self.fine_step * 32767.0 if self.name == "tip" else self.fine_step / self.height_step
        )
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
    parts : tuple of Part
        ``tip``, then ``sdg`` and ``height`` if held.
    chart_limit : float
        Largest |u| and |v|.
    """

    spec: Spec
    channels: tuple[str, ...]
    parts: tuple[Part, ...]
    chart_limit: float
    guard: float
    guard_text: str
    notes: tuple[str, ...] = ()

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
            if part.name != "tip"
        }
        return tuple((name, step) for name, step in steps.items() if step > 0.0)

    def shared_knots(self) -> tuple[NDArray[np.uint16], list[NDArray[np.uint16]]]:
        """Return the knots of all axes, equal ones once, and per part (axes, 3) uint16.

        The latter are coordinate, nodes and first knot, innermost axis first.
        """
        seen: dict[bytes, int] = {}
        pool: list[int] = []
        rows = []
        for part in self.parts:
            row = []
            for coordinate, knots in zip(part.coordinates, part.knots, strict=True):
                key = knots.tobytes()
                if key not in seen:
                    seen[key] = len(pool)
                    pool += knots.tolist()
                row.append((coordinate, len(knots), seen[key]))
            rows.append(np.array(row[::-1], dtype=np.uint16).reshape(-1, 3))
        return np.array(pool or [0], dtype=np.uint16), rows

    @property
    def bytes(self) -> int:
        """Bytes of all tables of numbers."""
        return c_body(self).bytes


def _axis_names(part: Part) -> str:
    names = {U: "u", V: "v"}
    return ", ".join(
        f"{names.get(c, f'parameter {c}')} {len(k)}"
        for c, k in zip(part.coordinates, part.knots, strict=True)
    )


def c_body(tables: Tables) -> CBody:
    """Return the C struct and arrays of `tables`."""
    knots, axes = tables.shared_knots()
    arrays = [CArray("knots", "uint16_t", knots, "Knots of the axes, 0 to 65534 over an axis.")]
    structs = []
    large = sum(part.codes.nbytes for part in tables.parts) > UNCUT
    chunk, mark = (CHUNK, " | SMAP_CUT") if large else (0, "")
    meaning = {
        "tip": "tip margin, sine of the tip angle times |(u, v, 1)|",
        "sdg": "components of D_g - s along two axes of the facet",
        "height": "height of the centre of mass over its facet",
    }
    for part, axis in zip(tables.parts, axes, strict=True):
        label = f"{part.name}: {meaning[part.name]}; nodes: {_axis_names(part) or 'one'}"
        arrays.append(
            CArray(f"{part.name}_axes", "uint16_t", axis, "Coordinate, nodes, first knot.", 3)
            if axis.size
            else CArray(f"{part.name}_axes", "uint16_t", np.zeros(1, np.uint16), "No axis.")
        )
        row = part.width * (part.codes.shape[-2] if part.codes.ndim > 2 else 1)
        ctype = CTYPE[part.bits]
        arrays.append(CArray(f"{part.name}_codes", ctype, part.codes, label, row, chunk=chunk))
        codes = f"@{part.name}_codes"
        gain, shift = part.gain
        offset = ", ".join(f"{float(x)!r}f" for x in part.offset)
        structs.append(
            f"{{ {codes if part.bits == 8 else '0'}, {codes if part.bits == 16 else '0'}, "
            f"@{part.name}_axes, {part.face_stride}u, {{ {offset} }}, {float(part.step)!r}f, "
            f"{{ {part.zero[0]}u, {part.zero[1]}u }}, {gain}u, {shift}u, {len(part.knots)}u, "
            f"{part.width}u{mark} }}"
        )
    arrays.append(CArray("parts", "smap_grid_part_t", structs, "Tables.", 1))
    fields = (
        ("parts", "@parts"),
        ("knots", "@knots"),
        ("half", f"{float(tables.half)!r}f"),
        # Both rounded up: so the rim is held, and the guard is not less than it must be.
        ("limit", f"{math.ceil(tables.chart_limit * 8192.0 * 32768.0 / 32767.0)}u"),
        ("guard", f"{math.ceil(tables.guard * 32767.0)}u"),
    )
    return CBody("smap_grid_t", fields, tuple(arrays), steps=tables.steps)
