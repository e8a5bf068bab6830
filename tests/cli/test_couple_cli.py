"""`lutgen import --couple`: joints grouped as asked for, or as proposed."""

import shutil
from pathlib import Path

import pytest

import lutgen
from lutgen.recipe import forward
from tests.fixtures.commands import data, good
from tests.fixtures.places import VECTORS
from tests.fixtures.robots import collision, joint, link, robot

HIPS = ["FL_hip_joint", "FR_hip_joint", "RL_hip_joint", "RR_hip_joint"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Return a folder with the quadruped, made the working folder."""
    for name in ("quadruped.urdf", "quadruped.srdf"):
        shutil.copy(VECTORS / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def imported(*arguments):
    return data("import", "quadruped.urdf", "-o", "q.toml", "--force", *arguments)


def test_more_than_ten_joints_are_coupled():
    imported()
    recipe = lutgen.load_recipe("q.toml")
    assert recipe.home == pytest.approx({"hip": 0.0, "thigh": 0.7, "knee": -1.4})
    # 17 nodes each: a map of 4,913 postures.
    assert recipe.grid.size == 17**3
    assert data("eval", "q.toml", "-g", "0,0,-1")["standing"] is True


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
