"""Importing onto an edited recipe: links become the description's, hand edits stay."""

from pathlib import Path

import pytest

from lutgen.errors import RecipeError
from lutgen.recipe import merged_recipe, start_recipe, start_recipes
from tests.fixtures.commands import data, good, run
from tests.fixtures.places import MAPS, VECTORS

ABSOLEM = (MAPS / "absolem.toml").read_text(encoding="utf-8")


def replaced(text, *pairs):
    """Return a text with each pair's first text, which must be in it, as its second."""
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new, 1)
    return text


@pytest.mark.parametrize("text", [ABSOLEM, *map(start_recipe, start_recipes())])
def test_a_recipe_merged_with_itself_stays_as_it_is(text):
    assert merged_recipe(text, "robot.toml", text) == (text, ())


def test_links_are_the_descriptions_and_everything_else_the_recipes():
    edited = replaced(
        ABSOLEM,
        ("mass = 3.18\n", "mass = 3.18    # weighed in May\n"),
        ("friction = 0.8", "friction = 0.5  # wet"),
        ("min = -180.0", "min = -90.0"),
        ("radius = 0.089", "radius = 0.095"),
    )
    fresh = replaced(
        ABSOLEM,
        ("mass = 3.18\n", "mass = 4.5\n"),
        ("origin = [0.25, 0.272, 0.0195]", "origin = [0.26, 0.272, 0.0195]"),
        ("axis = [0, 1, 0], parameter", "axis = [0, 2, 1], parameter"),
        ("scale = -1.0", "scale = 1.0"),
        ("radius = 0.029", "radius = 0.031"),
        ("rock_angle = 30.0", "rock_angle = 10.0"),
    )
    text, changes = merged_recipe(edited, "robot.toml", fresh)
    # Comment and place of the value stay, too.
    assert text == replaced(
        edited,
        ("mass = 3.18    # weighed in May", "mass = 4.5    # weighed in May"),
        ("origin = [0.25, 0.272, 0.0195]", "origin = [0.26, 0.272, 0.0195]"),
        ("axis = [0, 1, 0], parameter", "axis = [0, 2, 1], parameter"),
    )
    assert changes == (
        "link battery: mass was 3.18, is 4.5",
        "link front_left_flipper: origin was [0.25, 0.272, 0.0195], is [0.26, 0.272, 0.0195]",
        "joint of front_left_flipper: axis was [0, 1, 0], is [0, 2, 1]",
    )


def test_links_that_only_one_has_or_that_move_in_one_stay_and_are_named():
    joint = 'joint = { type = "revolute", axis = [0, 1, 0], parameter = "front", scale = -1.0 }\n'
    fresh = replaced(
        ABSOLEM,
        ('name = "laser"', 'name = "lidar"'),
        (f"origin = [0.25, 0.272, 0.0195]\nrpy = [0, 0, 0]\n{joint}", "origin = [9, 9, 9]\n"),
    )
    text, changes = merged_recipe(ABSOLEM, "robot.toml", fresh)
    assert text == ABSOLEM
    assert changes == (
        "link laser: is not in what was imported, stays",
        "link front_left_flipper: is fixed in the description, stays as it is",
        "link lidar: is in what was imported only, left out",
    )


def test_a_link_whose_joint_was_switched_off_stays_fixed():
    joint = '{ type = "revolute", axis = [0, 1, 0], parameter = "front", scale = -1.0 }'
    edited = replaced(ABSOLEM, (joint, '{ type = "none" }'))
    text, changes = merged_recipe(edited, "robot.toml", ABSOLEM)
    assert text == edited
    assert changes == ("link front_left_flipper: moves in the description, stays as it is",)


def test_a_recipe_that_is_bad_before_or_after_is_refused():
    with pytest.raises(RecipeError, match=r"mine\.toml: key `robot\.colour`"):
        merged_recipe(ABSOLEM.replace("friction =", "colour ="), "mine.toml", ABSOLEM)
    fresh = ABSOLEM.replace("mass = 3.18", "mass = -3.18")
    with pytest.raises(RecipeError, match=r"mine\.toml: key .*mass`: must be 0 or more"):
        merged_recipe(ABSOLEM, "mine.toml", fresh)


def test_the_command_keeps_what_was_edited(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    urdf = (VECTORS / "rover.urdf").read_text(encoding="utf-8")
    Path("rover.urdf").write_text(urdf)
    good("import", "rover.urdf", "-o", "rover.toml")
    first = Path("rover.toml").read_text(encoding="utf-8")
    edited = f"# Ours.\n{first}".replace("upright = 80.0", "upright = 70.0  # it is tall")
    Path("rover.toml").write_text(edited, encoding="utf-8")
    report = data("import", "rover.urdf", "-o", "rover.toml", "--merge")
    assert report["changed"] == []
    assert Path("rover.toml").read_text(encoding="utf-8") == edited
    Path("rover.urdf").write_text(replaced(urdf, ('<mass value="20"/>', '<mass value="22"/>')))
    said = good("import", "rover.urdf", "-o", "rover.toml", "--merge").stdout
    assert said.endswith("changed:\n  link body: mass was 20.0, is 22.0\n")
    assert Path("rover.toml").read_text(encoding="utf-8") == edited.replace("= 20.0", "= 22.0")
    # Without it the recipe stays, or is written anew.
    assert run("import", "rover.urdf", "-o", "rover.toml").exit_code == 2
    good("import", "rover.urdf", "-o", "rover.toml", "--force")
    assert Path("rover.toml").read_text(encoding="utf-8") == first.replace("= 20.0", "= 22.0")
