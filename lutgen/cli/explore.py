"""`lutgen explore`: one offline page on which a robot is moved by hand."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import Named, RecipeOptions, asks, check_outputs, force, option, output
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import show
from lutgen.errors import InputError

if TYPE_CHECKING:
    from lutgen.recipe import Recipe

ENDINGS = (".html", ".htm")


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    output: str = output(required=True, help="The page, an HTML file.")
    force: bool = force()
    recipe: str | None = option(
        metavar="RECIPE",
        help="Of a folder: the recipe that it was exported from, unless that is in the gallery.",
    )


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

        report = ExportFolder(source).report
        recipe = _recipe_of(source, report, asked)
        answers = answers_of_export(report, source, recipe)
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


def _recipe_of(folder: str, report: dict[str, Any], asked: Asked) -> "Recipe":
    """Return the recipe of an export: the one that is named, or that of the gallery."""
    from lutgen.recipe import GALLERY, gallery_names, load_recipe

    if asked.recipe is not None:
        return open_recipe(asked.recipe, asked.allow_python)
    for name in gallery_names():
        recipe = load_recipe(f"{GALLERY}{name}")
        if recipe.digest == report.get("recipe_sha256"):
            return recipe
    raise InputError(
        f"{folder}: an export holds no recipe, and that of {report['robot']} is not in the gallery "
        f"(got the digest {str(report.get('recipe_sha256'))[:12]}); name its file with --recipe."
    )
