"""Options that several commands share, and how their texts become numbers."""

import functools
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import click
from click.types import FloatParamType, IntParamType

from lutgen.errors import InputError
from lutgen.parts import to_internal

if TYPE_CHECKING:
    from lutgen.recipe import Recipe

log = logging.getLogger("lutgen")


# What the largest number of a recipe is, too.
LARGEST = 1e12


def finite_numbers(value: object) -> tuple[float, ...]:
    """Return the numbers of a text such as 0,0,-1; none where one is no number or beyond 1e12."""
    text = str(value)
    try:
        # Python reads the digits of every script.
        numbers = tuple(float(part) for part in text.split(",")) if text.isascii() else ()
    except ValueError:
        return ()
    return numbers if all(abs(number) <= LARGEST for number in numbers) else ()


class _Plain(click.ParamType):  # type: ignore[type-arg]
    """A number in plain digits and of a size that commands can compute with."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number."""
        number = super().convert(value, param, ctx)
        if isinstance(value, str) and not finite_numbers(value):
            self.fail(f"{value!r} is no number of plain digits up to 1e12", param, ctx)
        return number


class _Real(_Plain, FloatParamType):
    pass


class _Whole(_Plain, IntParamType):
    pass


class WholeRange(_Plain, click.IntRange):
    """A whole number within limits."""


KINDS: dict[Any, Any] = {float: _Real(), int: _Whole()}


class Named(click.Path):
    """A path, which an empty text is not: Python would take that for the folder it runs in."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path."""
        if not str(value):
            self.fail("names nothing (got ''); give a path", param, ctx)
        return super().convert(value, param, ctx)


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
            way_out = f"write {self.example}, of numbers up to 1e12"
            self.fail(f"{value!r} is no {self.what}; {way_out}", param, ctx)
        return numbers


class Assignment(click.ParamType):  # type: ignore[type-arg]
    """A geometry parameter and one number for it, name=number, or as many between colons.

    `name`, `what` and the `example` are for the help and the message.
    """

    def __init__(
        self, name: str = "NAME=VALUE", what: str = "assignment", example: str = "alpha=30"
    ) -> None:
        self.name, self.what, self.example = name, what, example

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Any, ...]:
        """Return (name, value), or (name, low, high)."""
        if isinstance(value, tuple):
            return value
        name, equals, rest = str(value).partition("=")
        numbers = finite_numbers(rest.replace(":", ",")) if "," not in rest else ()
        if not (name and equals and len(numbers) == self.name.count(":") + 1):
            way_out = f"write for example {self.example}, of numbers up to 1e12"
            self.fail(f"{value!r} is no {self.what}; {way_out}", param, ctx)
        return (name.strip(), *numbers)


def option(*flags: str, **settings: Any) -> Any:
    """Return a field of a dataclass that `asks` turns into an option of the command line.

    It is called like the field where no long flag is given.  `settings` are those of
    `click.option`; the help shows each default that is given.
    """
    settings.setdefault("show_default", "default" in settings)
    kind = settings.get("type", type(settings.get("default")))
    if kind in KINDS:
        settings["type"] = KINDS[kind]
    return field(metadata={"option": (flags, settings)})


def asks(kind: type) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of a dataclass, and one value of it as `asked`.

    They come in the order of the fields, those that the dataclass inherits last.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(command)
        def run(*args: Any, **given: Any) -> None:
            asked = kind(**{part.name: given.pop(part.name) for part in parts})
            command(*args, **given, asked=asked)

        parts = sorted(fields(kind), key=lambda part: part.name not in kind.__annotations__)
        for part in reversed(parts):
            flags, settings = part.metadata["option"]
            if not any(flag.startswith("--") for flag in flags):
                flags = (*flags, f"--{part.name.replace('_', '-')}")
            run = click.option(part.name, *flags, **settings)(run)
        return run

    return decorate


Assignments = tuple[tuple[str, float], ...]
allow_python = functools.partial(
    option, is_flag=True, help="Run the code that the recipe names (`python = ...`)."
)
force = functools.partial(
    option, is_flag=True, help="Replace what is there also where lutgen did not make it."
)
as_json = functools.partial(option, "--json", is_flag=True, help="Print the result as JSON.")
gravity = functools.partial(
    option,
    "-g",
    type=Numbers("X,Y,Z", "direction", "three numbers such as 0,0,-1", nonzero=True),
    default="0,0,-1",
    help="Gravity in the body frame, pointing down (x forward, y left, z up); any length.",
)
parameters = functools.partial(
    option,
    "-p",
    "--parameter",
    type=Assignment(),
    multiple=True,
    help="A geometry parameter, in the unit that the recipe gives it; repeat for each.",
)
METHODS = ("map", "nelder-mead", "search", "multistart")
method = functools.partial(option, type=click.Choice(METHODS), default="search")
output = functools.partial(option, "-o", type=Named())
size = functools.partial(
    option, metavar="WIDTH[xHEIGHT]", help="Of the figure in mm.  [default: one column, 89 wide]"
)
# Those of `lutgen.plot`, which takes a second to import.
STYLES = ("journal", "slides", "dark")
style = functools.partial(
    option, type=click.Choice(STYLES), default="journal", help="How the figure looks."
)
tilt = functools.partial(
    option, default=20.0, help="Of the ground in deg, for the metrics over all headings."
)


