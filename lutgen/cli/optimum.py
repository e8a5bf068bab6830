"""`lutgen optimum`: the best geometry for a gravity direction."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from lutgen.cli import options
from lutgen.cli.options import Named, RecipeOptions, asks, log, option
from lutgen.cli.sources import open_recipe
from lutgen.cli.table import TIPS, cell, number, show, unit_text
from lutgen.errors import InputError
from lutgen.parts import to_display
from lutgen.quantities import QUANTITIES, RANKED

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from lutgen.recipe import Recipe
    from lutgen.search import Optimum


@dataclass(frozen=True)
class Asked(RecipeOptions):
    """What the command line says."""

    gravity: tuple[float, float, float] = options.gravity()
    method: str = options.method(
        help=(
            "map: best node of the recipe's sweep; search: the paper's refined mesh; nelder-"
            "mead: one simplex; multistart: many, for objectives with several minima."
        )
    )
    objective: str = option(
        default="sdg", help=f"{', '.join(RANKED)}, or a sum such as sdg+0.1*height."
    )
    convention: str = options.convention()
    assignments: tuple[tuple[str, float], ...] = options.parameters(
        help=(
            "Keep this parameter at a value, in the recipe's unit, and search the others; "
            "repeatable."
        )
    )
    bounds: tuple[tuple[str, float, float], ...] = option(
        type=options.Assignment("NAME=LOW:HIGH", "interval", "alpha=20:40"),
        multiple=True,
        help="Where to search, in the recipe's unit; by default the recipe's range; repeatable.",
    )
    start: tuple[tuple[str, float], ...] = option(
        type=options.Assignment(),
        multiple=True,
        help="Where nelder-mead and multistart begin; by default in the middle; repeatable.",
    )
    limit: float | None = option(
        type=float,
        help=(
            "Worst acceptable value of the objective (deg for tip_angle) for the acceptable "
            "ranges; by default all geometries that stand are acceptable."
        ),
    )
    levels: int = option(type=options.WholeRange(min=1), default=6, help="Steps of search.")
    ends: str = option(
        type=click.Choice(["left", "right"]),
        default="left",
        help="Of search: which end of each of its 5 cells is a node.",
    )
    seed: int = option(type=options.WholeRange(min=0), default=0, help="Of multistart.")
    trace: bool = option(is_flag=True, help="Print the steps of the method too.")


@click.command(short_help="Best geometry for a gravity direction.")
@click.argument("recipe", type=Named())
@asks(Asked)
def optimum(recipe: str, asked: Asked) -> None:
    """Print the best geometry of RECIPE for a gravity direction.

    With +- how far each parameter may be off, and the interval in which it may lie, the others
    kept.  Exit code 3 where the robot stands in no geometry that was tried; what is printed then
    is the one closest to standing.

    \b
    $ lutgen optimum maps/paper_two.toml --limit 0.05
    paper_two, search: stands, sdg 0.000485608, 150 evaluations
    """
    from lutgen.search import optimum as run

    robot = open_recipe(recipe, asked.allow_python)
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
    kept = [low == high for low, high in box]
    report = optimum_report(robot, found, kept)
    if asked.trace:
        report["trace"] = _steps(robot, found)
    text = optimum_lines(robot, found, kept, asked.trace)
    show(report, text, asked.as_json, found.standing, TIPS)


def _box(robot: "Recipe", asked: Asked) -> list[tuple[float, float]]:
    """Return the bounds (rad, length) of all parameters; those of a kept one are equal."""
    box = {
        name: (value, value)
        for name, value in options.named_values(robot, asked.assignments).items()
    }
    names = [p.name for p in robot.parameters]
    for name, low, high in asked.bounds:
        options.require_known(robot.source, names, name, f"--bounds {name}={low:g}:{high:g}")
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
    given = dict(asked.assignments)
    names = [p.name for p in robot.parameters]
    for name, value in asked.start:
        options.require_known(robot.source, names, name, f"--start {name}={value:g}")
        if name in given:
            raise InputError(
                f"parameter {name} has a value already (got --start {name}={value:g} as well); "
                "give it one -p or one --start"
            )
        given[name] = value
    begin = [
        p.stored(given[p.name]) if p.name in given else (low + high) / 2.0
        for p, (low, high) in zip(robot.parameters, box, strict=True)
    ]
    return begin if asked.start else None


def _entry(key: str, values: "float | NDArray[np.float64]", unit: str) -> dict[str, Any]:
    """Return one entry with its unit in the key: deg and rad are said, lengths are not."""
    shown = to_display(values, unit)
    name = f"{key}_{unit}" if unit in ("deg", "rad") else key
    return {name: number(shown) if isinstance(shown, float) else [*map(number, shown)]}


def _text(value: float, unit: str) -> str:
    """Return a number (rad, length) as text; a dash where it is not finite."""
    return cell(number(to_display(value, unit)), unit=unit_text(unit))


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
                p.name: _entry("value", value, p.display_unit)
                for p, value in zip(robot.parameters, step.params, strict=True)
            },
            **_entry("value", step.value, unit),
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
        **_entry("value", found.value, unit),
        "evaluations": found.evaluations,
        "parameters": {
            p.name: {
                **_entry("value", found.params[i], p.display_unit),
                **_entry("delta", found.delta[i], p.display_unit),
                **_entry("acceptable", found.acceptable[i], p.display_unit),
                "kept": kept[i],
            }
            for i, p in enumerate(robot.parameters)
        },
        # Where the method itself ends: the paper's search may have seen better before.
        "last": last,
    }


def optimum_lines(
    robot: "Recipe", found: "Optimum", kept: Sequence[bool], traced: bool
) -> Iterator[str]:
    """Return the report as text."""
    unit = _unit(robot, found)

    def shape(params: "NDArray[np.float64]") -> list[str]:
        return [
            _text(value, p.display_unit) for p, value in zip(robot.parameters, params, strict=True)
        ]

    def node(step: int) -> str:
        at = found.trace[step]
        names = (p.name for p in robot.parameters)
        where = ", ".join(map(" ".join, zip(names, shape(at.params), strict=True)))
        value = _text(at.value, unit)
        return f"{where}: {'tips over' if value == '-' else value}"

    verdict = (
        f"stands, {found.objective} {_text(found.value, unit)}"
        if found.standing
        else "tips over in every geometry tried, least in this one"
    )
    yield f"{robot.name}, {found.method}: {verdict}, {found.evaluations} evaluations"
    best = shape(found.params)
    width = max(len(p.name) for p in robot.parameters)
    for i, p in enumerate(robot.parameters):
        low, high = p.shown(found.acceptable[i])
        more = ""
        if kept[i]:
            more = "  kept"
        elif math.isfinite(low):
            delta = _text(found.delta[i], p.display_unit)
            more = f"  +- {delta}  acceptable {low:.6g} to {high:.6g}"
        yield f"  {p.name:<{width}}  {best[i]}{more}"
    if shape(found.trace[-1].params) != best:
        yield f"last node, worse than the best seen: {node(-1)}"
    for i, step in enumerate(found.trace if traced else ()):
        yield f"step {i + 1}, {step.evaluations} evaluations: {node(i)}"
