"""`lutgen plot`: figures of a map or a recipe."""

from dataclasses import dataclass
from pathlib import Path

import click

from lutgen.cli import options as given
from lutgen.cli.lazy import figures, robots
from lutgen.cli.options import FigureOptions, RecipeOptions, command, log, open_source, option
from lutgen.cli.output import check_outputs, entries, show, silent

# Those of `lutgen.plot`, which takes a second to import.
KINDS = ("curve", "surface", "contour", "sphere", "polar", "robot")


@dataclass(frozen=True)
class Options(RecipeOptions, FigureOptions):
    output: str = given.output("--output", required=True, help="PNG, SVG or PDF file.")
    kind: str = option(required=True, type=click.Choice(KINDS), help="Which figure.")
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    gravity: tuple[float, float, float] = given.gravity()
    channel: str = option(default="tip_angle", help="Channel to draw.")
    axes: str | None = option(
        help="Parameters along the axes, comma separated.  [default: the first one or two]"
    )
    convention: str = given.convention()
    scale: tuple[float, float] | None = option(
        nargs=2,
        type=float,
        help="What the colours span at least, in the unit shown, so that figures compare.",
    )


@command("source", Options)
def plot(source: str, options: Options) -> None:
    """Draw a figure of SOURCE, a map or a recipe; its title is the answer.

    \b
    contour  which posture is best: a channel over two parameters
    surface  the same as a landscape
    curve    the same over one parameter; dots are a map's nodes
    sphere   how far one posture is from tipping over under every gravity
    polar    how far one posture may be tilted in each heading
    robot    what one posture stands on, and over which edge it tips first

    The channel is the tip-over angle unless --channel says sdg, height or another one.

    \b
    $ lutgen plot paper_two.h5 -o map.png --kind contour
    """
    check_outputs(options.force, options.output)
    opened = open_source(source, options.allow_python)
    recipe = opened if isinstance(opened, robots.Recipe) else opened.recipe
    axes = tuple(part.strip() for part in options.axes.split(",")) if options.axes else None
    if origin := given.posture_source(recipe, options.assignments):
        log.info("parameters without a value: %s", origin)
    with figures.on_sheet(options.size, options.style):
        figure = figures.draw(
            options.kind,
            opened,
            params=given.named_values(recipe, options.assignments),
            axes=axes,
            **entries(options, "gravity channel convention scale"),
        )
        figures.save(figure, options.output, force=options.force)
    report = {
        **entries(recipe, "robot=name digest"),
        "source": source,
        "kind": options.kind,
        "figure": options.output,
        "bytes": Path(options.output).stat().st_size,
    }
    show(report, silent, options.as_json)