def convention(
    default: str = "body",
    other: str = "plane",
    help: str = "Whether gravity is fixed in the body, or relative to the plane that the robot "
    "stands on.",
) -> Any:
    """Return the option that says to what gravity is fixed; the help lists the default first."""
    return option(type=click.Choice((default, other)), default=default, help=help)


@dataclass(frozen=True)
class RecipeOptions:
    """What all commands are asked that report on a recipe."""

    allow_python: bool = allow_python()
    as_json: bool = as_json()


def internal_values(source: str, units: Mapping[str, str], assignments: Assignments) -> list[float]:
    """Return the values (rad, length) of parameters with these display units, in their order."""
    given = _named(source, list(units), assignments)
    missing = [name for name in units if name not in given]
    if missing:
        raise InputError(
            f"{source}: parameter {missing[0]} has no value; give each of "
            f"{', '.join(f'-p {name}=…' for name in units)}"
        )
    return [to_internal(given[name], unit) for name, unit in units.items()]


def named_values(recipe: "Recipe", assignments: Assignments) -> dict[str, float]:
    """Return the assigned values by name, in display units; refuse unknown and repeated names."""
    return _named(recipe.source, [p.name for p in recipe.parameters], assignments)


def posture_values(recipe: "Recipe", assignments: Assignments) -> list[float]:
    """Return the internal values of all parameters: `home` or the middle where none is given.

    A value beyond its limits raises InputError.
    """
    given = named_values(recipe, assignments)
    values = [
        p.stored(given[p.name]) if p.name in given else value
        for p, value in zip(recipe.parameters, recipe.home_params, strict=True)
    ]
    for p, value in zip(recipe.parameters, values, strict=True):
        if not p.has(value):
            low, high = p.shown(p.minimum), p.shown(p.maximum)
            raise InputError(
                f"{recipe.source}: parameter {p.name} must lie in {low:g} to {high:g} "
                f"{p.display_unit} (got -p {p.name}={p.shown(value):g}); the recipe has its limits."
            )
    return values


def posture_source(recipe: "Recipe", assignments: Assignments) -> str:
    """Return where the posture comes from that `posture_values` gives; "" if all of it is given."""
    given = {name for name, _ in assignments}
    rest = [p.name for p in recipe.parameters if p.name not in given]
    home = [name for name in rest if name in recipe.home]
    middle = [name for name in rest if name not in recipe.home]
    if not home or not middle:
        alone = "home" if home else "middle of the range" if middle else ""
        return (
            alone
            if len(rest) == len(recipe.parameters)
            else alone and f"{alone}: {', '.join(rest)}"
        )
    return f"home: {', '.join(home)}; middle of the range: {', '.join(middle)}"


def _named(source: str, known: Sequence[str], assignments: Assignments) -> dict[str, float]:
    given: dict[str, float] = {}
    for name, value in assignments:
        require_known(source, known, name, f"-p {name}={value:g}")
        if name in given:
            raise InputError(f"parameter {name} is given twice (got {given[name]:g} and {value:g})")
        given[name] = value
    return given


def require_known(source: str, known: Sequence[str], name: str, got: str) -> None:
    """Refuse the name of a parameter that a robot does not have; `got` is the option with it."""
    if name not in known:
        raise InputError(
            f"{source}: there is no parameter {name!r} (got {got}); it has "
            f"{', '.join(known) or 'none'}"
        )


def check_outputs(force: bool, *paths: str | None) -> None:
    """Refuse, before the work, to write figures and films where lutgen made nothing."""
    from lutgen.files import check_target

    for path in paths:
        if path is not None:
            check_target(path, force)


def file_size(count: float) -> str:
    """Return a number of bytes as people read it."""
    unit = "B"
    for larger in ("KiB", "MiB", "GiB"):
        if count < 1024.0:
            break
        count, unit = count / 1024.0, larger
    return f"{count:.0f} B" if unit == "B" else f"{count:.1f} {unit}"
