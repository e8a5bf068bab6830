"""Write the tables of docs/reference/recipe.md from the JSON Schema of recipes.

`python -m tools.recipe_page` rewrites what stands between the marks of that page.
"""

import re
from pathlib import Path
from typing import Any

from lutgen.recipe import recipe_schema
from lutgen.recipe.load import toml

TARGET = Path(__file__).resolve().parents[1] / "docs" / "reference" / "recipe.md"
# What stands between two of them is written here.
BEGIN, END = "<!-- keys of {} -->", "<!-- end of keys -->"
SCHEMA = recipe_schema()
TABLES = {"File": SCHEMA, **SCHEMA["$defs"]}


def page(text: str) -> str:
    """Return the page with the tables of all keys in place of those that it has."""
    marked = BEGIN.format(r"(\S+)") + rf"\n.*?{END}\n"
    return re.sub(marked, lambda found: section(found[1]), text, flags=re.DOTALL)


def section(table: str) -> str:
    """Return the keys of a table between their marks."""
    rows = ["| key | type | default | meaning | example |", "|---|---|---|---|---|"]
    needed = TABLES[table].get("required", [])
    for name, schema in TABLES[table]["properties"].items():
        default = f"`{toml(schema['default'])}`" if schema.get("default", []) != [] else ""
        example = f"`{toml(schema['examples'][0])}`" if "examples" in schema else ""
        default = "needed" if name in needed else default
        # What a table means is said where it is defined.
        meaning = {**TABLES.get(schema.get("$ref", "").split("/")[-1], {}), **schema}
        cells = (f"`{name}`", kind(schema), default, meaning["description"], example)
        rows.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return "\n".join([BEGIN.format(table), *rows, END, ""])


def kind(schema: dict[str, Any]) -> str:
    """Return what a schema takes in words: type, choices, interval and unit."""
    if "enum" in schema:
        said = "one of " + ", ".join(f"`{one}`" for one in schema["enum"])
    elif "oneOf" in schema:
        said = " or ".join(map(kind, schema["oneOf"]))
    elif "$ref" in schema or "properties" in schema:
        said = "table"
    elif schema["type"] == "array":
        items = kind(schema["items"])
        said = "three numbers" if schema.get("maxItems") == 3 else f"list of {items}"
        said += ", not all 0" if "contains" in schema else ""
    elif schema["type"] == "object":
        said = f"table of {kind(schema['additionalProperties'])}"
    else:
        words = {"string": "text", "boolean": "true or false", "integer": "whole number"}
        said = words.get(schema["type"], schema["type"]) + interval(schema)
    return f"{said}, {schema['x-unit']}" if "x-unit" in schema else said


def interval(schema: dict[str, Any]) -> str:
    """Return the ends of a number that are not those of all."""
    ends = (("exclusiveMinimum", "above"), ("minimum", "from"))
    ends += (("exclusiveMaximum", "below"), ("maximum", "to"))
    return "".join(
        f" {word} {schema[name]:,.15g}" for name, word in ends if abs(schema.get(name, 1e12)) < 1e12
    ) + (", not 0" if "not" in schema else "")


if __name__ == "__main__":
    TARGET.write_text(page(TARGET.read_text(encoding="utf-8")), encoding="utf-8")
