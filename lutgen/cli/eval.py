"""`lutgen eval`: one posture under one direction."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Named, RecipeOptions, asks, log, option
from lutgen.cli.sources import open_source
from lutgen.cli.table import (
    TIPS,
    cell,
    channel_entries,
    degrees,
    number,
    posture_entries,
    posture_text,
    show,
    unit_text,
)
from lutgen.quantities import QUANTITIES

if TYPE_CHECKING:
    from lutgen.analysis import Diagnosis, Posture
    from lutgen.mapping import StabilityMap

VERDICT = {True: "stands", False: "tips over", None: "unknown: off the chart"}
ROCKS = "rocks"
VALUES = {one.json: one.unit for one in QUANTITIES.values() if not one.words} | {"slope_deg": "rad"}


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    assignments: tuple[tuple[str, float], ...] = options.parameters()
    gravity: tuple[float, float, float] = options.gravity()
    acceleration: tuple[float, float, float] | None = option(
        "-a",
        type=options.Numbers("AX,AY,AZ", "acceleration", "for example -2,0,0"),
        help=(
            "Acceleration of the robot in the body frame, m/s^2: inertia then acts beside "
            "gravity. Leave it out where gravity comes from an accelerometer, which reads "
            "both."
        ),
    )


@click.command("eval", short_help="Evaluate one point of a recipe, a map or an export.")
@click.argument("source", type=Named())
@asks(Asked)
def eval_(source: str, asked: Asked) -> None:
    """Evaluate SOURCE at one point.

    A recipe is evaluated exactly, a map by interpolation; of a folder of `lutgen export` the C
    runtime is asked.  Parameters without -p are at the recipe's `home`, then in the middle of their
    range.  Exit code 3 where the robot tips over, or where that cannot be told.

    \b
    $ lutgen eval maps/paper_two.toml -p alpha=31 -p gamma=31
    sdg            0.00253161
    """
    report = _report(source, asked)
    show(report, lines(report), asked.as_json, bool(report["standing"]), TIPS)


def _report(source: str, asked: Asked) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value."""
    from lutgen.analysis import Posture
    from lutgen.chart import gravito_inertial
    from lutgen.recipe import Recipe

    gravity: tuple[float, ...] = asked.gravity
    if asked.acceleration is not None:
        gravity = tuple(gravito_inertial(gravity, asked.acceleration).tolist())
    if Path(source).is_dir():
        from lutgen.cli.eval_export import export_report

        return export_report(Path(source), asked.assignments, gravity)
    opened = open_source(source, asked.allow_python)
    recipe = opened if isinstance(opened, Recipe) else opened.recipe
    values = options.posture_values(recipe, asked.assignments)
    posture = Posture(recipe, values)
    if isinstance(opened, Recipe):
        report = exact_report(posture, gravity)
    else:
        report = map_report(opened, values, gravity)
    return report | posture_entries(posture, options.posture_source(recipe, asked.assignments))


def exact_report(posture: "Posture", gravity: tuple[float, ...]) -> dict[str, Any]:
    """Return the report on one point of a recipe."""
    from lutgen.analysis import diagnose

    recipe, found = posture.recipe, diagnose(posture, gravity)
    rolling = any(contact.rolling for contact in recipe.contacts)
    report: dict[str, Any] = {
        "robot": recipe.name,
        "source": "exact",
        "length_unit": recipe.length_unit,
        "standing": found.standing,
        **channel_entries(found.channels),
        "slope_deg": degrees(found.slope),
        "slides_first": found.slides,
        **(_rolling_entries(posture, gravity) if rolling and not recipe.has_wrench else {}),
    }
    if found.least_stable is not None:
        report["least_stable_axis"] = _axis(found, found.least_stable)
    report["axes"] = [_axis(found, index) for index in range(len(found.tip_over_axes))]
    if found.normal_forces:
        report["normal_forces"] = found.normal_forces
        report["normal_forces_kind"] = found.forces_kind
        report["normal_forces_range"] = {
            name: list(bounds) for name, bounds in found.normal_ranges.items()
        }
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


def _rolling_entries(posture: "Posture", gravity: tuple[float, ...]) -> dict[str, Any]:
    """Return whether the robot holds or rolls away, and how it tips while it rolls freely."""
    from lutgen.analysis import holds, may_hold, rolling_gravity, rolls
    from lutgen.channels import evaluate

    entries: dict[str, Any] = {
        name: bool(verdict(posture, [gravity])[0])
        for name, verdict in (("holds", holds), ("may_hold", may_hold), ("rolls", rolls))
    }
    down = rolling_gravity(posture, gravity)
    if down is not None:
        angle = evaluate(posture.recipe, posture.row, down, ("tip_angle",))["tip_angle"][0, 0]
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
    on_chart = bool(stability_map.chart.locate([gravity])[3][0])
    if not on_chart:
        log.warning("the direction is off the map's chart: the map says nothing")
        channels.pop("facet", None)
    standing = channels.get("tip_angle", channels.get("sdg", math.nan)) >= 0.0
    if not {"tip_angle", "sdg"} & set(channels):
        standing = QUANTITIES["status"].word(channels.get("status", math.nan)) in ("stands", ROCKS)
    return {
        "robot": stability_map.recipe.name,
        "source": "interpolated",
        "length_unit": stability_map.recipe.length_unit,
        "on_chart": on_chart,
        "standing": standing if on_chart else None,
        **channel_entries(channels),
    }


def lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    length = unit_text(report["length_unit"])
    rocks = report["standing"] and report.get("status") == ROCKS
    verdict = ROCKS if rocks else VERDICT[report["standing"]]
    yield f"{report['robot']} ({report['source']}): {verdict}"
    for name, text in _entries(report, length):
        yield f"{name:<15}{text}"
    if "normal_forces" in report:
        yield f"normal forces, shares of their sum ({report['normal_forces_kind']}):"
        for name, share in report["normal_forces"].items():
            rough = report["heuristic_forces_eq12"][name]
            yield f"  {name:<13}{share:.6f}   (paper's heuristic, Eq 12: {rough:.6f})"


def _rolls_away(report: dict[str, Any]) -> str:
    """Return the verdict of every and of some load on rolling in words."""
    if report["rolls"]:
        return "yes"
    depends = report["may_hold"] and not report["holds"]
    return "may: it depends on how the contacts share the load" if depends else "no"


def _entries(report: dict[str, Any], length: str) -> Iterator[tuple[str, str]]:
    """Return the names and texts of what there is one of."""
    if "posture_from" in report:
        yield "posture", f"{posture_text(report['posture'])} ({report['posture_from']})"
    if report.get("status") is not None:
        among = " (the worst of the nodes around)" if report["source"] == "interpolated" else ""
        yield "status", f"{report['status']}{among}"
    for key, kind in VALUES.items():
        if key in report:
            unit = {"rad": " deg", "1": ""}.get(kind, length)
            # JSON has null for them: no boundary at all, or no value outside the region.
            yield key.removesuffix("_deg"), cell(report[key], ".9g", unit)
    if report.get("slides_first") is not None:
        yield "slides first", "yes" if report["slides_first"] else "no"
    if "rolls" in report:
        yield "rolls away", _rolls_away(report)
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
