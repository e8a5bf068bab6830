"""`lutgen eval`: one posture under one direction, of a recipe, a map or an export."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import analysis, charts, devices, evaluation, maps, robots
from lutgen.cli.options import RecipeOptions, command, log, open_source, posture_values
from lutgen.quantities import QUANTITIES

FORCES = (
    "normal_forces normal_forces_kind=forces_kind normal_forces_range=normal_ranges "
    "heuristic_forces_eq12=heuristic_forces"
)
VALUES = {one.json: one.unit for one in QUANTITIES.values() if not one.words} | {"slope_deg": "rad"}


@dataclass(frozen=True)
class Options(RecipeOptions):
    assignments: tuple[tuple[str, float], ...] = given.parameters()
    gravity: tuple[float, float, float] = given.gravity()
    acceleration: tuple[float, float, float] | None = given.option(
        "Acceleration of the robot in the body frame, m/s^2: inertia then acts beside gravity. "
        "Leave it out where gravity comes from an accelerometer, which reads both.",
        "-a",
        type=given.Numbers("AX,AY,AZ", "acceleration", "for example -2,0,0"),
    )


@command("source", Options)
def eval_(source: str, options: Options) -> None:
    """Evaluate one point of SOURCE, a recipe, a map or an export.

    A recipe is evaluated exactly, a map by interpolation; for a folder of `lutgen export`
    the C runtime answers.  Exit code 3 if the robot tips over, or if the answer is unknown.

    \b
    $ lutgen eval maps/paper_two.toml -p alpha=31 -p gamma=31
    sdg            0.00253161
    """
    gravity: Sequence[float] = options.gravity
    if options.acceleration is not None:
        gravity = charts.gravito_inertial(gravity, options.acceleration).tolist()
    if Path(source).is_dir():
        report = export_report(source, options.assignments, gravity)
    else:
        opened = open_source(source, options.allow_python)
        recipe = opened if isinstance(opened, robots.Recipe) else opened.recipe
        posture = analysis.Posture(recipe, posture_values(recipe, options.assignments))
        if isinstance(opened, robots.Recipe):
            report = exact_report(posture, gravity)
        else:
            report = map_report(opened, posture, gravity)
        report |= output.posture_entries(recipe, posture.params, options.assignments)
    output.show(report, lines, 0 if report["standing"] else output.TIPS)


def exact_report(posture: "analysis.Posture", gravity: Sequence[float]) -> dict[str, Any]:
    """Return the report on one point of a recipe."""
    recipe, found = posture.recipe, analysis.diagnose(posture, gravity)
    rolling = any(contact.rolling for contact in recipe.contacts)
    report: dict[str, Any] = {
        "robot": recipe.name,
        "source": "exact",
        "length_unit": recipe.length_unit,
        "standing": found.standing,
        **output.channel_entries(found.channels),
        "slope_deg": output.degrees(found.slope),
        "slides_first": found.slides,
        **(rolling_entries(posture, gravity) if rolling and not recipe.has_wrench else {}),
    }
    axes = [axis_entry(found, index) for index in range(len(found.tip_over_axes))]
    if found.least_stable is not None:
        report["least_stable_axis"] = axes[found.least_stable]
    report["axes"] = axes
    if found.normal_forces:
        report |= output.entries(found, FORCES)
        report["group_shares"] = {
            group.name: sum(found.normal_forces.get(name, 0.0) for name in {*group.contacts})
            for group in recipe.groups
        }
    if found.facet is not None:
        report["support"] = {
            "contacts": [recipe.contact_names[i] for i in found.facet.contacts],
            "centroid": found.facet.centroid,
            "pierced": found.pierced,
        }
    report["com"] = posture.placed.com[0]
    if recipe.com_uncertainty:
        report["com_uncertainty"] = recipe.com_uncertainty
    if recipe.has_wrench:
        report["resultant_over_weight"] = found.resultant
    return report


def rolling_entries(posture: "analysis.Posture", gravity: Sequence[float]) -> dict[str, Any]:
    """Return how the robot holds or rolls away, and how it tips while it rolls freely."""
    entries: dict[str, Any] = {
        name: bool(getattr(analysis, name)(posture, [gravity])[0])
        for name in ("holds", "may_hold", "rolls")
    }
    down = analysis.rolling_gravity(posture, gravity)
    if down is not None:
        found = evaluation.evaluate(posture.recipe, posture.row, down, ("tip_angle",))
        angle = output.degrees(found["tip_angle"][0, 0])
        entries |= {"rolling_gravity": down, "rolling_tip_angle_deg": angle}
    return entries


def axis_entry(found: "analysis.Diagnosis", index: int) -> dict[str, Any]:
    """Return what a report says of one tip-over axis."""
    axis = found.tip_over_axes[index]
    return {
        "index": index,
        "contacts": axis.names,
        **output.entries(axis, "tip_angle_deg margin energy_margin"),
        # Under a load there is no such measure of the nominal weight alone.
        "force_angle_rad": None
        if found.posture.recipe.com_uncertainty or found.posture.recipe.forces
        else float(analysis.axis_force_angle(axis.start, axis.stop, found.gravity_dir)),
    }


def map_report(
    stability_map: "maps.StabilityMap", posture: "analysis.Posture", gravity: Sequence[float]
) -> dict[str, Any]:
    """Return the report on one point of a map."""
    reading = stability_map.read([posture.params], [gravity])
    channels = {name: float(value[0]) for name, value in reading.items()}
    on_chart = bool(stability_map.chart.locate([gravity])[3][0])
    if not on_chart:
        log.warning("the direction is off the map's chart: the map says nothing")
        channels.pop("facet", None)
    standing = channels.get("tip_angle", channels.get("sdg", math.nan)) >= 0.0
    if not {"tip_angle", "sdg"} & set(channels):
        status = QUANTITIES["status"].word(channels.get("status", math.nan))
        standing = status in ("stands", "rocks")
    return {
        "robot": stability_map.recipe.name,
        "source": "interpolated",
        "length_unit": stability_map.recipe.length_unit,
        "on_chart": on_chart,
        "standing": standing if on_chart else None,
        **output.channel_entries(channels),
    }


def export_report(
    directory: str, assignments: given.Assignments, gravity: Sequence[float]
) -> dict[str, Any]:
    """Return the report on one point of an export, which its C answers beyond its range, too."""
    folder = devices.ExportFolder(directory)
    recipe, content = folder.recipe(), folder.report
    params = given.all_values(recipe, assignments)
    for parameter, value in zip(content["parameters"], params, strict=True):
        if not parameter["min"] <= value <= parameter["max"]:
            log.warning("parameter %s is outside the export's range", parameter["name"])
    status, channels = folder.read(params.tolist(), gravity)
    # Nothing is known off the chart or the axes.
    known = not status.startswith("OFF")
    values = {name: channels[name] if known else math.nan for name in content["channels"]}
    return {
        "robot": content["robot"],
        "source": "compiled",
        "length_unit": content["length_unit"],
        "status": f"SMAP_{status}",
        "on_chart": status != "OFF_CHART",
        "standing": status in ("OK", "ROCKS") if known else None,
        **output.channel_entries(values),
        **output.posture_entries(recipe, params, assignments),
    }


def lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    status = "stands" if report["standing"] else "tips"
    if report["standing"] and report.get("status") == "rocks":
        status = "rocks"
    unknown = "unknown: off the chart" if not report.get("on_chart", True) else "unknown: off range"
    verdict = unknown if report["standing"] is None else output.VERDICTS[status]
    yield f"{report['robot']} ({report['source']}): {verdict}"
    yield from entries(report, output.unit_text(report["length_unit"]))
    if "normal_forces" in report:
        yield f"normal forces, shares of their sum ({report['normal_forces_kind']}):"
        rough = report["heuristic_forces_eq12"]
        yield from output.aligned(
            (f"  {name}", f"{share:.6f}", f"(paper's heuristic, Eq 12: {rough[name]:.6f})")
            for name, share in report["normal_forces"].items()
        )
        shares = report["group_shares"].items()
        yield from output.aligned((f"  {name}", f"{share:.6f}") for name, share in shares)


def entries(report: dict[str, Any], length: str) -> Iterator[tuple[str, str]]:
    """Return the names and texts of what there is one of."""
    if "posture_from" in report:
        yield "posture", f"{output.posture_text(report['posture'])} ({report['posture_from']})"
    if report.get("status") is not None:
        among = " (the worst of the nodes around)" if report["source"] == "interpolated" else ""
        yield "status", f"{report['status']}{among}"
    for key, kind in VALUES.items():
        if key in report:
            unit = {"rad": " deg", "1": ""}.get(kind, length)
            # JSON has null for them: no boundary at all, or no value outside the region.
            yield key.removesuffix("_deg"), output.cell(report[key], ".9g", unit)
    if report.get("slides_first") is not None:
        yield "slides first", "yes" if report["slides_first"] else "no"
    if "rolls" in report:
        depends = report["may_hold"] and not report["holds"]
        may = "may: it depends on how the contacts share the load" if depends else "no"
        yield "rolls away", "yes" if report["rolls"] else may
    if "rolling_tip_angle_deg" in report:
        yield "rolls freely", f"tip_angle {report['rolling_tip_angle_deg']:.6g} deg"
    if "com_uncertainty" in report:
        yield "for any com", f"within {report['com_uncertainty']:g}{length}"
    if "resultant_over_weight" in report:
        yield "resultant", f"{math.hypot(*report['resultant_over_weight']):.6g} of the weight"
    if "least_stable_axis" in report:
        axis = report["least_stable_axis"]
        contacts = " - ".join(dict.fromkeys(axis["contacts"]))
        yield "least stable", f"axis {axis['index']}, {contacts}, {axis['tip_angle_deg']:.6g} deg"
