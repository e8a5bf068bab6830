"""One HTML page that needs no other file, made of a template, tables and pictures.

Owns the blocks of the template, a small part of Markdown: headings, paragraphs, notes after `>`,
and `![caption](name)`, where the name is that of a picture or, after `table:`, of a table.
"""

import base64
import html
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

from lutgen.paper.markup import inline, minus, plain

STYLE = files(__package__).joinpath("page.css").read_text(encoding="utf-8")
# What is smaller is rounding, and shown as 0.
NOISE = 1e-12
# Blocks of words by the mark that they begin with.
WORDS = {"### ": "<h3>{}</h3>", "> ": '<p class="note">{}</p>', "": "<p>{}</p>"}
EMBEDDED = re.compile(r"!\[(.*)\]\((.*)\)")


@dataclass(frozen=True)
class Picture:
    """A PNG file and its width on a page in CSS pixels."""

    path: Path
    width: int


@dataclass(frozen=True)
class Table:
    """Rows of cells under a head.

    A head is words, and how the column's numbers are written: a format specification, or "" for a
    column of text.  Cells are numbers, texts, or None for an empty cell.
    """

    head: Sequence[tuple[str, str]]
    rows: Sequence[Sequence[object]]

    def html(self, caption: str) -> str:
        """Return the table as HTML; columns of numbers stand right-aligned."""
        kinds = [' class="number"' if spec else "" for _, spec in self.head]
        head = [
            f"<th{kind}>{inline(w)}</th>" for (w, _), kind in zip(self.head, kinds, strict=True)
        ]
        lines = ["<table>", f"<caption>{inline(caption)}</caption>"]
        lines.append(f"<thead><tr>{''.join(head)}</tr></thead><tbody>")
        for row in self.rows:
            cells = (
                f"<td{kind}>{_cell(value, spec)}</td>"
                for value, (_, spec), kind in zip(row, self.head, kinds, strict=True)
            )
            lines.append(f"<tr>{''.join(cells)}</tr>")
        return "\n".join([*lines, "</tbody></table>"])


def _cell(value: object, spec: str) -> str:
    if value is None:
        return "\u2013"
    if isinstance(value, str):
        return minus(html.escape(value)) if spec else inline(value)
    text = minus(format(value, spec))
    # A small number: 1.23e-06 is 1.23 times a power of ten.
    power = re.fullmatch(r"(.*)e(.)0*(\d+)", text)
    if not power:
        return text
    sign = "\u2212" if power[2] == "-" else ""
    return f"{power[1]}\u00b710<sup>{sign}{power[3]}</sup>"


def shown_together(values: Sequence[float], digits: int = 6) -> list[str]:
    """Return numbers as text with the same decimals: as many as the largest of them needs.

    Examples
    --------
    >>> shown_together([0.0022, -0.001979, 0.0])
    ['0.002200', '-0.001979', '0.000000']
    >>> shown_together([float("nan"), 72.0, 4.0])
    ['0/0', '72', '4']
    """
    finite = [value for value in values if not math.isnan(value)]
    largest = max((abs(value) for value in finite), default=0.0)
    most = max(0, digits - 1 - math.floor(math.log10(largest))) if largest > NOISE else 0
    decimals = next(
        d
        for d in range(most + 1)
        if d == most or all(abs(round(v, d) - v) < 0.5 * 10.0**-most for v in finite)
    )
    # Adding 0 turns -0.0 into 0.0.
    texts = (f"{round(value, decimals) + 0.0:.{decimals}f}" for value in values)
    return ["0/0" if text == "nan" else text for text in texts]


def render(text: str, pictures: Mapping[str, Picture], tables: Mapping[str, Table]) -> str:
    r"""Return the page.

    `text` is the template, its numbers filled in, and its first line the title.

    Examples
    --------
    >>> text = "# Numbers\n\n## First\n\n![Two.](table:two)"
    >>> page = render(text, {}, {"two": Table([("a", "")], [["<"]])})
    >>> '<h2 id="first">First</h2>' in page and "<td>&lt;</td>" in page
    True
    """
    first, *blocks = text.strip().split("\n\n")
    title = first.removeprefix("# ")
    parts, listed = [], []
    for block in blocks:
        if block.startswith("## "):
            anchor = re.sub(r"\W+", "-", block[3:].lower()).strip("-")
            listed.append(f'<li><a href="#{anchor}">{inline(block[3:])}</a></li>')
            parts.append(f'<h2 id="{anchor}">{inline(block[3:])}</h2>')
        elif block.startswith("!["):
            parts += [_embedded(line, pictures, tables) for line in block.splitlines()]
        else:
            mark = next(mark for mark in WORDS if block.startswith(mark))
            parts.append(WORDS[mark].format(inline(block.removeprefix(mark))))
    return (
        '<!DOCTYPE html>\n<html lang="en-GB">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{html.escape(plain(title))}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n"
        f"<h1>{inline(title)}</h1>\n<nav><ol>{''.join(listed)}</ol></nav>\n"
        + "\n".join(parts)
        + "\n</body>\n</html>\n"
    )


def _embedded(line: str, pictures: Mapping[str, Picture], tables: Mapping[str, Table]) -> str:
    """Return a table, or a figure with its picture in it."""
    match = EMBEDDED.fullmatch(line)
    assert match, line
    caption, name = match.groups()
    if name.startswith("table:"):
        return tables[name.removeprefix("table:")].html(caption)
    picture = pictures[name]
    data = base64.b64encode(picture.path.read_bytes()).decode("ascii")
    return (
        f'<figure><img width="{picture.width}" alt="{html.escape(plain(caption))}" '
        f'src="data:image/png;base64,{data}"><figcaption>{inline(caption)}</figcaption></figure>'
    )
