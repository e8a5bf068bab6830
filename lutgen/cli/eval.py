"""`lutgen eval`: one posture under one direction."""

import json
import logging
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import (
    acceleration,
    allow_python,
    as_json,
    gravity,
    open_source,
    parameter_values,
    parameters,
)

if TYPE_CHECKING:
    from lutgen.analysis import Diagnosis
    from lutgen.mapping import StabilityMap
    from lutgen.recipe import Recipe

log = logging.getLogger("lutgen")


@click.command("eval", short_help="Evaluate one point of a recipe, a map or an export.")
@click.argument("source", type=click.Path())
@parameters
@gravity
@acceleration
@allow_python
@as_json
def eval_(
    source: str,
    assignments: tuple[tuple[str, float], ...],
    gravity: tuple[float, ...],
    acceleration: tuple[float, ...] | None,
    allow_python: bool,
    as_json: bool,
) -> None:
    """Evaluate SOURCE at one point.

    A recipe is evaluated exactly, a map by interpolation; of a folder of `lutgen export` the C
    code is compiled and asked.

    \b
    $ lutgen eval maps/paper_two.toml -p alpha=31 -p gamma=31
    sdg            0.00253161
    """
    from lutgen.chart import gravito_inertial
    from lutgen.recipe import Recipe

    if acceleration is not None:
        gravity = tuple(gravito_inertial(gravity, acceleration).tolist())
    if Path(source).is_dir():
        from lutgen.cli.eval_export import export_report

        show(export_report(Path(source), assignments, gravity), as_json)
        return
    opened = open_source(source, allow_python)
    recipe = opened if isinstance(opened, Recipe) else opened.recipe
    values = parameter_values(recipe, assignments)
    for parameter, value in zip(recipe.parameters, values, strict=True):
        if not parameter.minimum <= value <= parameter.maximum:
            what = "used as it is" if isinstance(opened, Recipe) else "clamped"
            log.warning("parameter %s is outside the recipe's range: %s", parameter.name, what)
    if isinstance(opened, Recipe):
        report = exact_report(opened, values, gravity)
    else:
        report = map_report(opened, values, gravity)
    show(report, as_json)


def show(report: dict[str, Any], as_json: bool) -> None:
    """Print a report."""
    if as_json:
        click.echo(json.dumps(report, indent=2, allow_nan=False))
        return
    for line in lines(report):
        click.echo(line)


def _number(value: float) -> float | None:
    """Return a number for JSON, which knows neither NaN nor infinity."""
    return float(value) if math.isfinite(value) else None


def channel_entries(channels: dict[str, float]) -> dict[str, Any]:
    """Return the channels under their names in the report; angles in deg."""
    entries: dict[str, Any] = {}
    for name, value in channels.items():
        if name == "tip_angle":
            entries["tip_angle_deg"] = _number(math.degrees(value))
        elif name == "facet":
            entries[name] = int(value)
        else:
            entries[name] = _number(value)
    return entries


def exact_report(
    recipe: "Recipe", values: list[float], gravity: tuple[float, ...]
) -> dict[str, Any]:
    """Return the report on one point of a recipe."""
    from lutgen.analysis import diagnose

    found = diagnose(recipe, values, gravity)
    rolling = any(contact.rolling for contact in recipe.contacts)
    report: dict[str, Any] = {
        "robot": recipe.name,
        "source": "exact",
        "length_unit": recipe.length_unit,
        "standing": found.standing,
        **channel_entries(found.channels),
        "slope_deg": _number(math.degrees(found.slope)),
        "slides_first": found.slides,
        **(_rolling_entries(recipe, values, gravity) if rolling and not recipe.has_wrench else {}),
    }
    if found.least_stable is not None:
        report["least_stable_axis"] = _axis(found, found.least_stable)
    report["axes"] = [_axis(found, index) for index in range(len(found.tip_over_axes))]
    if found.normal_forces:
        report["normal_forces"] = found.normal_forces
        report["normal_forces_kind"] = found.forces_kind
        report["heuristic_forces_eq12"] = found.heuristic_forces
    if found.facet is not None:
        report["support"] = {
            "contacts": [recipe.contact_names[i] for i in found.facet.contacts],
            "centroid": found.facet.centroid.tolist(),
            "pierced": [_number(c) for c in found.facet.pierced],
        }
    report["com"] = found.com.tolist()
    if recipe.com_uncertainty:
        report["com_uncertainty"] = recipe.com_uncertainty
    if recipe.has_wrench:
        report["resultant_over_weight"] = found.resultant.tolist()
    return report


