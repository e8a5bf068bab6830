"""`lutgen optimum`: the best geometry for a gravity direction."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from lutgen.cli import options as given
from lutgen.cli.lazy import robots, searches
from lutgen.cli.options import RecipeOptions, command, log, option, stored_values
from lutgen.cli.output import TIPS, VERDICTS, cell, entries, show, unit_text
from lutgen.errors import InputError, reject
from lutgen.parts import to_display
from lutgen.quantities import QUANTITIES, RANKED


@dataclass(frozen=True)
class Options(RecipeOptions):
    gravity: tuple[float, float, float] = given.gravity()
    method: str = given.method(
        "map: best node of the recipe's sweep; search: the paper's refined mesh; nelder-"
        "mead: one simplex; multistart: many points, for objectives with several minima."
    )
    objective: str = option(f"{', '.join(RANKED)}, or a sum such as sdg+0.1*height.", default="sdg")
    convention: str = given.convention()
    assignments: tuple[tuple[str, float], ...] = option(
        "Keep this parameter at a value, in the recipe's unit, and search the others; repeatable.",
        "-p --parameter",
    )
    bounds: tuple[tuple[str, float, float], ...] = option(
        "Where to search, in the recipe's unit; by default the recipe's range; repeatable."
    )
    start: tuple[tuple[str, float], ...] = option(
        "Where nelder-mead and multistart begin; by default in the middle; repeatable."
    )
    limit: float | None = option(
        "Worst acceptable value of the objective (deg for tip_angle) for the acceptable "
        "ranges; by default all geometries that stand are acceptable."
    )
    levels: int = option("Steps of search.", low=1, default=6)
    ends: Literal["left", "right"] = option(
        "Which end of each of the 5 cells of search is a node.", default="left"
    )
    seed: int = option("Seed of multistart.", low=0, default=0)
    trace: bool = option("Print the steps of the method too.")


@command("recipe", Options)
def optimum(robot: "robots.Recipe", options: Options) -> None:
    """Print the best geometry of RECIPE for a gravity direction.

    With +- how far each parameter may be off, and the interval in which it may lie, the others
    kept.  Exit code 3 where the robot stands in no geometry that was tried; what is printed then
    is the one closest to standing.

    \b
    $ lutgen optimum maps/paper_two.toml --limit 0.05
    paper_two, search: stands, sdg 0.000485608, 150 evaluations
    """
    kept = stored_values(robot, options.assignments)
    one = QUANTITIES.get(options.objective.strip())
    box, start = space_of(robot, kept, options)
    found = searches.optimum(
        robot,
        options.gravity,
        options.method,
        options.objective,
        bounds=box or None,
        start=start,
        limit=options.limit if options.limit is None or one is None else one.stored(options.limit),
        **entries(options, "convention levels ends seed"),
    )
    if options.limit is not None and found.standing and math.isnan(found.delta[0]):
        log.warning("the best geometry exceeds the limit: no range is acceptable")
    trace = steps(robot, found)
    report = {
        **entries(robot, "robot=name length_unit"),
        **entries(found, "method objective convention standing"),
        **entry("value", found.value, objective_unit(robot, found)),
        "evaluations": found.evaluations,
        "parameters": {
            p.name: {
                **entry("value", found.params[i], p.display_unit),
                **entry("delta", found.delta[i], p.display_unit),
                **entry("acceptable", found.acceptable[i], p.display_unit),
                "kept": p.name in kept,
            }
            for i, p in enumerate(robot.parameters)
        },
        # Where the method itself ends: the paper's search may have seen better before.
        "last": {key: part for key, part in trace[-1].items() if key != "evaluations"},
    }
    if options.trace:
        report["trace"] = trace
    show(report, optimum_lines, 0 if found.standing else TIPS)


def space_of(
    robot: "robots.Recipe", kept: Mapping[str, float], options: Options
) -> tuple[list[Any], list[float] | None]:
    """Return the bounds (rad, length) of all parameters, and where the search begins, if given.

    Bounds of a kept parameter are equal; where nothing is said of one it begins in the middle.
    """
    for flag, named in (("--bounds", options.bounds), ("--start", options.start)):
        for name, *_ in named:
            if name in kept:
                what, got = f"parameter {name} has a value already", f"-p as well as {flag} {name}"
                reject(robot.source, what, got, f"give it one -p or one {flag}", InputError)
    for name, low, high in options.bounds:
        if not low < high:
            what = f"the lower bound of {name} must be below the upper one"
            way_out = f"swap them, or write -p {name}={low:g} to keep it"
            reject("--bounds", what, f"{low:g}:{high:g}", way_out, InputError)
    box = {p.name: (p.minimum, p.maximum) for p in robot.parameters}
    box |= stored_values(robot, options.bounds, "--bounds")
    box |= {name: (value, value) for name, value in kept.items()}
    start = stored_values(robot, options.start, "--start")
    middle = {name: sum(ends) / 2.0 for name, ends in box.items()}
    return [*box.values()], [*(middle | start).values()] if start else None


def entry(key: str, values: Any, unit: str) -> dict[str, Any]:
    """Return one entry with its unit in the key: deg and rad are said, lengths are not."""
    return {f"{key}_{unit}" if unit in ("deg", "rad") else key: to_display(values, unit)}


def objective_unit(robot: "robots.Recipe", found: "searches.Optimum") -> str:
    """Return the unit of the objective; sums have the channels' units mixed."""
    one = QUANTITIES.get(found.objective.strip())
    return one.shown_unit(robot.length_unit) if one else robot.length_unit


