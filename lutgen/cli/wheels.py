"""`lutgen wheels`: wheel speeds and steering angles of a motion."""

import json
import logging
import math
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import Numbers, allow_python, as_json, gravity, parameter_values, parameters

if TYPE_CHECKING:
    from lutgen.analysis import Motion
    from lutgen.recipe import Recipe

log = logging.getLogger("lutgen")

IMPOSSIBLE = 1


@click.command(short_help="Wheel speeds and steering angles of a motion.")
@click.argument("recipe", type=click.Path())
@click.option(
    "--velocity",
    type=Numbers("VX,VY", "velocity", "two numbers such as 0.5,0"),
    default="0,0",
    show_default=True,
    help="Of the centre of mass, forward and to the left, in length units per second.",
)
@click.option(
    "--yaw-rate",
    type=float,
    default=0.0,
    show_default=True,
    help="About the ground's upward normal, deg/s.",
)
@parameters
@gravity
@allow_python
@as_json
@click.pass_context
def wheels(
    ctx: click.Context,
    recipe: str,
    velocity: tuple[float, float],
    yaw_rate: float,
    assignments: tuple[tuple[str, float], ...],
    gravity: tuple[float, float, float],
    allow_python: bool,
    as_json: bool,
) -> None:
    """Print how fast each wheel of RECIPE spins, and how far it is steered, for a motion.

    Exit code 1 where no wheel speeds give this motion without dragging a wheel sideways; the
    nearest motion that is possible is printed then.

    \b
    $ lutgen wheels maps/paper_two.toml --velocity 3,0 -p alpha=31 -p gamma=31
    paper_two: 3 DoF, non-steered (degree of mobility 3, of steerability 0)
    """
    from lutgen.analysis import wheel_speeds
    from lutgen.recipe import load_recipe

    robot = load_recipe(recipe, allow_python=allow_python)
    values = parameter_values(robot, assignments)
    for parameter, value in zip(robot.parameters, values, strict=True):
        if not parameter.minimum <= value <= parameter.maximum:
            log.warning("parameter %s is outside the recipe's range: used as it is", parameter.name)
    motion = wheel_speeds(robot, values, velocity, math.radians(yaw_rate), gravity)
    if not motion.standing:
        log.warning("the robot tips over: the wheels of the facet below its com are taken to touch")
    if as_json:
        click.echo(json.dumps(motion_report(robot, motion), indent=2, allow_nan=False))
    else:
        for line in motion_lines(robot, motion):
            click.echo(line)
    if not motion.possible:
        ctx.exit(IMPOSSIBLE)


def _degrees(value: float | None) -> float | None:
    return None if value is None else math.degrees(value)


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
        "yaw_rate_deg_s": _degrees(motion.yaw_rate),
        "possible": motion.possible,
        "slip": motion.slip,
        "nearest": {
            "velocity": list(motion.nearest_velocity),
            "yaw_rate_deg_s": _degrees(motion.nearest_yaw_rate),
        },
        "wheels": [
            {
                "contact": wheel.contact,
                "touches": wheel.touches,
                "speed_rad_s": wheel.speed,
                "steering_deg": _degrees(wheel.steering),
                "slip": wheel.slip,
            }
            for wheel in motion.wheels
        ],
    }


def motion_lines(recipe: "Recipe", motion: "Motion") -> list[str]:
    """Return the report as text."""
    found = motion.structure
    # The paper's lengths are ratios and have no unit.
    unit = "1/s" if recipe.length_unit == "1" else f"{recipe.length_unit}/s"
    width = max(len("wheel"), *(len(wheel.contact) for wheel in motion.wheels))
    text = [
        f"{recipe.name}: {found.category} (degree of mobility {found.mobility}, of steerability "
        f"{found.steerability})",
        f"{'wheel':<{width}}  {'speed rad/s':>12}  {'steering deg':>12}  {f'slip {unit}':>12}",
    ]
    for wheel in motion.wheels:
        if not wheel.touches:
            text.append(f"{wheel.contact:<{width}}  {'lifted':>12}")
            continue
        cells = (wheel.speed, _degrees(wheel.steering), wheel.slip)
        text.append(f"{wheel.contact:<{width}}  " + "  ".join(map(_cell, cells)))
    if not motion.possible:
        x, y = motion.nearest_velocity
        text.append(f"impossible: the wheels slip sideways by {motion.slip:.6g} {unit} in all")
        text.append(
            f"nearest possible: velocity {_rounded(x):.9g},{_rounded(y):.9g} {unit}, "
            f"yaw rate {_rounded(math.degrees(motion.nearest_yaw_rate)):.9g} deg/s"
        )
    return text


def _cell(value: float | None) -> str:
    return f"{'-' if value is None else f'{_rounded(value):.6g}':>12}"


def _rounded(value: float) -> float:
    """Return a number for people: what rounding leaves of zero is zero, and zero has no sign."""
    return 0.0 if abs(value) < 1e-12 else value
