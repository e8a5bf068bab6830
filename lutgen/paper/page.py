"""One HTML page that needs no other file: headings, paragraphs, tables and embedded pictures.

Owns the markup and its look; it knows nothing of the paper.  Every text is escaped here.
"""

import base64
import html
import re
from collections.abc import Iterable, Sequence
from pathlib import Path

__all__ = ["Page"]

STYLE = """
body { font: 16px/1.5 Georgia, 'DejaVu Serif', serif; color: #1a1a1a; background: #fff;
       max-width: 62rem; margin: 2rem auto; padding: 0 1.25rem; }
h1 { font-size: 1.7rem; line-height: 1.25; }
h2 { font-size: 1.3rem; margin-top: 2.6rem; border-bottom: 1px solid #bbb; }
h3 { font-size: 1.08rem; margin-top: 1.8rem; }
nav ol { columns: 2; }
table { border-collapse: collapse; margin: 1rem 0 1.4rem;
        font: 14px/1.4 'DejaVu Sans', Arial, sans-serif; }
caption { text-align: left; font-weight: bold; padding-bottom: .4rem; }
th, td { padding: .25rem .7rem .25rem 0; text-align: left; vertical-align: top; }
thead th { border-bottom: 1.5px solid #333; }
tbody tr { border-bottom: 1px solid #ddd; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums;
                       white-space: nowrap; }
figure { display: inline-block; vertical-align: top; margin: .6rem 1.2rem .6rem 0;
         max-width: 100%; }
figure img { max-width: 100%; }
figcaption { font: 13px/1.4 'DejaVu Sans', Arial, sans-serif; max-width: 28rem; color: #333; }
p.note { border-left: 3px solid #0072B2; padding-left: .8rem; }
code { font-size: .92em; }
@media print { body { margin: 0; max-width: none; } }
"""


class Page:
    """A page that grows from top to bottom.

    Parameters
    ----------
    title : str
        Of the page and its first heading.

    Examples
    --------
    >>> page = Page("Numbers")
    >>> page.heading("First", "first")
    >>> page.table(["name", "value"], [["a < b", 1.5]], caption="Two columns.")
    >>> "a &lt; b" in page.text() and '<td class="number">1.5</td>' in page.text()
    True
    """

    def __init__(self, title: str) -> None:
        self.title = title
        self._parts: list[str] = []
        self._contents: list[tuple[str, str]] = []

    def heading(self, text: str, anchor: str) -> None:
        """Begin a section, which the contents list."""
        self._contents.append((anchor, text))
        self._parts.append(f'<h2 id="{html.escape(anchor)}">{html.escape(text)}</h2>')

    def subheading(self, text: str) -> None:
        """Begin a part of a section."""
        self._parts.append(f"<h3>{html.escape(text)}</h3>")

    def paragraph(self, text: str, note: bool = False) -> None:
        """Add a paragraph; a note stands out, and what stands in backticks is code."""
        kind = ' class="note"' if note else ""
        words = re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(text))
        self._parts.append(f"<p{kind}>{words}</p>")

    def table(
        self, head: Sequence[str], rows: Iterable[Sequence[object]], caption: str = ""
    ) -> None:
        """Add a table; floats and ints stand right-aligned, floats with 6 significant digits."""
        body = [list(row) for row in rows]
        numeric = [
            bool(body)
            and all(isinstance(row[i], int | float) or row[i] in ("", "-") for row in body)
            for i in range(len(head))
        ]
        lines = ["<table>"]
        if caption:
            lines.append(f"<caption>{html.escape(caption)}</caption>")
        lines.append("<thead><tr>")
        lines += [_cell("th", text, numeric[i]) for i, text in enumerate(head)]
        lines.append("</tr></thead><tbody>")
        for row in body:
            cells = "".join(_cell("td", value, numeric[i]) for i, value in enumerate(row))
            lines.append(f"<tr>{cells}</tr>")
        lines.append("</tbody></table>")
        self._parts.append("\n".join(lines))

    def picture(self, path: Path, caption: str, width: int) -> None:
        """Embed a PNG file, `width` in CSS pixels."""
        data = base64.b64encode(path.read_bytes()).decode("ascii")
        words = html.escape(caption)
        self._parts.append(
            f'<figure><img width="{width}" alt="{words}" src="data:image/png;base64,{data}">'
            f"<figcaption>{words}</figcaption></figure>"
        )

    def text(self) -> str:
        """Return the whole page."""
        title = html.escape(self.title)
        listed = "".join(
            f'<li><a href="#{html.escape(anchor)}">{html.escape(text)}</a></li>'
            for anchor, text in self._contents
        )
        return (
            '<!DOCTYPE html>\n<html lang="en-GB">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n"
            f"<h1>{title}</h1>\n<nav><ol>{listed}</ol></nav>\n"
            + "\n".join(self._parts)
            + "\n</body>\n</html>\n"
        )


def _cell(tag: str, value: object, numeric: bool) -> str:
    """Return one cell of a table."""
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    kind = ' class="number"' if numeric else ""
    return f"<{tag}{kind}>{html.escape(text)}</{tag}>"
