"""`lutgen wheels`: wheel speeds and steering angles of a motion."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Named, RecipeOptions, asks, log, option
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import (
    NO,
    TIPS,
    aligned,
    cell,
    degrees,
    even,
    posture_entries,
    posture_text,
    show,
)

if TYPE_CHECKING:
    from lutgen.analysis import Motion
    from lutgen.recipe import Recipe


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    velocity: tuple[float, float] = option(
        type=options.Numbers("VX,VY", "velocity", "two numbers such as 0.5,0"),
        default="0,0",
        help="Of the centre of mass, forward and to the left, in length units per second.",
    )
    yaw_rate: float = option(default=0.0, help="About the ground's upward normal, deg/s.")
    assignments: tuple[tuple[str, float], ...] = options.parameters()
    gravity: tuple[float, float, float] = options.gravity()


@click.command(short_help="Wheel speeds and steering angles of a motion.")
@click.argument("recipe", type=Named())
@asks(Asked)
def wheels(recipe: str, asked: Asked) -> None:
    """Print how fast each wheel of RECIPE spins, and how far it is steered, for a motion.

    -p gives the posture; where it is left out, the recipe's `home`, then the middle of the range.
    Exit code 3 where the robot tips over under this gravity, else 1 where no wheel speeds give this
    motion without dragging a wheel sideways; the nearest motion that is possible is printed then.

    \b
    $ lutgen wheels maps/paper_two.toml --velocity 3,0 -p alpha=31 -p gamma=31
    paper_two: 3 DoF, non-steered (degree of mobility 3, of steerability 0)
    """
    from lutgen.analysis import Posture, wheel_speeds

    robot = open_recipe(recipe, asked.allow_python)
    posture = Posture(robot, options.posture_values(robot, asked.assignments))
    motion = wheel_speeds(posture, asked.velocity, math.radians(asked.yaw_rate), asked.gravity)
    if not motion.standing:
        log.warning("the robot tips over: the wheels of the facet below its com are taken to touch")
    report = motion_report(robot, motion)
    report |= posture_entries(posture, options.posture_source(robot, asked.assignments))
    good, no = motion.standing and motion.possible, NO if motion.standing else TIPS
    show(report, motion_lines(robot, motion, report), asked.as_json, good, no)


def motion_report(recipe: "Recipe", motion: "Motion") -> dict[str, Any]:
    """Return what `--json` prints; lengths in the recipe's unit, null where there is no value."""
    found = motion.structure
    return {
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "standing": motion.standing,
        "structure": {
            "category": found.category,
            "dof": found.dof,
            "steered": found.steered,
            "degree_of_mobility": found.mobility,
            "degree_of_steerability": found.steerability,
        },
        "velocity": list(motion.velocity),
        "yaw_rate_deg_s": degrees(motion.yaw_rate),
        "possible": motion.possible,
        "slip": motion.slip,
        "nearest": {
            "velocity": list(motion.nearest_velocity),
            "yaw_rate_deg_s": degrees(motion.nearest_yaw_rate),
        },
        "wheels": [
            {
                "contact": wheel.contact,
                "touches": wheel.touches,
                "speed_rad_s": wheel.speed,
                "steering_deg": degrees(wheel.steering),
                "slip": wheel.slip,
            }
            for wheel in motion.wheels
        ],
    }


def motion_lines(recipe: "Recipe", motion: "Motion", report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    found = motion.structure
    # The paper's lengths are ratios and have no unit.
    unit = "1/s" if recipe.length_unit == "1" else f"{recipe.length_unit}/s"
    yield (
        f"{recipe.name}: {found.category} (degree of mobility {found.mobility}, of steerability "
        f"{found.steerability})"
    )
    if "posture" in report:
        yield f"{posture_text(report['posture'])} ({report['posture_from']})"
    rows = [["wheel", "speed rad/s", "steering deg", f"slip {unit}"]]
    for wheel in motion.wheels:
        values = (wheel.speed, degrees(wheel.steering), wheel.slip)
        cells = [cell(even(value)) for value in values] if wheel.touches else ["lifted"]
        rows.append([wheel.contact, *cells])
    yield from aligned(rows, [f"<{max(len(row[0]) for row in rows)}", *(3 * [">12"])])
    if not motion.possible:
        x, y, yaw = map(even, (*motion.nearest_velocity, math.degrees(motion.nearest_yaw_rate)))
        yield f"impossible: the wheels slip sideways by {motion.slip:.6g} {unit} in all"
        yield f"nearest possible: velocity {x:.9g},{y:.9g} {unit}, yaw rate {yaw:.9g} deg/s"
