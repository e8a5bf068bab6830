"""`lutgen optimum`: the best geometry for a gravity direction."""

import json
import logging
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import Assignment, allow_python, as_json, convention, gravity, named_values
from lutgen.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.recipe import Parameter, Recipe
    from lutgen.search import Optimum

log = logging.getLogger("lutgen")

TIPS = 1


class Interval(click.ParamType):  # type: ignore[type-arg]
    """A geometry parameter and its bounds, name=low:high."""

    name = "NAME=LOW:HIGH"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, float, float]:
        """Return (name, low, high)."""
        if isinstance(value, tuple):
            return value
        name, equals, rest = str(value).partition("=")
        try:
            low, high = (float(part) for part in rest.split(":"))
        except ValueError:
            low = high = math.nan
        if not (name and equals and math.isfinite(low) and math.isfinite(high)):
            self.fail(f"{value!r} is no interval; write for example alpha=20:40", param, ctx)
        return name.strip(), low, high


@click.command(short_help="Best geometry for a gravity direction.")
@click.argument("recipe", type=click.Path())
@gravity
@click.option(
    "--method",
    type=click.Choice(["map", "nelder-mead", "search", "multistart"]),
    default="search",
    show_default=True,
    help="map: best node of the recipe's sweep; search: the paper's refined mesh; nelder-mead: one "
    "simplex; multistart: many, for objectives with several minima.",
)
@click.option(
    "--objective",
    default="sdg",
    show_default=True,
    help="sdg, height, tip_angle, margin, energy_margin, or a sum such as sdg+0.1*height.",
)
@convention
@click.option(
    "-p",
    "--parameter",
    "assignments",
    type=Assignment(),
    multiple=True,
    help="Keep this parameter at a value, in the recipe's unit, and search the others; repeatable.",
)
@click.option(
    "--bounds",
    type=Interval(),
    multiple=True,
    help="Where to search, in the recipe's unit; by default the recipe's range; repeatable.",
)
@click.option(
    "--start",
    type=Assignment(),
    multiple=True,
    help="Where nelder-mead and multistart begin; by default in the middle; repeatable.",
)
@click.option(
    "--limit",
    type=float,
    help="Worst acceptable value of the objective (deg for tip_angle) for the acceptable ranges; "
    "by default all geometries that stand are acceptable.",
)
@click.option(
    "--levels", type=click.IntRange(min=1), default=6, show_default=True, help="Steps of search."
)
@click.option(
    "--ends",
    type=click.Choice(["left", "right"]),
    default="left",
    show_default=True,
    help="Of search: which end of each of its 5 cells is a node.",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Of multistart."
)
@click.option("--trace", is_flag=True, help="Print the steps of the method too.")
@allow_python
@as_json
@click.pass_context
def optimum(
    ctx: click.Context,
    recipe: str,
    gravity: tuple[float, float, float],
    method: str,
    objective: str,
    convention: str,
    assignments: tuple[tuple[str, float], ...],
    bounds: tuple[tuple[str, float, float], ...],
    start: tuple[tuple[str, float], ...],
    limit: float | None,
    levels: int,
    ends: str,
    seed: int,
    trace: bool,
    allow_python: bool,
    as_json: bool,
) -> None:
    """Print the best geometry of RECIPE for a gravity direction.

    With +- how far each parameter may be off, and the interval in which it may lie, the others
    kept.  Exit code 1 where the robot stands in no geometry that was tried; what is printed then
    is the one closest to standing.

    \b
    $ lutgen optimum maps/paper_two.toml --limit 0.05
    paper_two, search: stands, sdg 0.000485608, 150 evaluations
    """
    from lutgen.recipe import load_recipe
    from lutgen.search import optimum as run

    robot = load_recipe(recipe, allow_python=allow_python)
    box = _box(robot, assignments, bounds)
    found = run(
        robot,
        gravity,
        method,
        objective,
        convention=convention,
        bounds=box,
        start=_start(robot, assignments, start, box),
        limit=math.radians(limit) if limit is not None and objective == "tip_angle" else limit,
        levels=levels,
        ends=ends,
        seed=seed,
    )
    if limit is not None and found.standing and math.isnan(found.delta[0]):
        log.warning("the best geometry exceeds the limit: no range is acceptable")
    report = optimum_report(robot, found, [low == high for low, high in box], trace)
    if as_json:
        click.echo(json.dumps(report, indent=2, allow_nan=False))
    else:
        for line in optimum_lines(report):
            click.echo(line)
    if not found.standing:
        ctx.exit(TIPS)


def _box(
    robot: "Recipe",
    assignments: Sequence[tuple[str, float]],
    bounds: Sequence[tuple[str, float, float]],
) -> "list[tuple[float, float]]":
    """Return the bounds (rad, length) of all parameters; those of a kept one are equal."""
    box = {name: (value, value) for name, value in named_values(robot, assignments).items()}
    for name, low, high in bounds:
        _known(robot, "--bounds", f"{name}={low:g}:{high:g}", name)
        if name in box:
            raise InputError(
                f"parameter {name} is bounded or kept twice (got --bounds {name}={low:g}:{high:g} "
                "as well); give it one -p or one --bounds"
            )
        if not low < high:
            raise InputError(
                f"the lower bound of {name} must be below the upper one (got {low:g}:{high:g}); "
                f"swap them, or write -p {name}={low:g} to keep it"
            )
        box[name] = (low, high)
    return [
        (_internal(p, box[p.name][0]), _internal(p, box[p.name][1]))
        if p.name in box
        else (p.minimum, p.maximum)
        for p in robot.parameters
    ]


