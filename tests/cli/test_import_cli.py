"""`lutgen import`: what is written, said and refused, and joints that are grouped with --couple."""

import builtins
import io
import os
import re
import shutil
import sys
from pathlib import Path

import pytest

import lutgen
from lutgen.recipe import forward
from tests.fixtures.commands import data, run
from tests.fixtures.commands import stdout as good
from tests.fixtures.places import VECTORS
from tests.fixtures.robots import collision, joint, link, robot

ROVER = VECTORS / "rover.urdf"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    shutil.copy(ROVER, tmp_path / "robot.urdf")
    for name in ("quadruped.urdf", "quadruped.srdf"):
        shutil.copy(VECTORS / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)


def test_a_robot_that_stands_on_nothing_is_written_with_a_warning(caplog):
    points = [f"--contact=chassis={x},{y},9" for x, y in ((1, 1), (1, -1), (-1, 0))]
    result = run("import", "robot.urdf", "-o", "high.toml", *points)
    assert result.exit_code == 0
    assert "stands in none of its postures on these contacts" in caplog.text
    caplog.clear()
    assert run("check", "high.toml").exit_code == 2
    good("import", "robot.urdf", "-o", "robot.toml")
    assert "stands in none" not in caplog.text


def test_a_warning_is_on_stderr_in_the_recipe_and_in_the_report(caplog):
    sound = ROVER.read_text(encoding="utf-8")
    degrees = sound.replace('lower="-0.8" upper="0.8"', 'lower="-45" upper="45"')
    Path("robot.urdf").write_text(degrees, encoding="utf-8")
    report = data("import", "robot.urdf", "-o", "robot.toml")
    (words,) = report["warnings"]
    assert "more than a turn looks like degrees" in words
    assert words in caplog.text
    text = Path("robot.toml").read_text(encoding="utf-8")
    assert "# Warning: " in text


def test_soft_limits_are_taken_when_asked_for():
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


def test_names_that_toml_or_the_map_cannot_take_are_changed():
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


def test_a_joint_that_hardly_matters_is_held_unless_it_is_asked_for():
    # A sensor of 10 g, 0.1 m off its axis, on a rover of 26 kg.
    text = ROVER.read_text(encoding="utf-8").replace(
        "</robot>",
        link("radar", 0.01, "0.1 0 0")
        + joint("spin", "continuous", "chassis", "radar", '<axis xyz="0 0 1"/>')
        + "</robot>",
    )
    Path("radar.urdf").write_text(text, encoding="utf-8")
    report = data("import", "radar.urdf", "-o", "radar.toml")
    assert report["parameters"] == ["arms", "lift"]
    # 2 * 0.1 m * 0.01 kg / 26.01 kg = 0.077 mm.
    assert (
        "joint spin: held, moves no contact and the com by at most 0.077 mm" in report["left_out"]
    )
    report = data("import", "radar.urdf", "-o", "r.toml", "-j", "spin")
    assert report["parameters"] == ["spin"]


def test_no_file_that_a_description_names_is_opened_unless_it_is_called_a_mesh(monkeypatch):
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


def test_without_the_package_one_sentence_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "xacrodoc", None)
    result = run("import", "-x", VECTORS / "xacro/robots/cart.xacro", "-o", "robot.toml")
    assert result.exit_code == 2
    assert "pip install lutgen[xacro]" in result.stderr


HIPS = ["FL_hip_joint", "FR_hip_joint", "RL_hip_joint", "RR_hip_joint"]


def imported(*arguments):
    return data("import", "quadruped.urdf", "-o", "q.toml", "--force", *arguments)


def test_the_recipe_says_which_joints_a_parameter_drives_and_why():
    good("import", "quadruped.urdf", "-o", "q.toml", "--force")
    text = Path("q.toml").read_text(encoding="utf-8")
    before, _, _ = text.partition('name = "hip"')
    comment = " ".join(before.replace("# ", "").split())
    assert '"FL_hip_joint", "FR_hip_joint" (times -1)' in comment
    assert "alike by name, and mirror images" in comment
    assert max(map(len, text.splitlines())) <= 110


