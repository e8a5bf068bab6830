"""`lutgen weigh`: mass and centre of mass from scales under the contacts, and from tilts."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from lutgen.cli import options as given
from lutgen.cli import output
from lutgen.cli.lazy import Floats, analysis, np, robots, searches
from lutgen.cli.options import RecipeOptions, command, option
from lutgen.errors import InputError, reject
from lutgen.files import write_text

GROUND = ("slope_deg", "heading_deg")
# Accuracy of a scale unless it is given: this part of the largest reading.
SCALE = 0.005


@dataclass(frozen=True)
class Options(RecipeOptions):
    scales: str | None = given.file(
        "CSV file: a column for each scale, named by its contact or contacts (a+b), kg; and "
        "if wanted parameters, slope_deg and heading_deg."
    )
    tilt: str | None = given.file(
        "CSV file: slope_deg and heading_deg at which the robot began to tip, parameters."
    )
    accuracy: float | None = option(
        "Standard deviation of a scale, kg.  [default: 0.5 % of the most read]"
    )
    angle_accuracy: float = option("Standard deviation of --tilt, deg.", above=0.0, default=1.0)
    output: str | None = given.output("Write the recipe with the correction (.toml).")
    force: bool = given.force()


@command("recipe", Options)
def weigh(robot: "robots.Recipe", options: Options) -> None:
    """Find mass and centre of mass from scales and tilts.

    Both are printed with their uncertainty.

    A row of a file is one weighing: the posture (`home` where a column is missing), the slope under
    the robot and its heading (0: nose down, 90: left side down), and what each scale reads.  The
    correction is three keys of the recipe, which every command uses.

    \b
    $ lutgen weigh robot.toml --scales scales.csv -o weighed.toml
    """
    readings: list[analysis.Reading] = [*scale_readings(robot, options)]
    readings += tilt_readings(robot, options)
    if not readings:
        reject("--scales, --tilt", "neither is given", "no file", "give one of them", InputError)
    found = analysis.weigh(robot, readings)
    if options.output is not None:
        write_text(options.output, analysis.corrected(robot, found), options.force)
    advice: dict[str, Any] | None = None
    axes = zip("xyz", found.com_std, strict=True)
    if found.advice is not None:
        posture = output.by_unit(robot, np.array(found.advice.params))
        known = output.entries(found.advice, "slope_deg heading_deg com_std")
        advice = {"posture": posture, **known}
    report = {
        **output.entries(robot, "robot=name length_unit"),
        "mass": found.mass if math.isfinite(found.mass_std) else None,
        "mass_std": found.mass_std,
        "recipe_mass": math.fsum(link.mass for link in robot.links) or None,
        **output.entries(found, "com_shift com_std"),
        "com_open": [axis for axis, std in axes if std == math.inf],
        "readings": [*residual_entries(readings, found)],
        "next": advice,
        "keys": analysis.correction(robot, found),
    }
    output.show(report, weigh_lines)


def scale_readings(robot: "robots.Recipe", options: Options) -> "list[analysis.Weighing]":
    """Return the weighings of the file of scales."""
    if options.scales is None:
        return []
    contacts, others = robot.contact_names, (*GROUND, *(p.name for p in robot.parameters))

    def columns(names: list[str]) -> tuple[tuple[str, ...], list[str]]:
        scales = [name for name in names if {*name.split("+")} <= {*contacts}]
        return (), [*dict.fromkeys((*contacts, *scales, *others))]

    rows, _ = searches.read_rows(options.scales, columns, "there is no weighing", 1)
    scales = [name for name in rows if name not in others]
    if not scales:
        way_out = f"name contacts: {', '.join(contacts)}"
        reject(options.scales, "line 1 names no scale", ",".join(rows), way_out, InputError)
    for name in scales:
        if (rows[name] < 0.0).any():
            what = f"column {name}: a scale reads 0 kg or more"
            reject(options.scales, what, f"{rows[name].min():g}", "correct it", InputError)
    largest = max(float(rows[name].max()) for name in scales)
    accuracy = options.accuracy if options.accuracy is not None else SCALE * largest
    if not accuracy > 0.0:
        raise InputError(f"--accuracy: must be above 0 kg (got {accuracy:g}).")
    readings = []
    for i, (params, ground) in enumerate(poses(robot, rows)):
        loads = {tuple(name.split("+")): float(rows[name][i]) for name in scales}
        readings.append(analysis.Weighing(params, loads, accuracy, *ground))
    return readings


def tilt_readings(robot: "robots.Recipe", options: Options) -> "list[analysis.Tipping]":
    """Return the tilts of the file of tilts."""
    if options.tilt is None:
        return []
    known = (*GROUND, *(p.name for p in robot.parameters))
    rows, _ = searches.read_rows(options.tilt, lambda _: (GROUND, known), "there is no tilt", 1)
    accuracy = math.radians(options.angle_accuracy)
    return [analysis.Tipping(params, *ground, accuracy) for params, ground in poses(robot, rows)]


def poses(
    robot: "robots.Recipe", rows: "dict[str, Floats]"
) -> "Iterator[tuple[tuple[float, ...], tuple[float, float]]]":
    """Yield posture (rad, length), slope and heading (rad) of each row."""
    for i in range(len(next(iter(rows.values())))):
        posture = [(p.name, float(rows[p.name][i])) for p in robot.parameters if p.name in rows]
        slope, heading = (math.radians(rows[key][i]) if key in rows else 0.0 for key in GROUND)
        if not 0.0 <= slope < math.radians(90.0):
            got = f"{math.degrees(slope):g} in row {i + 1}"
            reject("slope_deg", "must lie from 0 to 90", got, "correct it", InputError)
        yield tuple(given.posture_values(robot, tuple(posture)).tolist()), (slope, heading)


def residual_entries(
    readings: "list[analysis.Reading]", found: "analysis.Weighed"
) -> Iterator[dict[str, Any]]:
    """Return what a report says of each reading, and how far the result is from it."""
    rest = iter(found.residuals.tolist())
    for one in readings:
        if isinstance(one, analysis.Weighing):
            for group, load in one.loads.items():
                yield {"scale": "+".join(group), "kg": load, "residual_kg": next(rest)}
        else:
            residual = {"residual_deg": math.degrees(next(rest))}
            yield output.entries(one, "heading_deg slope_deg") | residual


def weigh_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    unit = output.unit_text(report["length_unit"])
    cell = output.cell
    yield f"{report['robot']}: {len(report['readings'])} readings"
    rows = []
    if report["mass"] is not None:
        recipe = cell(report["recipe_mass"], ".6g", " kg")
        deviation = f"+- {cell(report['mass_std'], '.2g', ' kg')}"
        rows.append(["mass", cell(report["mass"], ".6g", " kg"), deviation, f"(recipe {recipe})"])
    for axis, shift, std in zip("xyz", report["com_shift"], report["com_std"], strict=True):
        known = [cell(shift, "+.5g", unit), f"+- {cell(std, '.2g', unit)}"]
        if std is None:
            # A combination of parts may be known of which none is by itself.
            known = [*known[:1], "not determined by itself"] if shift else ["not determined"]
        rows.append([f"com {axis}", *known])
    yield from output.aligned(rows)
    if report["com_open"]:
        yield "what is not determined moves as little as the readings need: level scales give no"
        yield "height; weigh on a slope of 10 deg as well, or give --tilt"
    yield ["reading", "value", "residual"]
    for one in report["readings"]:
        if "scale" in one:
            known = [one["scale"], cell(one["kg"], ".6g", " kg")]
        else:
            at = f"tips, heading {one['heading_deg']:g} deg"
            known = [at, cell(one["slope_deg"], ".4g", " deg")]
        yield [*known, cell(one.get("residual_kg", one.get("residual_deg")), "+.2g")]
    advice = report["next"]
    if advice is not None and advice["com_std"] is not None:
        ground = f"on {advice['slope_deg']:g} deg, heading {advice['heading_deg']:g} deg"
        ground = ground if advice["slope_deg"] else "level"
        yield (
            f"most would help: all scales at {output.posture_text(advice['posture'])}, {ground}: "
            f"com to {cell(advice['com_std'], '.2g', unit)}"
        )
    yield "correction, under [robot]:"
    yield from (f"  {line}" for line in analysis.correction_lines(report["keys"]))
