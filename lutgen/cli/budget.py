"""`lutgen budget`: how hard a robot may brake, speed up and turn before it tips over."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Named, RecipeOptions, asks, option
from lutgen.cli.table import aligned, by_unit, cell, posture_text, show
from lutgen.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.recipe import Recipe

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
class Asked(RecipeOptions):
    """What the command line says."""

    assignments: tuple[tuple[str, float], ...] = options.parameters()
    over: tuple[str, float, float] | None = option(
        type=options.Assignment("NAME=LOW:HIGH", "range", "alpha=0:60"),
        help="Also over postures: a parameter from one end to the other.",
    )
    steps: int = option(default=5, help="How many values of --over.")
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
    reads: int = option(default=4, help="Of an export: reads of its map for each budget, 1 to 32.")
    output: str | None = options.output(help="CSV file of the table.")
    force: bool = options.force()


@click.command(short_help="How hard a robot may brake and turn before it tips over, by slope.")
@click.argument("source", type=Named())
@asks(Asked)
def budget(source: str, asked: Asked) -> None:
    """Print how hard SOURCE may brake, speed up and turn before it tips over.

    Of a recipe exactly; of the folder of an export as its C says it (smap_budget), which is never
    too much.  The robot stands on a slope and leans as its shape makes it.  Turning is given with
    the speed at which a turn of --turn takes it.  Sliding is not included.  -p gives the posture;
    where it is left out, the recipe's `home`, then the middle of the range.

    \b
    $ lutgen budget maps/paper_two.toml -p alpha=0 -p gamma=0
    $ lutgen budget firmware --over front=0:90 -o budget.csv
    """
    robot, tells = _asked_of(source, asked)
    postures = _postures(robot, asked)
    slopes = _slopes(asked)
    found = _table(robot, tells, postures, slopes, asked)
    if asked.output is not None:
        from lutgen.files import csv_text, write_text

        rows = [_flat(row) for row in found]
        text = csv_text(list(rows[0]), [list(row.values()) for row in rows])
        write_text(asked.output, text, asked.force)
    report = {
        "robot": robot.name,
        "source": "compiled" if Path(source).is_dir() else "exact",
        "heading_deg": asked.heading,
        "turn_m": asked.turn,
        "budgets": found,
    }
    show(report, lines(report), asked.as_json)


def _asked_of(source: str, asked: Asked) -> "tuple[Recipe, Any]":
    """Return the robot, and what tells budgets of postures, directions of gravity and ways."""
    if not 1 <= asked.reads <= 32:
        raise InputError(f"--reads: from 1 to 32 (got {asked.reads}).")
    if not 0.0 < asked.turn < math.inf:
        raise InputError(f"--turn: a radius above 0 m (got {asked.turn:g}).")
    if Path(source).is_dir():
        from firmware_export.device import ExportFolder
        from firmware_export.host import budget as ask

        folder = ExportFolder(source)
        if folder.integer:
            raise InputError(
                f"{source}: smap_budget computes with floats (got integer arithmetic); export with "
                "--arithmetic float."
            )

        def tell(params: Any, gravity: Any, way: Any) -> "NDArray[np.float64]":
            return ask(folder.blob, params, gravity, way, asked.reads)[0].astype(float)

        return folder.recipe(), tell
    from lutgen.analysis import budgets
    from lutgen.cli.sources import open_recipe

    robot = open_recipe(source, asked.allow_python)
    return robot, lambda params, gravity, way: budgets(robot, params, gravity, way)


def _postures(robot: "Recipe", asked: Asked) -> "NDArray[np.float64]":
    """Return the postures (p, k)."""
    import numpy as np

    start = np.array(options.posture_values(robot, asked.assignments), np.float64)
    if asked.over is None:
        return start[None, :]
    name, low, high = asked.over
    names = [p.name for p in robot.parameters]
    options.require_known(robot.source, names, name, f"--over {name}={low:g}:{high:g}")
    if not 2 <= asked.steps <= MOST:
        raise InputError(f"--steps: from 2 to {MOST} (got {asked.steps}).")
    rows, at = np.tile(start, (asked.steps, 1)), names.index(name)
    stored = robot.parameters[at].stored
    rows[:, at] = np.linspace(stored(low), stored(high), asked.steps)
    return rows


def _slopes(asked: Asked) -> "NDArray[np.float64]":
    """Return the slopes (s,) of the table, deg."""
    import numpy as np

    parts = options.finite_numbers(asked.slope.replace(":", ",")) if "," not in asked.slope else ()
    if len(parts) == 1:
        parts = (*parts, *parts)
    if len(parts) == 2:
        parts = (*parts, 10.0)
    if len(parts) != 3 or not 0.0 <= parts[0] <= parts[1] <= STEEPEST or not parts[2] > 0.0:
        raise InputError(
            f"--slope: FROM:TO:STEP from 0 to {STEEPEST:g} deg (got {asked.slope}); write for "
            "example 0:30:10."
        )
    low, high, step = parts
    if (high - low) / step > MOST:
        raise InputError(f"--slope: at most {MOST} slopes (got {asked.slope}); take larger steps.")
    return np.arange(low, high + 1e-9 * max(step, 1.0), step)


def _of_all(
    robot: "Recipe", tells: Any, postures: Any, slopes: Any, heading: float
) -> "dict[str, NDArray[np.float64]]":
    """Return the budgets (p, s) of postures on slopes (deg), by way; m/s^2."""
    import numpy as np

    from lutgen.analysis import tilted
    from lutgen.channels import body_gravity

    params = np.repeat(postures, len(slopes), axis=0)
    ground = tilted(np.radians(np.tile(slopes, len(postures))), math.radians(heading))
    down = body_gravity(robot, params, ground, "plane")
    shape = (len(postures), len(slopes))
    return {
        name: tells(params, down, np.tile(way, (len(params), 1))).reshape(shape)
        for name, way in WAYS.items()
    }


def _table(
    robot: "Recipe", tells: Any, postures: Any, slopes: Any, asked: Asked
) -> list[dict[str, Any]]:
    """Return a row for each posture and slope."""
    from lutgen.analysis import turn_speed

    found = _of_all(robot, tells, postures, slopes, asked.heading)
    rows = []
    for p, posture in enumerate(postures):
        for s, slope in enumerate(slopes):
            values = {name: float(of[p, s]) for name, of in found.items()}
            sides = min(values["turning left"], values["turning right"])
            rows.append(
                {
                    "posture": by_unit(robot, posture),
                    "slope_deg": float(slope),
                    **{f"{name.replace(' ', '_')}_m_s2": v for name, v in values.items()},
                    "turn_speed_m_s": float(turn_speed(sides, asked.turn)),
                }
            )
    return rows


def _flat(row: dict[str, Any]) -> dict[str, Any]:
    """Return a row of the table for CSV: the posture's columns first."""
    return {**row["posture"], **{key: value for key, value in row.items() if key != "posture"}}


def lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    exact = "exactly" if report["source"] == "exact" else "as its C says"
    facing = FACING.get(report["heading_deg"] % 360.0, f"heading {report['heading_deg']:g} deg")
    yield f"{report['robot']}: acceleration before it tips over, {exact}; slopes {facing}"
    yield (
        f"none: none below 50 m/s2; a turn of {report['turn_m']:g} m takes the less of both sides "
        "at the last speed"
    )
    before = None
    rows: list[list[str]] = []
    for row in [*report["budgets"], None]:
        posture = None if row is None else row["posture"]
        if posture != before or row is None:
            if rows:
                yield posture_text(before or {})
                yield from aligned([["slope", *WAYS, "turn at"], *rows])
            before, rows = posture, []
        if row is not None:
            keys = [f"{name.replace(' ', '_')}_m_s2" for name in WAYS]
            values = [_value(row[key], " m/s2") for key in keys]
            speed = cell(row["turn_speed_m_s"], ".2f", " m/s")
            rows.append([cell(row["slope_deg"], "g", " deg"), *values, speed])


def _value(value: float, unit: str) -> str:
    """Return a limit as text, rounded down."""
    if value <= 0.0:
        return "tips"
    return "none" if value >= BOUNDLESS else f"{math.floor(100.0 * value) / 100.0:.2f}{unit}"
