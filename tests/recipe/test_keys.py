"""The table of a recipe's keys: the parser knows each of them and no other, and as it says."""

import math
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from dataclasses import fields
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from lutgen.errors import RecipeError
from lutgen.recipe import Recipe, parse_recipe, recipe_schema, start_recipe, start_recipes
from lutgen.recipe.key import TYPES, Key, toml_value
from lutgen.recipe.keys import KEYS
from lutgen.recipe.table import Table
from tests.fixtures.places import MAPS
from tests.fixtures.toml import toml_text
from tests.recipe.test_recipe import BAD, GOOD

# Recipes that have every key between them.
EVERYTHING = """
[robot]
name = "everything"
length_unit = "m"
friction = 0.5
upright = 80.0
rock_angle = 20.0
rest_width = 0.01
contact_tolerance = 0.001
com_uncertainty = 0.01
[[robot.parameter]]
name = "lift"
min = -10.0
max = 50.0
unit = "deg"
[[robot.link]]
name = "body"
mass = 5.0
com = [0, 0, 0.1]
[[robot.link]]
name = "leg"
parent = "body"
origin = [0, 0, 0.1]
rpy = [0, 0, 10]
joint = { type = "revolute", axis = [0, 1, 0], parameter = "lift", scale = -1.0, offset = 5.0 }
mass = 1.0
com = [0.1, 0, 0]
[[robot.contact]]
name = "a"
link = "leg"
position = [0.5, 0.3, -0.3]
radius = 0.1
axis = [0, 1, 0]
rolling = true
[[robot.contact]]
name = "b"
link = "body"
position = [-0.5, 0.3, -0.3]
radius = 0.1
[[robot.contact]]
name = "c"
link = "body"
position = [0, -0.3, -0.4]
[[robot.wheel]]
contact = "a"
axis = [0, 1, 0]
radius = 0.1
steered = true
[[robot.wheel]]
contact = "b"
axis = [0, 1, 0]
radius = 0.1
rollers = 45.0
[[robot.payload]]
name = "load"
link = "body"
position = [0, 0, 0.2]
mass = 1.0
[[robot.force]]
name = "rope"
link = "body"
position = [0, 0, 0.2]
force = [-1, 0, 0]
moment = [0, 0.1, 0]
[sweep]
samples = { lift = 3 }
[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 5
channels = ["sdg", "tip_angle"]
[export]
flash = "16KiB"
max_error = "1%"
"""
CHANNELS = 'channels = ["sdg", "tip_angle"]\n'
IN_SWEEP = EVERYTHING.replace(CHANNELS, "").replace("[sweep]\n", f"[sweep]\n{CHANNELS}")
URDF = f"""
[robot]
name = "described"
length_unit = "m"
urdf = "rover.urdf"
[[robot.parameter]]
name = "mast"
joint = "JOINT"
min = 0.1
max = 0.2
unit = "m"
[[robot.contact]]
link = "LINK"
[sweep]
samples = {{ mast = 3 }}
[sweep.gravity]
chart = "cone"
max_tilt = 60.0
nodes = 5
{CHANNELS}
"""
RECIPES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(MAPS.glob("*.toml"))} | {
    "good": GOOD,
    "everything": EVERYTHING,
    "channels in sweep": IN_SWEEP,
    **{f"start {kind}": start_recipe(kind) for kind in start_recipes()},
}
ROWS = [(table, key) for table, keys in KEYS.items() for key in keys]
# No robot of the table's examples has them: they need code or a description.
GIVEN_OTHERWISE = {("robot", "urdf"), ("robot", "python"), ("robot.parameter", "joint")}
SCHEMA = Draft202012Validator(recipe_schema())
# Values of other types than the key's; no key takes a date or a table with this entry.
OTHER = {"a number that is none": math.nan, "a table": {"there is no such key": 1}}


def named(row: tuple[str, Key]) -> str:
    return f"{row[0]}.{row[1].name}".lstrip(".")


def entries(values: dict[str, Any], table: str) -> list[dict[str, Any]]:
    """Return the tables of a recipe with this name, of an array all."""
    found: list[dict[str, Any]] = [values]
    for part in filter(None, table.split(".")):
        below = [one[part] for one in found if part in one]
        found = [one for entry in below for one in (entry if isinstance(entry, list) else [entry])]
    return found


