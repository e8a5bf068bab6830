"""What judges the verdict must itself be right: on geometry that is known, and on wrong answers."""

import math
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")

from proofs.physics import agreement, braking, ground, holding, judge, rocking
from proofs.physics.body import Posture, body
from proofs.physics.start import start

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
