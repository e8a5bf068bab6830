"""On-board control: promises of a cycle, attacked in small; `proofs.control` does so at length."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from firmware_export.contacts import INFO as contacts
from firmware_export.control import maker
from firmware_export.control.limits import limits_of
from firmware_export.host import Controller
from firmware_export.model import Model
from firmware_export.protocol import Joint, Policy, describe
from lutgen.errors import InputError
from lutgen.recipe import load_recipe
from proofs import control
from proofs.steered import BLIND, Steered, robot
from tests.fixtures.length import part

LEVEL = np.array([[0.0, 0.0, control.G0]])
MOVES, RESTS = 0, 1


@cache
def paper():
    """Return the paper's robot with a price on moving, so that its table has something to say."""
    with pytest.MonkeyPatch.context() as patch:
        # What is promised of ways holds whatever the table says.
        patch.setattr(maker, "POSTURES", 400)
        patch.setattr(maker, "UNSEEN", 500)
        return robot("paper_two", objective="tip_angle-0.5*move2", within=1e-9)


def swift():
    """Return that robot with commands that take 0.5 s, and a table that is a slope each way."""
    one = paper()
    count = len(one.policy.codes)
    along = np.linspace(64, 192, count).astype(np.uint8)
    codes = np.stack(np.meshgrid(along, along, indexing="ij"), axis=2)
    ends = zip(one.policy.joints, one.model.lower, one.model.upper, strict=True)
    joints = tuple(j._replace(low=a, code=(b - a) / 255.0, rate=0.05) for j, a, b in ends)
    return replace(one, policy=replace(one.policy, latency=0.5, codes=codes, joints=joints))


def test_no_posture_of_a_certified_way_is_nearer_to_tipping_than_promised():
    count = part(3000, 12)
    found = control.transits(paper(), count, inside=12)
    assert found.promised > count // 2
    assert (found.faults, found.below) == (0, 0)


def test_ways_on_an_axle_that_swings_are_certified():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(maker, "POSTURES", 100)
        patch.setattr(maker, "UNSEEN", 20)
        tractor = robot("tractor", nodes=3)
    count = part(20_000, 12)
    found = control.transits(tractor, count, inside=12)
    assert found.promised > 0.4 * count
    assert (found.faults, found.below) == (0, 0)
    found = control.budgets(tractor, 1000)
    assert found.faults == 0
    assert found.share > 0.95


@pytest.mark.parametrize("name", ["marv", "absolem"])
def test_contacts_in_a_box_of_postures_are_as_near_its_middle_as_a_policy_says(name):
    model, rng = Model(load_recipe(f"recipe:{name}")), np.random.default_rng(5)
    limits = limits_of(model)
    half = rng.uniform(0.0, 0.15, (2000, model.k)) * (model.upper - model.lower)
    middle = model.at(rng.random(half.shape))
    inside = np.clip(middle + half * rng.uniform(-1.0, 1.0, half.shape), model.lower, model.upper)
    there, here = (model.postures(params).centres for params in (inside, middle))
    off = half @ limits.bend + (half * limits.reach).max(axis=1)
    share = np.linalg.norm(there - here, axis=2).max(axis=1) / off
    # A margin of a tenth is on both bounds.
    assert 0.8 < share.max() < 1.0


def test_a_damaged_table_costs_margin_but_no_safety():
    found = control.damaged(paper(), 40)
    assert found.promised > 1000
    assert found.faults == 0


def test_on_a_fixed_slope_the_robot_comes_to_rest():
    found = control.fixed_slopes(paper(), 200, cycles=300, tail=50)
    assert found.promised > 150
    assert found.faults == 0


def test_budgets_are_never_too_large_and_nearly_as_large_as_they_may_be():
    found = control.budgets(paper(), 2000)
    assert found.faults == 0
    assert found.share > 0.95  # the median, in four reads


def test_commands_keep_axes_and_rates_whatever_bits_come_in():
    found = control.bits(paper(), 5000)
    assert found.promised > 5000
    assert found.faults == 0


def test_the_slope_is_that_of_the_ground_whatever_the_posture():
    one, rng = paper(), np.random.default_rng(7)
    params = one.model.at(rng.random((50, 2)))
    slopes = np.tile([0.2, -0.1, -1.0], (50, 1)) / np.linalg.norm([0.2, -0.1, -1.0])
    found, status = one.controller().ground(params, -one.down(params, slopes))
    assert (status == 0).all()
    np.testing.assert_allclose(found, slopes, atol=2e-6)  # singles


@pytest.mark.parametrize("wrong", [np.nan, 1e30, 0.0])
def test_an_implausible_sensor_holds_the_last_command_and_alarms(wrong):
    one = paper()
    controller, posture = one.controller(), one.model.at(np.array([[0.5, 0.5]]))
    before, _, status = controller.step(posture, LEVEL)
    assert status[0] == 0
    command, cycle, status = controller.step(posture, LEVEL * wrong)
    assert (status[0], cycle["move"][0], cycle["alarm"][0]) == (6, BLIND, 3)
    np.testing.assert_array_equal(command, before)


def test_an_accelerometer_that_is_stuck_while_the_robot_turns_is_not_believed():
    one = paper()
    controller, posture = one.controller(), one.model.at(np.array([[0.5, 0.5]]))
    moves = [controller.step(posture, LEVEL, [[1.0, 0.0, 0.0]])[1]["move"][0] for _ in range(20)]
    assert moves[0] != BLIND
    assert moves[-1] == BLIND


