"""The tables of docs/reference/recipe.md, made from the keys that validation knows.

`python -m tools.recipe_page` writes them.  Owns what stands between the marks of that page; the
prose around them is written by hand.
"""

import re
from pathlib import Path

from lutgen.recipe.key import Key
from lutgen.recipe.keys import KEYS

TARGET = Path(__file__).resolve().parents[1] / "docs" / "reference" / "recipe.md"
# What stands between two of them is written here.
SAMPLES = "table of whole numbers, 2 or more, or lists of numbers"
DRIVE = "table of numbers, not 0, or of tables with `scale` and `offset`"
BEGIN, END = "<!-- keys of {} -->", "<!-- end of keys -->"


def page(text: str) -> str:
    """Return the page with the tables of all keys in place of those that it has."""
    marked = BEGIN.format(r"(\S+)") + rf"\n.*?{END}\n"
    return re.sub(marked, lambda found: section(found[1]), text, flags=re.DOTALL)


def section(table: str) -> str:
    """Return the keys of a table between their marks; the file itself is called "file"."""
    rows = ["| key | type | default | meaning | example | costs |", "|---|---|---|---|---|---|"]
    rows += [row(key) for key in KEYS["" if table == "file" else table]]
    return "\n".join([BEGIN.format(table), *rows, END, ""])


def row(key: Key) -> str:
    """Return the line of one key."""
    example = "" if key.example in ("[]", "{}") else f"`{key.example}`"
    cells = (f"`{key.name}`", kind(key), default(key), key.meaning, example, key.costs)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"


def kind(key: Key) -> str:
    """Return type, choices, interval and unit of a key."""
    said = f"one of {', '.join(f'`{one}`' for one in key.choices)}" if key.choices else key.type
    if key.type == "names":
        said = f"list of {', '.join(f'`{one}`' for one in key.choices)}"
    said = {"tables": "array of tables", "samples": SAMPLES, "drive": DRIVE}.get(key.type, said)
    if key.bounds:
        low, high = key.interval
        said += f" in {key.bounds}" if high < float("inf") else at_least(key, low)
    return f"{said}, {key.unit}" if key.unit else said


def at_least(key: Key, low: float) -> str:
    """Return an interval without an upper end in words."""
    return f", {low:g} or more" if key.closed[0] else f" above {low:g}"


def default(key: Key) -> str:
    """Return what a recipe without the key gets."""
    if key.needed:
        return "needed"
    if key.default == "[]":
        return "none"
    return key.default if key.default_value is None else f"`{key.default}`"


if __name__ == "__main__":
    TARGET.write_text(page(TARGET.read_text(encoding="utf-8")), encoding="utf-8")
