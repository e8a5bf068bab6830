"""`lutgen optimum`: the best geometry for a gravity direction."""

import logging
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli.options import (
    Assignment,
    allow_python,
    as_json,
    asks,
    convention,
    gravity,
    named_values,
    option,
)
from lutgen.cli.table import cell, number, show, unit_text
from lutgen.errors import InputError
from lutgen.quantities import QUANTITIES, RANKED

if TYPE_CHECKING:
    from lutgen.recipe import Recipe
    from lutgen.search import Optimum

log = logging.getLogger("lutgen")

TIPS = 1


@dataclass(frozen=True)
class Asked:
    """What the command line says."""

    gravity: tuple[float, float, float] = gravity()
    method: str = option(
        "--method",
        type=click.Choice(["map", "nelder-mead", "search", "multistart"]),
        default="search",
        help=(
            "map: best node of the recipe's sweep; search: the paper's refined mesh; nelder-"
            "mead: one simplex; multistart: many, for objectives with several minima."
        ),
    )
    objective: str = option(
        "--objective",
        default="sdg",
        help=f"{', '.join(RANKED)}, or a sum such as sdg+0.1*height.",
    )
    convention: str = convention()
    assignments: tuple[tuple[str, float], ...] = option(
        "-p",
        "--parameter",
        type=Assignment(),
        multiple=True,
        help=(
            "Keep this parameter at a value, in the recipe's unit, and search the others; "
            "repeatable."
        ),
    )
    bounds: tuple[tuple[str, float, float], ...] = option(
        "--bounds",
        type=Assignment("NAME=LOW:HIGH", "interval", "alpha=20:40"),
        multiple=True,
        help="Where to search, in the recipe's unit; by default the recipe's range; repeatable.",
    )
    start: tuple[tuple[str, float], ...] = option(
        "--start",
        type=Assignment(),
        multiple=True,
        help="Where nelder-mead and multistart begin; by default in the middle; repeatable.",
    )
    limit: float | None = option(
        "--limit",
        type=float,
        help=(
            "Worst acceptable value of the objective (deg for tip_angle) for the acceptable "
            "ranges; by default all geometries that stand are acceptable."
        ),
    )
    levels: int = option("--levels", type=click.IntRange(min=1), default=6, help="Steps of search.")
    ends: str = option(
        "--ends",
        type=click.Choice(["left", "right"]),
        default="left",
        help="Of search: which end of each of its 5 cells is a node.",
    )
    seed: int = option("--seed", type=click.IntRange(min=0), default=0, help="Of multistart.")
    trace: bool = option("--trace", is_flag=True, help="Print the steps of the method too.")
    allow_python: bool = allow_python()
    as_json: bool = as_json()


@click.command(short_help="Best geometry for a gravity direction.")
@click.argument("recipe", type=click.Path())
@asks(Asked)
@click.pass_context
def optimum(ctx: click.Context, recipe: str, asked: Asked) -> None:
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

    robot = load_recipe(recipe, allow_python=asked.allow_python)
    box = _box(robot, asked)
    one = QUANTITIES.get(asked.objective.strip())
    found = run(
        robot,
        asked.gravity,
        asked.method,
        asked.objective,
        convention=asked.convention,
        bounds=box,
        start=_start(robot, asked, box),
        limit=asked.limit if asked.limit is None or one is None else one.stored(asked.limit),
        levels=asked.levels,
        ends=asked.ends,
        seed=asked.seed,
    )
    if asked.limit is not None and found.standing and math.isnan(found.delta[0]):
        log.warning("the best geometry exceeds the limit: no range is acceptable")
    report = optimum_report(robot, found, [low == high for low, high in box])
    if asked.trace:
        report["trace"] = _steps(robot, found)
    show(report, optimum_lines(report), asked.as_json)
    if not found.standing:
        ctx.exit(TIPS)


def _box(robot: "Recipe", asked: Asked) -> list[tuple[float, float]]:
    """Return the bounds (rad, length) of all parameters; those of a kept one are equal."""
    box = {name: (value, value) for name, value in named_values(robot, asked.assignments).items()}
    for name, low, high in asked.bounds:
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
        (p.stored(box[p.name][0]), p.stored(box[p.name][1]))
        if p.name in box
        else (p.minimum, p.maximum)
        for p in robot.parameters
    ]


