"""What judges verdicts and imports must itself be right: on what is known, and on wrong answers."""

import math
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")
pytest.importorskip("pinocchio", reason="the extra `physics` is not installed")

from proofs import robots
from proofs.physics import agreement, braking, ground, holding, judge, rocking
from proofs.physics.body import Posture, body
from proofs.physics.start import start
from tests.fixtures.meshes import cylinder, write, written
from tests.fixtures.robots import joint, link, robot

TABLE = np.array([[0.1, 0.2, -0.3], [0.1, -0.2, -0.3], [-0.2, 0.2, -0.3], [-0.2, -0.2, -0.3]])


@pytest.mark.parametrize(
    ("off", "lean", "what"), [(-0.03, 17.0, "held on a facet"), (0.03, 20.0, "fell where safe")]
)
def test_a_com_off_by_3_cm_is_found(off, lean, what, monkeypatch):
    posture, t = body(TABLE), math.radians(lean)
    down = np.array([math.sin(t), 0.0, -math.cos(t)])
    tried = [(down, start(posture, down))]
    assert judge.missed("agreement", {"table": agreement.counted(posture, tried)}) == []
    true = Posture.tip_angles

    def wrong(posture, gravity_dir):
        moved = tuple(replace(s, centre=s.centre + off * np.eye(3)[0]) for s in posture.solids)
        return true(replace(posture, solids=moved), gravity_dir)

    monkeypatch.setattr(Posture, "tip_angles", wrong)
    found = judge.missed("agreement", {"table": agreement.counted(posture, tried)})
    assert found == [f"agreement, table: 1 {what}"]


def test_an_answer_that_every_gap_is_safe_is_disproved(monkeypatch):
    monkeypatch.setattr(rocking, "CHUNK", 6)
    name = "marv"
    assert judge.missed("rocking", {name: judge.judged("rocking", name, 0)}) == []
    monkeypatch.setattr(Posture, "tip_angles", lambda _, gravity_dir: np.ones(len(gravity_dir)))
    assert judge.missed("rocking", {name: judge.judged("rocking", name, 0)})


def test_a_guarantee_of_5_deg_too_much_is_broken(monkeypatch):
    said = ground.promised
    monkeypatch.setattr(ground, "HEADINGS", np.zeros(0))
    home = ground.gallery("marv"), np.array(ground.gallery("marv").home_params)
    assert judge.missed("ground", {"marv": ground.tilted(*home)}) == []

    def generous(*given):
        promise, headings, limits = said(*given)
        return promise + math.radians(5.0), headings, limits

    monkeypatch.setattr(ground, "promised", generous)
    assert judge.missed("ground", {"marv": ground.tilted(*home)})


def test_wheels_that_are_said_to_hold_and_roll_are_found(monkeypatch):
    monkeypatch.setattr(holding, "CHUNK", 3)
    name = "six wheels, only the middle ones braked"
    monkeypatch.setattr(holding, "said", lambda *_: "holds")
    assert judge.missed("holding", {name: judge.judged("holding", name, 0)})


def test_a_budget_of_a_tenth_more_is_too_much(monkeypatch):
    monkeypatch.setattr(braking, "CHUNK", 3)
    assert judge.missed("braking", {"excavator": judge.judged("braking", "excavator", 0)}) == []
    said = braking.budgets
    monkeypatch.setattr(braking, "budgets", lambda *given: 1.1 * said(*given))
    assert judge.missed("braking", {"excavator": judge.judged("braking", "excavator", 0)})


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