def holder(table: str, name: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return a recipe with a key, as plain values, and the first table of it that has the key."""
    text = IN_SWEEP if (table, name) == ("sweep", "channels") else EVERYTHING
    values = tomllib.loads(text)
    return values, next(one for one in entries(values, table) if name in one)


def refused(values: dict[str, Any]) -> str:
    """Return why the parser refuses a recipe, "" where it does not."""
    try:
        parse_recipe(toml_text(values))
    except RecipeError as error:
        return str(error)
    return ""


PRESENT = [row for row in ROWS if (row[0], row[1].name) not in GIVEN_OTHERWISE]


def test_the_recipe_of_these_tests_is_good_and_has_every_key() -> None:
    assert refused(tomllib.loads(EVERYTHING)) == refused(tomllib.loads(IN_SWEEP)) == ""
    for row in PRESENT:
        holder(row[0], row[1].name)


@pytest.mark.parametrize("row", PRESENT, ids=named)
def test_a_key_with_a_value_of_another_type_is_refused_by_its_name(row: tuple[str, Key]) -> None:
    # So the parser reads every key that the table has.
    table, key = row
    for value in OTHER.values():
        values, there = holder(table, key.name)
        there[key.name] = value
        assert f".{key.name}"[0 if table else 1 :] in refused(values).partition("`: ")[0]


@pytest.mark.parametrize("row", PRESENT, ids=named)
def test_what_the_table_says_is_needed_is_and_the_rest_can_be_left_out(
    row: tuple[str, Key],
) -> None:
    table, key = row
    values, there = holder(table, key.name)
    del there[key.name]
    if key.needed or key.default.startswith("needed"):
        assert any(word in refused(values) for word in ("is missing", "3 to 62 contacts"))
    else:
        # What else it made sense with may be refused, but not the want of it.
        assert f"{key.name}`: is missing" not in refused(values)


@pytest.mark.parametrize("table", KEYS)
def test_the_parser_knows_no_key_that_the_table_does_not_have(
    table: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: set[str] = set()
    need, there = Table.need, Table.__contains__

    def noted(self: Table, name: str) -> None:
        if ".".join(part.partition("[")[0] for part in self.key.split(".")) == table:
            asked.add(name)

    def needed(self: Table, name: str, way_out: str) -> Any:
        noted(self, name)
        return need(self, name, way_out)

    def contains(self: Table, name: str) -> bool:
        noted(self, name)
        return there(self, name)

    monkeypatch.setattr(Table, "need", needed)
    monkeypatch.setattr(Table, "__contains__", contains)
    for text in (EVERYTHING, IN_SWEEP):
        parse_recipe(text)
    assert asked <= {key.name for key in KEYS[table]}
    # And it did ask.
    assert asked


def same(a: Recipe, b: Recipe) -> bool:
    """Tell whether two recipes say the same in other words."""
    left_out = {"text", "source", "function"}
    names = [one.name for one in fields(Recipe) if one.name not in left_out]
    return all(getattr(a, name) == getattr(b, name) for name in names)


DEFAULTS = [row for row in PRESENT if row[1].default_value is not None]


@pytest.mark.parametrize("row", DEFAULTS, ids=named)
def test_a_default_is_what_a_recipe_without_the_key_gets(row: tuple[str, Key]) -> None:
    table, key = row
    values, there = holder(table, key.name)
    if key.type == "tables":
        # Others of this recipe name what stands there.
        values, there = holder("robot.payload", "name")
        values["robot"] = {
            name: value
            for name, value in values["robot"].items()
            if name in ("name", "length_unit", "contact")
        }
        for contact in values["robot"]["contact"]:
            contact["link"] = "body"
        del values["sweep"]["samples"]
        there = values["robot"]
    if key.name == "radius":
        there.pop("axis")
        there.pop("rolling")
        del values["robot"]["wheel"][0]
    with_it = deepcopy(values)
    for recipe in (values, with_it):
        for one in entries(recipe, table):
            # The root stands nowhere, and something must have a mass.
            if table == "robot.link" and one["name"] == "body" and key.name != "com":
                continue
            one.pop(key.name, None)
            if key.name == "mass":
                one.pop("com")
            if recipe is with_it:
                one[key.name] = deepcopy(key.default_value)
    assert same(parse_recipe(toml_text(values)), parse_recipe(toml_text(with_it)))


def test_other_defaults_are_words_and_these() -> None:
    # Those of the size are compared with what a recipe gets by the test of the page.
    words = {named(row) for row in ROWS if row[1].default and row[1].default_value is None}
    assert {name for name in words if "needed" not in key_of(name).default} == {
        *("export", "export.flash", "export.max_error"),
        *("robot.friction", "robot.rest_width", "robot.contact_tolerance"),
        *("robot.urdf", "robot.python", "robot.parameter.joint", "robot.link.joint"),
        *("robot.contact.axis", "robot.wheel.axis", "robot.wheel.radius", "robot.wheel.rollers"),
    }


def key_of(name: str) -> Key:
    """Return the row of a full name."""
    return next(row[1] for row in ROWS if named(row) == name)


@pytest.mark.parametrize("row", ROWS, ids=named)
def test_a_row_is_complete_and_its_example_is_a_value_of_its_type(row: tuple[str, Key]) -> None:
    _, key = row
    assert key.type in TYPES
    assert key.meaning.endswith(".")
    assert key.meaning[0].isupper()
    assert key.unit or key.type not in ("vector",)
    value = toml_value(key.example)
    kinds = {
        "text": str,
        "number": float,
        "whole number": int,
        "true or false": bool,
        "quantity": str,
        "samples": dict,
        "table": dict,
    }
    assert isinstance(value, kinds.get(key.type, list))
    assert not key.choices or set(value if isinstance(value, list) else [value]) <= {*key.choices}


def ends(row: tuple[str, Key]) -> Iterator[tuple[float, bool]]:
    """Return numbers at the ends of a key's interval and beyond, and whether they are in it."""
    _, key = row
    for end, closed, outside in zip(key.interval, key.closed, (-1, 1), strict=True):
        if math.isfinite(end):
            whole = key.type == "whole number"
            yield (int(end) if whole else end), closed
            yield (int(end) + outside if whole else end + 1e-3 * outside), False
            if not whole:
                yield end - 1e-3 * outside, True


BOUNDED = [row for row in PRESENT if row[1].bounds]


@pytest.mark.parametrize("row", BOUNDED, ids=named)
def test_the_parser_and_the_schema_keep_the_intervals_of_the_table(row: tuple[str, Key]) -> None:
    table, key = row
    for value, inside in ends(row):
        values, there = holder(table, key.name)
        there[key.name] = value
        if key.name == "radius":
            # What else needs a radius would be refused for the want of one, or for two of them.
            for one in entries(values, "robot.contact"):
                one.pop("axis", None)
                one.pop("rolling", None)
        assert (not any(f".{key.name}`" in line for line in [refused(values)])) is inside, value
        assert SCHEMA.is_valid(values) is inside, value


@pytest.mark.parametrize("name", RECIPES)
def test_the_schema_takes_every_recipe_that_the_parser_takes(name: str) -> None:
    found = [error.message[:200] for error in SCHEMA.iter_errors(tomllib.loads(RECIPES[name]))]
    assert found == []


def test_the_schema_takes_recipes_with_a_description_or_code() -> None:
    Draft202012Validator.check_schema(recipe_schema())
    assert SCHEMA.is_valid(tomllib.loads(URDF))
    assert not SCHEMA.is_valid(tomllib.loads(URDF.replace('"m"\nurdf', '"mm"\nurdf')))
    code = {"name": "a", "length_unit": "m", "python": "rover:postures"}
    sweep = {"gravity": {"chart": "sphere", "nodes": 2, "channels": ["sdg"]}}
    assert SCHEMA.is_valid({"robot": code, "sweep": sweep})
    for wrong in ({"link": []}, {"contact": []}, {"python": "  "}):
        assert not SCHEMA.is_valid({"robot": code | wrong, "sweep": sweep})


# What only the parser can know: it compares values with each other, or what they name.
BEYOND = {
    *("parameter reserved", "parameter twice", "unit other", "min infinite", "min huge"),
    *("min above max", "min equals max", "link twice", "link loop", "parent unknown"),
    *("joint parameter", "revolute in mm", "prismatic in deg", "parameter unused", "mass zero"),
    *("contact twice", "contact link", "samples unknown", "sample missing"),
    *("knots equal", "knots descend", "knot outside"),
    # NaN is a number that is neither above nor below another, and 3.0 an integer of JSON.
    *("friction nan", "knot nan", "sample fraction", "nodes fraction"),
}


@pytest.mark.parametrize("rule", BAD)
def test_the_schema_refuses_what_the_parser_refuses_as_far_as_a_schema_can(rule: str) -> None:
    old, new, *_ = BAD[rule]
    try:
        values = tomllib.loads(GOOD.replace(old, new, 1))
    except tomllib.TOMLDecodeError:
        pytest.skip("no editor gets as far as the schema")
    assert SCHEMA.is_valid(values) is (rule in BEYOND)


@pytest.mark.parametrize("row", PRESENT, ids=named)
def test_the_schema_refuses_unknown_keys_and_wrong_types_as_the_parser_does(
    row: tuple[str, Key],
) -> None:
    table, key = row
    values, there = holder(table, key.name)
    there[key.name] = OTHER["a table"]
    assert refused(values)
    assert not SCHEMA.is_valid(values)
    values, there = holder(table, key.name)
    there[f"{key.name}_"] = there[key.name]
    assert "is not a known key" in refused(values)
    assert not SCHEMA.is_valid(values)
