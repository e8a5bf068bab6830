"""What is added to smap.c before Frama-C reads it: comments for the analyser, and seeded faults.

Annotations are C comments, so the code that is proved is the code that is exported.  ``split``,
``merge`` and ``loop unroll`` only tell the analyser which states to keep apart.  ``assert`` is
proved by the analyser itself.  ``admit`` is taken as true: each has its own proof, which
docs/measured/c-runtime.md lists beside it.
"""

import re
from typing import NamedTuple

from lutgen.errors import ExportError

__all__ = ["ADMITS", "HINTS", "MUTANTS", "Hint", "Mutant", "annotate", "mutate"]


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


_I = r"\initialized(&facet->corner[i])"
_NEXT = r"\initialized(&facet->corner[i + 1 == facet->count ? 0 : i + 1])"
_AT = r"\initialized(&facet.corner[at])"
_AT_NEXT = r"\initialized(&facet.corner[at + 1 == facet.count ? 0 : at + 1])"

# Lines are regular expressions over one stripped line.
HINTS = (
    # smap_read and locate: nothing that is not finite gets past them
    Hint(r"query.t\[i\] = t;", (r"admit \is_finite(t);", "admit 0.0 <= t <= 1.0;")),
    Hint(
        r"const uint_fast8_t axis = i == 0 \? first : second;",
        (r"admit \is_finite(depth);", "admit depth > 0.0;"),
    ),
    Hint(
        r"query->d\[axis\] = query->place\[i\] = place;",
        (r"admit \is_finite(place);", "admit -map->chart_limit <= place <= map->chart_limit;"),
    ),
    # locate: which of the three components is which
    Hint(r"first = normal == 0;", ("split normal;",)),
    # root
    Hint(r"while \(mantissa < 0x800000u\) \{", ("admit mantissa > 0;", "loop unroll 24;")),
    Hint(r"for \(digit = 0x1000000u; .*", ("loop unroll 26;",)),
    # grid
    Hint(r"for \(i = 0; i < part->dims; i\+\+, axis \+= 3\) \{", ("loop unroll 11;",)),
    Hint(r"for \(left = nodes - 1u; .*", ("loop unroll 17;",)),
    Hint(r"cell->frac\[i\] = .*", ("split lower - knots;",)),
    Hint(r"cell->jump\[i\] = stride - back;", ("merge lower - knots;",), after=True),
    Hint(r"for \(corner = 0; corner < corners; corner\+\+\) \{", ("loop unroll 1025;",)),
    Hint(r"for \(level = 0; corner >> level & 1u; level\+\+\) \{", ("loop unroll 11;",)),
    Hint(
        r"value = between\(below\[level\], value, cell->frac\[level\]\);",
        ("admit value <= 65535;",),
        after=True,
    ),
    Hint(r"for \(term = 0; term < shape\[params\]; term\+\+\) \{", ("loop unroll 257;",)),
    # contacts: positions
    Hint(r"for \(term = 0; term < body->terms; term\+\+\) \{", ("loop unroll 1024;",)),
    Hint(r"for \(i = 0; i < 3 \* body->\w+; i\+\+\) \{", ("loop unroll 97;",)),
    # contacts: the facet search
    Hint(r"for \(step = 0; .*", ("loop unroll 0;",)),
    Hint(r"do \{ /\* gift wrapping.*", ("dynamic_split facet->count;", "loop unroll 33;")),
    Hint(
        r"facet->corner\[facet->count\+\+\] = at;",
        (
            r"assert \initialized(&facet->corner[0 .. facet->count - 1]);",
            "assert at < total && facet->count <= total;",
        ),
        after=True,
    ),
    Hint(r"return facet->count >= 3 && at == first;", ("merge facet->count;",)),
    Hint(r"for \(i = [02]; i < facet->count; i\+\+\) \{", ("loop unroll 33;",)),
    # ... is_rest
    Hint(r"float least = LARGEST;", ("split facet->count;",)),
    Hint(
        r"contact_point\(posture, facet->corner\[k\], point\);",
        (r"admit \initialized(&facet->corner[k]);",),
    ),
    Hint(r"for \(k = 0; k < facet->count; k\+\+\) \{", ("loop unroll 33;",)),
    Hint(r"return least >= posture->body->rest_width;", ("merge facet->count;",)),
    # ... nearest_edge: outline found three corners at least
    Hint(
        r"float from\[3\], to\[3\], wall\[3\];",
        ("split facet->count;", "admit facet->count >= 3;"),
    ),
    Hint(r"contact_point\(posture, facet->corner\[i\], \w+\);", (f"admit {_I};",)),
    Hint(r"contact_point\(posture, facet->corner\[i \+ 1 == .*", (f"admit {_NEXT};",)),
    Hint(r"return nearest;", ("assert nearest < facet->count;", "merge facet->count;")),
    # ... stability_factor
    Hint(
        r"contact_point\(posture, facet->corner\[0\], base\);",
        (r"admit \initialized(&facet->corner[0]) && \initialized(&facet->corner[1]);",),
    ),
    # ... contacts_read
    Hint(
        r"const uint8_t a = facet.corner\[at\];",
        (
            *("split facet.count;", "admit at < facet.count;", "split at;"),
            f"admit {_AT} && {_AT_NEXT};",
        ),
    ),
    Hint(r"if \(step == WALK_STEPS \|\| .*", ("merge at;", "merge facet.count;")),
    Hint(
        r"at = nearest_edge\(&posture, &other, g, &sine\);",
        ("split at;", r"admit \initialized(&other.corner[at]);"),
        after=True,
    ),
    Hint(r"facet = other;", ("merge at;",)),
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
    "contacts": Mutant(
        "the last cell of a mode is one further",
        "(float)last * 0.99999994f",
        "(float)last * 1.00000012f",
    ),
    "contacts many": Mutant(
        "a walk round a facet goes one corner too far",
        "facet.corner[at + 1 == facet.count ? 0 : at + 1]",
        "facet.corner[at + 1]",
    ),
    "grid": Mutant(
        "the last knot of an axis is one further",
        "left = nodes - 1u;",
        "left = nodes;",
    ),
    "poly": Mutant(
        "one term more is summed",
        "term < shape[params]; term++",
        "term <= shape[params]; term++",
    ),
}


def annotate(source: str) -> str:
    """Return smap.c with the annotations in it.

    Raises
    ------
    ExportError
        A line that annotations belong to is not in `source`.
    """
    lines = source.split("\n")
    before: dict[int, list[str]] = {}
    for hint in HINTS:
        places = [i for i, line in enumerate(lines) if re.fullmatch(hint.line, line.strip())]
        if not places:
            raise ExportError(
                f"smap.c: a line that the proof is annotated at is missing (got {hint.line!r}); "
                "bring proofs/annotate.py into line with smap.c."
            )
        for place in places:
            before.setdefault(place + int(hint.after), []).extend(
                f"//@ {text}" for text in hint.annotations
            )
    result = []
    for i, line in enumerate(lines):
        result += [*before.get(i, []), line]
    return "\n".join(result)


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
