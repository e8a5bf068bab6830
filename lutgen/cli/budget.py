"""`lutgen budget`: how hard a robot may brake, speed up and turn before it tips over."""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.options import RecipeOptions, command, open_recipe, option
from lutgen.errors import InputError

if TYPE_CHECKING:
    from lutgen.recipe import Recipe
    from lutgen.vector import Floats

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
# m/s^2: neither the recipe nor the C looks further than 50.
BOUNDLESS = 49.9


@dataclass(frozen=True)
class Options(RecipeOptions):
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    over: tuple[str, float, float] | None = option(
        type=given.Numbers(*given.RANGE),
        help="Also over postures: a parameter from one end to the other.",
    )
    steps: int = option(
        type=given.Number(int, 2, MOST), default=5, help="How many values of --over."
    )
    slope: str = option(
        default="0:30:10",
        metavar="FROM:TO:STEP",
        help="Slopes of the ground, deg; one alone is a number.",
    )
    heading: float = option(
        default=0.0,
        help="How the slope faces, deg from the nose to the left: 0 nose down, 90 left side down.",
    )
    turn: float = option(default=2.0, help="Radius of the turn whose speed is told, m.")
    reads: int = option(
        type=given.Number(int, 1, 32),
        default=4,
        help="Of an export: reads of its map for each budget, 1 to 32.",
    )
    output: str | None = given.output(help="CSV file of the table.")
    force: bool = given.force()


@command("source", Options)
def budget(source: str, options: Options) -> None:
    """Print how hard SOURCE may brake and turn before it tips over.

    Of a recipe exactly; of the folder of an export as its C says it (smap_budget), which is never
    too much.  The robot stands on a slope and leans as its shape makes it.  Turning is given with
    the speed at which a turn of --turn takes it.  Sliding is not included.

    \b
    $ lutgen budget maps/paper_two.toml -p alpha=0 -p gamma=0
    $ lutgen budget firmware --over front=0:90 -o budget.csv
    """
    if not 0.0 < options.turn < math.inf:
        raise InputError(f"--turn: a radius above 0 m (got {options.turn:g}).")
    robot, limit = opened(source, options)
    rows = budget_rows(robot, limit, postures(robot, options), options)
    report = {
        "robot": robot.name,
        "source": "compiled" if Path(source).is_dir() else "exact",
        "heading_deg": options.heading,
        "turn_m": options.turn,
        "budgets": rows,
    }
    flat = [{**row["posture"], **row} for row in rows]
    columns = {key: [row[key] for row in flat] for key in flat[0] if key != "posture"}
    output.save_columns(columns, options.output, options.force)
    output.show(report, lines, options.as_json)


def opened(source: str, options: Options) -> "tuple[Recipe, Callable[..., Floats]]":
    """Return the robot, and what limits postures under directions of gravity in directions."""
    if Path(source).is_dir():
        from firmware_export.device import ExportFolder
        from firmware_export.host import budget as read

        folder = ExportFolder(source)
        if folder.integer:
            raise InputError(
                f"{source}: smap_budget computes with floats (got integer arithmetic); export with "
                "--arithmetic float."
            )
        return folder.recipe(), lambda params, gravity, way: read(
            folder.blob, params, gravity, way, options.reads
        )[0].astype(float)
    from lutgen.analysis import budgets

    robot = open_recipe(source, options.allow_python)
    return robot, lambda params, gravity, way: budgets(robot, params, gravity, way)


def postures(robot: "Recipe", options: Options) -> "Floats":
    """Return the postures (p, k)."""
    import numpy as np

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
    import numpy as np

    parts = given.finite_numbers(text, ":")
    shapes = {1: (*parts, *parts, 10.0), 2: (*parts, 10.0), 3: parts}
    low, high, step = shapes.get(len(parts), 3 * (math.nan,))
    few = step > 0.0 and high - low <= MOST * step
    if not (0.0 <= low <= high <= STEEPEST and few):
        raise InputError(
            f"--slope: at most {MOST} slopes FROM:TO:STEP from 0 to {STEEPEST:g} deg (got {text}); "
            "write for example 0:30:10."
        )
    return np.arange(low, high + 1e-9 * max(step, 1.0), step)


def budget_rows(
    robot: "Recipe", limit: "Callable[..., Floats]", postures: "Floats", options: Options
) -> list[dict[str, Any]]:
    """Return a row for each posture (p, k) and slope."""
    import numpy as np

    from lutgen.analysis import tilted, turn_speed
    from lutgen.channels import body_gravity

    slopes = slopes_of(options.slope)
    params, slope = np.repeat(postures, len(slopes), axis=0), np.tile(slopes, len(postures))
    ground = tilted(np.radians(slope), math.radians(options.heading))
    down = body_gravity(robot, params, ground, "plane")
    found = {
        f"{name.replace(' ', '_')}_m_s2": limit(params, down, np.tile(way, (len(params), 1)))
        for name, way in WAYS.items()
    }
    sides = np.minimum(found["turning_left_m_s2"], found["turning_right_m_s2"])
    found["turn_speed_m_s"] = turn_speed(sides, options.turn)
    return [
        {
            "posture": output.by_unit(robot, params[i]),
            "slope_deg": float(slope[i]),
            **{key: float(values[i]) for key, values in found.items()},
        }
        for i in range(len(params))
    ]


def lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    exact = "exactly" if report["source"] == "exact" else "as its C says"
    facing = FACING.get(report["heading_deg"] % 360.0, f"heading {report['heading_deg']:g} deg")
    yield f"{report['robot']}: acceleration before it tips over, {exact}; slopes {facing}"
    yield (
        f"none: none below 50 m/s2; a turn of {report['turn_m']:g} m takes the less of both sides "
        "at the last speed"
    )
    for posture, group in itertools.groupby(report["budgets"], lambda row: row["posture"]):
        rows = [["slope", *WAYS, "turn at"]]
        for row in group:
            limits = [limit_text(row[f"{name.replace(' ', '_')}_m_s2"]) for name in WAYS]
            speed = output.cell(row["turn_speed_m_s"], ".2f", " m/s")
            rows.append([output.cell(row["slope_deg"], "g", " deg"), *limits, speed])
        yield output.posture_text(posture)
        yield from output.aligned(rows)


def limit_text(value: float) -> str:
    """Return a limit as text, rounded down."""
    if value <= 0.0:
        return output.VERDICTS["tips"]
    return "none" if value >= BOUNDLESS else f"{math.floor(100.0 * value) / 100.0:.2f} m/s2"
