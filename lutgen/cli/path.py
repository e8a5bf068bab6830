"""`lutgen path`: a robot drives over rough terrain, with and without control."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lutgen import bounds
from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import Floats, figures, np, robots, searches
from lutgen.cli.options import FigureOptions, RecipeOptions, command, option
from lutgen.errors import InputError, reject
from lutgen.quantities import QUANTITIES

PAPER, POINTS = "paper", 100


@dataclass(frozen=True)
class RunOptions(RecipeOptions, FigureOptions):
    """Options of every command that runs over ground: what `path` and `control` share."""

    assignments: tuple[tuple[str, float], ...] = given.parameters()
    output: str | None = given.output("CSV file of the last run.")
    plot: str | None = given.file("Figure (PNG, SVG or PDF).")
    animate: str | None = given.file("Film of both runs: GIF, or MP4 where ffmpeg is installed.")


@dataclass(frozen=True)
class Options(RunOptions):
    terrain: str = option(
        "The paper's path, or a file with columns x,y,z and if wanted heading (deg), nx,ny,nz.",
        default=PAPER,
        metavar="paper|FILE.csv",
    )
    points: int | None = option(
        f"Points of the paper's path.  [default: {POINTS}]", low=2, high=bounds.POINTS.most
    )
    turn: float = option(
        "Turn the robot by this angle against the path's heading, deg, to the left.", default=0.0
    )
    no_control: bool = option("Only drive without changing the shape.")
    lag: int = option("Points by which control is late.", low=0, default=1)
    method: str = given.method()
    objective: str = option(
        "The best of it is chosen: a channel, or a sum such as sdg+0.1*height.", default="sdg"
    )
    convention: str = given.convention(
        "plane", "body", "The path gives the attitude of the ground, or that of the body."
    )
    rates: tuple[tuple[str, float], ...] = option(
        "The fastest change of a parameter, per second (deg/s for angles); repeat for each.",
        "--rate",
    )
    speed: float | None = option("Along the path, length per second; with --rate.", above=0.0)
    headings: int | None = option(
        "Let the robot turn, too, to this many headings.", low=1, high=bounds.HEADINGS.most
    )


@command("recipe", Options)
def path(robot: "robots.Recipe", options: Options) -> None:
    """Drive RECIPE over rough ground and count where it tips over.

    Once with a fixed shape, and once with control.  -p gives the geometry before control begins.
    Exit code 3 where it tips over at any point of the last run, which may do all that is allowed.

    \b
    $ lutgen path maps/paper_two.toml --turn 30 -p alpha=30.96 -p gamma=30.96
    paper_two on the paper's path: 100 points, length 38.9766
    """
    check_run(options)
    runs = drives(robot, options)
    first, *_, last = [*runs, *runs]
    save_run(robot, {name: runs[name] for name in (first, last)}, table(robot, runs[last]), options)
    ground = runs[last].path
    report = {
        **output.entries(robot, "robot=name length_unit"),
        **output.entries(options, "terrain method objective convention lag"),
        "points": len(ground.position),
        "length": ground.distance[-1],
        # The path gives the slope of the ground, or the attitude of the body on it.
        **({"ground_tilt_deg": tilts(ground.gravity)} if options.convention == "plane" else {}),
        "path": dict(zip("xyz", ground.position.T, strict=True)),
        "runs": [run_entry(robot, name, run) for name, run in runs.items()],
    }
    code = output.TIPS if runs[last].tips.any() else 0
    output.show(report, path_lines, code)


def check_run(options: RunOptions) -> None:
    """Refuse outputs that cannot be written before the runs, which take their time."""
    if options.animate is not None:
        figures.check_animation(options.animate)
    output.check_outputs(options.force, options.plot, options.animate)


def save_run(
    robot: "robots.Recipe",
    runs: "Mapping[str, searches.Drive]",
    columns: Mapping[str, Any],
    options: RunOptions,
) -> None:
    """Write the table, the figure and the film that were requested."""
    output.save_columns(columns, options.output, options.force)
    output.save_figure(lambda plot: plot.draw_path(robot, runs), options.plot, options)
    if options.animate is not None:
        figures.animate(robot, runs, options.animate, options.force)


def drives(robot: "robots.Recipe", options: Options) -> "dict[str, searches.Drive]":
    """Return the runs by name: with the fixed shape first, with all that is allowed last."""
    ground = open_terrain(options.terrain, options.turn, options.points)
    start = given.posture_values(robot, options.assignments)
    rates = given.stored_values(robot, options.rates, "--rate")
    if options.no_control and (rates or options.speed is not None):
        what, got = "a shape that does not change has no rates", "--no-control with a rate or speed"
        reject("--rate, --speed", what, got, "leave one of them out", InputError)

    def run(control: bool, headings: int | None) -> "searches.Drive":
        return searches.drive(
            robot,
            ground,
            control=control,
            **output.entries(options, "lag method objective convention"),
            params0=start,
            headings=headings,
            rates=rates if control else None,
            speed=options.speed if control else None,
        )

    turns = [None] if options.headings is None else [None, options.headings]
    names = {False: ("fixed shape", "turning")}
    if not options.no_control:
        names[True] = ("changing shape", "changing shape and turning")
    return {
        name: run(control, headings)
        for control, both in names.items()
        for name, headings in zip(both, turns, strict=False)
    }


def open_terrain(terrain: str, turn: float, points: int | None = None) -> "searches.Path":
    """Return the paper's path or that of a file, with the robot turned by an angle (deg)."""
    if terrain == PAPER:
        ground = searches.paper_path(POINTS if points is None else points)
    elif points is not None:
        what = "a file has the points that it has"
        reject(terrain, what, f"--points {points}", "leave it out", InputError)
    else:
        ground = searches.read_path(terrain)
    return searches.turned(ground, math.radians(turn)) if turn else ground


