"""Every loop of smap.c and how often it goes round at most, from the shape of an export's tables.

Owns the list: a loop of smap.c that is not in it is an error, so that none can be without a bound.
Those of smap_check are left out: no call that is counted asks them.
"""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from firmware_export.emit.source import body_of
from firmware_export.protocol import Export
from lutgen.errors import ExportError

HEAD = re.compile(r"\b(?:for|while) \((.*)\) (?:\{|;)|\} while \((.*)\);")
FUNCTION = re.compile(r"^(?:SMAP_INLINE|static)\b[^;=]*?\b(smap_\w+)\(")
# Of smap_check: as long as the blob, and for the start of a program.
CHECKS = ("smap_check", "smap_crc")


@dataclass(frozen=True)
class Shape:
    """What the bounds depend on; 0 for what the codec has not.

    `angles` and `travels` are those of the joints, `coordinates` all that are summed, `terms` the
    most of one coordinate or polynomial, `dims` the most axes of a table, `nodes` the most of an
    axis.  From `rails` on the capacities of many contacts; of series the `groups` of coordinates,
    `pieces` and `degree` the most of a parameter.
    """

    params: int
    contacts: int = 3
    angles: int = 0
    travels: int = 0
    products: int = 0
    coordinates: int = 0
    terms: int = 0
    dims: int = 0
    nodes: int = 2
    rails: int = 0
    facets: int = 0
    edges: int = 0
    shown: int = 0
    links: int = 0
    groups: int = 0
    pieces: int = 0
    degree: int = 0

    @property
    def halvings(self) -> int:
        """Steps in which a binary search finds a cell of the longest axis."""
        return math.ceil(math.log2(max(self.nodes - 1, 1)))


def shape_of(export: Export) -> Shape:
    """Return the shape of an export's tables."""
    k, body = export.model.k, body_of(export)
    macros = dict(body.macros)
    if "SMAP_GRID" in macros:
        dims = max(len(part.knots) for part in export.tables.parts)
        nodes = max(len(knots) for part in export.tables.parts for knots in part.knots)
        return Shape(k, dims=dims, nodes=nodes)
    if "SMAP_TABLES" in macros:
        return Shape(k, dims=max(len(one.axes) for one in export.tables.points))
    if "SMAP_POLY" in macros:
        shape = next(array.numbers for array in body.arrays if array.name == "shape")
        return Shape(k, terms=int(np.asarray(shape).reshape(3, k + 1)[:, k].max()))
    terms: Any = export.tables.terms
    return Shape(
        k,
        contacts=body.contacts,
        coordinates=macros["SMAP_MAX_COORDINATES"],
        **terms.shape,
        rails=macros.get("SMAP_MANY_RAILS", 0),
        facets=macros.get("SMAP_MANY_FACETS", 0),
        edges=macros.get("SMAP_MANY_EDGES", 0),
        shown=macros.get("SMAP_MANY_SHOWN", 0),
        links=macros.get("SMAP_MANY_LINKS", 0),
    )


def _of(name: str) -> tuple[str, Callable[[Shape], int]]:
    return name, lambda s: int(getattr(s, name))


def _plain(words: str, rounds: int) -> tuple[str, Callable[[Shape], int]]:
    return words, lambda s: rounds


EDGES, CONTACTS, SHOWN, LINKS = (_of(name) for name in ("edges", "contacts", "shown", "links"))
RAILS, PARAMS, DIMS, FACETS = (_of(name) for name in ("rails", "params", "dims", "facets"))
THREE = _plain("3 coordinates", 3)

