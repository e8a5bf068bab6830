"""The page on recipes: its tables are those of the schema, its defaults what a recipe gets."""

import re

import pytest

import lutgen
from lutgen.channels.wrench import acceptance_of
from lutgen.recipe import robot_size_of
from tests.fixtures.recipes import rocker
from tools.recipe_page import SCHEMA, TABLES, TARGET, page

PAGE = TARGET.read_text(encoding="utf-8")


def test_the_page_has_every_table_of_a_recipe_once_as_the_script_writes_it():
    marked = re.findall(r"^<!-- keys of (\S+) -->$", PAGE, re.MULTILINE)
    # What a joint of a `drive` may have is said in its row.
    assert sorted([*marked, "Step"]) == sorted(TABLES)
    assert page(PAGE) == PAGE
    changed = PAGE.replace("| `80.0` |", "| `90.0` |")
    assert changed != PAGE
    assert page(changed) == PAGE


@pytest.mark.parametrize("name", ["rest_width", "contact_tolerance"])
def test_the_defaults_that_are_shares_of_the_size_are_those_that_a_recipe_gets(name):
    said = SCHEMA["$defs"]["Robot"]["properties"][name]["description"]
    share, percent = re.search(r"by default (\S+) (%?) ?of the size", said).groups()
    recipe = lutgen.parse_recipe(rocker())
    size = robot_size_of(recipe)
    # The far side of the front and rear wheels: sqrt(0.5^2 + 0.3^2 + 0.3^2) + 0.1.
    assert size == pytest.approx(0.43**0.5 + 0.1)
    wanted = float(share) / (100 if percent else 1) * size
    assert getattr(acceptance_of(recipe), name) == pytest.approx(wanted)
