"""Where the loops and functions of smap.c are, by its text."""

import re

from lutgen.errors import ExportError

HEAD = re.compile(r"\b(?:for|while) \((.*)\) (?:\{|;)|\} while \((.*)\);")
FUNCTION = re.compile(r"^(?:SMAP_INLINE|static)\b[^;=]*?\b(smap_\w+)\(")
# Of smap_check: as long as the blob, and for the start of a program.
CHECKS = ("smap_check", "smap_crc")


def heads(source: str) -> dict[int, str]:
    """Return the loops of C source: line -> what stands in the parentheses.

    A head may go on for two lines more.  The loops of smap_check are left out.

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
        for more in lines[number : number + 2]:
            if text.count("(") > text.count(")"):
                text = f"{text} {more.strip()}"
        match = HEAD.search(text)
        if match is None:
            raise ExportError(f"smap.c: line {number} has a loop without a bound (got {line!r}).")
        if not function.startswith(CHECKS):
            found[number] = match[1] or match[2]
    return found


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
