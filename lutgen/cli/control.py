"""`lutgen control`: the C steers a robot over rough ground, in a closed loop."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Assignments, Named, RecipeOptions, asks, option
from lutgen.cli.table import aligned, by_unit, show
from lutgen.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from firmware_export.control import Loop, Plant, Ride, Steering
    from lutgen.recipe import Recipe
    from lutgen.search import Drive

PAPER, POINTS = "paper", 100
# Of a policy that is made here: a cycle at each point of a path, no turn of `up` is too large, and
# little is given up for smoothness.
CYCLE, ANYHOW, WITHIN = 1.0, math.pi, math.radians(0.1)
MOVES = ("moves", "rests", "held", "escapes", "blind")
WITHOUT, WITH = "without control", "with control"


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    terrain: str = option(
        default=PAPER,
        metavar="paper|FILE.csv",
        help="As of `lutgen path`: the paper's path, or columns x,y,z and more.",
    )
    log: str | None = option(
        type=Named(),
        metavar="FILE.csv",
        help="Instead, what a robot has recorded: time, ax,ay,az, gx,gy,gz (rad/s) if it has a "
        "gyroscope, and each parameter.",
    )
    turn: float = option(
        default=0.0, help="Turn the robot by this angle against the path's heading, deg."
    )
    assignments: tuple[tuple[str, float], ...] = options.parameters()
    speed: float | None = option(
        type=float, help="Along the path, length per second.  [default: a cycle at each point]"
    )
    latency: float | None = option(
        type=float, help="From sample to motion, s; a cycle at least.  [default: the policy's]"
    )
    rate: Assignments = option(  # noqa: RUF009
        type=options.Assignment(),
        multiple=True,
        help="How fast a joint is, per second; repeat.  [default: the policy's]",
    )
    noise: float = option(
        default=0.0, help="Standard deviation of each axis of the accelerometer, m/s2."
    )
    seed: int = option(default=0, help="Of the noise.")
    no_gyroscope: bool = option(is_flag=True, help="The robot has none.")
    objective: str | None = option(help="Of the policy that is made for a recipe.")
    cycle: float | None = option(type=float, help="Of that policy, s.  [default: 1]")
    output: str | None = options.output(help="CSV file of the run with control.")
    plot: str | None = option(type=Named(), help="Figure (PNG, SVG or PDF).")
    size: str | None = options.size()
    style: str = options.style()
    force: bool = options.force()
    animate: str | None = option(
        type=Named(), help="Film of both runs: GIF, or MP4 where ffmpeg is installed."
    )


@click.command(short_help="Steer a robot over rough ground with the C of on-board control.")
@click.argument("source", type=Named())
@asks(Asked)
def control(source: str, asked: Asked) -> None:
    """Ride with SOURCE, a folder of `lutgen policy` or a recipe, in a closed loop with smap_step.

    The C that lutgen carries is asked with the folder's map and policy; nothing in the folder is
    run.  For a recipe both are made now, and not certified.  The command acts a cycle after its
    sample, or after --latency; where the robot tips is told by the recipe and not by the C.
    -p gives the shape in which it begins, and which it keeps without control.

    \b
    $ lutgen policy maps/paper_two.toml -o fw --cycle 1 --rate alpha=60 --rate gamma=60
    $ lutgen control fw --turn 30 -p alpha=30.96 -p gamma=30.96 --animate ride.gif
    """
    if asked.animate is not None:
        from lutgen.plot import check_animation

        check_animation(asked.animate)
    options.check_outputs(asked.force, asked.plot, asked.animate)
    from firmware_export.control import controlled, uncontrolled

    steering = _steering(source, asked)
    robot = steering.recipe
    ride, plant = _ride(steering, asked), _plant(steering, asked)
    start = _start(robot, ride, asked)
    loop = controlled(steering, ride, start, plant)
    runs = {WITHOUT: uncontrolled(steering, ride, start), WITH: loop.drive}
    if asked.output is not None:
        from lutgen.files import csv_text, write_text

        columns = _columns(robot, loop, steering.cycle)
        text = csv_text(list(columns), zip(*columns.values(), strict=True))
        write_text(asked.output, text, asked.force)
    if asked.plot is not None:
        from lutgen.plot import draw_path, on_sheet, save

        with on_sheet(asked.size, asked.style):
            save(draw_path(robot, runs), asked.plot, force=asked.force)
    if asked.animate is not None:
        from lutgen.plot import animate

        animate(robot, runs, asked.animate, asked.force)
    report = _report(source, steering, plant, runs, loop, asked)
    show(report, lines(report), asked.as_json)


def _steering(source: str, asked: Asked) -> "Steering":
    """Return the robot and what steers it."""
    from firmware_export.control import Wishes, steering_in, steering_of
    from lutgen.cli.sources import open_recipe

    if Path(source).is_dir():
        for name in ("objective", "cycle"):
            if getattr(asked, name) is not None:
                raise InputError(
                    f"{source}: a folder has its policy (got --{name}); make another one with "
                    "`lutgen policy`."
                )
        return steering_in(source)
    robot = open_recipe(source, asked.allow_python)
    cycle = CYCLE if asked.cycle is None else asked.cycle
    wishes = Wishes(
        objective=asked.objective or "tip_angle",
        within=WITHIN,
        rate=_stored(robot, asked.rate) or {p.name: _at_once(p, cycle) for p in robot.parameters},
        cycle=cycle,
        latency=max(asked.latency or 0.0, 1e-6),
        swerve=ANYHOW,
    )
    return steering_of(robot, wishes)


def _at_once(parameter: Any, cycle: float) -> float:
    """Return the rate at which a parameter goes all the way in a cycle."""
    span: float = parameter.maximum - parameter.minimum
    return span / cycle if cycle > 0.0 else span


def _stored(recipe: "Recipe", given: Assignments) -> dict[str, float]:
    """Return rates in rad or length per second, by parameter."""
    from lutgen.parts import to_internal

    rates = options.named_values(recipe, given)
    units = {p.name: p.display_unit for p in recipe.parameters}
    return {name: to_internal(rate, units[name]) for name, rate in rates.items()}


def _plant(steering: "Steering", asked: Asked) -> "Plant":
    """Return what is between the C and the ground."""
    from firmware_export.control import Plant

    rates = steering.rates.copy()
    names = [p.name for p in steering.recipe.parameters]
    for name, rate in _stored(steering.recipe, asked.rate).items():
        rates[names.index(name)] = rate
    latency = steering.latency if asked.latency is None else asked.latency
    return Plant(latency, rates, asked.noise, asked.seed, not asked.no_gyroscope)


def _ride(steering: "Steering", asked: Asked) -> "Ride":
    """Return what is ridden over."""
    from firmware_export.control import read_log, ride_along, ride_logged
    from lutgen.search import paper_path, read_path, turned

    if asked.log is not None:
        if asked.animate is not None:
            raise InputError(
                f"{asked.log}: a log does not say where the robot was (got --animate with --log); "
                "take --plot."
            )
        if asked.terrain != PAPER or asked.speed is not None or asked.turn:
            raise InputError(
                f"{asked.log}: a log has its own ground, time and heading (got --terrain, --speed "
                "or --turn with --log); leave them out."
            )
        return ride_logged(*read_log(asked.log, steering.recipe), steering)
    path = paper_path(POINTS) if asked.terrain == PAPER else read_path(asked.terrain)
    if asked.turn:
        path = turned(path, math.radians(asked.turn))
    return ride_along(path, steering.cycle, asked.speed)


def _start(robot: "Recipe", ride: "Ride", asked: Asked) -> "NDArray[np.float64]":
    """Return the posture (k,) in which the robot begins."""
    import numpy as np

    if ride.driven is not None and not asked.assignments:
        return np.array(ride.driven[0])
    return np.array(options.posture_values(robot, asked.assignments), np.float64)


def _columns(robot: "Recipe", loop: "Loop", cycle: float) -> dict[str, Any]:
    """Return what `-o` writes: the columns by name, each of n values."""
    import numpy as np

    drive, count = loop.drive, len(loop.moves)
    columns: dict[str, Any] = {"time": (np.arange(count) * cycle).tolist()}
    columns |= dict(zip("xyz", drive.path.position.T.tolist(), strict=True))
    columns |= by_unit(robot, drive.params)
    columns |= by_unit(robot, drive.wanted, "_commanded")
    columns |= {
        f"gravity_{axis}": drive.gravity_body[:, i].tolist() for i, axis in enumerate("xyz")
    }
    columns["tip_angle_deg"] = np.degrees(drive.channels["tip_angle"]).tolist()
    columns["move"] = [MOVES[move] for move in loop.moves]
    columns["alarm"], columns["poses"] = loop.alarms.tolist(), loop.poses.tolist()
    columns["tips"] = drive.tips.tolist()
    return columns


def _report(
    source: str,
    steering: "Steering",
    plant: "Plant",
    runs: "Mapping[str, Drive]",
    loop: "Loop",
    asked: Asked,
) -> dict[str, Any]:
    """Return what `--json` prints."""
    import numpy as np

    only = runs[WITH].tips & ~runs[WITHOUT].tips
    return {
        "robot": steering.recipe.name,
        "source": source,
        "ground": asked.log or asked.terrain,
        "codec": steering.codec,
        "cycle_s": steering.cycle,
        "cycles": len(loop.moves),
        "late_by_cycles": plant.lag(steering.cycle),
        "rates": by_unit(steering.recipe, plant.rates),
        "noise_m_s2": plant.noise,
        "runs": [
            {
                "name": name,
                "share": run.share,
                "tips": int(run.tips.sum()),
                "least_tip_angle_deg": math.degrees(float(run.channels["tip_angle"].min())),
                "median_tip_angle_deg": math.degrees(float(np.median(run.channels["tip_angle"]))),
            }
            for name, run in runs.items()
        ],
        "tips_only_with_control": int(only.sum()),
        "moves": {name: int((loop.moves == i).sum()) for i, name in enumerate(MOVES)},
        "alarms": [int((loop.alarms == level).sum()) for level in range(4)],
        "most_poses": int(loop.poses.max()),
    }


def lines(report: Mapping[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    ground = "the paper's path" if report["ground"] == PAPER else report["ground"]
    late = report["late_by_cycles"]
    yield (
        f"{report['robot']} on {ground}: {report['cycles']} cycles of {report['cycle_s']:g} s, "
        f"commands late by {late}"
    )
    yield from aligned(
        [
            [
                run["name"],
                f"tips over in {run['tips']} cycles ({100.0 * run['share']:.3g} %)",
                f"least tip angle {run['least_tip_angle_deg']:.4g} deg",
                f"median {run['median_tip_angle_deg']:.4g} deg",
            ]
            for run in report["runs"]
        ]
    )
    yield f"it tips only with control in {report['tips_only_with_control']} cycles"
    moves = ", ".join(f"{name} {count}" for name, count in report["moves"].items() if count)
    yield f"smap_step: {moves}; alarm 0 to 3: {', '.join(map(str, report['alarms']))}"