def _start(robot: "Recipe", asked: Asked, box: Sequence[tuple[float, float]]) -> list[float] | None:
    """Return where the search begins (rad, length): in the middle where nothing is said."""
    begin = [(low + high) / 2.0 for low, high in box]
    given = set(dict(asked.assignments))
    for name, value in asked.start:
        index = _known(robot, "--start", f"{name}={value:g}", name)
        if name in given:
            raise InputError(
                f"parameter {name} has a value already (got --start {name}={value:g} as well); "
                "give it one -p or one --start"
            )
        given.add(name)
        begin[index] = robot.parameters[index].stored(value)
    return begin if asked.start else None


def _known(robot: "Recipe", option: str, got: str, name: str) -> int:
    """Return the number of a parameter."""
    names = [p.name for p in robot.parameters]
    if name not in names:
        raise InputError(
            f"{robot.source}: there is no parameter {name!r} (got {option} {got}); it has "
            f"{', '.join(names) or 'none'}"
        )
    return names.index(name)


def _entry(unit: str, key: str, value: float | Sequence[float]) -> dict[str, Any]:
    """Return one entry with its unit in the key: deg and rad are said, lengths are not."""
    turn = math.degrees if unit == "deg" else float
    name = f"{key}_{unit}" if unit in ("deg", "rad") else key
    if isinstance(value, float):
        return {name: number(turn(value))}
    return {name: [number(turn(part)) for part in value]}


def _unit(robot: "Recipe", found: "Optimum") -> str:
    """Return the unit of the objective; sums have the channels' units mixed."""
    one = QUANTITIES.get(found.objective.strip())
    return one.shown_unit(robot.length_unit) if one else robot.length_unit


def _steps(robot: "Recipe", found: "Optimum") -> list[dict[str, Any]]:
    """Return the steps of the method."""
    unit = _unit(robot, found)
    return [
        {
            "parameters": {
                p.name: _entry(p.display_unit, "value", float(value))
                for p, value in zip(robot.parameters, step.params, strict=True)
            },
            **_entry(unit, "value", step.value),
            "evaluations": step.evaluations,
        }
        for step in found.trace
    ]


def optimum_report(robot: "Recipe", found: "Optimum", kept: Sequence[bool]) -> dict[str, Any]:
    """Return what `--json` prints; null where there is no value."""
    unit = _unit(robot, found)
    last = _steps(robot, found)[-1]
    del last["evaluations"]
    return {
        "robot": robot.name,
        "length_unit": robot.length_unit,
        "method": found.method,
        "objective": found.objective,
        "convention": found.convention,
        "standing": found.standing,
        **_entry(unit, "value", found.value),
        "evaluations": found.evaluations,
        "parameters": {
            p.name: {
                **_entry(p.display_unit, "value", float(found.params[i])),
                **_entry(p.display_unit, "delta", float(found.delta[i])),
                **_entry(p.display_unit, "acceptable", found.acceptable[i].tolist()),
                "kept": kept[i],
            }
            for i, p in enumerate(robot.parameters)
        },
        # Where the method itself ends: the paper's search may have seen better before.
        "last": last,
    }


def optimum_lines(report: dict[str, Any]) -> Iterator[str]:
    """Return the report as text."""
    length = unit_text(report["length_unit"])

    def value(entry: dict[str, Any], key: str = "value") -> str:
        for name, unit in ((f"{key}_deg", " deg"), (f"{key}_rad", " rad"), (key, length)):
            if name in entry:
                return cell(entry[name], unit=unit)
        raise KeyError(key)

    def places(step: dict[str, Any]) -> str:
        where = ", ".join(f"{name} {value(at)}" for name, at in step["parameters"].items())
        shown = value(step)
        return f"{where}: {'tips over' if shown == '-' else shown}"

    verdict = (
        f"stands, {report['objective']} {value(report)}"
        if report["standing"]
        else "tips over in every geometry tried, least in this one"
    )
    yield f"{report['robot']}, {report['method']}: {verdict}, {report['evaluations']} evaluations"
    parameters, last = report["parameters"], report["last"]
    width = max(map(len, parameters))
    for name, entry in parameters.items():
        low, high = next(entry[key] for key in entry if key.startswith("acceptable"))
        more = ""
        if entry["kept"]:
            more = "  kept"
        elif low is not None:
            more = f"  +- {value(entry, 'delta')}  acceptable {low:.6g} to {high:.6g}"
        yield f"  {name:<{width}}  {value(entry)}{more}"
    if any(value(last["parameters"][name]) != value(entry) for name, entry in parameters.items()):
        yield f"last node, worse than the best seen: {places(last)}"
    for index, step in enumerate(report.get("trace", []), 1):
        yield f"step {index}, {step['evaluations']} evaluations: {places(step)}"
