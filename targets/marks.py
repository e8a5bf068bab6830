"""Tables as Markdown, put between the marks of a page."""

from pathlib import Path

from lutgen.errors import InputError

ROOT = Path(__file__).resolve().parent.parent
MEASURED = ROOT / "docs" / "measured"


def markdown(head: str, rows: list[list[str]]) -> str:
    """Return a table as Markdown."""
    rule = "|---" * (head.replace(r"\|", "").count("|") - 1) + "|"
    return "\n".join([head, rule, *(f"| {' | '.join(row)} |" for row in rows)])


def between(path: Path, name: str, text: str) -> None:
    """Put text between the marks ``<!-- name -->`` and ``<!-- end of name -->`` of a page."""
    begin, end = f"<!-- {name} -->\n", f"\n<!-- end of {name} -->"
    head, found, rest = path.read_text(encoding="utf-8").partition(begin)
    _, closed, tail = rest.partition(end)
    if not (found and closed):
        raise InputError(f"{path.name}: has no marks of {name} (got none); put them in.")
    path.write_text(head + begin + text + end + tail, encoding="utf-8")
