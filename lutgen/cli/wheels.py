"""`lutgen wheels`: wheel speeds and steering angles of a motion."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import analysis
from lutgen.cli.options import RecipeOptions, command, log, open_recipe, option

STRUCTURE = "category dof steered degree_of_mobility=mobility degree_of_steerability=steerability"
WHEEL = "contact touches speed_rad_s=speed steering_deg slip"


@dataclass(frozen=True)
class Options(RecipeOptions):
    velocity: tuple[float, float] = option(
        type=given.Numbers("VX,VY", "velocity", "two numbers such as 0.5,0"),
        default="0,0",
        help="Of the centre of mass, forward and to the left, in length units per second.",
    )
    yaw_rate: float = option(default=0.0, help="About the ground's upward normal, deg/s.")
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    gravity: tuple[float, float, float] = given.gravity()


@command("recipe", Options)
def wheels(recipe: str, options: Options) -> None:
    """Print wheel speeds and steering angles of a motion.

    Exit code 3 where the robot tips over under this gravity, else 1 where no wheel speeds give this
    motion without dragging a wheel sideways; the nearest motion that is possible is printed then.

    \b
    $ lutgen wheels maps/paper_two.toml --velocity 3,0 -p alpha=31 -p gamma=31
    paper_two: 3 DoF, non-steered (degree of mobility 3, of steerability 0)
    """
    robot = open_recipe(recipe, options.allow_python)
    posture = analysis.Posture(robot, given.posture_values(robot, options.assignments))
    yaw_rate = math.radians(options.yaw_rate)
    motion = analysis.wheel_speeds(posture, options.velocity, yaw_rate, options.gravity)
    if not motion.standing:
        log.warning("the robot tips over: the wheels of the facet below its com are taken to touch")
    report = {
        **output.entries(robot, "robot=name length_unit"),
        "standing": motion.standing,
        "structure": output.entries(motion.structure, STRUCTURE),
        **output.entries(motion, "velocity yaw_rate_deg_s possible slip"),
        "nearest": {
            "velocity": motion.nearest_velocity,
            "yaw_rate_deg_s": output.degrees(motion.nearest_yaw_rate),
        },
        "wheels": [output.entries(one, WHEEL) for one in motion.wheels],
        **output.posture_entries(robot, posture.params, options.assignments),
    }
    code = output.TIPS if not motion.standing else 0 if motion.possible else output.NO
    output.show(report, motion_lines, options.as_json, code)


def motion_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    found = report["structure"]
    # The paper's lengths are ratios and have no unit.
    unit = "1/s" if report["length_unit"] == "1" else f"{report['length_unit']}/s"
    yield (
        f"{report['robot']}: {'' if report['standing'] else output.VERDICTS['tips'] + ', '}"
        f"{found['category']} (degree of mobility {found['degree_of_mobility']}, of steerability "
        f"{found['degree_of_steerability']})"
    )
    yield from output.posture_lines(report)
    rows = [["wheel", "speed rad/s", "steering deg", f"slip {unit}"]]
    for wheel in report["wheels"]:
        values = (wheel["speed_rad_s"], wheel["steering_deg"], wheel["slip"])
        cells = map(output.cell, values) if wheel["touches"] else ["lifted"]
        rows.append([wheel["contact"], *cells])
    yield from output.aligned(rows, numbers=(1, 2, 3))
    if not report["possible"]:
        nearest = (*report["nearest"]["velocity"], report["nearest"]["yaw_rate_deg_s"])
        x, y, yaw = (output.cell(value, ".9g") for value in nearest)
        yield f"impossible: the wheels slip sideways by {report['slip']:.6g} {unit} in all"
        yield f"nearest possible: velocity {x},{y} {unit}, yaw rate {yaw} deg/s"
