"""Pages of docs/measured whose tables are written by what measures them."""

from pathlib import Path

MEASURED = Path(__file__).resolve().parent.parent.parent / "docs" / "measured"


def page(text: str, name: str, content: str) -> str:
    """Return a document with what stands between two marks replaced."""
    first, last = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    before, rest = text.split(first)
    return before + first + content + last + rest.split(last)[1]
