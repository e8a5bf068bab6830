"""Inputs of commands: options as a dataclass, texts as numbers, and a source to work on."""

import contextlib
import functools
import inspect
import logging
import math
from collections.abc import Callable, Iterable
from dataclasses import Field, dataclass, field, fields
from pathlib import Path
from types import NoneType
from typing import Any, Literal, get_args, get_origin

import click

from lutgen.cli.lazy import Floats, maps, np, robots
from lutgen.errors import InputError, reject

log = logging.getLogger("lutgen")

# The largest number of a recipe, too.
LARGEST = 1e12
LIMITS = ("low", "high", "above")
# The end of a file name that means a map; a file of another name says so by its first bytes.
MAPS = (".h5", ".hdf5", ".nc")


def finite_numbers(value: object, separator: str = ",") -> tuple[float, ...]:
    """Return the numbers of a text such as 0,0,-1; none where one is no number or beyond 1e12."""
    text = str(value)
    try:
        # Python reads the digits of every script.
        numbers = tuple(map(float, text.split(separator))) if text.isascii() else ()
    except ValueError:
        return ()
    return numbers if all(abs(number) <= LARGEST for number in numbers) else ()


class Number(click.ParamType):  # type: ignore[type-arg]
    """A number in plain digits, of a kind and between limits that commands can compute with."""

    def __init__(
        self, kind: type, low: float = -LARGEST, high: float = LARGEST, above: float = -math.inf
    ) -> None:
        self.kind, self.low, self.high, self.above = kind, low, high, above
        self.name = "integer" if kind is int else "float"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the number."""
        numbers = finite_numbers(value)
        if len(numbers) != 1 or self.kind(numbers[0]) != numbers[0]:
            kind = "whole number" if self.kind is int else "number"
            self.fail(f"{value!r} is no {kind} of plain digits up to 1e12", param, ctx)
        if not (self.low <= numbers[0] <= self.high and numbers[0] > self.above):
            ends = (("above", self.above), ("at least", self.low), ("at most", self.high))
            words = [f"{words} {end:,.0f}" for words, end in ends if abs(end) < LARGEST]
            self.fail(f"{value} is not in the range: {' and '.join(words)}", param, ctx)
        return self.kind(numbers[0])


class Numbers(click.ParamType):  # type: ignore[type-arg]
    """Numbers such as ``X,Y,Z``, ``NAME=VALUE`` or ``NAME=LOW:HIGH``, as many as `name` has.

    `what` they are and an `example` are for the message; `nonzero` refuses all zeros.
    """

    def __init__(self, name: str, what: str, example: str, nonzero: bool = False) -> None:
        self.name, self.what, self.example, self.nonzero = name, what, example, nonzero

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Any, ...]:
        """Return the numbers, after the name where there is one."""
        if isinstance(value, tuple):
            return value
        named, separator = "=" in self.name, ":" if ":" in self.name else ","
        name, _, text = str(value).partition("=") if named else ("", "", value)
        numbers = finite_numbers(text, separator)
        right = len(numbers) == self.name.count(separator) + 1 and bool(name.strip()) is named
        if not right or (self.nonzero and not any(numbers)):
            way_out = f"write {self.example}, of numbers up to 1e12"
            self.fail(f"{value!r} is no {self.what}; {way_out}", param, ctx)
        return (name.strip(), *numbers) if named else numbers


class Named(click.Path):
    """A path, which an empty text is not: Python would take that for the folder it runs in."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the path."""
        if not str(value):
            self.fail("names nothing (got ''); give a path", param, ctx)
        return super().convert(value, param, ctx)


# Several numbers, by the annotation of their field.
NUMBERS: dict[Any, Numbers] = {
    tuple[float, float, float]: Numbers(
        "X,Y,Z", "direction", "three numbers such as 0,0,-1", nonzero=True
    ),
    tuple[str, float]: Numbers("NAME=VALUE", "assignment", "for example alpha=30"),
    tuple[str, float, float]: Numbers("NAME=LOW:HIGH", "range", "for example alpha=20:40"),
}


