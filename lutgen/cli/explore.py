"""`lutgen explore`: one offline page on which a robot is moved by hand."""

from dataclasses import dataclass
from pathlib import Path

import click

from lutgen.cli.options import Named, RecipeOptions, asks, check_outputs, force, output
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import show
from lutgen.errors import InputError

ENDINGS = (".html", ".htm")


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    output: str = output(required=True, help="The page, an HTML file.")
    force: bool = force()


@click.command(short_help="Write a page on which the robot is moved by hand.")
@click.argument("source", type=Named())
@asks(Asked)
def explore(source: str, asked: Asked) -> None:
    """Write one offline HTML page of SOURCE, a recipe, a map or a folder of `lutgen export`.

    The page shows the robot in 3-D on its ground, the directions of gravity in which it stands,
    and a map over two joints.  What it answers is the exported C, compiled to WebAssembly.
    Without a folder the tables are of the codec contacts.

    \b
    $ lutgen explore recipe:absolem -o absolem.html
    """
    from firmware_export.explore import answers_of_export, answers_of_recipe, page_text
    from lutgen.files import write_text

    suffix = Path(asked.output).suffix.lower()
    if suffix not in ENDINGS:
        raise InputError(
            f"{asked.output}: is no name of a page (got {suffix or 'no suffix'!r}); "
            f"end it in {' or '.join(ENDINGS)}."
        )
    check_outputs(asked.force, asked.output)
    if Path(source).is_dir():
        from firmware_export.device import ExportFolder

        folder = ExportFolder(source)
        recipe, answers = folder.recipe(), answers_of_export(folder)
    else:
        recipe = open_recipe(source, asked.allow_python)
        answers = answers_of_recipe(recipe)
    write_text(asked.output, page_text(recipe, answers), force=asked.force)
    made = {
        "robot": recipe.name,
        "digest": recipe.digest,
        "source": source,
        "page": asked.output,
        "bytes": Path(asked.output).stat().st_size,
        "answers": answers.about,
    }
    show(made, (), asked.as_json)
