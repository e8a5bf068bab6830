"""`lutgen new`: a commented recipe to start from."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import click

from lutgen.cli.options import as_json, asks, option, output
from lutgen.cli.table import aligned, show
from lutgen.errors import InputError


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    output: str | None = output(help="Recipe to write (.toml).")
    list_kinds: bool = option("--list", is_flag=True, help="List the kinds and write nothing.")
    force: bool = option(is_flag=True, help="Write over a file that is there.")
    as_json: bool = as_json()


@click.command(short_help="Write a commented recipe to start from; --list the kinds.")
@click.argument("kind", required=False)
@asks(Asked)
def new(kind: str | None, asked: Asked) -> None:
    """Write a commented recipe of a robot of this KIND, to be changed into yours.

    It is complete: `lutgen check` and `lutgen limits` take it as it is.

    \b
    $ lutgen new tracks -o robot.toml
    $ lutgen new --list
    """
    from lutgen.files import write_text
    from lutgen.recipe import start_recipe, start_recipes

    if asked.list_kinds:
        kinds = start_recipes()
        show({"kinds": kinds}, kind_lines(kinds), asked.as_json)
        return
    if kind is None or asked.output is None:
        missing = "a kind" if kind is None else "a file to write"
        raise InputError(
            f"lutgen new: needs {missing} (got none); write for example "
            "`lutgen new wheels -o robot.toml`, or `lutgen new --list`."
        )
    text = start_recipe(kind)
    write_text(asked.output, text, asked.force)
    lines = [f"{asked.output}: {start_recipes()[kind]}"]
    show({"kind": kind, "recipe": asked.output}, lines, asked.as_json)


def kind_lines(kinds: Mapping[str, str]) -> Iterator[str]:
    """Return the kinds as text."""
    yield from aligned([[kind, what] for kind, what in kinds.items()])