def _start(
    robot: "Recipe",
    assignments: Sequence[tuple[str, float]],
    start: Sequence[tuple[str, float]],
    box: Sequence[tuple[float, float]],
) -> list[float] | None:
    """Return where the search begins (rad, length): in the middle where nothing is said."""
    kept = dict(assignments)
    begin = [(low + high) / 2.0 for low, high in box]
    given: set[str] = set()
    for name, value in start:
        index = _known(robot, "--start", f"{name}={value:g}", name)
        if name in kept or name in given:
            raise InputError(
                f"parameter {name} has a value already (got --start {name}={value:g} as well); "
                "give it one -p or one --start"
            )
        given.add(name)
        begin[index] = _internal(robot.parameters[index], value)
    return begin if start else None


def _known(robot: "Recipe", option: str, got: str, name: str) -> int:
    """Return the number of a parameter."""
    names = [p.name for p in robot.parameters]
    if name not in names:
        raise InputError(
            f"{robot.source}: there is no parameter {name!r} (got {option} {got}); it has "
            f"{', '.join(names) or 'none'}"
        )
    return names.index(name)


def _internal(parameter: "Parameter", value: float) -> float:
    return math.radians(value) if parameter.display_unit == "deg" else value


def _number(value: float) -> float | None:
    """Return a number for JSON, which knows neither NaN nor infinity."""
    return float(value) if math.isfinite(value) else None


def _entry(unit: str, key: str, value: float | Sequence[float]) -> dict[str, Any]:
    """Return one entry with its unit in the key: deg and rad are said, lengths are not."""
    turn = math.degrees if unit == "deg" else float
    name = f"{key}_{unit}" if unit in ("deg", "rad") else key
    if isinstance(value, float):
        return {name: _number(turn(value))}
    return {name: [_number(turn(part)) for part in value]}


def optimum_report(
    robot: "Recipe", found: "Optimum", kept: Sequence[bool], trace: bool = False
) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value."""
    unit = "deg" if found.objective.strip() == "tip_angle" else robot.length_unit
    parameters = {
        p.name: {
            **_entry(p.display_unit, "value", float(found.params[i])),
            **_entry(p.display_unit, "delta", float(found.delta[i])),
            **_entry(p.display_unit, "acceptable", found.acceptable[i].tolist()),
            "kept": kept[i],
        }
        for i, p in enumerate(robot.parameters)
    }

    def at(params: "NDArray[np.float64]") -> dict[str, Any]:
        return {
            p.name: _entry(p.display_unit, "value", float(value))
            for p, value in zip(robot.parameters, params, strict=True)
        }

    steps = [
        {
            "parameters": at(step.params),
            **_entry(unit, "value", step.value),
            "evaluations": step.evaluations,
        }
        for step in found.trace
    ]
    report: dict[str, Any] = {
        "robot": robot.name,
        "length_unit": robot.length_unit,
        "method": found.method,
        "objective": found.objective,
        "convention": found.convention,
        "standing": found.standing,
        **_entry(unit, "value", found.value),
        "evaluations": found.evaluations,
        "parameters": parameters,
        # Where the method itself ends: the paper's search may have seen better before.
        "last": {key: steps[-1][key] for key in steps[-1] if key != "evaluations"},
    }
    if trace:
        report["trace"] = steps
    return report


def optimum_lines(report: dict[str, Any]) -> list[str]:
    """Return the report as text."""
    length = "" if report["length_unit"] == "1" else f" {report['length_unit']}"

    def value(entry: dict[str, Any], key: str = "value") -> str:
        for name, suffix in ((f"{key}_deg", " deg"), (f"{key}_rad", " rad"), (key, length)):
            if name in entry:
                return "-" if entry[name] is None else f"{entry[name]:.6g}{suffix}"
        raise KeyError(key)

    verdict = (
        f"stands, {report['objective']} {value(report)}"
        if report["standing"]
        else "tips over in every geometry tried, least in this one"
    )
    text = [
        f"{report['robot']}, {report['method']}: {verdict}, {report['evaluations']} evaluations"
    ]
    width = max(len(name) for name in report["parameters"])
    for name, entry in report["parameters"].items():
        line = f"  {name:<{width}}  {value(entry)}"
        low, high = next(entry[key] for key in entry if key.startswith("acceptable"))
        if entry["kept"]:
            line += "  kept"
        elif low is not None:
            line += f"  +- {value(entry, 'delta')}  acceptable {low:.6g} to {high:.6g}"
        text.append(line)

    def places(step: dict[str, Any]) -> str:
        where = ", ".join(f"{name} {value(at)}" for name, at in step["parameters"].items())
        shown = value(step)
        return f"{where}: {'tips over' if shown == '-' else shown}"

    last = report["last"]
    if any(value(last["parameters"][name]) != value(e) for name, e in report["parameters"].items()):
        text.append(f"last node, worse than the best seen: {places(last)}")
    for number, step in enumerate(report.get("trace", []), 1):
        text.append(f"step {number}, {step['evaluations']} evaluations: {places(step)}")
    return text
