"""`lutgen metrics`, `wheels` and `stance`: metrics of one posture, its wheels, uneven ground."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from lutgen import bounds
from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import analysis, charts, np, robots
from lutgen.cli.options import FigureOptions, RecipeOptions, command, log, option
from lutgen.quantities import QUANTITIES

WHEEL = "contact touches speed_rad_s=speed steering_deg slip"
SAID = {True: "holds", False: "does not hold", None: "undecided, at the limit of friction"}
# The frame's own axes have names.
AXES = {(1.0, 0.0, 0.0): "x", (0.0, 1.0, 0.0): "y", (0.0, 0.0, 1.0): "z"}


@dataclass(frozen=True)
class MetricsOptions(RecipeOptions):
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    tilt: float = option(
        "Tilt of the ground in deg, for the metrics over all headings.",
        low=0.0,
        high=180.0,
        default=20.0,
    )
    headings: int = option(
        "How many headings, evenly spaced, the first nose down.",
        low=1,
        high=bounds.HEADINGS.most,
        default=24,
    )


@command("recipe", MetricsOptions)
def metrics(robot: "robots.Recipe", options: MetricsOptions) -> None:
    """Compare five metrics of stability over all headings.

    They are |SD_g|, tip-over angle, static and energy margin, and force-angle, that of a weight of
    1.  Only the tip-over angle's sign is a verdict.

    \b
    $ lutgen metrics maps/paper_two.toml -p alpha=31 -p gamma=31 --tilt 20
    """
    posture = analysis.Posture(robot, given.posture_values(robot, options.assignments))
    around = np.arange(options.headings) * (360.0 / options.headings)
    down = analysis.tilted(math.radians(options.tilt), np.radians(around))
    found = analysis.compare_metrics(posture, down)
    verdicts: list[dict[str, bool]] = [{} for _ in around]
    if any(contact.rolling for contact in robot.contacts):
        holds, may = analysis.holds(posture, down), analysis.may_hold(posture, down)
        verdicts = [{"holds": holds[i], "may_hold": may[i]} for i in range(len(around))]
    report = {
        **output.entries(robot, "robot=name length_unit"),
        "tilt_deg": options.tilt,
        "level": {
            "status": QUANTITIES["status"].word(found.level_status),
            **output.channel_entries(found.level),
        },
        "headings": [
            {
                "heading_deg": heading,
                "standing": found.standing[i],
                "status": QUANTITIES["status"].word(found.status[i]),
                "least_share": found.least_share[i],
                **output.channel_entries({name: row[i] for name, row in found.values.items()}),
                "normalised": {name: row[i] for name, row in found.normalised.items()},
                **verdicts[i],
            }
            for i, heading in enumerate(around.tolist())
        ],
        **output.posture_entries(robot, posture.params, options.assignments),
    }
    output.show(report, metrics_lines)


def metrics_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text: one row per heading, and one for level ground."""
    length = output.unit_text(report["length_unit"])
    columns = {
        "sdg": f"sdg{length}",
        "tip_angle_deg": "tip_angle deg",
        "margin": f"margin{length}",
        "energy_margin": f"energy{length}",
        "force_angle_rad": f"force_angle rad{length}",
        "least_share": "least share",
    }
    rolling = "holds" in report["headings"][0]
    rows = [["heading deg", "verdict", *columns.values(), *(["holds"] if rolling else [])]]
    for entry in (report["level"], *report["headings"]):
        heading = f"{entry['heading_deg']:g}" if "heading_deg" in entry else "level"
        cells = [output.cell(entry.get(key)) for key in columns]
        rows.append([heading, output.VERDICTS[entry["status"]], *cells])
        if rolling:
            word = "yes" if entry.get("holds", True) else "may" if entry["may_hold"] else "no"
            rows[-1].append(word)
    yield f"{report['robot']}: tilted {report['tilt_deg']:g} deg"
    yield from output.posture_lines(report)
    yield from output.aligned(rows, numbers=(0, *range(2, 9)))


@dataclass(frozen=True)
class WheelsOptions(RecipeOptions):
    velocity: tuple[float, float] = option(
        "Velocity of the centre of mass, forward and to the left, length units per second.",
        type=given.Numbers("VX,VY", "velocity", "two numbers such as 0.5,0"),
        default="0,0",
    )
    yaw_rate: float = option("About the ground's upward normal, deg/s.", default=0.0)
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    gravity: tuple[float, float, float] = given.gravity()


