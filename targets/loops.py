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
from targets.heads import heads

# What a pose of many contacts has room and time for, by its macros.
CAPACITIES = (
    *("rails", "facets", "edges", "shown", "links", "walls", "sides"),
    *("events", "corners", "outlines", "gaps", "visits", "ways", "rollings"),
)


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
    row: int = 0
    facets: int = 0
    edges: int = 0
    shown: int = 0
    links: int = 0
    walls: int = 0
    sides: int = 0
    events: int = 0
    corners: int = 0
    outlines: int = 0
    gaps: int = 0
    visits: int = 0
    ways: int = 0
    rollings: int = 0
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
        row=_row(export),
        **{name: macros.get(f"SMAP_MANY_{name.upper()}", 0) for name in CAPACITIES},
    )


def _row(export: Export) -> int:
    """Return the most contacts of a rail; 0 without rails."""
    many: Any = export.tables.many
    return 0 if many is None else max(np.diff(many.first).tolist(), default=0)


def _of(name: str) -> tuple[str, Callable[[Shape], int]]:
    return name, lambda s: int(getattr(s, name))


def _plain(words: str, rounds: int) -> tuple[str, Callable[[Shape], int]]:
    return words, lambda s: rounds


def _mean(name: str, part: int) -> tuple[str, Callable[[Shape], int]]:
    """Return a bound of the mean over all rounds of the loop round it."""
    return f"{name} / {part} on average", lambda s: -(-int(getattr(s, name)) // part)


EDGES, CONTACTS, SHOWN, LINKS = (_of(name) for name in ("edges", "contacts", "shown", "links"))
RAILS, PARAMS, DIMS, FACETS = (_of(name) for name in ("rails", "params", "dims", "facets"))
TWICE = _plain("2", 2)
THREE = _plain("3 coordinates", 3)
# Loops and functions of which something bounds all rounds or calls within one call from outside,
# however often they are begun: the work left (smap_may), that a pose has no more room, or that they
# go on where they were left.
EVENTS, CORNERS, OUTLINES, GAPS, VISITS, ROLLINGS = (
    _of(name) for name in ("events", "corners", "outlines", "gaps", "visits", "rollings")
)
VISIT = (
    "{0} = w->onward[came]; {0} != came && o->low < o->high && smap_may(w, &w->left.visits); "
    "{0} = w->onward[{0}]"
)
POLYGON = "k = 0; k < 2u * count; k++"
WIDE = "side = 0; side < n && smap_may(w, &w->left.corners); side++"
OUTLINE = "e != start && smap_may(w, &w->left.outlines)"
NEWTON = "round = 0; round < SMAP_NEWTON && smap_may(w, &w->left.events); round++"
EVENT = "u <= 1.0f && smap_may(w, &w->left.events)"
GAP = (
    "e = smap_between_rests(w, 0); e < w->edges && smap_may(w, &w->left.gaps); "
    "e = smap_between_rests(w, (uint8_t)(e + 1u))"
)
BOUND = (
    "e = o->at.island[k] != k ? w->edges : smap_to_bound(w, k, 0); "
    "e < w->edges && smap_may(w, &w->left.outlines); "
    "e = smap_to_bound(w, k, e)"
)
SHOW = "e = smap_to_show(w, 0); e < w->edges && !w->failed; e = smap_to_show(w, e)"
LOOKED_AT, BENT = "; e < w->edges; e++", "k = first; gaps && k < o->at.segments && !w->failed; k++"
STRIP = (
    "e = smap_to_strip(w, 0); e < w->edges && !w->failed; e = smap_to_strip(w, (uint8_t)(e + 1u))"
)
SHORT = "; w->low[e] != SMAP_SHORT && w->low[at] == SMAP_SHORT && left > 0; left--"
ROLLING = "k = 1; k <= pairs && smap_may(w, &w->left.rollings); k++"
PIECE, PUSH = (
    "k = 1; (float)k <= count && !w->failed; k++",
    "k = 0; k < side->count && !w->failed; k++",
)
COUNTED = {
    VISIT.format("e"): "visits",
    VISIT.format("at"): "visits",
    POLYGON: "corners",
    WIDE: "corners",
    OUTLINE: "outlines",
    EVENT: "events",
    NEWTON: "events",
    GAP: "gaps",
    BOUND: "outlines",
    SHOW: "shown",
    STRIP: "gaps",
    LOOKED_AT: "edges",
    SHORT: "edges",
    BENT: "links",
    ROLLING: "rollings",
    PIECE: "walls",
    PUSH: "links",
}
# Function -> what bounds its calls, and how often it may still be called when that has run out.
CALLED = {
    "smap_loop": ("outlines", 0),
    "smap_go_on": ("ways", 1),
    "smap_go_further": ("ways", 1),
    "smap_find_roll": ("rollings", 3),
    "smap_add_side": ("sides", 1),
}

# Head of a loop as it stands in smap.c -> most rounds, in words and as a function of the shape.
LOOPS: Mapping[str, tuple[str, Callable[[Shape], int]]] = {
    # arithmetic, chart
    "mantissa < 0x800000u": _plain("a denormal's 23 shifts", 23),
    "digit = 0x1000000u; digit != 0; digit >>= 1": _plain("25 binary digits", 25),
    "digit = (uint32_t)1 << 30; digit != 0; digit >>= 2": _plain("16 digits", 16),
    "shift = 0; longest << shift < 16384u; shift++": _plain("14 shifts", 14),
    "i = 1; i < 6; i++": _plain("5 faces", 5),
    "i = 0; i < 2; i++": TWICE,
    **{f"{i} = 0; {i} < 3; {i}++": THREE for i in ("i", "k", "n", "c")},
    "i = 1; i < 3; i++": THREE,
    "i = 0; i < 9; i = (uint8_t)(i + 3)": THREE,
    "i = 0; i < 9; i++": _plain("9 coordinates", 9),
    # parameters and positions
    "i = 0; i < count; i++": ("parameters, or contacts", lambda s: max(s.params, s.contacts)),
    "i = 0; i < params; i++": PARAMS,
    "j = 0; j < params; j++": PARAMS,
    "i = 0; i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++": PARAMS,
    "i = 0; i < angles; i++, count = (uint8_t)(count + 2)": _of("angles"),
    "i = 0; i < travels; i++": _of("travels"),
    "i = 0; i < body[SMAP_IN_PRODUCTS]; i++": _of("products"),
    "i = 0; i < at.coordinates; i++": _of("coordinates"),
    "k = 0; k < count; k++, term++": _of("terms"),
    "i = 0; i < 3 * at.contacts; i = (uint16_t)(i + 3)": CONTACTS,
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
    "k = 0; k < smap_contacts_of(w->map); k++": CONTACTS,
    "k = 0; k < smap_rails_of(m); k++": RAILS,
    "k = 0; k < smap_rails_of(w->map); k++": RAILS,
    "k = 1; k + 1 < smap_rails_of(w->map); k++": RAILS,
    "left = smap_rails_of(w->map); left > 0; left--": RAILS,
    "k > 0": RAILS,
    "k++; k < rails; k++": RAILS,
    "a = a == SMAP_NONE ? 0 : a; a < rails && (b == SMAP_NONE || a <= b); a++": RAILS,
    "i = first; i < m->first[k + 1]; i++": CONTACTS,
    "j = w->map->first[k]; j < w->map->first[k + 1]; j++": _of("row"),
    "i = 0; i + 2 < count; i++": ("contacts less two", lambda s: max(s.contacts - 2, 1)),
    # Of triples i < j < k.
    "j = (uint8_t)(i + 1u); j + 1 < count; j++": _mean("contacts", 2),
    "k = (uint8_t)(j + 1u); k < count; k++": _mean("contacts", 3),
    "round = 0; round < 2; round++": _plain("2", 2),
    NEWTON: EVENTS,
    "part = 1; part < 4; part++": _plain("3 places of an arc", 3),
    "k = (uint8_t)(e + 1u); k < w->edges; k++": _mean("edges", 2),
    "f = 0; f < w->facets; f++": FACETS,
    "; w->edges < last; w->edges++": CONTACTS,
    # support polygons
    "at = count++; at > 0 && (spot[at - 1].b > here.b || (spot[at - 1].b == here.b && "
    "spot[at - 1].a < here.a)); at--": _mean("contacts", 2),
    POLYGON: CORNERS,
    # What is taken away was put there by a round of the loop round it.
    "n > least && !(smap_bend_of(&spot[corner[n - 2]], &spot[corner[n - 1]], &spot[i]) > 0.0f)": (
        _plain("1 on average", 1)
    ),
    "i = 0; i < n; i++": ("corners, walls or points", lambda s: max(s.contacts, s.links)),
    WIDE: CORNERS,
    "j = (uint8_t)(next + 1u < n ? next + 1u : 0); j != side; "
    "j = (uint8_t)(j + 1u < n ? j + 1u : 0)": CONTACTS,
    "k = 0; k < n; k++": ("corners, walls or points", lambda s: max(s.contacts, s.links)),
    "i = 1; i + 1 < n; i++": CONTACTS,
    # gaps
    "e = 0; e < w->edges; e++": EDGES,
    SHORT: EDGES,
    "k = 0; k < 2; k++": _plain("2", 2),
    "end = 0; end < 2; end++": _plain("2", 2),
    "k = 0; k < o->ends; k++": _plain("4 other ends", 4),
    "k = 0; k < count; k++": _plain("4 other ends", 4),
    "k = 0; k < (o.split ? 1 : 5); k++": _plain("5 trials", 5),
    **dict.fromkeys((VISIT.format("e"), VISIT.format("at")), VISITS),
    OUTLINE: OUTLINES,
    EVENT: EVENTS,
    GAP: GAPS,
    BOUND: OUTLINES,
    SHOW: SHOWN,
    STRIP: GAPS,
    "; e < w->edges && !(smap_is_gap(w, e) && w->twin[e] > e); e++": EDGES,
    LOOKED_AT: EDGES,
    "; e < w->edges && w->seen[e] != island; e++": EDGES,
    ROLLING: ROLLINGS,
    PIECE: _of("walls"),
    PUSH: LINKS,
    # walls
    "k = 0; k < o->at.edge[o->at.shown] && !w->failed; k++": EDGES,
    "k = 0; k < o->at.shown; k++": SHOWN,
    "k = 0; k + 1u < side->count; k++": _plain("SMAP_PIECES", 12),
    "k = 1; k < 4; k = (uint8_t)(k + 2u)": _plain("2 places of an arc", 2),
    BENT: LINKS,
    # reads of many contacts
    "i = 0; i < shown; i++": SHOWN,
    "; s < end; s++": LINKS,
    **{
        f"part = 0; part < 2; part++, s = {at}segment + {at}first[island], end = middle": TWICE
        for at in ("o->at.", "at->")
    },
    "k = o->at.first[island]; k < o->at.last[island]; k++": LINKS,
    "k = at->first[island]; k < at->last[island]; k++": LINKS,
    "k = 0; k < s->count; k++": _plain("SMAP_PIECES and one", 13),
    "left = 4; left > 0; left--": _plain("4 facets", 4),
    "e = o->at.edge[f]; e < end; e++": EDGES,
    "e = at->edge[f]; e < end; e++": EDGES,
    "; e < o->at.edge[f + 1]; e++": EDGES,
    "; e < at->edge[f + 1]; e++": EDGES,
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


def counted(source: str) -> dict[int, str]:
    """Return for the lines of loops that share a counter which one that is."""
    return {line: COUNTED[head] for line, head in heads(source).items() if head in COUNTED}


def called(shape: Shape) -> dict[str, tuple[str, int]]:
    """Return of the functions of `CALLED` what bounds their calls, and how often at most."""
    most = CALLED.items()
    return {name: (what, int(getattr(shape, what)) + more) for name, (what, more) in most}
