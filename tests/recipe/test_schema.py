"""The JSON Schema of recipes: it takes what the parser takes, and refuses what a schema can."""

import math
import random
import re
import tomllib
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from lutgen.recipe import recipe_schema, start_recipe, start_recipes
from lutgen.recipe.key import Key
from lutgen.recipe.keys import KEYS
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
from tests.fixtures.length import part
from tests.fixtures.places import MAPS
from tests.fixtures.recipes import rocker, tripod
from tests.recipe.test_recipe import BAD, GOOD

SCHEMA = Draft202012Validator(recipe_schema())
RECIPES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(MAPS.glob("*.toml"))} | {
    "good": GOOD,
    "everything": EVERYTHING,
    "channels in sweep": IN_SWEEP,
    "described": DESCRIBED,
    "coded": CODED,
    "rocker": rocker(),
    "tripod": tripod(),
    **{f"start {kind}": start_recipe(kind) for kind in start_recipes()},
}


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


BOUNDED = [row for row in ROWS if row[1].bounds]


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


# What only the parser can know: it compares values with each other, or what they name.
BEYOND = {
    *("parameter reserved", "parameter twice", "unit other", "min infinite", "min huge"),
    *("min above max", "min equals max", "link twice", "link loop", "parent unknown"),
    *("joint parameter", "revolute in mm", "prismatic in deg", "parameter unused", "mass zero"),
    *("contact twice", "contact link", "samples unknown", "sample missing"),
    *("sample alike", "knots equal", "knots descend", "knot outside"),
    # NaN is a number that is neither above nor below another, and 3.0 an integer of JSON.
    *("friction nan", "knot nan", "sample fraction", "nodes fraction"),
}


def plain(rule: str) -> dict[str, Any] | None:
    """Return the values of a bad recipe, None where it is no TOML: no schema gets to see that."""
    old, new, *_ = BAD[rule]
    try:
        return tomllib.loads(GOOD.replace(old, new, 1))
    except tomllib.TOMLDecodeError:
        return None


@pytest.mark.parametrize("rule", [rule for rule in BAD if plain(rule) is not None])
def test_the_schema_refuses_what_the_parser_refuses_as_far_as_a_schema_can(rule: str) -> None:
    assert SCHEMA.is_valid(plain(rule)) is (rule in BEYOND)


@pytest.mark.parametrize("row", ROWS, ids=named)
def test_the_schema_refuses_unknown_keys_and_wrong_types_as_the_parser_does(
    row: tuple[str, Key],
) -> None:
    table, key = row
    values, there = holder(table, key.name)
    # No schema knows the names of parameters and joints, which are the keys of such a table.
    wrong = {"values": {"lift": "high"}, "drive": {"left_axle": "fast"}}
    there[key.name] = wrong.get(key.type, OTHER[1])
    assert refused(values)
    assert not SCHEMA.is_valid(values)
    values, there = holder(table, key.name)
    there[f"{key.name}_"] = there[key.name]
    assert "is not a known key" in refused(values)
    assert not SCHEMA.is_valid(values)


# What is wrong, as the parser says it, that a schema can say as well.
SAID = re.compile(
    r"is not a known key|must be (a string|a number|a list of three|a table|true or false|an array)"
    r"|must not be (empty|negative)|is unknown|is not a channel|must lie (in|between)\b"
    r"|must be above 0"
)
POOL = (0, -1, 1.5, 3.0, 1000, True, "", "x", "body", "1%", [], [1, 2, 3], [0, 0, 0], ["sdg"], {})


def mutated(values: dict[str, Any], chance: random.Random) -> None:
    """Change one thing of a recipe: remove, rename, replace or copy an entry of a random table."""
    tables = [one for table in KEYS for one in entries(values, table) if one]
    table = chance.choice(tables)
    name = chance.choice(list(table))
    way = chance.randrange(4)
    if way == 0:
        del table[name]
    elif way == 1:
        other = chance.choice(tables)
        table[chance.choice(list(other))] = deepcopy(table[name])
    elif way == 2 and isinstance(table[name], list) and table[name]:
        table[name].append(deepcopy(table[name][0]))
    else:
        table[name] = deepcopy(chance.choice(POOL))


def test_of_mutated_recipes_the_schema_takes_the_good_and_refuses_wrong_types() -> None:
    chance = random.Random(5)
    taken = said = 0
    for number in range(part(2000)):
        values = tomllib.loads(list(RECIPES.values())[number % len(RECIPES)])
        mutated(values, chance)
        why = refused(values)
        valid = SCHEMA.is_valid(values)
        if not why:
            taken += 1
            assert valid, next(SCHEMA.iter_errors(values)).message
        elif SAID.search(why) and "`robot.home." not in why:
            said += 1
            assert not valid, why
    # Both happen, and often.
    assert taken > part(2000) // 20
    assert said > part(2000) // 4
