"""`lutgen check`: validate a recipe and say what its sweep will cost."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import Named, RecipeOptions, asks, file_size, log, posture_source
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import by_unit, even, posture_text, show, unit_text
from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    from lutgen.grid import Axis
    from lutgen.parts import Parameter
    from lutgen.recipe import Recipe

# Links that a warning lists.
SHOWN = 6


@click.command(short_help="Validate a recipe; print robot, nodes, file size and run time.")
@click.argument("recipe", type=Named())
@asks(RecipeOptions)
def check(recipe: str, asked: RecipeOptions) -> None:
    """Validate RECIPE and say what its sweep will cost.

    A warning says where it does not stand on its contacts at its `home`, and what looks like a
    mistake in its description.

    \b
    $ lutgen check maps/paper_two.toml
    paper_two: 3 contacts (P1 P2 P3), 2 parameters, unit 1
    """
    from lutgen.mapping import require_standing

    robot = open_recipe(recipe, asked.allow_python)
    require_standing(robot)
    report = check_report(robot)
    for warning in report["warnings"]:
        log.warning("%s", warning)
    show(report, check_lines(report), asked.as_json)


def check_report(robot: "Recipe") -> dict[str, Any]:
    """Return what `--json` prints."""
    import numpy as np

    from lutgen.mapping import expected_seconds, plan
    from lutgen.propose import recipe_doubts
    from lutgen.recipe import postures

    layout = plan(robot)
    home = np.array(robot.home_params)
    _, com = postures(robot, home[None])

    def value_bytes(name: str) -> int:
        return 1 if QUANTITIES[name].words else 4

    return {
        "name": robot.name,
        "digest": robot.digest,
        "length_unit": robot.length_unit,
        "contacts": list(robot.contact_names),
        "kinds": dict(Counter(contact.kind for contact in robot.contacts)),
        "wheels": [wheel.contact for wheel in robot.wheels],
        "forces": [force.name for force in robot.forces],
        "posture": by_unit(robot, home),
        "posture_from": posture_source(robot, ()),
        "mass": sum(link.mass for link in robot.links) if robot.python is None else None,
        "com": [even(part) for part in com[0].tolist()],
        "parameters": {
            p.name: axis_entry(p, axis)
            for p, axis in zip(robot.parameters, robot.grid.axes, strict=True)
        },
        "chart": {"kind": robot.chart.kind, "shape": list(robot.chart.shape)},
        "channels": list(robot.channels),
        "nodes": layout.nodes,
        "file_bytes": layout.nodes * sum(map(value_bytes, robot.channels)),
        "seconds": round(expected_seconds(robot), 3),
        "snapped": list(robot.snapped),
        "warnings": [*recipe_doubts(robot), *(home_warnings(robot) if robot.home else ())],
    }


def home_warnings(robot: "Recipe") -> Iterator[str]:
    """Return what keeps the robot from standing on its contacts at `home`, as far as known."""
    from lutgen.analysis import Posture, below_ground, diagnose

    posture = Posture(robot, robot.home_params)
    found = diagnose(posture, (0.0, 0.0, -1.0))
    if found.facet is None or not found.standing:
        yield "at its `home` the robot tips over on level ground"
    if found.facet is None:
        return
    below = below_ground(posture, found.facet)
    if below:
        unit = unit_text(robot.length_unit)
        parts = ", ".join(
            f"{name} {depth:.3g}{unit}" for name, depth in list(below.items())[:SHOWN]
        )
        more = f" and {len(below) - SHOWN} more" if len(below) > SHOWN else ""
        yield (
            "at its `home` the robot lies on its body: below the ground on which its contacts "
            f"stand are {parts}{more}; give contacts there, or another posture"
        )


def axis_entry(parameter: "Parameter", axis: "Axis") -> dict[str, Any]:
    """Return the ends of a map's axis in the unit that the recipe gives the parameter."""
    ends = [float(axis.knots[0]), float(axis.knots[-1])]
    if parameter.display_unit == "deg":
        ends = [round(math.degrees(value), 9) for value in ends]
    unit = parameter.display_unit
    return {"from": ends[0], "to": ends[1], "unit": unit, "nodes": axis.size}


def grid_lines(axes: Mapping[str, dict[str, Any]], chart: dict[str, Any]) -> Iterator[str]:
    """Return the axes of a map as text."""
    for name, axis in axes.items():
        yield f"  {name}: {axis['from']:g} to {axis['to']:g} {axis['unit']}, {axis['nodes']} nodes"
    faces, side, _ = chart["shape"]
    yield f"  gravity: {chart['kind']}, {faces} face(s) of {side} x {side} nodes"


def check_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    contacts, channels, nodes = report["contacts"], report["channels"], report["nodes"]
    yield (
        f"{report['name']}: {len(contacts)} contacts ({' '.join(contacts)}), "
        f"{len(report['parameters'])} parameters, unit {report['length_unit']}"
    )
    kinds = [f"{count} {kind}{'s' * (count > 1)}" for kind, count in report["kinds"].items()]
    parts = [f"{name}: {' '.join(report[name])}" for name in ("wheels", "forces") if report[name]]
    yield "  " + "; ".join([", ".join(kinds), *parts])
    yield from (f"  {line}" for line in report["snapped"])
    place = " ".join(f"{part:.6g}" for part in report["com"])
    mass = f"{report['mass']:.6g}" if report["mass"] else "not given"
    posture = posture_text(report["posture"])
    if report["posture"]:
        yield f"  posture: {posture} ({report['posture_from']})"
    yield f"  mass {mass}, com {place}{unit_text(report['length_unit'])}"
    yield from grid_lines(report["parameters"], report["chart"])
    yield f"  channels: {' '.join(channels)}"
    yield (
        f"sweep: {nodes:,} nodes, {nodes * len(channels):,} values, "
        f"{file_size(report['file_bytes'])}, about {report['seconds']:.1f} s of computing"
    )
