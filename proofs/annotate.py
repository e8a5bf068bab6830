"""What is added to smap.c before Frama-C reads it: comments for the analyser, and seeded faults.

Annotations are C comments, so the code that is proved is the code that is exported.  ``split``,
``merge`` and ``loop unroll`` only tell the analyser which states to keep apart.  ``assert`` is
proved by the analyser itself.  ``admit`` is taken as true: each has its own proof, which
docs/measured/c-runtime.md lists beside it.
"""

import re
from collections.abc import Collection
from typing import NamedTuple

from lutgen.errors import ExportError

__all__ = ["ADMITS", "HINTS", "MUTANTS", "Hint", "Mutant", "annotate", "mutate", "stale"]


class Hint(NamedTuple):
    """Annotations, and the line of smap.c before (or, with `after`, behind) which they go."""

    line: str
    annotations: tuple[str, ...]
    after: bool = False


class Mutant(NamedTuple):
    """A fault for the analyser to find: a text of smap.c and what replaces it."""

    name: str
    text: str
    instead: str


LOOP = re.compile(r"\s*(?:for \(|while \(|do \{)")
# Arrays of structures of many contacts, and how many there are.
_ROOM = {"facet": "FACETS", "segment": "LINKS", "side": "SIDES", "rim": "EDGES"}
_ADDRESS = re.compile(
    rf"&\w+->(?:at\.)?({'|'.join(_ROOM)})\[((?:[^][]|\[(?:[^][]|\[[^][]*\])*\])+)\]"
)
_POINT = "-16400 <= p[3 * i] <= 16400 && -16400 <= p[3 * i + 1] <= 16400"

_FEW = r"contacts|smap_contacts_of\(.*\)|rails|smap_rails_of\(.*\)|first\[k \+ 1\]|count"