def option(help: str = "", flags: str = "", **settings: Any) -> Any:
    """Return a field of a dataclass that `command` turns into an option of the command line.

    It is called like the field where no long flag is given.  Unless `settings`, those of
    `click.Option`, have another type, it is of the kind of its annotation: a flag, a number with
    the limits `low`, `high` and `above` of `Number`, some of `NUMBERS`, one of the words of a
    `Literal`, a text, or as many of them as there are.
    """
    return field(metadata={"option": (flags.split(), {"help": help or None, **settings})})


def _parameter(part: Field[Any]) -> click.Option:
    """Return the option of a field; the help shows each default that is given."""
    flags, given = part.metadata["option"]
    if not any(flag.startswith("--") for flag in flags):
        flags = [*flags, f"--{part.name.replace('_', '-')}"]
    parts = get_args(part.type)
    multiple = Ellipsis in parts
    kind = parts[0] if multiple or NoneType in parts else part.type
    settings = {"show_default": "default" in given, "type": NUMBERS.get(kind), **given}
    if kind is bool:
        settings["is_flag"] = True
    elif get_origin(kind) is Literal:
        settings["type"] = click.Choice(parts)
    elif kind in (int, float):
        limits = {key: settings.pop(key) for key in LIMITS if key in settings}
        settings["type"] = Number(kind, **limits)
    return click.Option([part.name, *flags], multiple=multiple, **settings)


def command(
    source: str | click.Argument | None, options: type
) -> Callable[[Callable[..., None]], click.Command]:
    """Return a decorator that makes a command of a function of a source and of options.

    A source called recipe is opened.  Its help begins with the example, which ends its docstring;
    in the list of commands it has the first line.  The options come in the order of the fields,
    those that are inherited last, and then --json, which `output.show` looks for.
    """
    if isinstance(source, str):
        source = click.Argument([source], type=Named())
    sources = [] if source is None else [source]

    def decorate(run: Callable[..., None]) -> click.Command:
        def callback(**given: Any) -> None:
            first = [given.pop(str(one.name)) for one in sources]
            if [one.name for one in sources] == ["recipe"]:
                first = [open_recipe(first[0], given["allow_python"])]
            del given["as_json"]
            run(*first, options(**given))

        own = options.__annotations__
        parts = sorted(fields(options), key=lambda part: part.name not in own)
        as_json = click.Option(
            ["as_json", "--json"], is_flag=True, help="Print the result as JSON."
        )
        text, _, example = inspect.cleandoc(run.__doc__ or "").rpartition("\n\n\b\n")
        return click.Command(
            run.__name__.rstrip("_"),
            callback=callback,
            params=[*sources, *map(_parameter, parts), as_json],
            help=f"\b\n{example}\n\n{text}",
            short_help=text.partition("\n")[0],
        )

    return decorate


Assignments = tuple[tuple[str, float], ...]
force = functools.partial(option, "Replace what is there also where lutgen did not make it.")
gravity = functools.partial(
    option,
    "Gravity in the body frame, pointing down (x forward, y left, z up); any length.",
    "-g",
    default="0,0,-1",
)
parameters = functools.partial(
    option,
    "A geometry parameter, in the unit that the recipe gives it; repeat for each.  One that "
    "is left out is at the recipe's `home`, then in the middle of its range.",
    "-p --parameter",
)
method = functools.partial(
    option, type=click.Choice(("map", "nelder-mead", "search", "multistart")), default="search"
)
file = functools.partial(option, type=Named())
output = functools.partial(file, flags="-o")


def convention(
    default: str = "body",
    other: str = "plane",
    help: str = "Gravity is fixed in the body, or relative to the plane that the robot stands on.",
) -> Any:
    """Return the option that says to what gravity is fixed; the help lists the default first."""
    return option(help, type=click.Choice((default, other)), default=default)


@dataclass(frozen=True)
class NoOptions:
    """The options of a command without its own."""