def _rolling_entries(
    recipe: "Recipe", values: list[float], gravity: tuple[float, ...]
) -> dict[str, Any]:
    """Return whether the robot rolls away, and how it tips while it rolls freely."""
    from lutgen.analysis import rolling_gravity, rolls
    from lutgen.channels import evaluate

    entries: dict[str, Any] = {"rolls": bool(rolls(recipe, values, [gravity])[0])}
    down = rolling_gravity(recipe, values, gravity)
    if down is not None:
        angle = evaluate(recipe, [values], down, ("tip_angle",))["tip_angle"][0, 0]
        entries["rolling_gravity"] = down.tolist()
        entries["rolling_tip_angle_deg"] = _number(math.degrees(angle))
    return entries


def _axis(found: "Diagnosis", index: int) -> dict[str, Any]:
    from lutgen.analysis import axis_force_angle

    axis = found.tip_over_axes[index]
    return {
        "index": index,
        "contacts": list(axis.names),
        "tip_angle_deg": _number(math.degrees(axis.tip_angle)),
        "margin": _number(axis.margin),
        "energy_margin": _number(axis.energy_margin),
        # Under a load there is no such measure of the nominal weight alone.
        "force_angle_rad": None
        if found.com_uncertainty or len(found.forces)
        else float(axis_force_angle(axis.start, axis.stop, found.gravity_dir)),
    }


def map_report(
    stability_map: "StabilityMap", values: list[float], gravity: tuple[float, ...]
) -> dict[str, Any]:
    """Return the report on one point of a map."""
    reading = stability_map.read([values], [gravity])
    channels = {name: float(value[0]) for name, value in reading.items()}
    _, _, _, inside = stability_map.chart.locate([gravity])
    if not inside[0]:
        log.warning("the direction is off the map's chart: the map says nothing")
        channels.pop("facet", None)
    known = channels.get("tip_angle", channels.get("sdg", math.nan))
    stands = known >= 0.0 if inside[0] else None
    return {
        "robot": stability_map.recipe.name,
        "source": "interpolated",
        "length_unit": stability_map.recipe.length_unit,
        "on_chart": bool(inside[0]),
        "standing": bool(stands) if stands is not None else None,
        **channel_entries(channels),
    }


def lines(report: dict[str, Any]) -> list[str]:
    """Return the report as text."""
    unit = report["length_unit"]
    length = "" if unit == "1" else f" {unit}"
    verdict = {True: "stands", False: "tips over", None: "unknown: off the chart"}
    text = [f"{report['robot']} ({report['source']}): {verdict[report['standing']]}"]
    if "status" in report:
        text.append(f"{'status':<15}{report['status']}")
    for key in ("sdg", "height", "tip_angle_deg", "margin", "energy_margin", "facet", "slope_deg"):
        if key in report:
            value = report[key]
            name, suffix = (key[:-4], " deg") if key.endswith("_deg") else (key, length)
            suffix = "" if key == "facet" else suffix
            # JSON has null for them: no boundary at all, or no value outside the region.
            shown = "-" if value is None else f"{value:.9g}{suffix}"
            text.append(f"{name:<15}{shown}")
    if report.get("slides_first") is not None:
        text.append(f"{'slides first':<15}{'yes' if report['slides_first'] else 'no'}")
    if "rolls" in report:
        text.append(f"{'rolls away':<15}{'yes' if report['rolls'] else 'no'}")
    if "rolling_tip_angle_deg" in report:
        angle = report["rolling_tip_angle_deg"]
        text.append(f"{'rolling freely':<15}tip_angle {angle:.6g} deg")
    if "com_uncertainty" in report:
        text.append(f"{'for any com':<15}within {report['com_uncertainty']:g}{length}")
    if "resultant_over_weight" in report:
        size = math.hypot(*report["resultant_over_weight"])
        text.append(f"{'resultant':<15}{size:.6g} of the weight")
    axis = report.get("least_stable_axis")
    if axis is not None:
        text.append(
            f"{'least stable':<15}axis {axis['index']}, {' - '.join(axis['contacts'])}, "
            f"{axis['tip_angle_deg']:.6g} deg"
        )
    if "normal_forces" in report:
        text.append(f"normal forces, shares of their sum ({report['normal_forces_kind']}):")
        for name, share in report["normal_forces"].items():
            rough = report["heuristic_forces_eq12"][name]
            text.append(f"  {name:<13}{share:.6f}   (paper's heuristic, Eq 12: {rough:.6f})")
    return text
