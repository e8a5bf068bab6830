"""The loops of the runtime: each that is in its text, and the bound of each.

Owns the bounds of `smap_check`; those of all other functions are in targets/loops.py.
"""

import re
from collections import Counter
from collections.abc import Iterator

from lutgen.errors import ExportError
from targets.loops import in_words

__all__ = ["functions", "loops", "plain", "rows", "unbounded"]

# Loops of smap_check and what it calls, by a head that no other function has, or by both.
BLOB = "bytes of the map"
CHECKED = {
    "bit = 0; bit < 8; bit++": "8 bits",
    "i = 0; i < (uint32_t)(at.products - at.joints); i++": BLOB,
    "i = 0; shared && i < (uint32_t)(at.joints - at.codes); i++": BLOB,
    "i = 0; i < 2u * body[SMAP_IN_PRODUCTS]; i++": "2 x products",
    "i = 0; at.axis_of + i < at.counts; i++": "contacts",
    "i = 0; i < terms; i++": BLOB,
    "row = at->rows; row < at->products; row += SMAP_ROW_BYTES": BLOB,
    "i = 0; i < 2u * products; i++": "2 x products",
    "i = 0; i < 2u * knots; i++": BLOB,
    "i = 0; i < dims; i++": "dims",
    "k = 1; knot != SMAP_EVEN && k < nodes; k++": "nodes of an axis, within the map",
    "i = 0; i < faces; i++": "faces",
    "i = 0; i < parts; i++": "2 tables",
    "i = 0; i < rails; i++": "rails",
    "i = 0; i < SMAP_MANY_SINGLES; i = (uint8_t)(i + 4)": "10 numbers",
    "k = 0; k < at[0]; k++": "dims",
    "nodes = 0; body[4] && nodes < 3u * total; nodes++": BLOB,
    "smap_crc: i = 0; i < count; i++": BLOB,
    "smap_check_singles: i = 0; i < count; i++": BLOB,
}


def plain(source: str) -> str:
    """Return C without its comments, line by line as before."""
    return re.sub(r"/\*.*?\*/", lambda found: "\n" * found[0].count("\n"), source, flags=re.DOTALL)


def _head(text: str, start: int) -> str:
    """Return a loop's keyword and condition, from `start` to the bracket that closes it."""
    depth = 0
    for at in range(text.index("(", start), len(text)):
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        if depth == 0:
            return " ".join(text[start : at + 1].split())
    raise ExportError("smap.c: a loop is not closed (got the end of the file); correct it.")


def functions(text: str) -> list[tuple[int, str]]:
    """Return where each function begins, by a bracket in the first column, and its name."""
    starts = [(0, "")]
    for found in re.finditer(r"^\{", text, re.MULTILINE):
        before = text[: found.start()].rstrip()
        signature = before[max(before.rfind(";"), before.rfind("}"), before.rfind("\n#")) + 1 :]
        name = re.search(r"(\w+)\s*\(", signature)
        starts.append((found.start(), name[1] if name else ""))
    return starts


def loops(source: str) -> Iterator[tuple[str, str]]:
    """Yield the function and the head of every loop, in their order.

    A ``do`` is given by its ``while``.  ``goto`` is refused: it can make a loop that is not seen.
    """
    text = plain(source)
    if re.search(r"\bgoto\b|\bsetjmp\b|\blongjmp\b", text):
        raise ExportError("smap.c: jumps (got goto or longjmp); write a loop.")
    starts = functions(text)
    for found in re.finditer(r"\b(?:for|while)\b(?=\s*\()", text):
        function = [name for at, name in starts if at <= found.start()][-1]
        yield function, _head(text, found.start())


def _bound(function: str, head: str) -> str:
    """Return how often a loop goes round at most, in words; "" where no list says it."""
    inside = head[head.index("(") + 1 : -1]
    for words in (CHECKED.get(f"{function}: {inside}"), CHECKED.get(inside)):
        if words:
            return words
    return in_words(inside)


def unbounded(source: str) -> list[str]:
    """Return the loops that no list has a bound of."""
    return [
        f"{function}: {head} has no bound"
        for function, head in loops(source)
        if not _bound(function, head)
    ]


def rows(parts: dict[str, str]) -> list[list[str]]:
    """Return the table of loops: head, how often it is there, in which parts, rounds at most."""
    times: Counter[tuple[str, str]] = Counter()
    places: dict[tuple[str, str], list[str]] = {}
    for name, text in sorted(parts.items()):
        for function, head in loops(text):
            row = head, _bound(function, head)
            times[row] += 1
            places.setdefault(row, []).append(name.removesuffix(".c"))
    return [
        [head, str(count), ", ".join(dict.fromkeys(places[head, words])), words]
        for (head, words), count in times.items()
    ]