# Head of a loop as it stands in smap.c -> most rounds, in words and as a function of the shape.
LOOPS: Mapping[str, tuple[str, Callable[[Shape], int]]] = {
    # arithmetic, chart
    "mantissa < 0x800000u": _plain("a denormal's 23 shifts", 23),
    "digit = 0x1000000u; digit != 0; digit >>= 1": _plain("25 binary digits", 25),
    "step = 0; step < 4; step++": _plain("4 steps", 4),
    "digit = (uint32_t)1 << 30; digit != 0; digit >>= 2": _plain("16 digits", 16),
    "shift = 0; longest << shift < 16384u; shift++": _plain("14 shifts", 14),
    "i = 1; i < 6; i++": _plain("5 faces", 5),
    "i = 0; i < 2; i++": _plain("2", 2),
    **{f"{i} = 0; {i} < 3; {i}++": THREE for i in ("i", "k", "n", "c")},
    "i = 1; i < 3; i++": THREE,
    "i = 0; i < 9; i = (uint8_t)(i + 3)": THREE,
    "i = 0; i < 9; i++": _plain("9 coordinates", 9),
    # parameters and positions
    "i = 0; i < count; i++": ("parameters, or contacts", lambda s: max(s.params, s.contacts)),
    "i = 0; i < params; i++": PARAMS,
    "j = 0; j < params; j++": PARAMS,
    "i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++": PARAMS,
    "i = 0; status == SMAP_OK && i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++": PARAMS,
    "i = 0; status == SMAP_OK && i < count; i++": PARAMS,
    "i = 0; i < angles; i++, count = (uint8_t)(count + 2)": _of("angles"),
    "i = 0; i < travels; i++": _of("travels"),
    "i = 0; i < body[SMAP_IN_PRODUCTS]; i++": _of("products"),
    "i = 0; i < at.coordinates; i++": _of("coordinates"),
    "k = 0; k < count; k++, term++": _of("terms"),
    "i = 0; i < 3 * at.contacts; i++": ("3 x contacts", lambda s: 3 * s.contacts),
    "term = 0; term < shape[params]; term++": _of("terms"),
    # series
    "i = 0; i < groups; i++": _of("groups"),
    "n = 1; n < pieces && q[j] >= smap_f32(knots + SMAP_KNOT_BYTES * n); n++": _of("pieces"),
    "n = 0; n < degree; n++": _of("degree"),
    "pair = at->products; pair < at->entries; pair += 2": _of("products"),
    "k = 0; k < from[2 + c]; k++, term++": _of("terms"),
    "j = 0; j < 3; j++, codes += 2": THREE,
    # tables
    "; most >> shift > 32767u; shift++": _plain("17 shifts", 17),
    "k = 0; k < axes; k++": DIMS,
    "k = 0; k < table[i].axes[0]; k++": DIMS,
    "i = 0; i < part[SMAP_PART_DIMS]; i++, axis += 6": DIMS,
    "left = (uint16_t)(nodes - 1u); left > 1; left = (uint16_t)((left + 1u) >> 1)": (
        "log2 of an axis's nodes",
        lambda s: s.halvings,
    ),
    "corner = 0; corner < corners; corner++": ("2 to a table's axes", lambda s: 2**s.dims),
    "level = 0; corner >> level & 1u; level++": DIMS,
    # many contacts: what a posture is put together from
    "i = 0; i <= out->rails; i++": ("rails and their end", lambda s: s.rails + 1),
    "i = 0; i < at.contacts; i++": CONTACTS,
    "i = 0; i < contacts; i++": CONTACTS,
    "k = 0; k < w->map->contacts; k++": CONTACTS,
    "k = 0; k < m->rails; k++": RAILS,
    "k = 0; k < w->map->rails; k++": RAILS,
    "k = 1; k + 1 < w->map->rails; k++": RAILS,
    "left = w->map->rails; left > 0; left--": RAILS,
    "k > 0": RAILS,
    "k++; k < rails; k++": RAILS,
    "i = first; i < m->first[k + 1]; i++": CONTACTS,
    "j = w->map->first[k]; j < w->map->first[k + 1]; j++": CONTACTS,
    "left = 8u * SMAP_MANY_FACETS; left > 0; left--": ("8 x facets", lambda s: 8 * s.facets),
    "i = 0; i + 2 < count; i++": CONTACTS,
    "j = (uint8_t)(i + 1u); j + 1 < count; j++": CONTACTS,
    "k = (uint8_t)(j + 1u); k < count; k++": CONTACTS,
    "round = 0; round < 2; round++": _plain("2", 2),
    "round = 0; round < SMAP_NEWTON; round++": _plain("SMAP_NEWTON", 8),
    "part = 1; part < 4; part++": _plain("3 places of an arc", 3),
    "k = (uint8_t)(e + 1u); k < w->edges; k++": EDGES,
    "f = 0; f < w->facets; f++": FACETS,
    "; w->edges < last; w->edges++": CONTACTS,
    # support polygons
    "at = count++; at > 0 && (spot[at - 1].b > here.b || (spot[at - 1].b == here.b && "
    "spot[at - 1].a < here.a)); at--": CONTACTS,
    "k = 0; k < 2u * count; k++": ("2 x contacts", lambda s: 2 * s.contacts),
    "n > least && !(smap_bend_of(&spot[corner[n - 2]], &spot[corner[n - 1]], &spot[i]) > 0.0f)": (
        CONTACTS
    ),
    "i = 0; i < n; i++": ("corners, walls or points", lambda s: max(s.contacts, s.links)),
    "j = (uint8_t)(next + 1u < n ? next + 1u : 0); j != i; "
    "j = (uint8_t)(j + 1u < n ? j + 1u : 0)": CONTACTS,
    "k = 0; k < n; k++": ("corners, walls or points", lambda s: max(s.contacts, s.links)),
    "i = 1; i + 1 < n; i++": CONTACTS,
    # gaps
    "e = 0; e < w->edges; e++": EDGES,
    "e = 0; e < w->edges && !w->failed; e++": EDGES,
    "e = w->next[e]; w->low[e] == SMAP_SHORT && left > 0; left--": EDGES,
    "k = 1; k <= pairs; k++": _plain("pairs of steps of half a turn", 8),
    "k = 0; k < 2; k++": _plain("2", 2),
    "end = 0; end < 2; end++": _plain("2", 2),
    "k = 0; k < o->ends; k++": _plain("4 other ends", 4),
    "k = 0; k < count; k++": _plain("4 other ends", 4),
    "k = 0; k < (o.split ? 1 : 5); k++": _plain("5 trials", 5),
    "e = smap_onward(w, came); e != came && left > 0 && o->low < o->high; left--": EDGES,
    "at = smap_onward(w, came); at != came && left > 0 && o->low < o->high; left--": EDGES,
    # walls
    "e != start && left > 0": EDGES,
    "e != start && left > 0 && !w->failed": EDGES,
    "k = 0; k < o->at.edge[o->at.shown] && !w->failed; k++": EDGES,
    "k = 0; k < o->at.shown; k++": SHOWN,
    "k = 1; (float)k <= count; k++": _plain("SMAP_PIECES", 12),
    "k = 0; k < side->count; k++": LINKS,
    "k = 0; k + 1u < side->count; k++": LINKS,
    "k = 1; k < 4; k = (uint8_t)(k + 2u)": _plain("2 places of an arc", 2),
    "k = first; gaps && k < o->at.segments && !w->failed; k++": LINKS,
    "e = 0; o->at.island[k] == k && o->at.kind[k] == SMAP_REST && e < w->edges; e++": EDGES,
    # reads of many contacts
    "i = 0; i < o->at.shown; i++": SHOWN,
    "i = 0; at->alive && i < at->shown; i++": SHOWN,
    "; s < end; s++": LINKS,
    "k = o->at.first[island]; k < o->at.last[island]; k++": LINKS,
    "k = at->first[island]; k < at->last[island]; k++": LINKS,
    "k = 0; k < s->count; k++": LINKS,
    "left = 4; left > 0; left--": _plain("4 facets", 4),
    "e = o->at.edge[f]; e < o->at.edge[f + 1]; e++": EDGES,
    "e = at->edge[f]; e < at->edge[f + 1]; e++": EDGES,
    "; x != 0; x >>= 1": _plain("32 bits", 32),
    "sum < 0x10000000u": _plain("15 shifts", 15),
    "sum >= 0x40000000u": _plain("2 shifts", 2),
    "factor >= 65535.0f && i->shift < 40": _plain("40 shifts", 40),
    "factor < 32767.0f && i->shift > -40": _plain("80 shifts", 80),
}
# Each corner but one is merged once.
TOTALS: Mapping[str, Any] = {"level = 0; corner >> level & 1u; level++": lambda s: 2**s.dims}
# Of smap.c: what the bounds above take for granted.
CONSTANTS = {"SMAP_NEWTON": 8, "SMAP_PIECES": 12, "SMAP_PAIRS": 2.5}


