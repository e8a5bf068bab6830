"""`lutgen plot`: figures of a map or a recipe."""

from dataclasses import dataclass
from pathlib import Path

import click

from lutgen.cli.options import (
    FigureOptions,
    Named,
    RecipeOptions,
    command,
    convention,
    gravity,
    log,
    named_values,
    open_source,
    option,
    parameters,
    posture_source,
    tilt,
)
from lutgen.cli.output import check_outputs, show, silent

# Those of `lutgen.plot`, which takes a second to import.
KINDS = ("curve", "surface", "contour", "sphere", "polar", "metrics", "robot")


@dataclass(frozen=True)
class Asked(RecipeOptions, FigureOptions):
    """What the command line says."""

    output: str = option(
        "-o", "--output", required=True, type=Named(), help="PNG, SVG or PDF file."
    )
    kind: str = option("--kind", required=True, type=click.Choice(KINDS), help="Which figure.")
    assignments: tuple[tuple[str, float], ...] = parameters()
    gravity: tuple[float, float, float] = gravity()
    channel: str = option("--channel", default="sdg", help="Channel to draw.")
    axes: str | None = option(
        "--axes",
        help="Parameters along the axes, comma separated.  [default: the first one or two]",
    )
    convention: str = convention()
    tilt: float = tilt()
    scale: tuple[float, float] | None = option(
        "--scale",
        nargs=2,
        type=float,
        help="What the colours span at least, in the unit shown, so that figures compare.",
    )


@command("source", Asked, "Draw a figure (PNG, SVG or PDF).")
def plot(source: str, asked: Asked) -> None:
    """Draw a figure of SOURCE, a map or a recipe.

    \b
    curve    |SD_g| and height over one parameter, one gravity direction
    contour  a channel over two parameters, one gravity direction
    surface  the same in perspective
    sphere   a channel over all gravity directions, one posture
    polar    the largest tilt before tip-over for each heading, one posture
    metrics  five metrics of stability over all headings at one tilt, one posture
    robot    the body: contacts, support polygon, com, gravity ray, tip-over axes

    What -p leaves out and no axis varies is at the recipe's `home`, then in the middle of its
    range.

    \b
    $ lutgen plot paper_two.h5 -o map.png --kind contour
    """
    from lutgen.plot import draw, on_sheet, save
    from lutgen.recipe import Recipe

    check_outputs(asked.force, asked.output)
    opened = open_source(source, asked.allow_python)
    recipe = opened if isinstance(opened, Recipe) else opened.recipe
    axes = tuple(part.strip() for part in asked.axes.split(",")) if asked.axes else None
    if origin := posture_source(recipe, asked.assignments):
        log.info("parameters without a value: %s", origin)
    with on_sheet(asked.size, asked.style):
        figure = draw(
            asked.kind,
            opened,
            params=named_values(recipe, asked.assignments),
            gravity=asked.gravity,
            channel=asked.channel,
            axes=axes,
            convention=asked.convention,
            tilt=asked.tilt,
            scale=asked.scale,
        )
        save(figure, asked.output, force=asked.force)
    report = {
        "robot": recipe.name,
        "digest": recipe.digest,
        "source": source,
        "kind": asked.kind,
        "figure": asked.output,
        "bytes": Path(asked.output).stat().st_size,
    }
    show(report, silent, asked.as_json)