# Lines are regular expressions over one stripped line; parts that an export lacks are left out.
HINTS = (
    # arithmetic: the square root
    Hint(r"while \(mantissa < 0x800000u\) \{", ("admit mantissa > 0;", "loop unroll 24;")),
    Hint(r"for \(digit = 0x1000000u; .*", ("loop unroll 26;",)),
    # ... a whole number of what two comparisons let pass, which no NaN does
    Hint(
        r"return \(int16_t\)away;",
        (r"admit \is_finite(away);", "admit -32767.5 <= away <= 32767.5;"),
    ),
    # many contacts: contacts and rails are few, and what is known of each of them is kept apart
    Hint(
        rf"for \(\w+ = \w+; .*(?:{_FEW}); \w+\+\+\) \{{",
        ("loop unroll 40;",),
    ),
    Hint(
        r"for \(i = 0; i < (?:angles|travels|body\[SMAP_IN_PRODUCTS\]|at\.coordinates); .*",
        ("loop unroll 100;",),
    ),
    Hint(r"for \(k = 0; k < count; k\+\+, term\+\+\) \{", ("loop unroll 100;",)),
    Hint(r"pairs = \(uint8_t\)\(1\.0f \+ uneven\);", (r"admit \is_finite(uneven);",)),
    Hint(
        r"/\* from here on a number \*/", (r"admit \is_finite(n);", "admit 0.0 <= n;"), after=True
    ),
    Hint(
        r"count = 1\.0f \+ \(float\)\(int32_t\)longest;",
        (r"admit \is_finite(longest);", "admit 0.0 <= longest;"),
    ),
    Hint(
        r"for \(k = 0; k < o->at\.edge\[o->at\.shown\] && w->left; k\+\+\) \{",
        ("loop unroll 300;",),
    ),
    Hint(
        r"const int32_t x = n\[0\], y = n\[1\], z = n\[2\];",
        ("admit -32767 <= x && -32767 <= y && -32767 <= z;",),
        after=True,
    ),
    Hint(r"for \(; x != 0; x >>= 1\) \{", ("loop unroll 33;",)),
    Hint(r"while \(sum < 0x10000000u\) \{", ("admit sum > 0;", "loop unroll 16;")),
    Hint(r"while \(sum >= 0x40000000u\) \{", ("loop unroll 3;",)),
    Hint(
        r"whole = \(float\)\(int32_t\)away;",
        (r"admit \is_finite(away);", "admit -1000.0 <= away <= 1000.0;"),
    ),
    Hint(r"const uint8_t shift = o->shift;", ("admit shift <= 29;",), after=True),
    # ... where a pointer goes that is worked out: no alarm tells while it stays in the pose
    Hint(
        r"smap_visit_t \*const v = &visit\[at\];",
        ("assert at < SMAP_WAYS;",),
    ),
    Hint(r"at = \(uint8_t\)\(at \+ smap_come\(.*", ("assert at < SMAP_WAYS - 1;",)),
    Hint(r"if \(smap_may\(w, SMAP_COST_ROLL\)\) \{", ("assert k < SMAP_MANY_ROLLS;",)),
    Hint(r"return w->roll \+ SMAP_ROLL \* k;", ("assert k < SMAP_MANY_ROLLS;",)),
    Hint(
        r"const float\(\*const at\)\[3\] = .*w->corner \+ facet->first;",
        ("assert facet->first <= SMAP_MANY_EDGES - 3;",),
    ),
    Hint(
        r"const float area2 = smap_area2\(\(const float\(\*\)\[3\]\)w->corner .*",
        ("assert w->facet[here].first <= SMAP_MANY_EDGES - 3;",),
    ),
    Hint(r"spot\[at\] = (?:here|spot\[at - 1\]);", ("assert at < SMAP_MANY_CONTACTS;",)),
    *(
        Hint(line, tuple(f"assert corner[{i}] < SMAP_MANY_CONTACTS;" for i in indices))
        for line, indices in (
            (r"const smap_spot_t \*o = &spot\[corner\[0\]\];", ("0",)),
            (r"const smap_spot_t \*p = &spot\[corner\[i\]\], .*", ("i", "i + 1")),
            (r"const smap_spot_t \*o = &spot\[corner\[side\]\], .*", ("side", "next")),
            (r"const float out = smap_bend_of\(o, q, &spot\[corner\[j\]\]\);", ("j",)),
        )
    ),
    Hint(r"corner\[n\+\+\] = i;", ("assert i < SMAP_MANY_CONTACTS;",)),
    Hint(
        r"memcpy\(w->onward, w->next, w->edges\);",
        ("assert w->edges <= SMAP_MANY_EDGES;",),
    ),
    *(
        Hint(
            rf"const smap_segment_t \*s = middle, \*end = {at}segment \+ .*",
            (f"assert {at}last[island] <= SMAP_MANY_LINKS;",),
        )
        for at in ("o->at.", "at->")
    ),
    Hint(
        r"const int16_t\(\*n\)\[3\] = o->wall \+ at->edge\[f\];",
        ("assert at->edge[f + 1] <= SMAP_MANY_WALLS;",),
    ),
    *(
        Hint(
            line,
            tuple(
                f"assert o->at.{name} <= SMAP_MANY_{most};"
                for name, most in (("shown", "SHOWN"), ("walls", "WALLS"), ("points", "LINKS"))
            ),
        )
        for line in (r"smap_turn_back\(m, o->plane, .*", r"smap_units_i\(o->plane, .*")
    ),
    # range, chart: what gets past the guards
    Hint(r"q\[i\] = x;", (r"admit \is_finite(x);", "admit -1e7 <= x <= 1e7;")),
    Hint(
        r"place\[params \+ i\] = d\[axes\[i \+ 1\]\] \* half; .*",
        (r"admit \is_finite(d[axes[i + 1]]);", "admit -2.0 <= d[axes[i + 1]] <= 2.0;"),
    ),
    Hint(r"g\[i\] \*= \(int32_t\)1 << shift;", ("admit -32768 <= g[i] <= 32768;",), after=True),
    Hint(r"\*length = smap_length_root\(.*", ("admit 16385 <= *length <= 56757;",), after=True),
    # series: a parameter is within what the pieces cover
    Hint(
        r"for \(n = 0; n < degree; n\+\+\) \{",
        (r"admit \is_finite(s);", "admit -1.01 <= s <= 1.01;"),
    ),
    # three contacts
    Hint(r"tip = 2 \* least / .*", ("admit -1073741824 <= least <= 1073741823;",)),
    Hint(
        r"smap_table_point_i\(&table\[i\], wide, place, &p\[3 \* i\]\);",
        (f"admit {_POINT} && -16400 <= p[3 * i + 2] <= 16400;",),
        after=True,
    ),
    Hint(r"part\[i\] = v\[i\] >> shift;", ("admit -32768 <= part[i] <= 32767;",), after=True),
    Hint(r"length = smap_whole_root\(length\);", ("admit length > 0;",), after=True),
    Hint(
        r"out\[i\] = \(int16_t\)\(part\[i\] \* 16383 / \(int32_t\)length\);",
        ("admit -16383 <= out[i] <= 16383;",),
        after=True,
    ),
    # grid
    Hint(r"float x = chart \? .*", ("admit -0.1 <= x <= 65534.1;",), after=True),
    Hint(r"cell->frac\[i\] = .* / \(high - low\);", ("split low;", "admit low < high;")),
    Hint(r"cell->frac\[i\] = .* / \(high - low\);", ("merge low;",), after=True),
    Hint(
        r"face = smap_face\(map, along, axes\);", ("split axes[1];", "split axes[2];"), after=True
    ),
    Hint(r"out->tip_angle = smap_tree\(.*", ("merge axes[1];", "merge axes[2];")),
    Hint(
        r"value = smap_between\(below\[level\], value, cell->frac\[level\], .*",
        ("admit value <= 65535;",),
        after=True,
    ),
)

