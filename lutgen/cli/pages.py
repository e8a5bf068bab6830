"""`lutgen plot`, `explore` and `paper`: figures, and pages that need no other file."""

from dataclasses import dataclass
from pathlib import Path

import click

from lutgen.cli import options as given
from lutgen.cli.lazy import devices, robots
from lutgen.cli.output import check_outputs, entries, save_figure, show
from lutgen.errors import InputError, reject
from lutgen.files import write_text

# Those of `lutgen.plot`, which takes a second to import.
KINDS = ("curve", "surface", "contour", "sphere", "polar", "robot")
ENDINGS = (".html", ".htm")


@dataclass(frozen=True)
class PlotOptions(given.RecipeOptions, given.FigureOptions):
    output: str = given.output("PNG, SVG or PDF file.", required=True)
    kind: str = given.option("Which figure.", required=True, type=click.Choice(KINDS))
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    gravity: tuple[float, float, float] = given.gravity()
    channel: str = given.option("Channel to draw.", default="tip_angle")
    axes: str | None = given.option(
        "Parameters along the axes, comma separated.  [default: the first one or two]"
    )
    convention: str = given.convention()
    scale: tuple[float, float] | None = given.option(
        "Least span of the colours, in the unit shown, so that figures compare.",
        nargs=2,
        type=given.Number(float),
    )


@given.command("source", PlotOptions)
def plot(source: str, options: PlotOptions) -> None:
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
    opened = given.open_source(source, options.allow_python)
    recipe = opened if isinstance(opened, robots.Recipe) else opened.recipe
    axes = tuple(part.strip() for part in options.axes.split(",")) if options.axes else None
    if origin := given.posture_source(recipe, options.assignments):
        given.log.info("parameters without a value: %s", origin)
    choices = {
        **entries(options, "kind gravity channel convention scale"),
        "params": given.named_values(recipe, options.assignments),
        "axes": axes,
    }
    save_figure(lambda plot: plot.draw(source=opened, **choices), options.output, options)
    report = {
        **entries(recipe, "robot=name digest"),
        "source": source,
        "kind": options.kind,
        "figure": options.output,
        "bytes": Path(options.output).stat().st_size,
    }
    show(report, lambda _: ())


@dataclass(frozen=True)
class ExploreOptions(given.RecipeOptions):
    output: str = given.output("The page, an HTML file.", required=True)
    force: bool = given.force()


@dataclass(frozen=True)
class PaperOptions:
    output: str = given.option(
        "Folder to write.", "-o", required=True, type=given.Named(file_okay=False)
    )
    force: bool = given.force()


@given.command("source", ExploreOptions)
def explore(source: str, options: ExploreOptions) -> None:
    """Write a page on which the robot of SOURCE is moved by hand.

    SOURCE is a recipe, a map or a folder of `lutgen export`.  The page is offline, and shows the
    robot in 3-D on its ground, the directions of gravity in which it stands, and a map over two
    joints.  Its answers are those of the exported C, compiled to WebAssembly. Without a folder the
    tables are of the codec contacts.

    \b
    $ lutgen explore recipe:absolem -o absolem.html
    """
    from firmware_export.explore import answers_of_export, answers_of_recipe, page_text

    suffix = Path(options.output).suffix.lower()
    if suffix not in ENDINGS:
        what, way_out = "is no name of a page", f"end it in {' or '.join(ENDINGS)}"
        reject(options.output, what, repr(suffix or "no suffix"), way_out, InputError)
    check_outputs(options.force, options.output)
    if Path(source).is_dir():
        folder = devices.ExportFolder(source)
        recipe, answers = folder.recipe(), answers_of_export(folder)
    else:
        recipe = given.open_recipe(source, options.allow_python)
        answers = answers_of_recipe(recipe)
    write_text(options.output, page_text(recipe, answers), force=options.force)
    report = {
        **entries(recipe, "robot=name digest"),
        "source": source,
        "page": options.output,
        "bytes": Path(options.output).stat().st_size,
        "answers": answers.about,
    }
    show(report, lambda _: ())


@given.command(None, PaperOptions)
def paper(options: PaperOptions) -> None:
    """Reproduce the paper: its three simulations, figures and one page.

    The folder gets paper.html, which needs no other file, and beside it the figures as PNG, the
    numbers as CSV and the stability map as HDF5.  It takes about half a minute of one core once the
    kernels are compiled.

    \b
    $ lutgen paper -o paper
    """
    from lutgen.paper import write_report

    page = str(write_report(options.output, options.force))
    report = {"folder": options.output, "page": page}
    show(report, lambda report: [report["page"]])
