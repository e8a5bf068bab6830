"""Text into the models of `schema`, every fault at once in a sentence; their JSON Schema."""

import json
import os
import re
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NoReturn, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from lutgen import bounds
from lutgen.errors import LutgenError, RecipeError, readable, reject, suggestion
from lutgen.recipe.schema import PATTERNS, File

Model = TypeVar("Model", bound=BaseModel)

# A map file begins with this, and no text does.
HDF5 = b"\x89HDF\r\n\x1a\n"
NOTHING = "nothing"
# Characters of a value, and faults of a file, that a message has.
_LONGEST, _MOST = 60, 10
# The words for a kind of fault, with the numbers of its context.
_WHAT = {
    "missing": "is missing",
    "extra_forbidden": "is not a known key",
    "string_type": "must be a string",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "list_type": "must be a list",
    "dict_type": "must be a table",
    "model_type": "must be a table",
    "finite_number": "must be finite",
    "literal_error": "is unknown",
    "greater_than": "must be above {gt}",
    "greater_than_equal": "must be {ge} or more",
    "less_than": "must be below {lt}",
    "less_than_equal": "must be {le} or less",
    "too_short": "needs {min_length} or more entries",
    "too_long": "takes at most {max_length} entries",
}


@dataclass(frozen=True)
class Fault:
    """A fault of a key: what is wrong, the value that it has, and the way out."""

    key: str
    what: str
    got: object
    way_out: str

    def __str__(self) -> str:
        text = f"key `{self.key}`: {self.what} (got {_shown(self.got)}); {self.way_out}."
        return readable(text).replace("\n", "\\n")


def _shown(value: object) -> str:
    """Return a value as Python has it, cut short; one that it refuses to print by its type."""
    try:
        text = NOTHING if value is NOTHING else repr(value)
    except (ValueError, RecursionError):
        text = bounds.shown(value) if isinstance(value, int) else f"a {type(value).__name__}"
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def refuse(source: str, faults: Iterable[Fault]) -> None:
    """Raise a RecipeError with a sentence for each fault, if there are any."""
    found = [f"{source}: {fault}" for fault in faults]
    if len(found) > _MOST:
        found[_MOST:] = [f"{source}: and {len(found) - _MOST} more faults."]
    if found:
        raise RecipeError("\n".join(found))