# Every statement that is taken as true, in the order of HINTS.
ADMITS = tuple(
    dict.fromkeys(
        text.removeprefix("admit ").removesuffix(";")
        for hint in HINTS
        for text in hint.annotations
        if text.startswith("admit ")
    )
)

MUTANTS = {
    "points": Mutant(
        "one coordinate more is written", "i < at.coordinates; i++", "i <= at.coordinates; i++"
    ),
    "series": Mutant("one polynomial more is written", "n < degree; n++", "n <= degree; n++"),
    "tables": Mutant(
        "the last cell of an axis is one further", "(uint32_t)last - 1u", "(uint32_t)last"
    ),
    "tables whole": Mutant(
        "the last cell of an axis is one further", "cell[k] = x >> 16;", "cell[k] = (x >> 16) + 1u;"
    ),
    "rails": Mutant(
        "one part more of the boundary than there is room for",
        "o->at.segments >= SMAP_MOST(",
        "o->at.segments > SMAP_MOST(",
    ),
    "grid": Mutant(
        "the last knot of an axis is one further",
        "left = (uint16_t)(nodes - 1u);",
        "left = nodes;",
    ),
    "grid whole": Mutant(
        "a box may be halved along any of 16 axes",
        "axis = head & (SMAP_TREE_AXES - 1u)",
        "axis = head & 15u",
    ),
}


def annotate(source: str, limits: Collection[int] = ()) -> str:
    """Return smap.c with the annotations in it; what it has no line for is left out.

    A hint whose line is in no part at all is an error of `stale`.  `limits` are numbers that what
    loops count may not go beyond: where the analyser guesses how far, it guesses these first.
    With them each index of which an address is taken is asserted to be one of its array: a pointer
    that stays in the pose raises no alarm.
    """
    lines = source.split("\n")
    before: dict[int, list[str]] = {}
    for hint in HINTS:
        places = [i for i, line in enumerate(lines) if re.fullmatch(hint.line, line.strip())]
        for place in places:
            before.setdefault(place + int(hint.after), []).extend(hint.annotations)
    if limits:
        _assert_indices(lines, before)
        _bound_loops(lines, limits, before)
    result = []
    for i, line in enumerate(lines):
        result += [*(f"//@ {text}" for text in before.get(i, [])), line]
    return "\n".join(result)


def _assert_indices(lines: list[str], before: dict[int, list[str]]) -> None:
    for place, line in enumerate(lines):
        first = place
        # What a statement goes on with is said before it begins.
        while first and not re.search(r"(?:[;{}]|\*/|^#.*|^)$", lines[first - 1]):
            first -= 1
        for name, index in _ADDRESS.findall(line):
            before.setdefault(first, []).append(f"assert {index} < SMAP_MANY_{_ROOM[name]};")


def _bound_loops(lines: list[str], limits: Collection[int], before: dict[int, list[str]]) -> None:
    guesses = f'loop widen_hints "all", {", ".join(map(str, sorted(limits)))};'
    for place, line in enumerate(lines):
        if LOOP.match(line):
            given = before.setdefault(place, [])
            # What is said of one loop is one comment.
            last = [given.pop()] if given and given[-1].startswith("loop ") else []
            given.append(" ".join([*last, guesses]))


def stale(parts: dict[str, str]) -> list[str]:
    """Return the lines of hints that are in no part of the runtime."""
    lines = {line.strip() for text in parts.values() for line in text.split("\n")}
    return [hint.line for hint in HINTS if not any(re.fullmatch(hint.line, line) for line in lines)]


def mutate(source: str, codec: str) -> str:
    """Return smap.c, annotated or not, with the fault that is seeded for a codec.

    Raises
    ------
    ExportError
        The text to replace is not in `source`.
    """
    mutant = MUTANTS[codec]
    if mutant.text not in source:
        raise ExportError(
            f"smap.c: the place of a seeded fault is missing (got {mutant.text!r}); "
            "bring proofs/annotate.py into line with smap.c."
        )
    # An annotation that says the contrary must stay, or it would hide the fault.
    lines = source.split("\n")
    return "\n".join(
        line if line.startswith("//@ ") else line.replace(mutant.text, mutant.instead)
        for line in lines
    )
