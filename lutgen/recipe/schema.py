"""The JSON Schema of recipes, made from the table of their keys: editors complete and check by it.

Owns what a schema can say of the rules between keys.  What it cannot say, such as that a name is
that of a link, only `parse_recipe` refuses.
"""

import math
from typing import Any

from lutgen.recipe.key import Key, toml_value
from lutgen.recipe.keys import KEYS
from lutgen.recipe.robot_keys import MAX_CONTACTS

Schema = dict[str, Any]

DRAFT = "https://json-schema.org/draft/2020-12/schema"
THREE: Schema = {
    "type": "array",
    "items": {"type": "number"},
    "minItems": 3,
    "maxItems": 3,
}
NODES: Schema = {"type": "integer", "minimum": 2}
KNOTS: Schema = {"type": "array", "items": {"type": "number"}, "minItems": 2}
SCALE: Schema = {"type": "number", "not": {"const": 0}}
STEP: Schema = {
    "type": "object",
    "properties": {"scale": SCALE, "offset": {"type": "number"}},
    "additionalProperties": False,
}
# What the values of keys are, but tables with keys of their own.
TYPES: dict[str, Schema] = {
    "text": {"type": "string", "pattern": r"\S"},
    "number": {"type": "number"},
    "whole number": {"type": "integer"},
    "true or false": {"type": "boolean"},
    "vector": THREE,
    # One of three numbers is not 0.
    "direction": {**THREE, "contains": {"not": {"const": 0}}},
    "names": {"type": "array", "minItems": 1, "uniqueItems": True},
    "quantity": {"type": ["string", "number"]},
    "values": {"type": "object", "additionalProperties": {"type": "number"}},
    "drive": {
        "type": "object",
        "minProperties": 1,
        "additionalProperties": {"anyOf": [SCALE, STEP]},
    },
    "samples": {"type": "object", "additionalProperties": {"anyOf": [NODES, KNOTS]}},
}


def _without(*keys: str) -> Schema:
    """Return the schema of a table that has none of these keys."""
    return {"properties": dict.fromkeys(keys, False)}


def _is(key: str, value: str) -> Schema:
    """Return the schema of a table whose key is there with this value."""
    return {"required": [key], "properties": {key: {"const": value}}}


def _has(key: str) -> Schema:
    return {"required": [key]}


def _items(key: str, schema: Schema) -> Schema:
    """Return the schema of a table in whose array every entry is so."""
    return {"properties": {key: {"items": schema}}}


PARAMETERS: Schema = {
    "properties": {
        "robot": {"required": ["parameter"], "properties": {"parameter": {"minItems": 1}}}
    },
    "required": ["robot"],
}
OF_ITS_OWN: Schema = {
    **_has("contact"),
    "properties": {
        "contact": {
            "minItems": 3,
            "maxItems": MAX_CONTACTS,
            "items": {"required": ["name", "position"]},
        }
    },
}
# Rules between the keys of a table.
RULES: dict[str, list[Schema]] = {
    "": [{"if": PARAMETERS, "then": {"properties": {"sweep": _has("samples")}}}],
    "robot": [
        {
            "if": _has("urdf"),
            "then": {**_is("length_unit", "m"), "allOf": [_without("python", "link")]},
            "else": _items("parameter", _without("joint", "drive")),
        },
        {
            "if": _has("python"),
            "then": _without("link", "contact", "wheel", "payload", "force"),
            "else": {"if": {"not": _has("urdf")}, "then": OF_ITS_OWN, "else": _has("contact")},
        },
    ],
    "robot.parameter": [{"if": _has("drive"), "then": _without("joint")}],
    "robot.link": [
        {
            "if": _is("name", "body"),
            "then": _without("parent", "origin", "rpy", "joint"),
            "else": _has("parent"),
        },
        {"dependentRequired": {"com": ["mass"]}},
    ],
    "robot.link.joint": [
        {
            "if": _is("type", "none"),
            "then": _without("axis", "parameter", "scale", "offset"),
            "else": {"required": ["axis", "parameter"]},
        },
        {"properties": {"scale": {"not": {"const": 0}}}},
    ],
    "robot.contact": [
        {
            "if": _has("axis"),
            "then": {**_has("radius"), "properties": {"radius": {"exclusiveMinimum": 0}}},
        },
        {"if": {"not": _has("position")}, "then": _without("radius", "axis")},
    ],
    "robot.wheel": [{"if": _has("rollers"), "then": {"properties": {"steered": {"const": False}}}}],
    "sweep": [{"oneOf": [_has("channels"), {"properties": {"gravity": _has("channels")}}]}],
    "sweep.gravity": [
        {
            "if": _is("chart", "sphere"),
            "then": {**_without("max_tilt"), "allOf": [{"properties": {"nodes": {"minimum": 2}}}]},
            "else": _has("max_tilt"),
        }
    ],
}


def recipe_schema() -> Schema:
    """Return the JSON Schema of recipes, draft 2020-12, as plain lists and dicts.

    Returns
    -------
    dict
        It accepts what `parse_recipe` accepts, and refuses unknown keys, wrong types and numbers
        out of their intervals.  It does not know which names there are, whether limits and knots
        increase, NaN, and that 3.0 is no whole number.

    Examples
    --------
    >>> recipe_schema()["properties"]["robot"]["properties"]["friction"]["exclusiveMinimum"]
    0.0
    """
    return {"$schema": DRAFT, "title": "Recipe of lutgen", **_table("")}


def _table(table: str) -> Schema:
    """Return the schema of a table."""
    result: Schema = {
        "type": "object",
        "properties": {key.name: _entry(table, key) for key in KEYS[table]},
        "additionalProperties": False,
    }
    needed = [key.name for key in KEYS[table] if key.needed]
    if needed:
        result["required"] = needed
    if table in RULES:
        result["allOf"] = RULES[table]
    return result


def _entry(table: str, key: Key) -> Schema:
    """Return the schema of a key, with what an editor shows of it."""
    result: Schema = {"description": _description(key)}
    below = f"{table}.{key.name}".lstrip(".")
    if key.type == "table":
        return result | _table(below)
    if key.type == "tables":
        return result | {"type": "array", "items": _table(below)}
    result |= TYPES[key.type]
    if key.type == "names":
        result["items"] = {"enum": list(key.choices)}
    elif key.choices:
        result["enum"] = list(key.choices)
    if key.pattern:
        # The ends of a quantity may be blank.
        result["pattern"] = rf"^\s*({key.pattern})\s*$"
    if key.type == "quantity":
        result["allOf"] = [{"pattern": "^[^eE]*[1-9]"}]
    result |= {name: end for name, end in _bounds(key).items() if math.isfinite(end)}
    if key.default_value is not None:
        result["default"] = key.default_value
    result["examples"] = [toml_value(key.example)]
    return result


def _bounds(key: Key) -> dict[str, float]:
    """Return both ends of a key's interval under the names that a schema gives them."""
    low, high = key.closed
    names = "minimum" if low else "exclusiveMinimum", "maximum" if high else "exclusiveMaximum"
    return dict(zip(names, key.interval, strict=True))


def _description(key: Key) -> str:
    """Return what an editor says of a key: meaning, unit, default and cost."""
    parts = [key.meaning]
    if key.unit:
        parts.append(f"Unit: {key.unit}.")
    if key.default.startswith("needed"):
        parts.append(f"{key.default.capitalize()}.")
    elif key.default and key.default_value is None:
        parts.append(f"Default: {key.default}.")
    if key.costs:
        parts.append(f"Costs: {key.costs}.")
    return " ".join(parts)
