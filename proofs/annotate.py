"""What is added to smap.c before Frama-C reads it: comments for the analyser, and seeded faults.

Annotations are C comments, so the code that is proved is the code that is exported.  ``split``,
``merge`` and ``loop unroll`` only tell the analyser which states to keep apart.  ``assert`` is
proved by the analyser itself.  ``admit`` is taken as true: each has its own proof, which
docs/measured/c-runtime.md lists beside it.
"""

import re
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


_POINT = "-16400 <= p[3 * i] <= 16400 && -16400 <= p[3 * i + 1] <= 16400"

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
    "poly": Mutant(
        "one term more is summed",
        "term < shape[params]; term++",
        "term <= shape[params]; term++",
    ),
    "tables": Mutant(
        "the last cell of an axis is one further", "(uint32_t)last - 1u", "(uint32_t)last"
    ),
    "tables whole": Mutant(
        "the last cell of an axis is one further", "cell[k] = x >> 16;", "cell[k] = (x >> 16) + 1u;"
    ),
    "grid": Mutant(
        "the last knot of an axis is one further",
        "left = (uint16_t)(nodes - 1u);",
        "left = nodes;",
    ),
}


def annotate(source: str) -> str:
    """Return smap.c with the annotations in it; what it has no line for is left out.

    A hint whose line is in no part at all is an error of `stale`.
    """
    lines = source.split("\n")
    before: dict[int, list[str]] = {}
    for hint in HINTS:
        places = [i for i, line in enumerate(lines) if re.fullmatch(hint.line, line.strip())]
        for place in places:
            before.setdefault(place + int(hint.after), []).extend(
                f"//@ {text}" for text in hint.annotations
            )
    result = []
    for i, line in enumerate(lines):
        result += [*before.get(i, []), line]
    return "\n".join(result)


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
