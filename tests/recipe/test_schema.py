"""The JSON Schema of recipes: it takes what the parser takes, and refuses what a schema can."""

import tomllib
from copy import deepcopy
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from lutgen.recipe import recipe_schema, start_recipe, start_recipes
from lutgen.recipe.keys import KEYS
from tests.fixtures.every_key import CODED, DESCRIBED, EVERYTHING, IN_SWEEP, entries, refused
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import rocker, tripod

SCHEMA = Draft202012Validator(recipe_schema())
RECIPES = [tomllib.loads(path.read_text(encoding="utf-8")) for path in sorted(MAPS.glob("*.toml"))]
RECIPES += map(tomllib.loads, (EVERYTHING, IN_SWEEP, DESCRIBED, CODED, rocker(), tripod()))
RECIPES += map(tomllib.loads, map(start_recipe, start_recipes()))
POOL = (0, -1, 1.5, 3.0, 1000, True, "", "x", "body", "1%", [], [1, 2, 3], [0, 0, 0], ["sdg"], {})


def test_the_recipes_of_these_tests_are_good_and_have_every_key() -> None:
    assert [why for why in map(refused, RECIPES) if why] == []
    there = {
        (table, key) for values in RECIPES for table in KEYS for one in entries(values, table)
        for key in one
    }  # fmt: skip
    assert {(table, key.name) for table in KEYS for key in KEYS[table]} <= there


@pytest.mark.parametrize(
    ("table", "key", "value", "said"),
    [
        ("robot", "frction", 0.5, "is not a known key"),
        ("robot", "length_unit", None, "is missing"),
        ("robot", "name", 3, "must be a string"),
        ("robot", "upright", 180.5, "must lie in"),
        ("robot", "friction", 0.0, "must be above 0"),
        ("robot", "rest_width", -1.0, "must not be negative"),
        ("robot.parameter", "unit", "turns", "is neither an angle"),
        ("robot.contact", "position", [0.0, 1.0], "must be a list of three"),
        ("robot.contact", "rolling", "yes", "must be true or false"),
        ("sweep.gravity", "nodes", 1.5, "must be a"),
        ("sweep.gravity", "channels", ["sgd"], "is not a channel"),
        ("robot.force", "force", "x", "must be a list of three"),
    ],
)
def test_parser_and_schema_refuse_the_same_by_the_name_of_the_key(
    table: str, key: str, value: Any, said: str
) -> None:
    values = tomllib.loads(EVERYTHING)
    there = entries(values, table)[0]
    there[key] = value
    if value is None:
        del there[key]
    why = refused(values)
    assert said in why
    assert f".{key}" in why
    assert not SCHEMA.is_valid(values)


def test_the_schema_knows_what_a_description_and_code_exclude() -> None:
    Draft202012Validator.check_schema(recipe_schema())
    for text, wrong in (
        (DESCRIBED, {"length_unit": "mm"}),
        (DESCRIBED, {"link": []}),
        (DESCRIBED, {"python": "rover:postures"}),
        (CODED, {"contact": []}),
        (CODED, {"link": []}),
        (CODED, {"python": "  "}),
    ):
        values = tomllib.loads(text)
        values["robot"] |= wrong
        assert refused(values)
        assert not SCHEMA.is_valid(values), wrong


@settings(max_examples=60)
@given(st.data())
def test_the_schema_takes_what_the_parser_takes_which_names_a_rule_of_the_rest(
    data: st.DataObject,
) -> None:
    values = deepcopy(data.draw(st.sampled_from(RECIPES)))
    tables = [one for table in KEYS for one in entries(values, table) if one]
    table, other = data.draw(st.sampled_from(tables)), data.draw(st.sampled_from(tables))
    name = data.draw(st.sampled_from([*table]))
    new = data.draw(st.sampled_from([*POOL, *other.values()]))
    if data.draw(st.booleans()):
        del table[name]
    table[data.draw(st.sampled_from([name, *other]))] = deepcopy(new)
    if why := refused(values):
        assert "key `" in why
    else:
        assert SCHEMA.is_valid(values)