@command("recipe", WheelsOptions)
def wheels(robot: "robots.Recipe", options: WheelsOptions) -> None:
    """Print wheel speeds and steering angles of a motion.

    Exit code 3 where the robot tips over under this gravity, else 1 where no wheel speeds give this
    motion without dragging a wheel sideways; the nearest motion that is possible is printed then.

    \b
    $ lutgen wheels maps/paper_two.toml --velocity 3,0 -p alpha=31 -p gamma=31
    paper_two: 3 DoF, non-steered
    """
    posture = analysis.Posture(robot, given.posture_values(robot, options.assignments))
    yaw_rate = math.radians(options.yaw_rate)
    motion = analysis.wheel_speeds(posture, options.velocity, yaw_rate, options.gravity)
    if not motion.standing:
        log.warning("the robot tips over: the wheels of the facet below its com are taken to touch")
    report = {
        **output.entries(robot, "robot=name length_unit"),
        "standing": motion.standing,
        "structure": output.entries(motion, "category dof steered"),
        **output.entries(motion, "velocity yaw_rate_deg_s possible slip"),
        "nearest": {
            "velocity": motion.nearest_velocity,
            "yaw_rate_deg_s": output.degrees(motion.nearest_yaw_rate),
        },
        "wheels": [output.entries(one, WHEEL) for one in motion.wheels],
        **output.posture_entries(robot, posture.params, options.assignments),
    }
    code = output.TIPS if not motion.standing else 0 if motion.possible else output.NO
    output.show(report, motion_lines, code)


def motion_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    # The paper's lengths are ratios and have no unit.
    unit = "1/s" if report["length_unit"] == "1" else f"{report['length_unit']}/s"
    yield (
        f"{report['robot']}: {'' if report['standing'] else output.VERDICTS['tips'] + ', '}"
        f"{report['structure']['category']}"
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


@dataclass(frozen=True)
class StanceOptions(FigureOptions):
    gravity: tuple[float, float, float] | None = option(
        "Gravity in the frame of the file, pointing down; instead of the file's.", "-g"
    )
    output: str | None = given.output("Figure (PNG, SVG or PDF).")


@command("file", StanceOptions)
def stance(file: str, options: StanceOptions) -> None:
    """Print if feet on uneven ground hold a weight.

    FILE (TOML) describes them and the centre of mass.  Each foot has a place, a normal and a
    friction coefficient of its own.  Exit code 3 where no forces within the friction cones carry
    the weight, or if that is unknown.

    \b
    $ lutgen stance stair.toml -g 0.1,0,-1
    stair: holds
    """
    footing = analysis.read_footing(file)
    if options.gravity is not None:
        footing = replace(footing, gravity_dir=np.array(options.gravity))
    found = footing.equilibrium()
    output.save_figure(lambda plot: plot.draw_footing(footing, found), options.output, options)
    # Lengths are in the file's unit, forces shares of the weight.
    report = {
        **output.entries(footing, "title length_unit gravity=gravity_dir com"),
        **output.entries(found, "holds margin axes region region_is_open=is_open"),
        "feet": [*feet(footing, found)],
    }
    output.show(report, stance_lines, 0 if found.holds else output.TIPS)


def feet(footing: "analysis.Footing", found: "analysis.Equilibrium") -> Iterator[dict[str, Any]]:
    """Return one entry for each foot; null where the weight is not held."""
    for i, up in enumerate(charts.unit_directions(footing.normals)):
        mu = float(footing.friction[i])
        force = normal = used = None
        if found.forces is not None:
            force = found.forces[i]
            normal = float(force @ up)
            along = float(np.linalg.norm(force - normal * up))
            # A foot that carries nothing uses no friction, nor does one that has none.
            used = along / (mu * normal) if mu * normal > 1e-9 else 0.0
        yield {
            "name": footing.names[i],
            "friction": mu,
            "normal_force": normal,
            "force": force,
            "friction_used": used,
        }


def stance_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    unit = output.unit_text(report["length_unit"])
    yield f"{report['title']}: {SAID[report['holds']]}"
    rows = [["margin", length(report["margin"], unit)]]
    for i, axis in enumerate(report["axes"]):
        name = AXES.get(tuple(axis)) or ",".join(length(x, form=".3g") for x in axis)
        at = sum(a * b for a, b in zip(axis, report["com"], strict=True))
        text = f"com at {length(at, unit)}"
        if report["region"]:
            along = [corner[i] for corner in report["region"]]
            text += f", may lie from {length(min(along))} to {length(max(along), unit)}"
        rows.append([f"along {name}", text])
    count = len(report["region"])
    shape = {0: "none", 1: "a point", 2: "a line"}.get(count, f"{count} corners")
    is_open = ", open within the search" if report["region_is_open"] else ""
    yield from output.aligned([*rows, ["region", shape + is_open]])
    yield ["foot", "friction", "normal force", "friction used"]
    for foot in report["feet"]:
        used = foot["friction_used"]
        used = "-" if used is None else f"{100.0 * used:.0f} %"
        force = length(foot["normal_force"], form=".3f")
        yield [foot["name"], f"{foot['friction']:g}", force, used]


def length(value: float | None, unit: str = "", form: str = ".4g") -> str:
    """Return a number as text; a linear program leaves more of zero than a sum does."""
    return output.cell(0.0 if value is not None and abs(value) < 1e-9 else value, form, unit)
