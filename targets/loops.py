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
CAPACITIES = (*("rails", "facets", "edges", "shown", "links", "walls", "sides", "work"),)


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
    work: int = 0
    groups: int = 0
    pieces: int = 0
    degree: int = 0

    @property
    def halvings(self) -> int:
        """Steps in which a binary search finds a cell of the longest axis."""
        return math.ceil(math.log2(max(self.nodes - 1, 1)))

    @property
    def triples(self) -> int:
        """Ways to choose three contacts."""
        return math.comb(self.contacts, 3)


def shape_of(export: Export) -> Shape:
    """Return the shape of an export's tables."""
    k, body = export.model.k, body_of(export)
    macros = dict(body.macros)
    if "SMAP_GRID" in macros:
        return Shape(k, dims=k + 2, nodes=max(map(len, export.tables.knots)))
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
# Work that is taken: as often as there is enough left of it, during a whole call.
CHARGE = re.compile(r"smap_may\(w, SMAP_COST_(\w+)\)")
# Other loops of which something bounds all rounds within one call from outside, however often they
# are begun: the work was taken before (POLYGON), a pose has no more room, or they go on
# where they were left.
POLYGON = "k = 0; k < 2u * count; k++"
LOOKED_AT = "; e < w->edges; e++"
BENT = "k = first; k < end; before = k++"
SHORT = "; w->low[e] != SMAP_SHORT && w->low[at] == SMAP_SHORT && left > 0; left--"
PUSH = "k = side->wall; k < end && point + 1 < o->at.points && w->left; k++, point++"
# The innermost of the three loops over contacts i < j < k.
TRIPLE = "k = (uint8_t)(j + 1u); k < count; k++"
# A read looks at a segment of the boundary once.  Of a facet it looks at each strip once from each
# of two edges at most, at all pieces of its sides (no more than there are walls), and goes on four
# times.
SEGMENT, WITHIN = "; s < end; s++", "k = s->wall; k < end; k++"
# Head -> counter, and of which capacity it is how many.
COUNTED = {
    TRIPLE: ("triples", "triples", 1),
    LOOKED_AT: ("edges", "edges", 1),
    SHORT: ("edges", "edges", 1),
    BENT: ("links", "links", 1),
    PUSH: ("links", "links", 1),
    SEGMENT: ("segments", "links", 1),
    WITHIN: ("within", "walls", 8),
}
PAID = {POLYGON: "CORNER"}
# Function -> the work that is taken before each call, and how often it may be called without.
CALLED = {
    "smap_add_facet": ("FACET", 0),
    "smap_corners_new": ("NEAR", 0),
    "smap_is_clear": ("ARC", 0),
    "smap_are_clear": ("CLEAR", 0),
    "smap_bound": ("LOOP", 0),
    "smap_come": ("WAY", 0),
    "smap_find_roll": ("ROLL", 0),
    # Where no work is left: once for the roll that is asked for, and once on the way back.
    "smap_no_roll": ("ROLL", 2),
    "smap_lost_to_mate": ("MATE", 0),
    "smap_take_inner": ("INNER", 0),
}

