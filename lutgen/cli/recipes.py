"""`lutgen recipes`, `new`, `schema` and `check`: recipes to take, to start from and to validate."""

import json
import math
import re
import textwrap
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import click

from lutgen.cli import options as given
from lutgen.cli.lazy import Axis, analysis, maps, np, proposals, robots
from lutgen.cli.options import RecipeOptions, command, log, option
from lutgen.cli.output import aligned, by_unit, entries, file_size, posture_text, show, unit_text
from lutgen.errors import InputError, reject
from lutgen.files import write_text
from lutgen.parts import Parameter
from lutgen.quantities import QUANTITIES

# Links that a warning lists.
SHOWN = 6


@dataclass(frozen=True)
class NewOptions:
    output: str | None = given.output("Recipe to write (.toml).")
    list_kinds: bool = option("List the kinds and write nothing.", "--list")
    force: bool = option("Write over a file that is there.")


def completed(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:
    """Return the names that begin so, for the completion of a shell."""
    return [name for name in robots.gallery_names() if name.startswith(incomplete)]


NAME = click.Argument(["name"], required=False, shell_complete=completed)
KIND = click.Argument(["kind"], required=False)


@command(NAME, given.NoOptions)
def recipes(name: str | None, options: given.NoOptions) -> None:
    """List the gallery's recipes, or print the one called NAME.

    Every command takes recipe:NAME where it takes a recipe's file.

    \b
    $ lutgen sweep recipe:absolem -o absolem.h5
    $ lutgen recipes absolem > mine.toml
    """
    if name is not None:
        text = robots.gallery_text(name)
        report = {**recipe_entry(name), "text": text}
        show(report, lambda report: report["text"].splitlines())
    else:
        report = {"recipes": [*map(recipe_entry, robots.gallery_names())]}
        show(report, recipes_lines)


def recipe_entry(name: str) -> dict[str, Any]:
    """Return what `--json` prints of one recipe."""
    source = f"{robots.GALLERY}{name.removeprefix(robots.GALLERY)}"
    recipe = robots.load_recipe(source)
    head = re.match(r"(?:#[^\n]*\n)*", recipe.text)
    words = " ".join(line.lstrip("# ") for line in (head[0] if head else "").splitlines())
    return {
        "name": recipe.name,
        "source": source,
        **entries(recipe, "digest length_unit contacts=contact_names"),
        "parameters": [p.name for p in recipe.parameters],
        "nodes": recipe.nodes,
        # The first sentence of the comment that it begins with.
        "description": re.split(r"(?<=\.)\s+(?=[A-Z])", words)[0],
    }


def recipes_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the list as text."""
    rows = [["recipe", "contacts", "nodes", "parameters"]]
    for entry in report["recipes"]:
        counts = f"{len(entry['contacts'])}", f"{entry['nodes']:,}"
        rows.append([entry["source"], *counts, " ".join(entry["parameters"])])
    lines = aligned(rows, numbers=(1, 2))
    yield lines[0]
    for line, entry in zip(lines[1:], report["recipes"], strict=True):
        yield line
        yield from (f"  {line}" for line in textwrap.wrap(entry["description"], 98))


@command(KIND, NewOptions)
def new(kind: str | None, options: NewOptions) -> None:
    """Write a commented recipe to start from; --list the kinds.

    It is complete: `lutgen check` and `lutgen limits` take it as it is.

    \b
    $ lutgen new tracks -o robot.toml
    $ lutgen new --list
    """
    kinds = robots.start_recipes()
    if options.list_kinds:
        show({"kinds": kinds}, lambda report: report["kinds"].items())
        return
    if kind is None or options.output is None:
        missing = "a kind" if kind is None else "a file to write"
        way_out = "write for example `lutgen new wheels -o robot.toml`, or `lutgen new --list`"
        reject("lutgen new", f"needs {missing}", "none", way_out, InputError)
    write_text(options.output, robots.start_recipe(kind), options.force)
    show(
        {"kind": kind, "recipe": options.output},
        lambda report: [f"{report['recipe']}: {kinds[kind]}"],
    )


@command(None, given.NoOptions)
def schema(options: given.NoOptions) -> None:
    """Print the JSON Schema of recipes, by which editors complete.

    It is of draft 2020-12, and refuses unknown keys, wrong types and numbers out of range; `lutgen
    check` knows more.

    \b
    $ lutgen schema > recipe.schema.json
    """
    click.echo(json.dumps(robots.recipe_schema(), indent=2, allow_nan=False))


@command("recipe", RecipeOptions)
def check(robot: "robots.Recipe", options: RecipeOptions) -> None:
    """Validate RECIPE and say what its sweep will cost.

    A warning says where it does not stand on its contacts at its `home`, and what looks like a
    mistake in its description.

    \b
    $ lutgen check maps/paper_two.toml
    paper_two: 3 contacts (P1 P2 P3), 2 parameters, unit 1
    """
    maps.require_standing(robot)
    warnings = [*proposals.recipe_doubts(robot), *home_warnings(robot)]
    for warning in warnings:
        log.warning("%s", warning)
    home = np.array(robot.home_params)
    _, com = robots.postures(robot, home[None])
    value_bytes = sum(1 if QUANTITIES[name].words else 4 for name in robot.channels)
    report = {
        **entries(robot, "name digest length_unit contacts=contact_names"),
        "kinds": Counter(contact.kind for contact in robot.contacts),
        "wheels": [wheel.contact for wheel in robot.wheels],
        "forces": [force.name for force in robot.forces],
        "axles": {axle.name: axle.contacts for axle in robot.axles},
        "posture": by_unit(robot, home),
        "posture_from": given.posture_source(robot, ()),
        "mass": sum(link.mass for link in robot.links) if robot.python is None else None,
        "com": np.where(np.abs(com[0]) < 1e-12, 0.0, com[0]),
        "parameters": {
            p.name: axis_entry(p, axis)
            for p, axis in zip(robot.parameters, robot.grid.axes, strict=True)
        },
        "chart": entries(robot.chart, "kind shape"),
        **entries(robot, "channels nodes"),
        "file_bytes": robot.nodes * value_bytes,
        "seconds": round(maps.expected_seconds(robot), 3),
        "snapped": robot.snapped,
        "warnings": warnings,
    }
    show(report, check_lines)


def home_warnings(robot: "robots.Recipe") -> Iterator[str]:
    """Return what keeps the robot from standing on its contacts at `home`, as far as known."""
    if not robot.home:
        return
    posture = analysis.Posture(robot, robot.home_params)
    found = analysis.diagnose(posture, (0.0, 0.0, -1.0))
    if found.facet is None or not found.standing:
        yield "at its `home` the robot tips over on level ground"
    below = {} if found.facet is None else analysis.below_ground(posture, found.facet)
    if below:
        unit = unit_text(robot.length_unit)
        parts = [f"{name} {depth:.3g}{unit}" for name, depth in below.items()]
        more = f" and {len(parts) - SHOWN} more" if len(parts) > SHOWN else ""
        yield (
            "at its `home` the robot lies on its body: below the ground on which its contacts "
            f"stand are {', '.join(parts[:SHOWN])}{more}; give contacts there, or another posture"
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


def check_lines(report: dict[str, Any]) -> Iterable[str]:
    """Return the report as text."""
    contacts, channels, nodes = report["contacts"], report["channels"], report["nodes"]
    yield (
        f"{report['name']}: {len(contacts)} contacts ({' '.join(contacts)}), "
        f"{len(report['parameters'])} parameters, unit {report['length_unit']}"
    )
    kinds = [f"{count} {kind}{'s' * (count > 1)}" for kind, count in report["kinds"].items()]
    parts = [f"{name}: {' '.join(report[name])}" for name in ("wheels", "forces") if report[name]]
    yield "  " + "; ".join([", ".join(kinds), *parts])
    for name, carried in report["axles"].items():
        yield f"  axle {name} swings with {' and '.join(carried)}"
    yield from (f"  {line}" for line in report["snapped"])
    if report["posture"]:
        yield f"  posture: {posture_text(report['posture'])} ({report['posture_from']})"
    mass = f"{report['mass']:.6g}" if report["mass"] else "not given"
    place = " ".join(f"{part:.6g}" for part in report["com"])
    yield f"  mass {mass}, com {place}{unit_text(report['length_unit'])}"
    yield from grid_lines(report["parameters"], report["chart"])
    yield f"  channels: {' '.join(channels)}"
    yield (
        f"sweep: {nodes:,} nodes, {nodes * len(channels):,} values, "
        f"{file_size(report['file_bytes'])}, about {report['seconds']:.1f} s of computing"
    )
