"""Every loop of smap.c and how often it goes round at most, from the shape of an export's tables.

Owns the list: a loop of smap.c that is not in it is an error, so that none can be without a bound.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from firmware_export.emit.source import body_of
from firmware_export.protocol.exported import Export
from lutgen.errors import ExportError

HEAD = re.compile(r"\b(?:for|while) \((.*)\) (?:\{|;)|\} while \((.*)\);")


@dataclass(frozen=True)
class Shape:
    """What the bounds depend on; 0 for what the codec has not.

    `modes` is the most of any parameter, `nodes` the most of any axis, `dims` of any table, `terms`
    of the contacts or of a polynomial.
    """

    params: int
    contacts: int = 0
    hinges: int = 0
    modes: int = 0
    products: int = 0
    terms: int = 0
    dims: int = 0
    nodes: int = 2

    @property
    def halvings(self) -> int:
        """Steps in which a binary search finds a cell of the longest axis."""
        return math.ceil(math.log2(max(self.nodes - 1, 1)))


def shape_of(export: Export) -> Shape:
    """Return the shape of an export's tables."""
    k, tables = export.model.k, export.tables
    if export.codec == "grid":
        dims = max(len(part.knots) for part in tables.parts)
        nodes = max(len(knots) for part in tables.parts for knots in part.knots)
        return Shape(k, dims=dims, nodes=nodes)
    if export.codec not in ("contacts", "poly"):  # no loop over anything but parameters
        return Shape(k)
    body: Any = body_of(export)
    arrays = {array.name: array.numbers.size for array in body.arrays if array.plain}
    if export.codec == "poly":
        fewest = next(array.numbers for array in body.arrays if array.name == "shape")
        counts = [int(n) for n in fewest.reshape(3, k + 1)[:, k]]
        return Shape(k, contacts=3, terms=max(counts))
    fields = dict(body.fields)
    modes = [array.numbers for array in body.arrays if array.name == "shape"]
    return Shape(
        k,
        contacts=int(fields["contacts"]),
        hinges=int(fields["axes"]),
        modes=max((int(n) for n in modes[0].reshape(-1)[::2]), default=0) if modes else 0,
        products=int(fields["product_count"]),
        terms=arrays.get("entries", 0),
    )


