"""`lutgen metrics`: five metrics of stability side by side."""

import json
import math
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import allow_python, as_json, parameter_values, parameters, tilt
from lutgen.errors import InputError

if TYPE_CHECKING:
    from lutgen.analysis import Metrics
    from lutgen.recipe import Recipe

MOST = 3600


@click.command(short_help="Compare five metrics over all headings.")
@click.argument("recipe", type=click.Path())
@parameters
@tilt
@click.option(
    "--headings",
    type=click.IntRange(1, MOST),
    default=24,
    show_default=True,
    help="How many headings, evenly spaced, the first nose down.",
)
@allow_python
@as_json
def metrics(
    recipe: str,
    assignments: tuple[tuple[str, float], ...],
    tilt: float,
    headings: int,
    allow_python: bool,
    as_json: bool,
) -> None:
    """Print |SD_g|, tip-over angle, static and energy margin, and force-angle of one posture.

    The force-angle measure is that of a weight of 1.  Only the tip-over angle's sign is a verdict.
    `lutgen plot --kind metrics` draws them.

    \b
    $ lutgen metrics maps/paper_two.toml -p alpha=31 -p gamma=31 --tilt 20
    """
    from lutgen.recipe import load_recipe

    if not 0.0 <= tilt <= 180.0:
        raise InputError(f"--tilt must lie between 0 and 180 deg (got {tilt:g}); 20 is the default")
    robot = load_recipe(recipe, allow_python=allow_python)
    values = parameter_values(robot, assignments)
    report = metrics_report(robot, values, tilt, headings)
    if as_json:
        click.echo(json.dumps(report, indent=2, allow_nan=False))
        return
    for line in metrics_lines(report):
        click.echo(line)


def metrics_report(
    recipe: "Recipe", values: list[float], tilt: float, headings: int
) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value."""
    import numpy as np

    from lutgen.analysis import compare_metrics, tilted

    around = np.arange(headings) * (360.0 / headings)
    directions = tilted(math.radians(tilt), np.radians(around))
    found = compare_metrics(recipe, values, directions)
    return {
        "robot": recipe.name,
        "length_unit": recipe.length_unit,
        "tilt_deg": tilt,
        "level": _values(found.level),
        "headings": [_at(found, i, float(heading)) for i, heading in enumerate(around)],
    }


def _at(found: "Metrics", index: int, heading: float) -> dict[str, Any]:
    """Return the entry of one heading."""
    normalised = {name: float(values[index]) for name, values in found.normalised.items()}
    return {
        "heading_deg": heading,
        "standing": bool(found.standing[index]),
        **_values({name: float(values[index]) for name, values in found.values.items()}),
        "normalised": {name: _number(value) for name, value in normalised.items()},
    }


def _values(values: dict[str, float]) -> dict[str, float | None]:
    """Return metrics under their names in the report, as `lutgen eval` has them."""
    entries: dict[str, float | None] = {}
    for name, value in values.items():
        if name == "tip_angle":
            entries["tip_angle_deg"] = _number(math.degrees(value))
        else:
            entries["force_angle_rad" if name == "force_angle" else name] = _number(value)
    return entries


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def metrics_lines(report: dict[str, Any]) -> list[str]:
    """Return the report as text: one row per heading, and one for level ground."""
    unit = report["length_unit"]
    length = "" if unit == "1" else f" {unit}"
    columns = {
        "sdg": f"sdg{length}",
        "tip_angle_deg": "tip_angle deg",
        "margin": f"margin{length}",
        "energy_margin": f"energy{length}",
        "force_angle_rad": f"force_angle rad{length}",
    }

    def row(name: str, verdict: str, cells: list[str]) -> str:
        widths = [max(len(title), 10) for title in columns.values()]
        numbers = [f"{cell:>{width}}" for cell, width in zip(cells, widths, strict=True)]
        return "  ".join([f"{name:>11}", f"{verdict:<9}", *numbers])

    def cells(entry: dict[str, Any]) -> list[str]:
        return ["-" if entry[key] is None else f"{entry[key]:.6g}" for key in columns]

    text = [f"{report['robot']}: tilted {report['tilt_deg']:g} deg"]
    text.append(row("heading deg", "verdict", list(columns.values())))
    text.append(row("level", "stands", cells(report["level"])))
    for entry in report["headings"]:
        verdict = "stands" if entry["standing"] else "tips over"
        text.append(row(f"{entry['heading_deg']:g}", verdict, cells(entry)))
    return text
