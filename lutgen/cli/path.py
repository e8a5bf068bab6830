"""`lutgen path`: a robot drives over rough terrain, with and without control."""

import json
import math
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import Assignment, allow_python, as_json, parameters, posture_values
from lutgen.cli.path_report import PAPER, lines, report, table
from lutgen.errors import InputError

if TYPE_CHECKING:
    from lutgen.search import Drive, Path

METHODS = ("map", "nelder-mead", "search", "multistart")
POINTS = 100


@click.command(short_help="Drive over rough terrain: where does the robot tip over?")
@click.argument("recipe", type=click.Path())
@click.option(
    "--terrain",
    default=PAPER,
    show_default=True,
    metavar="paper|FILE.csv",
    help="The paper's path, or a file with columns x,y,z and if wanted heading (deg), nx,ny,nz.",
)
@click.option("--points", type=int, help=f"Of the paper's path.  [default: {POINTS}]")
@click.option(
    "--turn",
    type=float,
    default=0.0,
    show_default=True,
    help="Turn the robot by this angle against the path's heading, deg, to the left.",
)
@parameters
@click.option("--no-control", is_flag=True, help="Only drive without changing the shape.")
@click.option(
    "--lag", type=int, default=1, show_default=True, help="Points by which control is late."
)
@click.option("--method", type=click.Choice(METHODS), default="search", show_default=True)
@click.option(
    "--objective",
    default="sdg",
    show_default=True,
    help="What control makes best: a channel, or a sum such as sdg+0.1*height.",
)
@click.option(
    "--convention",
    type=click.Choice(("plane", "body")),
    default="plane",
    show_default=True,
    help="Whether the path gives the attitude of the ground or that of the body.",
)
@click.option(
    "--rate",
    "rates",
    type=Assignment(),
    multiple=True,
    help="The fastest change of a parameter, per second (deg/s for angles); repeat for each.",
)
@click.option("--speed", type=float, help="Along the path, length per second; with --rate.")
@click.option("--headings", type=int, help="Let the robot turn, too, to this many headings.")
@click.option("-o", "--output", type=click.Path(), help="CSV file of the last run.")
@click.option("--plot", type=click.Path(), help="Figure (PNG, SVG or PDF).")
@click.option(
    "--animate", type=click.Path(), help="Film of both runs: GIF, or MP4 where ffmpeg is installed."
)
@allow_python
@as_json
def path(
    recipe: str,
    terrain: str,
    points: int | None,
    turn: float,
    assignments: tuple[tuple[str, float], ...],
    no_control: bool,
    lag: int,
    method: str,
    objective: str,
    convention: str,
    rates: tuple[tuple[str, float], ...],
    speed: float | None,
    headings: int | None,
    output: str | None,
    plot: str | None,
    animate: str | None,
    allow_python: bool,
    as_json: bool,
) -> None:
    """Drive RECIPE along a path and count where it tips over, with a fixed shape and with control.

    -p gives the geometry before control begins; the middle of the range where it is left out.

    \b
    $ lutgen path maps/paper_two.toml --turn 30 -p alpha=30.96 -p gamma=30.96
    paper_two on the paper's path: 100 points, length 38.9766
    """
    from lutgen.recipe import load_recipe, to_internal
    from lutgen.search import drive

    if animate is not None:
        from lutgen.plot import check_animation

        # The runs take their time.
        check_animation(animate)
    robot = load_recipe(recipe, allow_python=allow_python)
    ground = open_terrain(terrain, points, turn)
    units = {p.name: p.display_unit for p in robot.parameters}
    start = posture_values(robot, assignments)
    limits = {name: to_internal(rate, units.get(name, "1")) for name, rate in rates}
    if len(limits) < len(rates):
        raise InputError(
            f"a rate is given twice (got {', '.join(f'{n}={r:g}' for n, r in rates)}); give one "
            "for each parameter"
        )

    def run(control: bool, turning: int | None) -> "Drive":
        limited: dict[str, Any] = {"rates": limits, "speed": speed} if control else {}
        return drive(
            robot,
            ground,
            control=control,
            lag=lag,
            method=method,
            objective=objective,
            convention=convention,
            params0=start,
            headings=turning,
            **limited,
        )

    if no_control and (rates or speed is not None):
        raise InputError(
            "a shape that does not change has no rates (got --no-control with --rate or --speed); "
            "leave one of them out"
        )
    runs = {"fixed shape": run(False, None)}
    if headings is not None:
        runs["turning"] = run(False, headings)
    if not no_control:
        runs["changing shape"] = run(True, None)
    if headings is not None and not no_control:
        runs["changing shape and turning"] = run(True, headings)
    names = list(runs)
    if output is not None:
        from lutgen.files import csv_text, write_text

        columns = table(robot, runs[names[-1]])
        rows = zip(*(values.tolist() for values in columns.values()), strict=True)
        write_text(output, csv_text(list(columns), rows))
    drawn = {name: runs[name] for name in (names[0], names[-1])}
    if plot is not None:
        from lutgen.plot import draw_path, save

        save(draw_path(robot, drawn), plot)
    if animate is not None:
        from lutgen.plot import animate as write_animation

        write_animation(robot, drawn, animate)
    if as_json:
        settings = {
            "terrain": terrain,
            "method": method,
            "objective": objective,
            "convention": convention,
            "lag": lag,
        }
        click.echo(json.dumps(report(robot, runs, settings), indent=2, allow_nan=False))
        return
    for line in lines(robot, terrain, runs):
        click.echo(line)


def open_terrain(terrain: str, points: int | None, turn: float) -> "Path":
    """Return the path, with the robot turned by `turn` deg."""
    from lutgen.search import paper_path, read_path, turned

    if not math.isfinite(turn):
        raise InputError(f"--turn must be a finite angle (got {turn:g}); give one in deg")
    if terrain == PAPER:
        ground = paper_path(POINTS if points is None else points)
    elif points is not None:
        raise InputError(
            f"{terrain}: a file has the points that it has (got --points {points}); leave it out"
        )
    else:
        ground = read_path(terrain)
    return turned(ground, math.radians(turn)) if turn else ground
