"""The JSON Schema of recipes: it takes what the parser takes, and the parser names the rest."""

import tomllib
from copy import deepcopy

from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from lutgen.recipe import recipe_schema, start_recipe, start_recipes
from tests.fixtures.every_key import CODED, DESCRIBED, EVERYTHING, IN_SWEEP, refused
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import rocker, tripod

SCHEMA = recipe_schema()
VALIDATOR = Draft202012Validator(SCHEMA)
TEXTS = [path.read_text(encoding="utf-8") for path in sorted(MAPS.glob("*.toml"))]
TEXTS += [EVERYTHING, IN_SWEEP, DESCRIBED, CODED, rocker(), tripod()]
RECIPES = [tomllib.loads(text) for text in (*TEXTS, *map(start_recipe, start_recipes()))]
POOL = (0, -1, 1.5, 3.0, 1e300, True, "", "x", "body", "1%", [], [1, 2, 3], [0, 0, 0], ["sdg"], {})


def tables(value):
    """Return a table and those below it."""
    below = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    found = [one for part in below for one in tables(part)]
    return [value, *found] if isinstance(value, dict) else found


def test_the_gallery_the_starts_and_recipes_with_every_key_are_valid():
    Draft202012Validator.check_schema(SCHEMA)
    assert [why for why in map(refused, RECIPES) if why] == []
    assert all(map(VALIDATOR.is_valid, RECIPES))
    there = {key for recipe in RECIPES for table in tables(recipe) for key in table}
    assert {key for table in SCHEMA["$defs"].values() for key in table["properties"]} <= there


def test_each_key_says_what_it_means_by_an_example_that_is_valid():
    for table in SCHEMA["$defs"].values():
        for key in table["properties"].values():
            assert "$ref" in key or key["description"].endswith(".")
            for example in key.get("examples", []):
                whole = {**key, "$defs": SCHEMA["$defs"]}
                assert Draft202012Validator(whole).is_valid(example), key
                assert not Draft202012Validator(whole).is_valid({"x": None})


@settings(max_examples=150)
@given(st.data())
def test_the_schema_takes_what_the_parser_takes_which_names_a_key_of_the_rest(data):
    values = deepcopy(data.draw(st.sampled_from(RECIPES)))
    filled = [table for table in tables(values) if table]
    table, other = data.draw(st.sampled_from(filled)), data.draw(st.sampled_from(filled))
    name = data.draw(st.sampled_from([*table]))
    new = data.draw(st.sampled_from([*POOL, *other.values()]))
    if data.draw(st.booleans()):
        del table[name]
    table[data.draw(st.sampled_from([name, *other]))] = deepcopy(new)
    if why := refused(values):
        assert "key `" in why
    else:
        assert VALIDATOR.is_valid(values)
