"""`lutgen import` and the page on robot descriptions: what is written, said and refused."""

import builtins
import io
import json
import os
import re
import shutil
import sys
from pathlib import Path

import pytest

import lutgen
from tests.fixtures.commands import run
from tests.fixtures.commands import stdout as good
from tests.fixtures.places import VECTORS
from tests.fixtures.robots import collision, joint, link, robot

ROVER = VECTORS / "rover.urdf"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Return a folder with the rover's description, made the working folder."""
    shutil.copy(ROVER, tmp_path / "robot.urdf")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_robot_that_stands_on_nothing_is_written_with_a_warning(folder, caplog):
    points = [f"--contact=chassis={x},{y},9" for x, y in ((1, 1), (1, -1), (-1, 0))]
    result = run("import", "robot.urdf", "-o", "high.toml", *points)
    assert result.exit_code == 0
    assert "stands in none of its postures on these contacts" in caplog.text
    caplog.clear()
    assert run("check", "high.toml").exit_code == 2
    good("import", "robot.urdf", "-o", "robot.toml")
    assert "stands in none" not in caplog.text


def test_a_warning_is_on_stderr_in_the_recipe_and_in_the_report(folder, caplog):
    sound = ROVER.read_text(encoding="utf-8")
    degrees = sound.replace('lower="-0.8" upper="0.8"', 'lower="-45" upper="45"')
    Path("robot.urdf").write_text(degrees, encoding="utf-8")
    report = json.loads(good("import", "robot.urdf", "-o", "robot.toml", "--json"))
    (words,) = report["warnings"]
    assert "more than a turn looks like degrees" in words
    assert words in caplog.text
    text = Path("robot.toml").read_text(encoding="utf-8")
    assert "# Warning: " in text


def test_soft_limits_are_taken_when_asked_for(folder):
    soft = '<safety_controller soft_lower_limit="-0.1" soft_upper_limit="0.2" k_velocity="1"/>'
    text = ROVER.read_text(encoding="utf-8")
    old = '<joint name="arms" type="revolute">'
    assert old in text
    Path("robot.urdf").write_text(text.replace(old, old + soft), encoding="utf-8")
    good("import", "robot.urdf", "-o", "robot.toml", "--soft-limits", "--name", "crawler")
    recipe = lutgen.load_recipe("robot.toml")
    arms = recipe.parameters[0]
    assert recipe.name == "crawler"
    assert (arms.minimum, arms.maximum) == (pytest.approx(-0.1), pytest.approx(0.2))


def test_names_that_toml_or_the_map_cannot_take_are_changed(folder):
    foot = collision('sphere radius="0.1"', "{} {} -1")
    feet = "".join(foot.format(x, y) for x in (-1, 1) for y in (-1, 1))
    limits = '<axis xyz="1 0 0"/><limit lower="0" upper="1"/>'
    text = robot(
        link("t&quot;p\u00e9]]x", 1.0, "0 0 1"),
        link("body", 1.0, inside=feet),
        link("a'b", 1.0),
        link("c", 1.0),
        joint("j", "fixed", "t&quot;p\u00e9]]x", "body"),
        joint("u", "prismatic", "body", "a'b", limits),
        joint("1-2", "prismatic", "body", "c", limits),
        name="&lt;a&gt; &quot;",
    )
    Path("odd.urdf").write_text(text, encoding="utf-8")
    said = good("import", "odd.urdf", "-o", "odd.toml")
    recipe = lutgen.load_recipe("odd.toml")
    assert recipe.name == '<a> "'
    assert [link.name for link in recipe.links] == ["body", "body_0", "a'b", "c"]
    assert [p.name for p in recipe.parameters] == ["joint_u", "joint_1_2"]
    assert len(said.splitlines()) == 5


def test_a_joint_that_hardly_matters_is_held_unless_it_is_asked_for(folder):
    # A sensor of 10 g, 0.1 m off its axis, on a rover of 26 kg.
    text = ROVER.read_text(encoding="utf-8").replace(
        "</robot>",
        link("radar", 0.01, "0.1 0 0")
        + joint("spin", "continuous", "chassis", "radar", '<axis xyz="0 0 1"/>')
        + "</robot>",
    )
    Path("radar.urdf").write_text(text, encoding="utf-8")
    report = json.loads(good("import", "radar.urdf", "-o", "radar.toml", "--json"))
    assert report["parameters"] == ["arms", "lift"]
    # 2 * 0.1 m * 0.01 kg / 26.01 kg = 0.077 mm.
    assert (
        "joint spin: held, moves no contact and the com by at most 0.077 mm" in report["left_out"]
    )
    report = json.loads(good("import", "radar.urdf", "-o", "r.toml", "--json", "-j", "spin"))
    assert report["parameters"] == ["spin"]


def test_no_file_that_a_description_names_is_opened_unless_it_is_called_a_mesh(folder, monkeypatch):
    text = ROVER.read_text(encoding="utf-8")
    Path("a.urdf").write_text(text.replace("package://rover/mast.stl", "../../secret"))
    Path("secret").write_text("x")
    good("import", "a.urdf", "-o", "first.toml")  # all modules are loaded now
    seen = []

    def spied(before):
        def spy(file, *arguments, **options):
            # A number stands for a file that was opened before.
            seen.extend([] if isinstance(file, int) else [str(file)])
            return before(file, *arguments, **options)

        return spy

    for module in (io, builtins, os):
        monkeypatch.setattr(module, "open", spied(module.open))
    good("import", "a.urdf", "-o", "second.toml")
    monkeypatch.undo()
    # What is written has a name that cannot be foreseen.
    names = {re.sub(r"^\.lutgen-\w+$", "new", Path(name).name) for name in seen}
    assert names == {"a.urdf", "new"}


def test_without_the_package_one_sentence_says_how_to_get_it(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "xacrodoc", None)
    result = run("import", "-x", VECTORS / "xacro/robots/cart.xacro", "-o", "robot.toml")
    assert result.exit_code == 2
    assert "pip install lutgen[xacro]" in result.stderr
