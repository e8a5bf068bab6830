"""Strict reading of TOML tables: every key is known, typed and in range, or refused.

A ``Table`` remembers its file and key, so that each message names the place, what is
wrong, the value received and the way out.  It does not know what a robot is.
"""

import math
import os
import re
import tomllib
from collections.abc import Container, Iterable, Mapping
from pathlib import Path
from typing import Any, NoReturn

from lutgen import bounds
from lutgen.errors import RecipeError, suggestion, unreadable

# What a map file begins with, and no text does.
HDF5 = b"\x89HDF\r\n\x1a\n"
# Values are quoted in messages up to this many characters.
_LONGEST = 60


def fail(source: str, key: str, what: str, got: object, way_out: str) -> NoReturn:
    """Raise the RecipeError FILE: key KEY: WHAT (got GOT); WAY OUT.."""
    shown = got if isinstance(got, str) and got.startswith("nothing") else _repr(got)
    if len(shown) > _LONGEST:
        shown = shown[: _LONGEST - 3] + "..."
    raise RecipeError(f"{source}: key `{key}`: {what} (got {shown}); {way_out}.")


def _repr(value: object) -> str:
    """Return a value as written; of a number that Python refuses to print, its length."""
    try:
        return repr(value)
    except ValueError:
        return bounds.shown(value) if isinstance(value, int) else f"a {type(value).__name__}"


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file, which must be UTF-8 and no longer than a recipe may be."""
    source = os.fspath(path)
    most = bounds.RECIPE_BYTES
    try:
        with Path(path).open("rb") as file:
            raw = file.read(most.most + 1)
    except OSError as error:
        raise unreadable(source, error) from error
    if len(raw) > most.most:
        raise RecipeError(
            f"{source}: is too long (got more than {most.most:,} {most.what}); is it a recipe?"
        )
    if raw.startswith(HDF5):
        raise RecipeError(
            f"{source}: is no text (got HDF5, as maps are); the recipe inside a map is "
            "`lutgen.load_map(path).recipe`."
        )
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise RecipeError(
            f"{source}: line {line} is not UTF-8 (got byte 0x{raw[error.start]:02x}); "
            "save the file as UTF-8."
        ) from None


def parse_table(text: str, source: str, known: Iterable[str]) -> "Table":
    """Return the table that a whole TOML file is."""
    _check_numbers_and_keys(text, source)
    try:
        values = tomllib.loads(text)
    except RecursionError:
        raise _too_deep(source) from None
    except tomllib.TOMLDecodeError as error:
        last = f"at line {text.count(chr(10)) + 1}, the end of the file"
        got = str(error).replace("at end of document", last)
        raise RecipeError(f"{source}: is not TOML (got {got}); correct that line.") from None
    _check_depth(values, source)
    return Table(values, source, "", known)


def _check_numbers_and_keys(text: str, source: str) -> None:
    """Refuse what a reader of TOML takes long for, or nobody can print."""
    digits, dots = bounds.DIGITS, bounds.KEY_DOTS
    for run in re.finditer(rf"[0-9_]{{{digits.most + 1},}}", text):
        line = text.count("\n", 0, run.start()) + 1
        raise RecipeError(
            f"{source}: line {line}: a number is too long (got {len(run[0]):,}, at most "
            f"{digits.most:,} {digits.what}); round it."
        )
    # Whatever ends a key parts these runs; a reader looks at each key once for each of its dots.
    for run in re.finditer(rf"[^\n,=\[\]{{}}#]{{{dots.most + 1},}}", text):
        if run[0].count(".") > dots.most:
            line = text.count("\n", 0, run.start()) + 1
            raise RecipeError(
                f"{source}: line {line}: a key is nested too deep (got {run[0].count('.'):,}, at "
                f"most {dots.most:,} {dots.what}); recipes have three."
            )


def _check_depth(values: Mapping[str, Any], source: str) -> None:
    """Refuse tables and lists too deep within each other: to print one takes as many calls."""
    layer: list[Any] = [values]
    for _ in range(bounds.NESTING.most):
        layer = [
            inner
            for outer in layer
            for inner in (outer.values() if isinstance(outer, dict) else outer)
            if isinstance(inner, dict | list)
        ]
        if not layer:
            return
    raise _too_deep(source)


def _too_deep(source: str) -> RecipeError:
    most = bounds.NESTING
    return RecipeError(
        f"{source}: is nested too deep (got more than {most.most} {most.what}); recipes have "
        "fewer than ten."
    )


class Table:
    """One TOML table together with its place in the file.

    `values` are what the TOML reader gave, `source` is the file's name and `key` the full key of
    the table, "" for the whole file; the table may hold `known` keys only.
    """

    def __init__(
        self, values: Mapping[str, Any], source: str, key: str, known: Iterable[str]
    ) -> None:
        self.values = values
        self.source = source
        self.key = key
        known = list(known)
        for name, value in values.items():
            if name not in known:
                self.fail(name, "is not a known key", value, suggestion(name, known, "use one of"))

    def __contains__(self, name: str) -> bool:
        return name in self.values

    def path(self, name: str) -> str:
        """Return the full key of an entry."""
        if not name:
            return self.key
        return f"{self.key}.{name}" if self.key else name

    def fail(self, name: str, what: str, got: object, way_out: str) -> NoReturn:
        """Refuse an entry with a RecipeError."""
        fail(self.source, self.path(name), what, got, way_out)

    def need(self, name: str, way_out: str) -> Any:
        """Return the raw value of an entry that must be there."""
        if name not in self.values:
            self.fail(name, "is missing", "nothing", way_out)
        return self.values[name]

    def refuse(self, names: Iterable[str], what: str, way_out: str) -> None:
        """Refuse entries that are known but make no sense here."""
        for name in names:
            if name in self.values:
                self.fail(name, what, self.values[name], way_out)

    def string(self, name: str, way_out: str, choices: Iterable[str] | None = None) -> str:
        """Return a non-empty string, one of `choices` if they are given."""
        value = self.need(name, way_out)
        if not isinstance(value, str):
            self.fail(name, "must be a string", value, way_out)
        if choices is not None:
            if value not in choices:
                self.fail(name, "is unknown", value, suggestion(value, choices, "use one of"))
        elif not value.strip():
            self.fail(name, "must not be empty", value, way_out)
        return value

    def one_of(self, name: str, way_out: str, choices: Iterable[str], what: str) -> str:
        """Return one of `choices`; `what` is said of any other string."""
        value = self.string(name, way_out)
        if value not in choices:
            self.fail(name, what, value, suggestion(value, choices, "use one of"))
        return value

    def new_name(self, noun: str, others: Container[str]) -> str:
        """Return the name of a part, which no other may have."""
        name = self.string("name", f"name the {noun}")
        self.refuse_twice(name, others)
        return name

    def refuse_twice(self, name: str, others: Container[str]) -> None:
        """Refuse a name that was given before."""
        if name in others:
            self.fail("name", "is given twice", name, "choose another name")

    def number(self, name: str, way_out: str, default: float | None = None) -> float:
        """Return a finite number; integers count, true and false do not."""
        if default is not None and name not in self.values:
            return default
        return self.as_number(name, self.need(name, way_out), way_out)

    def as_number(self, name: str, value: object, way_out: str) -> float:
        """Return `value`, found at `name`, as a finite float."""
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.fail(name, "must be a number", value, way_out)
        try:
            result = float(value)
        except OverflowError:
            result = math.inf
        if not math.isfinite(result):
            self.fail(name, "must be finite", value, way_out)
        if abs(result) > bounds.MAGNITUDE.most:
            self.fail(name, f"must be at most {bounds.MAGNITUDE.most:.0e}", value, way_out)
        return result

    def integer(self, name: str, way_out: str) -> int:
        """Return an integer; 3.0, true and false do not count."""
        value = self.need(name, way_out)
        if isinstance(value, bool) or not isinstance(value, int):
            self.fail(name, "must be a whole number", value, way_out)
        return value

    def at_most(self, name: str, value: int, bound: bounds.Bound) -> None:
        """Refuse a whole number of an entry above a bound."""
        if value > bound.most:
            what = f"is beyond the limit of {bound.most:,} {bound.what}"
            self.fail(name, what, value, "use fewer")

    def vector(
        self,
        name: str,
        way_out: str,
        default: tuple[float, float, float] | None = None,
    ) -> tuple[float, float, float]:
        """Return three finite numbers."""
        if default is not None and name not in self.values:
            return default
        value = self.need(name, way_out)
        if not isinstance(value, list) or len(value) != 3:
            self.fail(name, "must be a list of three numbers", value, way_out)
        x, y, z = (self.as_number(f"{name}[{i}]", v, way_out) for i, v in enumerate(value, 1))
        return x, y, z

    def unit_vector(self, name: str, way_out: str) -> tuple[float, float, float]:
        """Return the direction of three numbers that are not all zero, with length 1."""
        x, y, z = self.vector(name, way_out)
        length = math.hypot(x, y, z)
        if not 0.0 < length < math.inf:
            self.fail(name, "must have a length above 0", [x, y, z], way_out)
        return x / length, y / length, z / length

    def strings(self, name: str, way_out: str) -> list[str]:
        """Return a list of strings that is not empty."""
        value = self.need(name, way_out)
        if not isinstance(value, list) or not value:
            self.fail(name, "must be a list with at least one name", value, way_out)
        for i, entry in enumerate(value, 1):
            if not isinstance(entry, str):
                self.fail(f"{name}[{i}]", "must be a string", entry, way_out)
        return value

    def table(self, name: str, known: Iterable[str], way_out: str) -> "Table":
        """Return the table below `name`, which must be there."""
        value = self.need(name, way_out)
        if not isinstance(value, dict):
            self.fail(name, "must be a table", value, way_out)
        return Table(value, self.source, self.path(name), known)

    def tables(self, name: str, known: Iterable[str]) -> list["Table"]:
        """Return the tables of an array of tables, numbered from 1; none if absent."""
        value = self.values.get(name, [])
        way_out = f"start each entry with [[{self.path(name)}]]"
        if not isinstance(value, list):
            self.fail(name, "must be an array of tables", value, way_out)
        if len(value) > bounds.ENTRIES.most:
            self.fail(
                name, f"has more than {bounds.ENTRIES.most:,} entries", len(value), "use fewer"
            )
        known = list(known)
        result = []
        for i, entry in enumerate(value, 1):
            if not isinstance(entry, dict):
                self.fail(f"{name}[{i}]", "must be a table", entry, way_out)
            result.append(Table(entry, self.source, self.path(f"{name}[{i}]"), known))
        return result