def table(recipe: "robots.Recipe", run: "searches.Drive") -> dict[str, Any]:
    """Return what `-o` writes: the columns of a run by name, each of p numbers."""
    columns: dict[str, Any] = vector_columns("", run.path.position)
    columns["heading_deg"] = np.degrees(run.heading).tolist()
    columns |= output.by_unit(recipe, run.params)
    if (run.wanted != run.params).any():
        columns |= output.by_unit(recipe, run.wanted, "_wanted")
    columns |= vector_columns("gravity_", run.gravity_body)
    for name, values in run.channels.items():
        one = QUANTITIES[name]
        columns[one.json] = one.shown(values).tolist()
    columns["tips"] = run.tips.tolist()
    return columns


def vector_columns(name: str, vectors: "Floats") -> dict[str, list[float]]:
    """Return the columns of vectors (p, 3)."""
    return {f"{name}{axis}": part for axis, part in zip("xyz", vectors.T.tolist(), strict=True)}


def run_entry(recipe: "robots.Recipe", name: str, run: "searches.Drive") -> dict[str, Any]:
    """Return what a report says of one run."""
    angle = run.channels["tip_angle"]
    return {
        "name": name,
        "share": run.share,
        "tips_at": np.flatnonzero(run.tips),
        "least_tip_angle_deg": math.degrees(angle.min()),
        "least_at": int(angle.argmin()),
        **output.entries(run, "evaluations heading_deg turn_deg"),
        "params": output.by_unit(recipe, run.params),
        "wanted": output.by_unit(recipe, run.wanted),
        "body_tilt_deg": tilts(run.gravity_body),
        "gravity_body": run.gravity_body,
        "tip_angle_deg": np.degrees(angle),
        **{channel: run.channels[channel] for channel in ("sdg", "height", "margin")},
    }


def tilts(down: "Floats") -> "Floats":
    """Return the angles (deg) of directions (p, 3) from straight down."""
    return np.asarray(np.degrees(np.arctan2(np.hypot(down[:, 0], down[:, 1]), -down[:, 2])))


def path_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    where = "the paper's path" if report["terrain"] == PAPER else report["terrain"]
    length = f"{report['length']:.6g}{output.unit_text(report['length_unit'])}"
    yield f"{report['robot']} on {where}: {report['points']} points, length {length}"
    for run in report["runs"]:
        least = run["least_at"]
        at = ", ".join(f"{report['path'][axis][least]:.4g}" for axis in "xyz")
        tips = f"at {len(run['tips_at'])} points ({100.0 * run['share']:.3g} %)"
        angle = f"least tip angle {run['least_tip_angle_deg']:.4g} deg at point {least} ({at})"
        yield [run["name"], f"{output.VERDICTS['tips']} {tips}, {angle}"]
