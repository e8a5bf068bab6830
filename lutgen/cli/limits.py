"""`lutgen limits`: how far a robot can be tilted, in one posture or in all."""

import json

import click

from lutgen.cli.options import allow_python, as_json, parameters, posture_values

# The curves of the figure have this many headings or more.
FIGURE = 72


@click.command(short_help="Largest tilt nose down, nose up, left, right and in the worst heading.")
@click.argument("recipe", type=click.Path())
@parameters
@click.option("--all", "over_all", is_flag=True, help="Also over all postures of the sweep.")
@click.option("--best", is_flag=True, help="Also the best posture of the sweep in each heading.")
@click.option(
    "--headings",
    type=int,
    default=24,
    show_default=True,
    help="How many the table of --best has; a multiple of 4.",
)
@click.option(
    "--convention",
    type=click.Choice(("plane", "body")),
    default="plane",
    show_default=True,
    help="Whether the ground under the robot is tilted from level, or its body.",
)
@click.option("-o", "--output", type=click.Path(), help="Figure (PNG, SVG or PDF).")
@allow_python
@as_json
def limits(
    recipe: str,
    assignments: tuple[tuple[str, float], ...],
    over_all: bool,
    best: bool,
    headings: int,
    convention: str,
    output: str | None,
    allow_python: bool,
    as_json: bool,
) -> None:
    """Print how far RECIPE can be tilted before it tips over.

    From level, with its shape kept: nose down, left side down, nose up, right side down and in its
    worst heading.  It stands at the guaranteed tilt in every heading, also between those listed.
    -p gives the posture; the middle of the range where it is left out.

    \b
    $ lutgen limits maps/absolem.toml -p front=90 -p rear=90
    guaranteed in every heading: 52.14 deg
    """
    from lutgen.analysis import even_headings, posture_limits, sweep_limits
    from lutgen.cli.limits_report import lines, report
    from lutgen.recipe import load_recipe

    robot = load_recipe(recipe, allow_python=allow_python)
    # Refused before the work, which takes as many as the figure needs.
    around = even_headings(headings)
    found = posture_limits(robot, posture_values(robot, assignments), convention)
    swept = None
    if over_all or best:
        grid = robot.grid
        around = even_headings(headings * -(-FIGURE // headings))
        swept = sweep_limits(robot, grid.params(range(grid.size)), around, convention)
    if output is not None:
        from lutgen.plot import draw_limits, save

        save(draw_limits(robot, found, swept, worst=over_all), output)
    told = report(robot, found, swept, over_all, headings if best else 0)
    if as_json:
        click.echo(json.dumps(told, indent=2, allow_nan=False))
        return
    for line in lines(told):
        click.echo(line)
