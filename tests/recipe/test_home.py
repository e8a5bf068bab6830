"""The key `home`: what it may hold, and which commands and figures stand there."""

import math

import pytest

import lutgen
from tests.fixtures.commands import data
from tests.fixtures.commands import stdout as said_by
from tests.fixtures.places import VECTORS
from tests.fixtures.recipes import sweep_part, tripod
from tests.fixtures.robots import collision, joint, link

WHOLE = "home = { reach = 0.1, swing = 20 }"
HALF = "home = { swing = 20 }"


@pytest.fixture
def path(tmp_path):
    file = tmp_path / "tripod.toml"
    file.write_text(tripod(head=WHOLE), encoding="utf-8")
    return file


def test_home_becomes_radians_and_the_middle_fills_what_it_leaves_out():
    recipe = lutgen.parse_recipe(tripod(head=WHOLE))
    assert recipe.home == {"reach": 0.1, "swing": math.radians(20.0)}
    assert recipe.home_params == (0.1, math.radians(20.0))
    half = lutgen.parse_recipe(tripod(head=HALF))
    assert half.home_params == (0.3, math.radians(20.0))
    none = lutgen.parse_recipe(tripod())
    assert none.home == {}
    # The middle is that of the two ends in rad, which rounds otherwise than 5 deg.
    assert none.home_params == pytest.approx((0.3, math.radians(5.0)), rel=1e-15)


def test_eval_limits_and_metrics_stand_at_home_and_say_so(path):
    for command in ("eval", "limits", "metrics"):
        found = data(command, path)
        given = data(command, path, "-p", "reach=0.1", "-p", "swing=20")
        assert found.pop("posture_from") == "home"
        if command == "eval":
            assert found["posture"] == {"reach_m": 0.1, "swing_deg": pytest.approx(20.0)}
        same = {key: value for key, value in found.items() if key != "posture"}
        assert same.items() <= given.items()
    assert "posture        reach = 0.1 m, swing = 20 deg (home)" in said_by("eval", path)
    assert "reach = 0.1 m, swing = 20 deg (home)\n" in said_by("limits", path)


def test_what_is_given_comes_first_and_the_middle_last(path):
    path.write_text(tripod(head=HALF), encoding="utf-8")
    mixed = data("eval", path)
    assert mixed["posture_from"] == "home: swing; middle of the range: reach"
    assert mixed["posture"]["reach_m"] == pytest.approx(0.3)
    assert data("eval", path, "-p", "swing=0")["posture_from"] == "middle of the range: reach"
    assert data("eval", path, "-p", "reach=0")["posture_from"] == "home: swing"
    path.write_text(tripod(), encoding="utf-8")
    assert data("limits", path)["posture_from"] == "middle of the range"


def test_check_warns_where_the_robot_lies_on_its_body_or_tips_at_home(path, caplog):
    belly = '[[robot.link]]\nname = "belly"\nparent = "body"\nmass = 0.5\ncom = [0.0, 0.0, -1.5]\n'
    text = path.read_text(encoding="utf-8")
    text = text.replace("[[robot.contact]]", f"{belly}[[robot.contact]]", 1)
    path.write_text(text, encoding="utf-8")
    (warning,) = data("check", path)["warnings"]
    assert "lies on its body" in warning
    assert "belly 0." in warning
    assert "body 0" not in warning
    assert warning in caplog.text
    # Without `home` nobody said that it stands there, and without the belly it stands.
    for silent in (text.replace(WHOLE, ""), text.replace(belly, "")):
        path.write_text(silent, encoding="utf-8")
        assert data("check", path)["warnings"] == []
    # With the leg drawn in, the centre of mass is ahead of it; stretched out the robot stands.
    text = tripod(head="home = { reach = 0.0, swing = 0.0 }")
    path.write_text(text.replace("com = [0.02, 0.03, 0.1]", "com = [0.95, 0, 0.1]"))
    (warning,) = data("check", path)["warnings"]
    assert "tips over on level ground" in warning


def test_shapes_of_a_description_are_body_too(tmp_path):
    # A ball under the chassis of the rover, so large that it reaches through the ground.
    urdf = (VECTORS / "rover.urdf").read_text(encoding="utf-8")
    keel = link("keel", inside=collision('sphere radius="0.3"'))
    keel += joint("keel_fixed", "fixed", "chassis", "keel")
    links = ("left_arm", "right_arm", "left_wheel", "right_wheel")
    recipe = tmp_path / "named.toml"
    recipe.write_text(
        '[robot]\nname = "rover"\nlength_unit = "m"\nurdf = "robot.urdf"\nhome = { arms = 0 }\n'
        '[[robot.parameter]]\nname = "arms"\nmin = -45.0\nmax = 45.0\nunit = "deg"\n'
        + "".join(f'[[robot.contact]]\nlink = "{name}"\n' for name in links)
        + sweep_part("arms = 3")
    )
    (tmp_path / "robot.urdf").write_text(urdf.replace("</robot>", f"{keel}</robot>"))
    (warning,) = data("check", recipe)["warnings"]
    # Wheels of 0.1 m about the chassis' origin, a ball of 0.3 m there.
    assert "keel 0.2 m" in warning
    (tmp_path / "robot.urdf").write_text(urdf)
    assert data("check", recipe)["warnings"] == []
