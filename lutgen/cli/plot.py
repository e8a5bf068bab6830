"""`lutgen plot`: figures of a map or a recipe."""

import click

from lutgen.cli.options import (
    allow_python,
    convention,
    gravity,
    named_values,
    open_source,
    parameters,
    tilt,
)

KINDS = ("curve", "surface", "contour", "sphere", "polar", "metrics", "robot")


@click.command(short_help="Draw a figure (PNG, SVG or PDF).")
@click.argument("source", type=click.Path())
@click.option("-o", "--output", required=True, type=click.Path(), help="PNG, SVG or PDF file.")
@click.option("--kind", required=True, type=click.Choice(KINDS), help="Which figure.")
@parameters
@gravity
@click.option("--channel", default="sdg", show_default=True, help="Channel to draw.")
@click.option(
    "--axes",
    help="Parameters along the axes, comma separated.  [default: the first one or two]",
)
@convention
@tilt
@allow_python
def plot(
    source: str,
    output: str,
    kind: str,
    assignments: tuple[tuple[str, float], ...],
    gravity: tuple[float, float, float],
    channel: str,
    axes: str | None,
    convention: str,
    tilt: float,
    allow_python: bool,
) -> None:
    """Draw a figure of SOURCE, a map or a recipe.

    \b
    curve    |SD_g| and height over one parameter, one gravity direction
    contour  a channel over two parameters, one gravity direction
    surface  the same in perspective
    sphere   a channel over all gravity directions, one posture
    polar    the largest tilt before tip-over for each heading, one posture
    metrics  five metrics of stability over all headings at one tilt, one posture
    robot    the body: contacts, support polygon, com, gravity ray, tip-over axes

    \b
    $ lutgen plot paper_two.h5 -o map.png --kind contour
    """
    from lutgen.plot import draw, save
    from lutgen.recipe import Recipe

    opened = open_source(source, allow_python)
    recipe = opened if isinstance(opened, Recipe) else opened.recipe
    named = tuple(part.strip() for part in axes.split(",")) if axes else None
    figure = draw(
        kind,
        opened,
        params=named_values(recipe, assignments),
        gravity=gravity,
        channel=channel,
        axes=named,
        convention=convention,
        tilt=tilt,
    )
    save(figure, output)