def test_the_alarm_rises_at_once_and_falls_late():
    one = paper()
    controller, posture = one.controller(), one.model.at(np.array([[0.0, 0.0]]))
    flat = [controller.step(posture, LEVEL)[1] for _ in range(2)][-1]
    assert flat["alarm"][0] == 0
    lean = flat["tip"][0] - np.radians(4.0)
    steep = [[control.G0 * np.sin(lean), 0.0, control.G0 * np.cos(lean)]]
    # Further than a cycle explains: not believed once, then seen.
    levels = [controller.step(posture, steep)[1]["alarm"][0] for _ in range(3)]
    assert max(levels) >= 2
    again = [int(controller.step(posture, LEVEL)[1]["alarm"][0]) for _ in range(60)]
    assert again[0] >= 2
    assert again[-1] == 0


def test_a_policy_of_another_map_or_with_a_wrong_bit_is_refused():
    one = paper()
    packed = one.policy.packed(one.blob.bytes)
    Controller(one.blob, packed)
    for at in (0, 9, 20, 60, len(packed) - 1):
        broken = bytearray(packed)
        broken[at] ^= 4
        with pytest.raises(InputError, match="refused"):
            Controller(one.blob, bytes(broken))


def test_prediction_sees_gravity_where_the_gyroscope_says_it_will_be():
    one = paper()
    posture = one.model.at(np.array([[0.2, 0.2]]))
    still = one.controller().step(posture, LEVEL)[1]["tip"][0]
    turning = one.controller().step(posture, LEVEL, [[0.0, 1.0, 0.0]])[1]
    assert turning["tip"][0] < still
    assert turning["left"][0] == pytest.approx(turning["tip"][0], rel=1e-3)  # at 1 rad/s


def _after_a_step(one, before, after, rate):
    """Return the command (1, k) on level ground at the second of two postures (1, k)."""
    controller, level = one.controller(), np.array([[0.0, 0.0, -1.0]])
    controller.step(before, -control.G0 * one.down(before, level))
    command, cycle, _ = controller.step(after, -control.G0 * one.down(after, level), rate)
    assert cycle["move"][0] in (MOVES, RESTS)
    return command


def test_the_table_is_asked_by_the_slope_that_the_ground_is_turning_to():
    one, level = swift(), np.array([[0.0, 0.0, -1.0]])
    posture = one.controller().target(level).astype(float)
    rate = np.array([[0.3, 0.4, 0.0]])  # gravity turns against it, for the policy's 0.5 s
    down = one.down(posture, level)
    slope, _ = one.controller().ground(posture, -(down + 0.5 * np.cross(down, rate)))
    most = np.array([joint.rate for joint in one.policy.joints])
    wanted = posture + np.clip(one.controller().target(slope) - posture, -most, most)
    assert np.abs(wanted - posture).max() > 0.02
    np.testing.assert_allclose(_after_a_step(one, posture, posture, rate), wanted, atol=1e-5)
    np.testing.assert_allclose(_after_a_step(one, posture, posture, None), posture, atol=1e-5)


def test_the_robot_s_own_lean_is_no_turn_of_the_ground():
    one, level = swift(), np.array([[0.0, 0.0, -1.0]])
    target = one.controller().target(level).astype(float)
    before, after = target - 0.03, target - 0.01
    felt = np.cross(one.down(after, level), one.down(before, level)) / one.policy.cycle
    assert np.linalg.norm(felt) > 0.2
    with_it, without = (_after_a_step(one, before, after, rate) for rate in (felt, None))
    np.testing.assert_allclose(with_it, target, atol=1e-5)
    np.testing.assert_allclose(without, target, atol=1e-5)


def test_the_driver_is_followed_within_delta():
    one = paper()
    joints = tuple(joint._replace(delta=0.05) for joint in one.policy.joints)
    controller = one.controller(policy=replace(one.policy, joints=joints))
    wanted, slopes = one.model.at(np.random.default_rng(1).random((50, 2))), np.zeros((50, 3))
    slopes[:, 2] = -1.0
    target = controller.target(slopes, wanted)
    assert (np.abs(target - wanted) <= 0.05 + 1e-6).all()


@cache
def crawler():
    """Return absolem with a policy that was not looked for: ways alone are asked."""
    model = Model(load_recipe("recipe:absolem"))
    export = contacts.export(model, "absolem", ("tip_angle",))
    joints = [Joint(0.0, 1e-3, 0.0314, 6.28, 0.00314, 0.354, 0.0045, x) for x in (1.35, 1.11)]
    policy = Policy(
        np.zeros((2, 2, 2), np.uint8), 1.0, tuple(joints), 0.02, 0.06, 0.05, (0.3, 0.2, 0.1), 0.5
    )
    return Steered(model, describe(export), policy)


def test_a_contact_that_hangs_low_over_a_rest_may_carry_elsewhere_in_the_box():
    # In the middle the tracks hang 1.9, 1.8 and 0.9 mm over a plane on which flippers' tips stand.
    one = crawler()
    start = np.radians([[-143.62, 16.40], [-151.14, 13.23], [-11.30, 31.11]])
    end = np.radians([[-143.23, 17.90], [-150.62, 11.93], [-10.49, 32.20]])
    down = np.array([[-0.796, 0.272, -0.541], [-0.781, -0.086, -0.619], [-0.601, 0.357, -0.715]])
    inside = np.radians([[-143.48, 17.90], [-151.14, 13.23], [-10.64, 31.15]])
    turned = np.array([[-0.793, 0.308, -0.526], [-0.782, -0.100, -0.615], [-0.601, 0.357, -0.715]])
    least = one.controller().transit(start, end, down)
    assert (least <= one.tip(inside, turned) + 1e-4).all()


def test_of_many_contacts_a_budget_is_what_the_boundary_leaves():
    found = control.budgets(crawler(), 300)
    assert found.faults == 0
    assert found.share > 0.99