@dataclass(frozen=True)
class RecipeOptions:
    """Options of every command that reports on a recipe."""

    allow_python: bool = option("Run the code that the recipe names (`python = ...`).")


@dataclass(frozen=True)
class FigureOptions:
    """Options of every command that draws."""

    size: str | None = option(
        "Size of the figure, mm.  [default: 203 wide]", metavar="WIDTH[xHEIGHT]"
    )
    # Those of `lutgen.plot`, which takes a second to import.
    style: Literal["journal", "dark"] = option("How the figure looks.", default="journal")
    force: bool = force()


def open_source(path: str, allow_python: bool = False) -> "robots.Recipe | maps.StabilityMap":
    """Open a recipe or a map, whichever `path` names."""
    is_map = path.endswith(MAPS)
    # The reader says why a file cannot be opened.
    with contextlib.suppress(OSError), Path(path).open("rb") as file:
        is_map = is_map or file.read(len(robots.HDF5)) == robots.HDF5
    return maps.load_map(path) if is_map else robots.load_recipe(path, allow_python=allow_python)


def open_recipe(path: str, allow_python: bool = False) -> "robots.Recipe":
    """Open a recipe, also the one inside a map; its code is looked for beside the map."""
    opened = open_source(path, allow_python)
    if isinstance(opened, robots.Recipe):
        return opened
    recipe = opened.recipe
    if recipe.python is None:
        return recipe
    # A map leaves the code alone, and so has a robot without contacts.
    return robots.parse_recipe(recipe.text, recipe.source, allow_python, urdf=recipe.urdf)


def named_values(
    recipe: "robots.Recipe", given: Iterable[tuple[Any, ...]], flag: str = "-p"
) -> dict[str, Any]:
    """Return what an option gives parameters by name, a number each or low and high, as written."""
    known = [p.name for p in recipe.parameters]
    found: dict[str, Any] = {}
    for name, *numbers in given:
        got = f"{flag} {name}={':'.join(f'{number:g}' for number in numbers)}"
        if name not in known:
            way_out = f"it has {', '.join(known) or 'none'}"
            reject(recipe.source, f"there is no parameter {name!r}", got, way_out, InputError)
        if name in found:
            what = f"parameter {name} is given twice"
            reject(recipe.source, what, got, "leave one out", InputError)
        found[name] = numbers[0] if len(numbers) == 1 else np.array(numbers)
    return found


def stored_values(
    recipe: "robots.Recipe", given: Iterable[tuple[Any, ...]], flag: str = "-p"
) -> dict[str, Any]:
    """Return the same in rad or the recipe's length."""
    found = named_values(recipe, given, flag)
    return {p.name: p.stored(found[p.name]) for p in recipe.parameters if p.name in found}


def all_values(recipe: "robots.Recipe", given: Assignments) -> "Floats":
    """Return all parameters (rad, length): those not given at `home`, or in mid range."""
    found = dict(zip((p.name for p in recipe.parameters), recipe.home_params, strict=True))
    return np.array([*(found | stored_values(recipe, given)).values()], np.float64)


def posture_values(recipe: "robots.Recipe", given: Assignments) -> "Floats":
    """Return the same, within the limits; InputError is raised for a value beyond them."""
    params = all_values(recipe, given)
    robots.within_limits(recipe, [params])
    return params


def posture_source(recipe: "robots.Recipe", given: Assignments) -> str:
    """Return where the posture comes from that `posture_values` gives; "" if all of it is given."""
    names = [p.name for p in recipe.parameters]
    rest = [name for name in names if name not in dict(given)]
    found: dict[str, list[str]] = {}
    for name in sorted(rest, key=lambda name: name not in recipe.home):
        words = "home" if name in recipe.home else "middle of the range"
        found.setdefault(words, []).append(name)
    if len(found) == 1 and rest == names:
        return next(iter(found))
    return "; ".join(f"{words}: {', '.join(part)}" for words, part in found.items())