def test_ten_joints_or_fewer_stay_independent():
    text = Path("quadruped.urdf").read_text(encoding="utf-8")
    for name in HIPS:
        text = text.replace(f'name="{name}" type="revolute"', f'name="{name}" type="fixed"')
    Path("quadruped.urdf").write_text(text, encoding="utf-8")
    report = imported()
    assert len(report["parameters"]) == 8
    assert (report["coupled"], report["because"]) == ({}, "")
    # Asked for, they are coupled as well.
    assert [*imported("--couple", "auto")["coupled"]] == ["thigh", "knee"]


def test_joints_signs_and_factors_are_taken_as_written():
    report = imported(
        "--couple", "front=FL_hip_joint,-FR_hip_joint,0.5*RL_hip_joint,-2*RR_hip_joint"
    )
    assert report["coupled"] == {"front": dict(zip(HIPS, [1.0, -1.0, 0.5, -2.0], strict=True))}
    assert report["parameters"] == ["front"]
    recipe = lutgen.load_recipe("q.toml")
    (front,) = recipe.parameters
    # Twice its value is within 0.8 rad.
    assert (front.minimum, front.maximum) == (pytest.approx(-0.4), pytest.approx(0.4))
    scales = {link.joint.scale for link in recipe.links if link.joint}
    assert scales == {1.0, -1.0, 0.5, -2.0}


def test_the_standing_posture_is_that_of_home_whatever_is_coupled():
    bent = ("-p", "FL_thigh_joint=10", "-p", "RR_thigh_joint=50")
    imported("-j", "FL_hip_joint", *bent)
    held = lutgen.load_recipe("q.toml")
    imported(
        "--couple", "all=*_thigh_joint", "--couple", "k=FL_knee_joint,-0.5*RR_knee_joint", *bent
    )
    coupled = lutgen.load_recipe("q.toml")
    one, two = forward(held, [held.home_params]), forward(coupled, [coupled.home_params])
    assert one.centres == pytest.approx(two.centres, abs=1e-12)
    assert one.com == pytest.approx(two.com, abs=1e-12)


def test_a_pattern_takes_signs_from_mirror_images_unless_they_are_written():
    report = imported("--couple", "hips=*_hip_joint", "--couple", "knees=knees")
    assert report["coupled"]["hips"] == dict(zip(HIPS, [1.0, -1.0, 1.0, -1.0], strict=True))
    assert set(report["coupled"]["knees"].values()) == {1.0}
    report = imported("--couple", "hips=+*_hip_joint")
    assert report["coupled"]["hips"] == dict.fromkeys(HIPS, 1.0)
    report = imported("--couple", "hips=-FL_hip_joint,R*_hip_joint")
    assert report["coupled"]["hips"] == {HIPS[0]: -1.0, HIPS[2]: -1.0, HIPS[3]: 1.0}


def test_where_even_groups_are_too_many_the_greatest_are_parameters():
    # Eight joints on each side of a row, heavier from one to the next: 16 joints in 8 pairs.
    foot = "".join(
        collision('sphere radius="0.05"', f"{x} {y} -0.5") for x in (1, -1) for y in (1, -1)
    )
    limits = '<axis xyz="{}"/><limit lower="-1" upper="1"/>'
    arms = "".join(
        link(f"{side}_{i}", 4.0 + i, "0 0 0.3")
        + joint(
            *(f"{side}_arm{i}", "revolute", "base", f"{side}_{i}", limits.format("1 0 0")),
            f"{i / 4 - 1} {y} 0.5",
        )
        for i in range(8)
        for side, y in (("left", 0.5), ("right", -0.5))
    )
    Path("many.urdf").write_text(robot(link("base", 9.0, inside=foot), arms), encoding="utf-8")
    report = data("import", "many.urdf", "-o", "many.toml", "--force")
    assert report["parameters"] == [f"arm_{i}" for i in range(2, 8)]
    assert "16 joints move contacts or com" in report["because"]
    held = [text for text in report["left_out"] if "changes less" in text]
    assert held == [
        "joints left_arm0, right_arm0, left_arm1, right_arm1: held, each changes less than those "
        "that are parameters"
    ]
    assert lutgen.load_recipe("many.toml").grid.size == 3**6
