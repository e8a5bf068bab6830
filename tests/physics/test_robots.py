"""What compares imported robots must itself be right: on a car whose numbers are known."""

import math

import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")
pytest.importorskip("pinocchio", reason="the extra `physics` is not installed")

from proofs import robots
from tests.fixtures.meshes import cylinder, write, written
from tests.fixtures.robots import joint, link, robot


@pytest.fixture
def car(tmp_path):
    """Return a car of 10 kg on four wheels that are meshes, and a mast that leans by a joint."""
    write(tmp_path / "wheel.stl", cylinder(0.1, 0.05, 48))
    inertia = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    parts = [link("base", 10.0, "0 0 0.1")]
    for name, x, y in (("a", 0.3, 0.2), ("b", 0.3, -0.2), ("c", -0.3, 0.2), ("d", -0.3, -0.2)):
        parts += [
            link(name, 1.0, inside=written("wheel.stl")),
            joint(f"{name}_axle", "continuous", "base", name, '<axis xyz="0 1 0"/>', f"{x} {y} 0"),
        ]
    lean = '<axis xyz="0 1 0"/><limit lower="0.2" upper="1" effort="1" velocity="1"/>'
    parts += [link("mast", 2.0, "0 0 0.5"), joint("lean", "revolute", "base", "mast", lean)]
    path = tmp_path / "car.urdf"
    path.write_text(robot(*parts).replace("</inertial>", inertia), encoding="utf-8")
    return path


def test_mass_and_com_are_pinocchios_and_a_wrong_posture_is_named(car):
    described, posture, source, made = robots.imported(car)
    recipe = made.recipe
    assert source == "zero, no SRDF names one to stand in"
    assert robots.parameters(made) == "lean"
    assert made.guessed[0].startswith("a, b, c, d: a wheel of radius 100.00 mm")
    assert robots.weighed(car, described, posture, recipe) == []
    faults = robots.weighed(car, described, {"lean": 0.5}, recipe)
    # The mast's com goes from 0.5 sin(0.2) to 0.5 sin(0.5) m: by 0.02 m for 2 of 16 kg.
    assert faults == [f"com of the recipe differs by {(math.sin(0.5) - math.sin(0.2)) / 16:.2g}"]


def test_the_engine_agrees_with_the_limits_and_not_with_wrong_ones(car, monkeypatch):
    monkeypatch.setattr(robots, "HEADINGS", 4)
    recipe = robots.imported(car)[3].recipe
    assert robots.engine(recipe) == [robots.CLOSE] * 4
    before = robots.tilt_limits
    monkeypatch.setattr(robots, "tilt_limits", lambda *given: before(*given) + math.radians(0.5))
    assert robots.engine(recipe) == [math.inf] * 4