def steps(robot: "robots.Recipe", found: "searches.Optimum") -> list[dict[str, Any]]:
    """Return the steps of the method."""
    unit = objective_unit(robot, found)
    return [
        {
            "parameters": {
                p.name: entry("value", value, p.display_unit)
                for p, value in zip(robot.parameters, step.params, strict=True)
            },
            **entry("value", step.value, unit),
            "evaluations": step.evaluations,
        }
        for step in found.trace
    ]


def optimum_lines(report: dict[str, Any]) -> Iterator[Sequence[str]]:
    """Return the report as text."""
    length, parameters = unit_text(report["length_unit"]), report["parameters"]
    verdict = f"stands, {report['objective']} {text(report, length)}"
    if not report["standing"]:
        verdict = f"{VERDICTS['tips']} in every geometry tried, least in this one"
    evaluations = f"{report['evaluations']} evaluations"
    yield f"{report['robot']}, {report['method']}: {verdict}, {evaluations}"
    for name, part in parameters.items():
        acceptable, more = [*values_of(part, "acceptable")[0]], list[str]()
        if part["kept"]:
            more = ["kept"]
        elif None not in acceptable:
            low, high = map(cell, acceptable)
            more = [f"+- {text(part, length, 'delta')}", f"acceptable {low} to {high}"]
        yield [f"  {name}", text(part, length), *more]
    last = report["last"]["parameters"]
    if any(text(last[name], length) != text(parameters[name], length) for name in last):
        yield f"last node, worse than the best seen: {node(report['last'], length)}"
    for i, step in enumerate(report.get("trace", ()), 1):
        yield f"step {i}, {step['evaluations']} evaluations: {node(step, length)}"


def values_of(part: Mapping[str, Any], key: str) -> tuple[Any, str | None]:
    """Return what a report has under a key that may name its unit, and that unit."""
    units = {key: None, f"{key}_deg": " deg", f"{key}_rad": " rad"}
    return next((part[name], unit) for name, unit in units.items() if name in part)


def text(part: Mapping[str, Any], length: str, key: str = "value") -> str:
    """Return a value of a report with its unit."""
    value, unit = values_of(part, key)
    return cell(value, unit=length if unit is None else unit)


def node(step: Mapping[str, Any], length: str) -> str:
    """Return where a step of the method ends, and its value."""
    where = ", ".join(f"{name} {text(part, length)}" for name, part in step["parameters"].items())
    value = text(step, length)
    return f"{where}: {VERDICTS['tips'] if value == '-' else value}"
