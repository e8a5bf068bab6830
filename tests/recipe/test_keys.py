"""The table of a recipe's keys: the parser knows each of them and no other, and as it says."""

import tomllib
from copy import deepcopy
from dataclasses import fields
from typing import Any

import pytest

from lutgen.recipe import Recipe, parse_recipe
from lutgen.recipe.key import Key, toml_value
from lutgen.recipe.keys import KEYS
from lutgen.recipe.schema import TYPES
from lutgen.recipe.table import Table
from proofs.toml import toml_text
from tests.fixtures.every_key import (
    CODED,
    DESCRIBED,
    EVERYTHING,
    IN_SWEEP,
    OTHER,
    ROWS,
    entries,
    holder,
    named,
    refused,
)


def test_the_recipes_of_these_tests_are_good_and_have_every_key() -> None:
    for text in (EVERYTHING, IN_SWEEP, DESCRIBED, CODED):
        assert refused(tomllib.loads(text)) == ""
    for row in ROWS:
        holder(row[0], row[1].name)


@pytest.mark.parametrize("row", ROWS, ids=named)
def test_a_key_with_a_value_of_another_type_is_refused_by_its_name(row: tuple[str, Key]) -> None:
    # So the parser reads every key that the table has.
    table, key = row
    for value in OTHER:
        values, there = holder(table, key.name)
        there[key.name] = value
        assert f".{key.name}"[0 if table else 1 :] in refused(values).partition("`: ")[0]


@pytest.mark.parametrize("row", ROWS, ids=named)
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


DEFAULTS = [row for row in ROWS if row[1].default_value is not None]


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
        *("export", "export.flash", "export.max_error", "robot.home"),
        *("robot.friction", "robot.rest_width", "robot.contact_tolerance"),
        *("robot.urdf", "robot.python", "robot.parameter.joint", "robot.parameter.drive"),
        "robot.link.joint",
        *("robot.contact.axis", "robot.wheel.axis", "robot.wheel.radius", "robot.wheel.rollers"),
    }


def key_of(name: str) -> Key:
    """Return the row of a full name."""
    return next(row[1] for row in ROWS if named(row) == name)


@pytest.mark.parametrize("row", ROWS, ids=named)
def test_a_row_is_complete_and_its_example_is_a_value_of_its_type(row: tuple[str, Key]) -> None:
    _, key = row
    assert key.type in (*TYPES, "table", "tables")
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
        "values": dict,
        "drive": dict,
        "table": dict,
    }
    assert isinstance(value, kinds.get(key.type, list))
    assert not key.choices or set(value if isinstance(value, list) else [value]) <= {*key.choices}
