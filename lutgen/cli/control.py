"""`lutgen control`: the C steers a robot over rough ground, in a closed loop."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lutgen.cli import options as given
from lutgen.cli.lazy import Floats, np, onboard, searches
from lutgen.cli.options import command, open_recipe, option, stored_values
from lutgen.cli.output import VERDICTS, by_unit, show
from lutgen.cli.path import PAPER, RunOptions, check_run, open_terrain, save_run, vector_columns
from lutgen.errors import InputError, reject

# A policy that is made here has a cycle at each point of a path, no turn of `up` is too large, and
# little is given up for smoothness.
CYCLE, ANYHOW, WITHIN = 1.0, math.pi, math.radians(0.1)
MOVES = ("moves", "rests", "held", "escapes", "blind")
WITHOUT, WITH = "without control", "with control"


@dataclass(frozen=True)
class Options(RunOptions):
    terrain: str = option(
        "As of `lutgen path`: the paper's path, or columns x,y,z and more.",
        default=PAPER,
        metavar="paper|FILE.csv",
    )
    log: str | None = given.file(
        "Instead, what a robot has recorded: time, ax,ay,az, gx,gy,gz (rad/s) if it has a "
        "gyroscope, and each parameter.",
        metavar="FILE.csv",
    )
    turn: float = option(
        "Turn the robot by this angle against the path's heading, deg.", default=0.0
    )
    speed: float | None = option(
        "Along the path, length per second.  [default: a cycle at each point]", above=0.0
    )
    latency: float | None = option(
        "From sample to motion, s; a cycle at least.  [default: the policy's]", low=0.0
    )
    rate: tuple[tuple[str, float], ...] = option(
        "How fast a joint is, per second; repeat.  [default: the policy's]"
    )
    noise: float = option(
        "Standard deviation of each axis of the accelerometer, m/s2.", low=0.0, default=0.0
    )
    seed: int = option("Seed of the noise.", default=0)
    no_gyroscope: bool = option("The robot has none.")
    objective: str | None = option("Objective of the policy that is made for a recipe.")
    cycle: float | None = option("Cycle of that policy, s.  [default: 1]", above=0.0)


@command("source", Options)
def control(source: str, options: Options) -> None:
    """Steer a robot over rough ground with the C of on-board control.

    SOURCE is a folder of `lutgen policy`, or a recipe, in a closed loop with smap_step.  The C
    that lutgen carries runs with the folder's map and policy; nothing in the folder is run.
    For a recipe both are made now, and not certified.  The command acts a cycle after its sample,
    or after --latency.  The recipe, not the C, says where the robot tips.  -p gives the shape in
    which it begins, and which it keeps without control.

    \b
    $ lutgen policy maps/paper_two.toml -o fw --cycle 1 --rate alpha=60 --rate gamma=60
    $ lutgen control fw --turn 30 -p alpha=30.96 -p gamma=30.96 --animate ride.gif
    """
    check_run(options)
    # Read before a policy is made, which takes its time.
    ground = ground_of(options)
    steering = steering_for(source, options)
    if ground is not None:
        ride = onboard.ride_along(ground, steering.cycle, options.speed)
    else:
        ride = onboard.ride_logged(str(options.log), steering)
    plant = plant_for(steering, options)
    if ride.driven is not None and not options.assignments:
        start: Floats = ride.driven[0]
    else:
        start = given.posture_values(steering.recipe, options.assignments)
    loop = onboard.controlled(steering, ride, start, plant)
    runs = {WITHOUT: onboard.uncontrolled(steering, ride, start), WITH: loop.drive}
    save_run(steering.recipe, runs, columns_of(steering, loop), options)
    late = plant.lag(steering.cycle)
    report = {
        "robot": steering.recipe.name,
        "source": source,
        "ground": options.log or options.terrain,
        "codec": steering.codec,
        "cycle_s": steering.cycle,
        "cycles": len(loop.moves),
        "late_by_cycles": late,
        "rates": by_unit(steering.recipe, plant.rates),
        "noise_m_s2": plant.noise,
        "runs": [
            {
                "name": name,
                "share": run.share,
                "tips": int(run.tips.sum()),
                "least_tip_angle_deg": math.degrees(run.channels["tip_angle"].min()),
                "median_tip_angle_deg": math.degrees(np.median(run.channels["tip_angle"])),
            }
            for name, run in runs.items()
        ],
        "tips_only_with_control": int((runs[WITH].tips & ~runs[WITHOUT].tips).sum()),
        "moves": {name: int((loop.moves == i).sum()) for i, name in enumerate(MOVES)},
        "alarms": [int((loop.alarms == level).sum()) for level in range(4)],
        "most_poses": int(loop.poses.max()),
    }
    show(report, lines)


def steering_for(source: str, options: Options) -> "onboard.Steering":
    """Return the robot and what steers it."""
    if Path(source).is_dir():
        for name, value in (("objective", options.objective), ("cycle", options.cycle)):
            if value is not None:
                way_out = "make another one with `lutgen policy`"
                reject(source, "a folder has its policy", f"--{name}", way_out, InputError)
        return onboard.steering_in(source)
    robot = open_recipe(source, options.allow_python)
    cycle = CYCLE if options.cycle is None else options.cycle
    # Every parameter goes all the way in a cycle, unless its rate is given.
    policy_options = onboard.PolicyOptions(
        objective=options.objective or "tip_angle",
        within=WITHIN,
        rate=stored_values(robot, options.rate, "--rate")
        or {p.name: (p.maximum - p.minimum) / cycle for p in robot.parameters},
        cycle=cycle,
        latency=max(options.latency or 0.0, 1e-6),
        swerve=ANYHOW,
    )
    return onboard.steering_of(robot, policy_options)


def plant_for(steering: "onboard.Steering", options: Options) -> "onboard.Plant":
    """Return what is between the C and the ground."""
    rates = steering.rates.copy()
    names = [p.name for p in steering.recipe.parameters]
    for name, rate in stored_values(steering.recipe, options.rate, "--rate").items():
        rates[names.index(name)] = rate
    latency = steering.latency if options.latency is None else options.latency
    return onboard.Plant(latency, rates, options.noise, options.seed, not options.no_gyroscope)


def ground_of(options: Options) -> "searches.Path | None":
    """Return the path that is ridden over; None where a log is."""
    if options.log is None:
        return open_terrain(options.terrain, options.turn)
    if options.animate is not None:
        what = "a log does not say where the robot was"
        reject(options.log, what, "--animate with --log", "take --plot", InputError)
    if options.terrain != PAPER or options.speed is not None or options.turn:
        what, way_out = "a log has its own ground, time and heading", "leave them out"
        reject(options.log, what, "--terrain, --speed or --turn with --log", way_out, InputError)
    return None


def columns_of(steering: "onboard.Steering", loop: "onboard.Loop") -> dict[str, Any]:
    """Return what `-o` writes: the columns by name, each of n values."""
    drive, count = loop.drive, len(loop.moves)
    return {
        "time": (np.arange(count) * steering.cycle).tolist(),
        **vector_columns("", drive.path.position),
        **by_unit(steering.recipe, drive.params),
        **by_unit(steering.recipe, drive.wanted, "_commanded"),
        **vector_columns("gravity_", drive.gravity_body),
        "tip_angle_deg": np.degrees(drive.channels["tip_angle"]).tolist(),
        "move": [MOVES[move] for move in loop.moves],
        "alarm": loop.alarms.tolist(),
        "poses": loop.poses.tolist(),
        "tips": drive.tips.tolist(),
    }


def lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    ground = "the paper's path" if report["ground"] == PAPER else report["ground"]
    yield (
        f"{report['robot']} on {ground}: {report['cycles']} cycles of {report['cycle_s']:g} s, "
        f"commands late by {report['late_by_cycles']}"
    )
    for run in report["runs"]:
        yield [
            run["name"],
            f"{VERDICTS['tips']} in {run['tips']} cycles ({100.0 * run['share']:.3g} %)",
            f"least tip angle {run['least_tip_angle_deg']:.4g} deg",
            f"median {run['median_tip_angle_deg']:.4g} deg",
        ]
    yield f"it tips over only with control in {report['tips_only_with_control']} cycles"
    moves = ", ".join(f"{name} {count}" for name, count in report["moves"].items() if count)
    yield f"smap_step: {moves}; alarm 0 to 3: {', '.join(map(str, report['alarms']))}"