# Head of a loop as it stands in smap.c -> most rounds, in words and as a function of the shape.
LOOPS: Mapping[str, tuple[str, Callable[[Shape], int]]] = {
    # arithmetic, chart
    "mantissa < 0x800000u": _plain("a denormal's 23 shifts", 23),
    "digit = 0x1000000u; digit != 0; digit >>= 1": _plain("25 binary digits", 25),
    "digit = (uint32_t)1 << 30; digit != 0; digit >>= 2": _plain("16 digits", 16),
    "shift = 0; longest << shift < 32768u; shift++": _plain("15 shifts", 15),
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
    "i = 0; i < SMAP_BLOB(made->head.map)[SMAP_AT_PARAMS]; i++": PARAMS,
    "i = 0; made->head.status == SMAP_OK && i < SMAP_BLOB(map)[SMAP_AT_PARAMS]; i++": PARAMS,
    "i = 0; i < out->contacts; i++": CONTACTS,
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
    "k = 0; k < dims; k++": ("parameters, u and v", lambda s: s.params + 2),
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
    "k = 0; k < contacts; k++": CONTACTS,
    "k = 0; k < corners; k++": CONTACTS,
    "k = 1; k < contacts; k++": CONTACTS,
    # Of each spot that is no corner: corners times such spots.
    "at = 0; at < corners; at++": _mean("contacts", 4),
    "last = corners++; last > at + 1u; last--": CONTACTS,
    "k = 0; k < count; k++": CONTACTS,
    "k = 0; k < smap_rails_of(m); k++": RAILS,
    "k = 0; k < smap_rails_of(w->map); k++": RAILS,
    "k = 1; k + 1 < smap_rails_of(w->map); k++": ("inner rails", lambda s: max(s.rails - 2, 0)),
    "left = smap_rails_of(w->map); left > 0; left--": RAILS,
    "k--; k > 0 && !o->on[k]; k--": RAILS,
    "k++; k + 1 < rails && !o->on[k]; k++": RAILS,
    "a = a == SMAP_NONE ? 0 : a; a < rails && (b == SMAP_NONE || a <= b); a++": RAILS,
    "i = first; i < m->first[k + 1]; i++": _of("row"),
    "j = w->map->first[k]; j < w->map->first[k + 1]; j++": _of("row"),
    "i = 0; rails > 2 && i < smap_contacts_of(w->map); i++": CONTACTS,
    "j = w->map->first[next]; j < w->map->first[next + 1]; j++": _of("row"),
    "i = 0; i + 2 < count; i++": ("contacts less two", lambda s: max(s.contacts - 2, 1)),
    # Of triples i < j < k.
    "j = (uint8_t)(i + 1u); j + 1 < count; j++": _mean("contacts", 2),
    TRIPLE: _mean("contacts", 3),
    "round = smap_are_alike(w, i, j) ? 2 : 0; round < 2; round++": _plain("2", 2),
    "part = 1; part < 4; part++": _plain("3 places of an arc", 3),
    **{f"e = w->facet[{f}].first; e < smap_last_of(w, {f}); e++": CONTACTS for f in ("f", "facet")},
    "k = 0; k < others; k++": CONTACTS,
    "k = (uint8_t)(e + 1u); k < w->edges; k++": _mean("edges", 2),
    **{f"{f} = 0; {f} < w->facets; {f}++": FACETS for f in ("f", "k")},
    "e = first; e < last; e++": CONTACTS,
    "k = 0; e != SMAP_NONE && k < corners; k++": CONTACTS,
    # support polygons
    "at = k; at > 0 && (spot[at - 1].b > here.b || (spot[at - 1].b == here.b && "
    "spot[at - 1].a < here.a)); at--": _mean("contacts", 2),
    POLYGON: _of("work"),
    # What is taken away was put there by a round of the loop round it.
    "n > least && !(smap_bend_of(&spot[corner[n - 2]], &spot[corner[n - 1]], &spot[i]) > 0.0f)": (
        _plain("1 on average", 1)
    ),
    "i = 0; i < n; i++": ("corners, walls or points", lambda s: max(s.contacts, s.links)),
    "j = (uint8_t)(next + 1 < n ? next + 1 : 0); j != side; "
    "j = (uint8_t)(j + 1 < n ? j + 1 : 0)": CONTACTS,
    "k = 0; k < n; k++": ("corners, walls or points", lambda s: max(s.contacts, s.links)),
    "i = 1; i + 1 < n; i++": CONTACTS,
    # gaps
    "e = 0; e < w->edges; e++": EDGES,
    "start = 0; start < w->edges; start++": EDGES,
    "e = o->at.island[k] == k ? 0 : w->edges; e < w->edges; e++": EDGES,
    SHORT: EDGES,
    "k = 0; k < 2; k++": _plain("2", 2),
    "end = 0; end < 2; end++": _plain("2", 2),
    "; e < w->edges && !(smap_is_gap(w, e) && w->twin[e] > e); e++": EDGES,
    LOOKED_AT: EDGES,
    PUSH: LINKS,
    # walls
    "k = 0; k < o->at.edge[o->at.shown] && w->left; k++": EDGES,
    "k = 0; k < o->at.shown; k++": SHOWN,
    BENT: LINKS,
    # reads of many contacts
    "i = 0; i < shown; i++": SHOWN,
    SEGMENT: LINKS,
    **{
        f"part = 0; part < 2; part++, s = {at}segment + {at}first[island], end = middle": TWICE
        for at in ("o->at.", "at->")
    },
    "k = o->at.first[island]; k < o->at.last[island]; k++": LINKS,
    "k = at->first[island]; k < at->last[island]; k++": LINKS,
    WITHIN: _plain("SMAP_PIECES and one", 13),
    "left = 4; left > 0 && status == SMAP_FURTHER; left--": _plain("4 facets", 4),
    "e = o->at.edge[f]; e < end; e++": EDGES,
    "e = at->edge[f]; e < end; e++, n++": EDGES,
    "k = *e; k < o->at.edge[*f + 1]; k++": EDGES,
    "k = *e; k < at->edge[*f + 1]; k++": EDGES,
    "; x != 0; x >>= 1": _plain("32 bits", 32),
    "sum < 0x10000000u": _plain("15 shifts", 15),
    "sum >= 0x40000000u": _plain("2 shifts", 2),
}
# Each corner but one is merged once.
TOTALS: Mapping[str, Any] = {"level = 0; corner >> level & 1u; level++": lambda s: 2**s.dims}
# Of smap.c: what the bounds above take for granted.
CONSTANTS = {"SMAP_NEWTON": 8, "SMAP_PIECES": 12, "SMAP_PAIRS": 2.5}


