"""`lutgen path`: a robot drives over rough terrain, with and without control."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Named, RecipeOptions, asks, option
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import TIPS, by_unit, number, show, unit_text
from lutgen.errors import InputError
from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.recipe import Recipe
    from lutgen.search import Drive, Path

PAPER, POINTS = "paper", 100


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    terrain: str = option(
        default=PAPER,
        metavar="paper|FILE.csv",
        help=(
            "The paper's path, or a file with columns x,y,z and if wanted heading (deg), nx,ny,nz."
        ),
    )
    points: int | None = option(type=int, help=f"Of the paper's path.  [default: {POINTS}]")
    turn: float = option(
        default=0.0,
        help="Turn the robot by this angle against the path's heading, deg, to the left.",
    )
    assignments: tuple[tuple[str, float], ...] = options.parameters()
    no_control: bool = option(is_flag=True, help="Only drive without changing the shape.")
    lag: int = option(default=1, help="Points by which control is late.")
    method: str = options.method()
    objective: str = option(
        default="sdg",
        help="What control makes best: a channel, or a sum such as sdg+0.1*height.",
    )
    convention: str = options.convention(
        "plane", "body", "Whether the path gives the attitude of the ground or that of the body."
    )
    rates: tuple[tuple[str, float], ...] = option(
        "--rate",
        type=options.Assignment(),
        multiple=True,
        help="The fastest change of a parameter, per second (deg/s for angles); repeat for each.",
    )
    speed: float | None = option(type=float, help="Along the path, length per second; with --rate.")
    headings: int | None = option(type=int, help="Let the robot turn, too, to this many headings.")
    output: str | None = options.output(help="CSV file of the last run.")
    style: str = options.style()
    force: bool = options.force()
    plot: str | None = option(type=Named(), help="Figure (PNG, SVG or PDF).")
    animate: str | None = option(
        type=Named(), help="Film of both runs: GIF, or MP4 where ffmpeg is installed."
    )


@click.command(short_help="Drive over rough terrain: where does the robot tip over?")
@click.argument("recipe", type=Named())
@asks(Asked)
def path(recipe: str, asked: Asked) -> None:
    """Drive RECIPE along a path and count where it tips over, with a fixed shape and with control.

    -p gives the geometry before control begins; where it is left out, the recipe's `home`, then the
    middle of the range.  Exit code 3 where it tips over at any point of the last run, which may do
    all that is allowed.

    \b
    $ lutgen path maps/paper_two.toml --turn 30 -p alpha=30.96 -p gamma=30.96
    paper_two on the paper's path: 100 points, length 38.9766
    """
    if asked.animate is not None:
        from lutgen.plot import check_animation

        # The runs take their time.
        check_animation(asked.animate)
    options.check_outputs(asked.force, asked.plot, asked.animate)
    robot = open_recipe(recipe, asked.allow_python)
    runs = drives(robot, asked)
    names = list(runs)
    if asked.output is not None:
        from lutgen.files import csv_text, write_text

        columns = table(robot, runs[names[-1]])
        text = csv_text(list(columns), zip(*columns.values(), strict=True))
        write_text(asked.output, text, asked.force)
    drawn = {name: runs[name] for name in (names[0], names[-1])}
    if asked.plot is not None:
        from lutgen.plot import draw_path, on_sheet, save

        with on_sheet(style=asked.style):
            save(draw_path(robot, drawn), asked.plot, force=asked.force)
    if asked.animate is not None:
        from lutgen.plot import animate

        animate(robot, drawn, asked.animate, asked.force)
    lines = path_lines(robot, runs, asked.terrain)
    stands = not runs[names[-1]].tips.any()
    show(path_report(robot, runs, asked), lines, asked.as_json, stands, TIPS)


def drives(robot: "Recipe", asked: Asked) -> "dict[str, Drive]":
    """Return the runs by name: with the fixed shape first, with all that is allowed last."""
    from lutgen.parts import to_internal
    from lutgen.search import drive

    ground = open_terrain(asked)
    units = {p.name: p.display_unit for p in robot.parameters}
    start = options.posture_values(robot, asked.assignments)
    rates = {name: to_internal(rate, units.get(name, "1")) for name, rate in asked.rates}
    if len(rates) < len(asked.rates):
        raise InputError(
            f"a rate is given twice (got {', '.join(f'{n}={r:g}' for n, r in asked.rates)}); give "
            "one for each parameter"
        )
    if asked.no_control and (rates or asked.speed is not None):
        raise InputError(
            "a shape that does not change has no rates (got --no-control with --rate or --speed); "
            "leave one of them out"
        )

    def run(control: bool, headings: int | None) -> "Drive":
        return drive(
            robot,
            ground,
            control=control,
            lag=asked.lag,
            method=asked.method,
            objective=asked.objective,
            convention=asked.convention,
            params0=start,
            headings=headings,
            rates=rates if control else None,
            speed=asked.speed if control else None,
        )

    turns = [None] if asked.headings is None else [None, asked.headings]
    names = {False: ("fixed shape", "turning")}
    if not asked.no_control:
        names[True] = ("changing shape", "changing shape and turning")
    return {
        name: run(control, headings)
        for control, both in names.items()
        for name, headings in zip(both, turns, strict=False)
    }


def open_terrain(asked: Asked) -> "Path":
    """Return the path, with the robot turned."""
    from lutgen.search import paper_path, read_path, turned

    terrain, points, turn = asked.terrain, asked.points, asked.turn
    if terrain == PAPER:
        ground = paper_path(POINTS if points is None else points)
    elif points is not None:
        raise InputError(
            f"{terrain}: a file has the points that it has (got --points {points}); leave it out"
        )
    else:
        ground = read_path(terrain)
    return turned(ground, math.radians(turn)) if turn else ground


def table(recipe: "Recipe", run: "Drive") -> dict[str, Any]:
    """Return what `-o` writes: the columns of a run by name, each of p numbers."""
    import numpy as np

    columns: dict[str, Any] = dict(zip("xyz", run.path.position.T.tolist(), strict=True))
    columns["heading_deg"] = np.degrees(run.heading).tolist()
    columns |= by_unit(recipe, run.params)
    if (run.wanted != run.params).any():
        columns |= by_unit(recipe, run.wanted, "_wanted")
    columns |= {f"gravity_{axis}": run.gravity_body[:, i].tolist() for i, axis in enumerate("xyz")}
    for name, values in run.channels.items():
        one = QUANTITIES[name]
        columns[one.json] = one.shown(values).tolist()
    columns["tips"] = run.tips.tolist()
    return columns


def path_report(recipe: "Recipe", runs: Mapping[str, "Drive"], asked: Asked) -> dict[str, Any]:
    """Return what `--json` prints; null where a number is not finite."""
    import numpy as np

    ground = next(iter(runs.values())).path
    return {
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "terrain": asked.terrain,
        "method": asked.method,
        "objective": asked.objective,
        "convention": asked.convention,
        "lag": asked.lag,
        "points": len(ground.position),
        "length": float(ground.distance[-1]),
        # What the path gives is the slope of the ground, or the attitude of the body on it.
        **({"ground_tilt_deg": _tilts(ground.gravity)} if asked.convention == "plane" else {}),
        "path": {axis: ground.position[:, i].tolist() for i, axis in enumerate("xyz")},
        "runs": [
            {
                "name": name,
                "share": run.share,
                "tips_at": np.flatnonzero(run.tips).tolist(),
                "least_tip_angle_deg": math.degrees(run.channels["tip_angle"].min()),
                "least_at": int(run.channels["tip_angle"].argmin()),
                "evaluations": run.evaluations,
                "heading_deg": np.degrees(run.heading).tolist(),
                "turn_deg": np.degrees(run.turn).tolist(),
                "params": by_unit(recipe, run.params),
                "wanted": by_unit(recipe, run.wanted),
                "body_tilt_deg": _tilts(run.gravity_body),
                "gravity_body": run.gravity_body.tolist(),
                "tip_angle_deg": np.degrees(run.channels["tip_angle"]).tolist(),
                **{
                    channel: [number(value) for value in run.channels[channel]]
                    for channel in ("sdg", "height", "margin")
                },
            }
            for name, run in runs.items()
        ],
    }


def _tilts(down: "NDArray[np.float64]") -> list[float]:
    """Return the angles (deg) of directions (p, 3) from straight down."""
    import numpy as np

    return np.degrees(np.arctan2(np.hypot(down[:, 0], down[:, 1]), -down[:, 2])).tolist()  # type: ignore[no-any-return]


def path_lines(recipe: "Recipe", runs: Mapping[str, "Drive"], terrain: str) -> Iterator[str]:
    """Return the report as text."""
    unit = unit_text(recipe.length_unit)
    where = "the paper's path" if terrain == PAPER else terrain
    ground = next(iter(runs.values())).path
    count = len(ground.position)
    yield f"{recipe.name} on {where}: {count} points, length {ground.distance[-1]:.6g}{unit}"
    width = max(map(len, runs))
    for name, run in runs.items():
        angle = run.channels["tip_angle"]
        least = int(angle.argmin())
        at = ", ".join(f"{value:.4g}" for value in ground.position[least])
        yield (
            f"{name:<{width}}  tips over at {int(run.tips.sum())} points "
            f"({100.0 * run.share:.3g} %), least tip angle {math.degrees(angle[least]):.4g} deg at "
            f"point {least} ({at})"
        )
