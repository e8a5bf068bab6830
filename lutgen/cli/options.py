"""Options that several commands share, and how their texts become numbers."""

import logging
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import click

from lutgen.errors import InputError

if TYPE_CHECKING:
    from lutgen.mapping import StabilityMap
    from lutgen.recipe import Recipe

log = logging.getLogger("lutgen")

allow_python = click.option(
    "--allow-python", is_flag=True, help="Run the code that the recipe names (`python = ...`)."
)
as_json = click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")


def finite_numbers(value: object) -> tuple[float, ...]:
    """Return the numbers of a text such as 0,0,-1; none where one is no finite number."""
    try:
        numbers = tuple(float(part) for part in str(value).split(","))
    except ValueError:
        return ()
    return numbers if all(map(math.isfinite, numbers)) else ()


class Numbers(click.ParamType):  # type: ignore[type-arg]
    """Numbers separated by commas, as many as `name` has parts, such as ``X,Y,Z``.

    `what` they are and an `example` of them are for the message; `nonzero` refuses all zeros.
    """

    def __init__(self, name: str, what: str, example: str, nonzero: bool = False) -> None:
        self.name = name
        self.what, self.example, self.nonzero = what, example, nonzero

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Return the numbers."""
        if isinstance(value, tuple):
            return value
        numbers = finite_numbers(value)
        if len(numbers) != self.name.count(",") + 1 or (self.nonzero and not any(numbers)):
            self.fail(f"{value!r} is no {self.what}; write {self.example}", param, ctx)
        return numbers


class Assignment(click.ParamType):  # type: ignore[type-arg]
    """A geometry parameter and its value, name=number."""

    name = "NAME=VALUE"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, float]:
        """Return (name, value)."""
        if isinstance(value, tuple):
            return value
        name, equals, number = str(value).partition("=")
        try:
            result = float(number)
        except ValueError:
            result = math.nan
        if not (name and equals and math.isfinite(result)):
            self.fail(f"{value!r} is no assignment; write for example alpha=30", param, ctx)
        return name.strip(), result


gravity = click.option(
    "-g",
    "--gravity",
    type=Numbers("X,Y,Z", "direction", "three numbers such as 0,0,-1", nonzero=True),
    default="0,0,-1",
    show_default=True,
    help="Gravity in the body frame, pointing down (x forward, y left, z up); any length.",
)
acceleration = click.option(
    "-a",
    "--acceleration",
    type=Numbers("AX,AY,AZ", "acceleration", "for example -2,0,0"),
    help="Acceleration of the robot in the body frame, m/s^2: inertia then acts beside gravity. "
    "Leave it out where gravity comes from an accelerometer, which reads both.",
)
convention = click.option(
    "--convention",
    type=click.Choice(("body", "plane")),
    default="body",
    show_default=True,
    help="Whether gravity is fixed in the body, or relative to the plane that the robot stands on.",
)
tilt = click.option(
    "--tilt",
    type=float,
    default=20.0,
    show_default=True,
    help="Of the ground in deg, for the metrics over all headings.",
)
parameters = click.option(
    "-p",
    "--parameter",
    "assignments",
    type=Assignment(),
    multiple=True,
    help="A geometry parameter, in the unit that the recipe gives it; repeat for each.",
)


def parameter_values(recipe: "Recipe", assignments: Sequence[tuple[str, float]]) -> list[float]:
    """Return the internal values (rad, length) of all parameters, in recipe order."""
    units = {p.name: p.display_unit for p in recipe.parameters}
    return internal_values(recipe.source, units, assignments)


def internal_values(
    source: str, units: Mapping[str, str], assignments: Sequence[tuple[str, float]]
) -> list[float]:
    """Return the values (rad, length) of parameters with these display units, in their order."""
    given = _named(source, list(units), assignments)
    missing = [name for name in units if name not in given]
    if missing:
        raise InputError(
            f"{source}: parameter {missing[0]} has no value; give each of "
            f"{', '.join(f'-p {name}=…' for name in units)}"
        )
    return [
        math.radians(given[name]) if unit == "deg" else given[name] for name, unit in units.items()
    ]


def named_values(recipe: "Recipe", assignments: Sequence[tuple[str, float]]) -> dict[str, float]:
    """Return the assigned values by name, in display units; refuse unknown and repeated names."""
    return _named(recipe.source, [p.name for p in recipe.parameters], assignments)


def posture_values(recipe: "Recipe", assignments: Sequence[tuple[str, float]]) -> list[float]:
    """Return the internal values of all parameters: the middle of the range where none is given.

    A value outside the recipe's range is used as it is, and a warning says so.
    """
    from lutgen.recipe import to_internal

    given = named_values(recipe, assignments)
    values = []
    for p in recipe.parameters:
        value = (p.minimum + p.maximum) / 2.0
        if p.name in given:
            value = to_internal(given[p.name], p.display_unit)
            if not p.minimum <= value <= p.maximum:
                log.warning("parameter %s is outside the recipe's range: used as it is", p.name)
        values.append(value)
    return values


def _named(
    source: str, known: Sequence[str], assignments: Sequence[tuple[str, float]]
) -> dict[str, float]:
    given: dict[str, float] = {}
    for name, value in assignments:
        if name not in known:
            raise InputError(
                f"{source}: there is no parameter {name!r} (got -p {name}={value:g}); "
                f"it has {', '.join(known) or 'none'}"
            )
        if name in given:
            raise InputError(f"parameter {name} is given twice (got {given[name]:g} and {value:g})")
        given[name] = value
    return given


def open_source(path: str, allow_python: bool = False) -> "Recipe | StabilityMap":
    """Open a recipe (.toml) or a map (anything else)."""
    if path.endswith(".toml"):
        from lutgen.recipe import load_recipe

        return load_recipe(path, allow_python=allow_python)
    from lutgen.mapping import load_map

    return load_map(path)


def file_size(count: float) -> str:
    """Return a number of bytes as people read it."""
    unit = "B"
    for larger in ("KiB", "MiB", "GiB"):
        if count < 1024.0:
            break
        count, unit = count / 1024.0, larger
    return f"{count:.0f} B" if unit == "B" else f"{count:.1f} {unit}"