# Head of a loop as it stands in smap.c -> most rounds, in words and as a function of the shape.
LOOPS: Mapping[str, tuple[str, Any]] = {
    "mantissa < 0x800000u": ("a denormal's 23 shifts", lambda s: 23),
    "digit = 0x1000000u; digit != 0; digit >>= 1": ("25 binary digits", lambda s: 25),
    "step = 0; step < 4; step++": ("4 steps", lambda s: 4),
    "digit = (uint32_t)1 << 30; digit != 0; digit >>= 2": ("16 digits", lambda s: 16),
    "; largest < 16384u; largest <<= 1": ("14 shifts", lambda s: 14),
    "face = 1; face < 6; face++": ("5 faces", lambda s: 5),
    "i = 1; i < 6; i++": ("5 faces", lambda s: 5),
    "k = 0; k < 3; k++": ("3 coordinates", lambda s: 3),
    "i = 0; i < 3; i++": ("3 coordinates", lambda s: 3),
    "j = 0; j < 3; j++": ("3 coordinates", lambda s: 3),
    "m = 0; m < 3; m++": ("3 coordinates", lambda s: 3),
    "i = 0; i < 2; i++": ("2", lambda s: 2),
    "i = 0; i < 9; i += 3": ("3 contacts", lambda s: 3),
    "i = 0; i < 9; i++": ("9 coordinates", lambda s: 9),
    "i = 0; i < params; i++": ("parameters", lambda s: s.params),
    "i = 0; i < map->params; i++": ("parameters", lambda s: s.params),
    "j = 0; j < params; j++": ("parameters", lambda s: s.params),
    "m = 0; m < modes; m++": ("modes of a parameter", lambda s: s.modes),
    "i = 0; i < body->product_count; i++": ("products", lambda s: s.products),
    "i = 0; i < 3 * body->contacts; i++": ("3 x contacts", lambda s: 3 * s.contacts),
    "i = 0; i < 3 * body->axes; i++": ("3 x disc axes", lambda s: 3 * s.hinges),
    "term = 0; term < body->terms; term++": ("terms", lambda s: s.terms),
    "term = 0; term < shape[params]; term++": ("terms of a contact", lambda s: s.terms),
    "i = 0; i < body->contacts; i++": ("contacts", lambda s: s.contacts),
    "i = 0; i < body->axes; i++": ("disc axes", lambda s: s.hinges),
    "i = 0; i < posture->body->axes; i++": ("disc axes", lambda s: s.hinges),
    "i = 0; i < posture->body->contacts; i++": ("contacts", lambda s: s.contacts),
    "i = 0; i < total; i++": ("contacts", lambda s: s.contacts),
    "at != first && facet->count < total": ("contacts", lambda s: s.contacts),
    "i = 0; i < facet->count; i++": ("corners, at most contacts", lambda s: s.contacts),
    "i = 2; i < facet->count; i++": ("corners, at most contacts", lambda s: s.contacts),
    "k = 0; k < facet->count; k++": ("corners, at most contacts", lambda s: s.contacts),
    "step = 0; step < NEWTON_STEPS; step++": ("NEWTON_STEPS", lambda s: 8),
    "sine < 0.0f": ("WALK_STEPS and the one that gives up", lambda s: 25),
    "i = 0; i < part->dims; i++, axis += 3": ("axes of a table", lambda s: s.dims),
    "left = nodes - 1u; left > 1; left = (left + 1) >> 1": (
        *("log2 of an axis's nodes",),
        lambda s: s.halvings,
    ),
    "corner = 0; corner < corners; corner++": ("2 to a table's axes", lambda s: 2**s.dims),
    "level = 0; corner >> level & 1u; level++": ("axes of a table", lambda s: s.dims),
}
# Each corner but one is merged once.
TOTALS: Mapping[str, Any] = {"level = 0; corner >> level & 1u; level++": lambda s: 2**s.dims}
# Of smap.c: what the bounds above take for granted.
CONSTANTS = {"NEWTON_STEPS": 8, "WALK_STEPS": 24}


def heads(source: str) -> dict[int, str]:
    """Return the loops of C source: line -> what stands in the parentheses.

    Raises
    ------
    ExportError
        If a line holds a loop in a form that is not known.
    """
    found = {}
    plain = re.sub(r"/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), source, flags=re.DOTALL)
    for number, line in enumerate(plain.splitlines(), 1):
        if not re.search(r"\b(for|while|goto)\b", line):
            continue
        match = HEAD.search(line.rstrip())
        if match is None:
            raise ExportError(f"smap.c: line {number} has a loop without a bound (got {line!r}).")
        found[number] = match[1] or match[2]
    return found


def bounds(source: str, shape: Shape) -> dict[int, int]:
    """Return for the line of every loop of smap.c how often it goes round at most.

    Raises
    ------
    ExportError
        If a loop, or a constant, is not in the list.
    """
    result = {}
    for number, head in heads(source).items():
        if head not in LOOPS:
            raise ExportError(
                f"smap.c: the loop of line {number} has no bound (got {head!r}); add it to "
                "targets/loops.py."
            )
        result[number] = int(LOOPS[head][1](shape))
    for name, value in CONSTANTS.items():
        found = re.search(rf"#define {name} (\d+)", source)
        if found is not None and int(found[1]) != value:
            raise ExportError(f"smap.c: {name} is another (got {found[1]}); correct loops.py.")
    return result


def totals(source: str, shape: Shape) -> dict[int, int]:
    """Return for the lines of `TOTALS` their most rounds during all of the loop round them."""
    found = heads(source)
    return {line: int(TOTALS[head](shape)) for line, head in found.items() if head in TOTALS}


def starts(source: str) -> list[int]:
    """Return the lines of C source at which the body of a function begins."""
    return [number for number, line in enumerate(source.splitlines(), 1) if line == "{"]
