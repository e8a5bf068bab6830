"""`lutgen eval`: one posture under one direction."""

import logging
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import (
    Numbers,
    allow_python,
    as_json,
    asks,
    gravity,
    open_source,
    option,
    parameter_values,
    parameters,
)
from lutgen.cli.table import cell, channel_entries, degrees, number, show, unit_text
from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    from lutgen.analysis import Diagnosis
    from lutgen.mapping import StabilityMap
    from lutgen.recipe import Recipe

log = logging.getLogger("lutgen")

VERDICT = {True: "stands", False: "tips over", None: "unknown: off the chart"}
VALUES = {one.json: one.unit for one in QUANTITIES.values()} | {"slope_deg": "rad"}


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    assignments: tuple[tuple[str, float], ...] = parameters()
    gravity: tuple[float, float, float] = gravity()
    acceleration: tuple[float, float, float] | None = option(
        "-a",
        "--acceleration",
        type=Numbers("AX,AY,AZ", "acceleration", "for example -2,0,0"),
        help=(
            "Acceleration of the robot in the body frame, m/s^2: inertia then acts beside "
            "gravity. Leave it out where gravity comes from an accelerometer, which reads "
            "both."
        ),
    )
    allow_python: bool = allow_python()
    as_json: bool = as_json()


@click.command("eval", short_help="Evaluate one point of a recipe, a map or an export.")
@click.argument("source", type=click.Path())
@asks(Asked)
def eval_(source: str, asked: Asked) -> None:
    """Evaluate SOURCE at one point.

    A recipe is evaluated exactly, a map by interpolation; of a folder of `lutgen export` the C
    runtime is asked.

    \b
    $ lutgen eval maps/paper_two.toml -p alpha=31 -p gamma=31
    sdg            0.00253161
    """
    report = _report(source, asked)
    show(report, lines(report), asked.as_json)


def _report(source: str, asked: Asked) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value."""
    from lutgen.chart import gravito_inertial
    from lutgen.recipe import Recipe

    gravity: tuple[float, ...] = asked.gravity
    if asked.acceleration is not None:
        gravity = tuple(gravito_inertial(gravity, asked.acceleration).tolist())
    if Path(source).is_dir():
        from lutgen.cli.eval_export import export_report

        return export_report(Path(source), asked.assignments, gravity)
    opened = open_source(source, asked.allow_python)
    if isinstance(opened, Recipe):
        return exact_report(opened, parameter_values(opened, asked.assignments), gravity)
    return map_report(
        opened, parameter_values(opened.recipe, asked.assignments, "clamped"), gravity
    )


def exact_report(
    recipe: "Recipe", values: list[float], gravity: tuple[float, ...]
) -> dict[str, Any]:
    """Return the report on one point of a recipe."""
    from lutgen.analysis import Posture, diagnose

    found = diagnose(Posture(recipe, values), gravity)
    rolling = any(contact.rolling for contact in recipe.contacts)
    report: dict[str, Any] = {
        "robot": recipe.name,
        "source": "exact",
        "length_unit": recipe.length_unit,
        "standing": found.standing,
        **channel_entries(found.channels),
        "slope_deg": degrees(found.slope),
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
            "pierced": [number(c) for c in found.pierced],
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
    from lutgen.analysis import Posture, rolling_gravity, rolls
    from lutgen.channels import evaluate

    entries: dict[str, Any] = {"rolls": bool(rolls(Posture(recipe, values), [gravity])[0])}
    down = rolling_gravity(Posture(recipe, values), gravity)
    if down is not None:
        angle = evaluate(recipe, [values], down, ("tip_angle",))["tip_angle"][0, 0]
        entries["rolling_gravity"] = down.tolist()
        entries["rolling_tip_angle_deg"] = degrees(angle)
    return entries


def _axis(found: "Diagnosis", index: int) -> dict[str, Any]:
    from lutgen.analysis import axis_force_angle

    axis = found.tip_over_axes[index]
    return {
        "index": index,
        "contacts": list(axis.names),
        "tip_angle_deg": degrees(axis.tip_angle),
        "margin": number(axis.margin),
        "energy_margin": number(axis.energy_margin),
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


def lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    length = unit_text(report["length_unit"])
    yield f"{report['robot']} ({report['source']}): {VERDICT[report['standing']]}"
    for name, text in _entries(report, length):
        yield f"{name:<15}{text}"
    if "normal_forces" in report:
        yield f"normal forces, shares of their sum ({report['normal_forces_kind']}):"
        for name, share in report["normal_forces"].items():
            rough = report["heuristic_forces_eq12"][name]
            yield f"  {name:<13}{share:.6f}   (paper's heuristic, Eq 12: {rough:.6f})"


def _entries(report: dict[str, Any], length: str) -> Iterator[tuple[str, str]]:
    """Return the names and texts of what there is one of."""
    if "status" in report:
        yield "status", report["status"]
    for key, kind in VALUES.items():
        if key in report:
            unit = {"rad": " deg", "1": ""}.get(kind, length)
            # JSON has null for them: no boundary at all, or no value outside the region.
            yield key.removesuffix("_deg"), cell(report[key], ".9g", unit)
    for name, key in (("slides first", "slides_first"), ("rolls away", "rolls")):
        if report.get(key) is not None:
            yield name, "yes" if report[key] else "no"
    if "rolling_tip_angle_deg" in report:
        yield "rolling freely", f"tip_angle {report['rolling_tip_angle_deg']:.6g} deg"
    if "com_uncertainty" in report:
        yield "for any com", f"within {report['com_uncertainty']:g}{length}"
    if "resultant_over_weight" in report:
        yield "resultant", f"{math.hypot(*report['resultant_over_weight']):.6g} of the weight"
    if "least_stable_axis" in report:
        axis = report["least_stable_axis"]
        contacts = " - ".join(axis["contacts"])
        angle = f"{axis['tip_angle_deg']:.6g} deg"
        yield "least stable", f"axis {axis['index']}, {contacts}, {angle}"