def fail(source: str, key: str, what: str, got: object, way_out: str) -> NoReturn:
    """Raise a RecipeError of one fault."""
    raise RecipeError(f"{source}: {Fault(key, what, got, way_out)}")


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file, which must be UTF-8 and no longer than a recipe may be."""
    source = os.fspath(path)
    raw = bounds.read(source, bounds.RECIPE_BYTES)
    if raw.startswith(HDF5):
        what, way_out = "is no text", "the recipe inside a map is `lutgen.load_map(path).recipe`"
        reject(source, what, "HDF5, as maps are", way_out)
    return utf8(raw, source)


def utf8(raw: bytes, source: str, kind: type[LutgenError] = RecipeError) -> str:
    """Return bytes as text, without a byte order mark; the error has the line of a fault."""
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        what = f"line {line} is not UTF-8"
        reject(source, what, f"byte 0x{raw[error.start]:02x}", "save the file as UTF-8", kind)


def read_tables(text: str, source: str, model: type[Model]) -> Model:
    """Return a TOML text as a model; RecipeError has every fault of its keys."""
    _refuse_long_keys(text, source)
    try:
        values = tomllib.loads(text)
    except RecursionError:
        what = "is nested too deep"
        reject(source, what, "more levels than can be read", "recipes have fewer than ten")
    except ValueError as error:
        # Also of a number with more digits than Python reads.
        last = f"at line {text.count(chr(10)) + 1}, the end of the file"
        got = str(error).replace("at end of document", last)
        raise RecipeError(f"{source}: is not TOML (got {got}); correct that line.") from None
    try:
        return model.model_validate(values)
    except ValidationError as error:
        found = error.errors(include_url=False)
        found.sort(key=lambda one: one["type"] != "extra_forbidden")
        refuse(source, [_fault(model, one) for one in found])
        raise


def _refuse_long_keys(text: str, source: str) -> None:
    """Refuse keys of very many parts: a reader looks at each once for each of its dots."""
    dots = bounds.KEY_DOTS
    # Each character that ends a key parts these runs.
    for run in re.finditer(rf"[^\n,=\[\]{{}}#]{{{dots.most + 1},}}", text):
        if run[0].count(".") > dots.most:
            line = text.count("\n", 0, run.start()) + 1
            what = f"line {line}: a key is nested too deep"
            got = f"{run[0].count('.'):,}, at most {dots.most:,} {dots.what}"
            reject(source, what, got, "recipes have three")


def path_of(parts: Sequence[int | str]) -> str:
    """Return the full key of a place; entries of arrays count from 1."""
    path = ""
    for part in parts:
        if isinstance(part, int):
            path += f"[{part + 1}]"
        elif not part.startswith("|"):
            path += f".{part}" if path else part
    return path


def _fault(model: type[BaseModel], error: Any) -> Fault:
    kind, where, context = error["type"], error["loc"], error.get("ctx", {})
    numbers = {name: f"{one:,.15g}" for name, one in context.items() if type(one) in (int, float)}
    table, name, field = _place(model, where)
    got = NOTHING if kind == "missing" else error["input"]
    what = _WHAT.get(kind, error["msg"]).format(**numbers)
    if kind == "string_pattern_mismatch":
        what = PATTERNS.get(context["pattern"], "is not a quantity above 0")
    elif kind == "float_type" and type(got) is int:
        what = "is too large"
    if kind == "extra_forbidden":
        way_out = suggestion(str(where[-1]), table.model_fields, "use one of")
    elif kind == "literal_error" and isinstance(got, str):
        choices = re.findall("'([^']*)'", context["expected"])
        way_out = suggestion(got, choices, "use one of")
    elif field.examples:
        way_out = example(name, field)
    else:
        there = path_of([part for part in where if isinstance(part, str)])
        many = field.default == []
        way_out = f"start each entry with [[{there}]]" if many else f"write a table [{there}]"
    return Fault(path_of(where), what, got, way_out)


def example(name: str, field: FieldInfo) -> str:
    """Return the way out that shows a value of a key."""
    return f"write for example {name} = {toml((field.examples or [''])[0])}"


def _place(
    model: type[BaseModel], where: Sequence[int | str]
) -> tuple[type[BaseModel], str, FieldInfo]:
    """Return the table of a place, and the last known key on the way with its name."""
    name, field = "", FieldInfo()
    for part in where:
        if isinstance(part, str) and part in model.model_fields:
            name, field = part, model.model_fields[part]
            inner = below(field.annotation)
            if inner is None:
                break
            model = inner
    return model, name, field


def below(annotation: Any) -> type[BaseModel] | None:
    """Return the model that the values of a key are, or None."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(below, get_args(annotation))), None)


def toml(value: object) -> str:
    """Return a value as TOML has it."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{name} = {toml(one)}" for name, one in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


class _Writer(GenerateJsonSchema):
    """Writes what TOML can say, in the order of the keys: it has no null."""

    def sort(self, value: Any, parent_key: str | None = None) -> Any:
        return value

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def nullable_schema(self, schema: core_schema.NullableSchema) -> dict[str, Any]:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> dict[str, Any]:
        if schema.get("default", ...) is None:
            return self.generate_inner(schema["schema"])
        return super().default_schema(schema)


def recipe_schema() -> dict[str, Any]:
    """Return the JSON Schema of recipes, draft 2020-12, as plain lists and dicts.

    It knows keys, types and intervals.  Only `parse_recipe` checks keys against each other, such as
    that a name is that of a link.
    """
    return {"$schema": _Writer.schema_dialect, **File.model_json_schema(schema_generator=_Writer)}
