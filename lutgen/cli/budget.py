"""`lutgen budget`: how hard a robot may brake, speed up and turn before it tips over."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import Floats, analysis, evaluation, np, robots
from lutgen.cli.options import RecipeOptions, command, option
from lutgen.errors import InputError, reject

# Where the robot accelerates, body frame.
WAYS = {
    "braking": (-1.0, 0.0, 0.0),
    "speeding up": (1.0, 0.0, 0.0),
    "turning left": (0.0, 1.0, 0.0),
    "turning right": (0.0, -1.0, 0.0),
}
FACING = {0.0: "nose down", 90.0: "left side down", 180.0: "nose up", 270.0: "right side down"}
# Most slopes and most postures, and the steepest slope (deg).
MOST, STEEPEST = 200, 80.0
# m/s^2: a budget is looked for up to 50.
BOUNDLESS = 49.9


@dataclass(frozen=True)
class Options(RecipeOptions):
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    over: tuple[str, float, float] | None = option(
        "Also over postures: a parameter from one end to the other."
    )
    steps: int = option("How many values of --over.", low=2, high=MOST, default=5)
    slope: str = option(
        "Slopes of the ground, deg; one alone is a number.",
        default="0:30:10",
        metavar="FROM:TO:STEP",
    )
    heading: float = option(
        "How the slope faces, deg from the nose to the left: 0 nose down, 90 left side down.",
        default=0.0,
    )
    turn: float = option("Radius of the turn whose speed is printed, m.", above=0.0, default=2.0)
    headings: int = option("How many have a stop speed; a multiple of 4.", default=8)
    bump: float = option("Height of a bump below one contact as it stops, m.", low=0.0, default=0.0)
    output: str | None = given.output("CSV file of the table.")
    force: bool = given.force()


@command("recipe", Options)
def budget(robot: "robots.Recipe", options: Options) -> None:
    """Print how hard the robot of RECIPE may brake and turn before it tips over.

    The robot stands on a slope and leans as its shape makes it.  Turning is given with the speed at
    which a turn of --turn takes it.  Sliding is not included.  Also printed is from which speed a
    dead stop does not tip it, all contacts at once in each heading or one contact alone in any.

    \b
    $ lutgen budget maps/paper_two.toml -p alpha=0 -p gamma=0
    $ lutgen budget maps/absolem.toml --over front=0:90 -o budget.csv
    """
    rows = budget_rows(robot, postures(robot, options), options)
    report = {
        "robot": robot.name,
        "heading_deg": options.heading,
        "turn_m": options.turn,
        "bump_m": options.bump,
        "budgets": rows,
    }
    flat = [{**row["posture"], **row} for row in rows]
    for row in flat:
        row |= {f"stop_at_{at}_deg_m_s": v for at, v in row.pop("stop_speeds_m_s").items()}
    columns = {key: [row[key] for row in flat] for key in flat[0] if key != "posture"}
    output.save_columns(columns, options.output, options.force)
    output.show(report, lines)


def postures(robot: "robots.Recipe", options: Options) -> "Floats":
    """Return the postures (p, k)."""
    start = given.posture_values(robot, options.assignments)
    if options.over is None:
        return start[None, :]
    ((name, (low, high)),) = given.stored_values(robot, [options.over], "--over").items()
    rows = np.tile(start, (options.steps, 1))
    at = [p.name for p in robot.parameters].index(name)
    rows[:, at] = np.linspace(low, high, options.steps)
    return rows


def slopes_of(text: str) -> "Floats":
    """Return the slopes (s,) that `--slope` names, deg."""
    parts = given.finite_numbers(text, ":")
    shapes = {1: (*parts, *parts, 10.0), 2: (*parts, 10.0), 3: parts}
    low, high, step = shapes.get(len(parts), 3 * (math.nan,))
    few = step > 0.0 and high - low <= MOST * step
    if not (0.0 <= low <= high <= STEEPEST and few):
        what = f"at most {MOST} slopes FROM:TO:STEP from 0 to {STEEPEST:g} deg"
        reject("--slope", what, text, "write for example 0:30:10", InputError)
    return np.arange(low, high + 1e-9 * max(step, 1.0), step)


def budget_rows(
    robot: "robots.Recipe", postures: "Floats", options: Options
) -> list[dict[str, Any]]:
    """Return a row for each posture (p, k) and slope."""
    slopes = slopes_of(options.slope)
    params, slope = np.repeat(postures, len(slopes), axis=0), np.tile(slopes, len(postures))
    ground = analysis.tilted(np.radians(slope), math.radians(options.heading))
    down = evaluation.body_gravity(robot, params, ground, "plane")
    found = {
        f"{name.replace(' ', '_')}_m_s2": analysis.budgets(robot, params, down, way)
        for name, way in WAYS.items()
    }
    sides = np.minimum(found["turning_left_m_s2"], found["turning_right_m_s2"])
    found["turn_speed_m_s"] = analysis.turn_speed(sides, options.turn)
    around = analysis.even_headings(options.headings)
    names, rows = [f"{heading:g}" for heading in np.degrees(around).round(6).tolist()], []
    for i, row in enumerate(params):
        stops = analysis.stop_speeds(analysis.Posture(robot, row), down[i], around, options.bump)
        entries = {
            "posture": output.by_unit(robot, row),
            "slope_deg": float(slope[i]),
            **{key: float(values[i]) for key, values in found.items()},
            "stop_speed_m_s": stops.anyhow,
            "stop_speeds_m_s": dict(zip(names, stops.all_at_once.tolist(), strict=True)),
        }
        rows.append(entries)
    return rows


def lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    facing = FACING.get(report["heading_deg"] % 360.0, f"heading {report['heading_deg']:g} deg")
    yield f"{report['robot']}: acceleration before it tips over; slopes {facing}"
    yield (
        f"none: none below 50 m/s2; a turn of {report['turn_m']:g} m takes the less of both sides "
        "at the last speed"
    )
    for posture, group in itertools.groupby(report["budgets"], lambda row: row["posture"]):
        rows = list(group)
        yield output.posture_text(posture)
        yield ["slope", *WAYS, "turn at"]
        for row in rows:
            limits = [limit_text(row[f"{name.replace(' ', '_')}_m_s2"]) for name in WAYS]
            speed = output.cell(row["turn_speed_m_s"], ".2f", " m/s")
            yield [output.cell(row["slope_deg"], "g", " deg"), *limits, speed]
        yield from stop_lines(rows, report["bump_m"])


def stop_lines(rows: list[dict[str, Any]], bump: float) -> Iterator[Sequence[str]]:
    """Return the speeds of stops as text, if there are any."""
    if rows[0]["stop_speed_m_s"] is None:
        return
    on = f" on a bump of {bump:g} m" if bump else ""
    yield f"highest speed (m/s) at which a dead stop{on} does not tip it, by heading to the left"
    headings = [f"{heading} deg" for heading in rows[0]["stop_speeds_m_s"]]
    yield ["slope", *headings, "one contact"]
    for row in rows:
        speeds = [*row["stop_speeds_m_s"].values(), row["stop_speed_m_s"]]
        yield [output.cell(row["slope_deg"], "g", " deg"), *map(speed_text, speeds)]


def speed_text(speed: float | None) -> str:
    """Return a speed as text, rounded down; none where it never tips."""
    return "none" if speed is None else f"{analysis.rounded_down(speed):.2f}"


def limit_text(value: float) -> str:
    """Return a limit as text, rounded down."""
    if value <= 0.0:
        return output.VERDICTS["tips"]
    return "none" if value >= BOUNDLESS else f"{analysis.rounded_down(value):.2f} m/s2"