def heads(source: str) -> dict[int, str]:
    """Return the loops of C source: line -> what stands in the parentheses.

    A head may go on on the next line.  The loops of smap_check are left out.

    Raises
    ------
    ExportError
        If a line holds a loop in a form that is not known.
    """
    found, function = {}, ""
    plain = re.sub(r"/\*.*?\*/", lambda m: "\n" * m[0].count("\n"), source, flags=re.DOTALL)
    lines = plain.splitlines()
    for number, line in enumerate(lines, 1):
        if begun := FUNCTION.match(line):
            function = begun[1]
        directive = line.startswith("#")
        if directive or not re.search(r"\b(for|while|goto)\b", line):
            continue
        text = line.rstrip()
        if text.count("(") > text.count(")") and number < len(lines):
            text = f"{text} {lines[number].strip()}"
        match = HEAD.search(text)
        if match is None:
            raise ExportError(f"smap.c: line {number} has a loop without a bound (got {line!r}).")
        if not function.startswith(CHECKS):
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
        found = re.search(rf"#define {name} ([\d.]+)", source)
        if found is not None and float(found[1]) != value:
            raise ExportError(f"smap.c: {name} is another (got {found[1]}); correct loops.py.")
    return result


def totals(source: str, shape: Shape) -> dict[int, int]:
    """Return for the lines of `TOTALS` their most rounds during all of the loop round them."""
    found = heads(source)
    return {line: int(TOTALS[head](shape)) for line, head in found.items() if head in TOTALS}


def spans(source: str) -> dict[int, int]:
    """Return the lines of loops' heads -> the line on which the body ends.

    A body ends with the brace that stands as far from the margin as its head.
    """
    lines, found = source.splitlines(), dict[int, int]()
    for number in heads(source):
        text = lines[number - 1]
        margin = text[: len(text) - len(text.lstrip())]
        ends = (at for at in range(number, len(lines)) if lines[at].startswith(f"{margin}}}"))
        if text.lstrip().startswith(("for", "while")):
            found[number] = next(ends) + 1
    return found


def starts(source: str) -> list[int]:
    """Return the lines of C source at which the body of a function begins."""
    return [number for number, line in enumerate(source.splitlines(), 1) if line == "{"]