def costs(source: str, shape: Shape) -> dict[str, int]:
    """Return the units of each part of the work, as smap.c says."""
    result = {}
    for name, units in re.findall(r"#define SMAP_COST_(\w+) (.*?) */\*", source):
        terms = units.replace("SMAP_EACH", str(shape.contacts)).replace("/", "//")
        terms = terms.replace("smap_rails_of(w->map)", str(shape.rails))
        result[name] = int(eval(re.sub(r"\b(\d+)u\b", r"\1", terms), {"__builtins__": {}}))
    return result


def in_words(head: str) -> str:
    """Return how often a loop of smap.c goes round at most, in words; "" where no list says it."""
    charge = CHARGE.search(head)
    if charge:
        return f"work, by SMAP_COST_{charge[1]}"
    return LOOPS[head][0] if head in LOOPS else ""


def bounds(source: str, shape: Shape) -> dict[int, int]:
    """Return for the line of every loop of smap.c how often it goes round at most.

    Raises
    ------
    ExportError
        If a loop, or a constant, is not in the list.
    """
    result, units = {}, costs(source, shape)
    for number, head in heads(source).items():
        charge = CHARGE.search(head)
        if charge is None and head not in LOOPS:
            raise ExportError(
                f"smap.c: the loop of line {number} has no bound (got {head!r}); add it to "
                "targets/loops.py."
            )
        result[number] = shape.work // units[charge[1]] if charge else int(LOOPS[head][1](shape))
    for name, value in CONSTANTS.items():
        found = re.search(rf"#define {name} ([\d.]+)", source)
        if found is not None and float(found[1]) != value:
            raise ExportError(f"smap.c: {name} is another (got {found[1]}); correct loops.py.")
    return result


def totals(source: str, shape: Shape) -> dict[int, int]:
    """Return for the lines of `TOTALS` their most rounds during all of the loop round them."""
    found = heads(source)
    return {line: int(TOTALS[head](shape)) for line, head in found.items() if head in TOTALS}


def counted(source: str, shape: Shape) -> dict[int, tuple[str, int, int]]:
    """Return for the lines of loops that share a counter: its name, its most, a round's part."""
    result, units = {}, costs(source, shape)
    for line, head in heads(source).items():
        charge = CHARGE.search(head)
        paid = charge[1] if charge else PAID.get(head)
        if paid is not None:
            result[line] = "work", shape.work, units[paid]
        elif head in COUNTED:
            counter, capacity, often = COUNTED[head]
            result[line] = counter, often * int(getattr(shape, capacity)), 1
    return result


def called(source: str, shape: Shape) -> dict[str, tuple[int, int]]:
    """Return of the functions of `CALLED` the work that each call takes, and calls without."""
    units = costs(source, shape)
    return {name: (units.get(cost, 1), more) for name, (cost, more) in CALLED.items()}
