"""`lutgen recipes`: the gallery's recipes, which come with the package."""

import re
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import click

from lutgen.cli.options import as_json, asks
from lutgen.cli.table import aligned, show


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    as_json: bool = as_json()


def _completed(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return the names that begin so, for the completion of a shell."""
    from lutgen.recipe import gallery_names

    return [name for name in gallery_names() if name.startswith(incomplete)]


@click.command(short_help="List the gallery's recipes, or print one of them.")
@click.argument("name", required=False, shell_complete=_completed)
@asks(Asked)
def recipes(name: str | None, asked: Asked) -> None:
    """List the recipes that come with lutgen, or print the text of the one called NAME.

    Every command takes recipe:NAME where it takes a recipe's file.

    \b
    $ lutgen sweep recipe:absolem -o absolem.h5
    $ lutgen recipes absolem > mine.toml
    """
    from lutgen.recipe import gallery_names, gallery_text

    if name is not None:
        text = gallery_text(name)
        show({**_entry(name), "text": text}, text.splitlines(), asked.as_json)
        return
    report = {"recipes": [_entry(one) for one in gallery_names()]}
    show(report, recipes_lines(report), asked.as_json)


def _entry(name: str) -> dict[str, Any]:
    """Return what `--json` prints of one recipe."""
    from lutgen.recipe import GALLERY, load_recipe

    source = f"{GALLERY}{name.removeprefix(GALLERY)}"
    recipe = load_recipe(source)
    return {
        "name": recipe.name,
        "source": source,
        "digest": recipe.digest,
        "length_unit": recipe.length_unit,
        "contacts": list(recipe.contact_names),
        "parameters": [p.name for p in recipe.parameters],
        "nodes": recipe.nodes,
        "description": _first_sentence(recipe.text),
    }


def _first_sentence(text: str) -> str:
    """Return the first sentence of the comment that a recipe begins with."""
    head = re.match(r"(?:#[^\n]*\n)*", text)
    words = " ".join(line.lstrip("# ") for line in (head[0] if head else "").splitlines())
    return re.split(r"(?<=\.)\s+(?=[A-Z])", words)[0]


def recipes_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the list as text."""
    rows = [["recipe", "contacts", "nodes", "parameters"]]
    for entry in report["recipes"]:
        counts = f"{len(entry['contacts'])}", f"{entry['nodes']:,}"
        rows.append([entry["source"], *counts, " ".join(entry["parameters"])])
    width = max(len(row[0]) for row in rows)
    lines = aligned(rows, [f"<{width}", ">8", ">12", "<"])
    yield lines[0]
    for line, entry in zip(lines[1:], report["recipes"], strict=True):
        yield line
        yield from textwrap.wrap(
            entry["description"], 100, initial_indent="  ", subsequent_indent="  "
        )
