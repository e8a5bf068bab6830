"""The page on recipes: its keys are those that a recipe may have, its defaults those it gets."""

import math
import re

import pytest

import lutgen
from lutgen.channels.wrench import acceptance_of
from lutgen.recipe import robot_size_of
from lutgen.recipe.recipe import ROBOT_KEYS
from lutgen.recipe.robot import CONTACT_KEYS, JOINT_KEYS, LINK_KEYS, WHEEL_KEYS
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import rocker

PAGE = (ROOT / "docs/reference/recipe.md").read_text(encoding="utf-8")
# What has a table of its own.
TABLES = ("parameter", "link", "contact", "wheel", "payload", "force")


def test_the_table_lists_every_key_of_the_robot() -> None:
    listed = re.findall(r"^\| `(\w+)` \|", PAGE, re.MULTILINE)
    assert set(listed) == set(ROBOT_KEYS) - set(TABLES)
    for name in TABLES:
        assert f"`[[robot.{name}]]`" in PAGE


@pytest.mark.parametrize("key", sorted({*CONTACT_KEYS, *JOINT_KEYS, *LINK_KEYS, *WHEEL_KEYS}))
def test_the_page_names_every_key_of_links_joints_contacts_and_wheels(key: str) -> None:
    assert re.search(rf"\b{key}\b", PAGE.partition("## `[[robot.parameter]]`")[2])


def test_the_defaults_are_those_that_a_recipe_gets() -> None:
    said = dict(re.findall(r"^\| `(\w+)` \| ([^|]+) \|", PAGE, re.MULTILINE))
    recipe = lutgen.parse_recipe(rocker())
    assert math.degrees(recipe.upright) == pytest.approx(float(said["upright"]))
    assert math.degrees(recipe.rock_angle) == pytest.approx(float(said["rock_angle"]))
    assert recipe.com_uncertainty == float(said["com_uncertainty"])
    limits, size = acceptance_of(recipe), robot_size_of(recipe)
    share, tolerance = said["rest_width"].split(" % of")[0], said["contact_tolerance"].split()[0]
    assert limits.rest_width == pytest.approx(float(share) / 100 * size)
    assert limits.contact_tolerance == pytest.approx(float(tolerance) * size)
    # The far side of the front and rear wheels: sqrt(0.5^2 + 0.3^2 + 0.3^2) + 0.1.
    assert size == pytest.approx(math.sqrt(0.43) + 0.1)
