"""What judges the verdict must itself be right: on geometry that is known, and on wrong answers."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="the extra `physics` is not installed")

from proofs.physics import ground, holding, judge, noisy, rockers, rocking
from proofs.physics.begin import Start
from proofs.physics.body import rigid_body
from proofs.physics.cases import CASES
from proofs.physics.nudged import fates, watched
from proofs.physics.pierced import heights, pierced
from proofs.physics.release import DOWN
from proofs.physics.robots import cap
from proofs.physics.slow import UNTIL, lag, slope_at_fall

# Torsion (m) with which no contact turns about the normal; that of a wheel's patch is 0.01.
FIRM = 1.0
TABLE = np.array([[0.1, 0.2, -0.3], [0.1, -0.2, -0.3], [-0.2, 0.2, -0.3], [-0.2, -0.2, -0.3]])


@pytest.mark.parametrize("name", [*CASES, "noisy car"])
def test_gravity_leaves_between_the_contacts_and_nothing_is_below_their_plane(name: str) -> None:
    # Together they are a proof: a mixture of points of the robot, and a plane that supports it.
    rng = np.random.default_rng(2)
    seen = 0
    while seen < 20:
        posture = noisy.car(rng, 1e-5) if name == "noisy car" else CASES[name].make(rng)
        directions = np.array([cap(rng, 60.0) for _ in range(40)])
        for down, place in zip(directions, pierced(posture, directions), strict=True):
            if place is None:
                continue
            seen += 1
            reach = heights(posture, place.normal[None])[0]
            assert reach.max() == pytest.approx(place.height, abs=1e-12)
            out = down * place.height / (place.normal @ down)
            # Two points of a wheel at which the search ended are 1e-7 m apart, and nearly in line.
            share = np.linalg.lstsq(
                np.vstack([place.points.T, np.ones(3)]), np.append(out, 1.0), rcond=1e-12
            )[0]
            assert share @ place.points == pytest.approx(out, abs=1e-7)
            assert share.min() > -1e-3 or place.is_line(posture)
            assert place.points @ place.normal == pytest.approx(place.height, abs=1e-9)


def test_a_ray_that_misses_the_contacts_leaves_nothing() -> None:
    sideways = np.array([[1.0, 0.0, -0.1], [0.0, 0.0, 1.0]])
    assert pierced(rigid_body(TABLE), sideways / np.linalg.norm(sideways, axis=1)[:, None]) == [
        None,
        None,
    ]


def test_a_noisy_car_stands_below_45_deg_and_falls_above_in_the_engine() -> None:
    posture = noisy.car(np.random.default_rng(3), 1e-5)
    tilts = [math.radians(45.0 + off) for off in (-1.0, 1.0, 6.0)]
    tried = np.array([noisy.leaning(tilt, 0.0) for tilt in tilts])
    fell = [
        any(fate.fell for fate in fates(posture, place, down))
        for down, place in zip(tried, pierced(posture, tried), strict=True)
        if place is not None
    ]
    assert fell == [False, True, True]


def test_a_rocking_chair_comes_to_rest_and_one_with_its_com_high_falls() -> None:
    angle = np.radians([-8.0, 0.0, 8.0])
    rail = np.stack([0.4 * np.sin(angle), 0.0 * angle, -0.4 * np.cos(angle)], axis=1)
    centres = np.concatenate([rail + side * np.eye(3)[1] for side in (-0.2, 0.2)])
    for com, falls in ((-0.2, 0), (0.3, 2)):
        posture = rigid_body(centres - [0.0, 0.0, com], 0.02, np.array([0.0, 1.0, 0.0]))
        # In balance on the middle wheels, which are the lowest by themselves for a moment.
        place = pierced(posture, DOWN[None])[0]
        assert place is not None
        assert place.is_line(posture)
        assert sum(fate.fell for fate in fates(posture, place, DOWN)) == falls


def test_the_slow_tilt_is_late_by_less_than_a_third_of_a_degree() -> None:
    late = np.degrees(lag(count=4))
    # It cannot be early, and `ground` relies on little spread.
    assert 0.1 < late.min() < late.max() < 0.35


def test_the_ground_is_tilted_in_the_heading_that_is_asked() -> None:
    posture = rigid_body(TABLE)
    begin = Start(DOWN, 0.3, TABLE)
    for heading, reach in ((0.0, 0.1), (0.5 * math.pi, 0.2), (math.pi, 0.2)):
        limit = math.atan2(reach, 0.3)
        slope = slope_at_fall(posture, begin, heading, UNTIL * limit)
        # The engine's lag, 0.1 to 0.35 deg.
        assert 0.1 < math.degrees(slope - limit) < 0.35


def test_a_robot_that_lies_up_to_80_deg_has_no_slope_of_fall() -> None:
    flat = rigid_body(TABLE * [30.0, 30.0, 1.0])
    assert math.isnan(slope_at_fall(flat, Start(DOWN, 0.3, flat.centres), 0.0, 1.0))


def test_an_answer_that_everything_stands_is_disproved_and_that_all_tips_is_not() -> None:
    trials = [rocking.Trial(1.0, 5.0, 2, 1, 1), rocking.Trial(-1.0, 5.0, 2, 0, 0)]
    (found,) = [rocking.row("any", trials)]
    assert (found.safe, found.fell, found.rests, found.tips, found.held) == (2, 1, 1, 2, 2)
    assert rocking.missed([found])
    assert not rocking.missed([rocking.row("any", trials[1:])])


def test_a_robot_may_fall_by_turning_about_one_contact_which_is_no_roll() -> None:
    # Six wheels of two rims each on rockers and bogies, on a slope of 53.8 deg: in balance over
    # the right front wheel, which carries 7 %, and the left rear one.
    wheels = [(0.33032, 0.3, -0.12406), (-0.04421, 0.3, -0.18131), (-0.30399, 0.3, -0.192)]
    wheels += [(0.28666, -0.3, -0.19138), (-0.09133, -0.3, -0.16445), (-0.34702, -0.3, -0.11726)]
    centres = np.array([[x, y + side, z] for x, y, z in wheels for side in (0.04, -0.04)])
    posture = rigid_body(centres, 0.1, np.array([0.0, 1.0, 0.0]), 28.6)
    down = np.array([-0.53269, 0.60558, -0.5912])
    down /= np.linalg.norm(down)
    place = pierced(posture, down[None])[0]
    assert place is not None
    assert place.is_line(posture)
    assert 0.3 < math.degrees(posture.tip_angle(down)) < 0.7
    firm = replace(posture, torsion=FIRM)
    assert any(fate.fell for fate in fates(posture, place, down))
    assert not any(fate.fell for fate in fates(firm, place, down))
    # Contacts that do not turn hold nothing that rolls over.
    beyond = np.array([-0.50, 0.66, -0.56])
    beyond /= np.linalg.norm(beyond)
    place = pierced(posture, beyond[None])[0]
    assert place is not None
    assert posture.tip_angle(beyond) < 0.0
    assert all(fate.fell for fate in fates(firm, place, beyond))


def test_the_releases_over_gaps_are_in_balance_and_both_outcomes_occur() -> None:
    rng = np.random.default_rng(5)
    falls = []
    while len(falls) < 12:
        posture = rocking.ROBOTS["3 to 8 balls"](rng)
        for down, place, turn in rocking.over_gaps(rng, posture):
            assert place.is_line(posture)
            assert rocking.NARROW <= turn <= rocking.WIDE
            falls.append(sum(fate.fell for fate in fates(posture, place, down)))
    assert min(falls) == 0
    assert max(falls) > 0


def test_a_fall_below_the_guarantee_is_counted_with_the_lag_taken_off() -> None:
    def row(slope: float) -> ground.Row:
        return ground.row("any", [ground.Fall((0.0,), 30.0, (30.0,), (slope,))], 0.2)

    assert row(30.2).broken == 0
    assert row(30.0).broken == 1
    assert row(math.nan).broken == 0
    assert ground.missed([row(30.0)])
    # A guarantee of nothing would never be broken: what a robot bears beyond it is shown.
    assert row(32.3).spared == pytest.approx(2.1)


def test_six_wheels_hold_and_move_as_their_brakes_do() -> None:
    for middle, tangent, moves in ((False, 0.3, False), (True, 0.3, False), (True, 0.6, True)):
        machine = holding.six(0.2, middle)
        assert machine.moves(holding.slope(tangent, 0.0)) is moves


def test_uneven_wheels_decide_whether_a_middle_axle_brakes() -> None:
    machine = holding.six(0.2, True)
    down = holding.slope(0.3, 0.0)
    lifted = tuple(
        solid
        if not solid.braked
        else holding.replace(solid, centre=solid.centre + 2e-4 * holding.UP)
        for solid in machine.solids
    )
    assert not machine.moves(down)
    assert holding.replace(machine, solids=lifted).moves(down)


def test_a_promise_that_is_not_kept_is_named() -> None:
    name = next(iter(holding.ROBOTS))
    assert holding.missed([holding.Trial(name, "holds", 1)], [])
    assert holding.missed([holding.Trial(name, "rolls", holding.SETS)], [])
    assert not holding.missed([holding.Trial(name, "may hold", 2)], [])
    assert holding.missed([], [holding.Known(name, 0.5, 0.5, 0.5, 0.4, 0.45)])


def test_a_sole_of_half_a_metre_goes_over_at_40_deg_and_rests_on_level_ground() -> None:
    sole = rockers.SOLES["2 x 60 wheels, 1.12 deg apart"]
    # Coarser by half a step of 1.12 deg than the smooth sole: 40.5 and 7.5 deg.
    assert np.degrees(sole.limits) == pytest.approx([40.5, 7.75], abs=0.3)
    begin = Start(DOWN, float(heights(sole.posture, DOWN[None]).max()), sole.posture.centres[:3])
    assert not watched(sole.posture, begin, DOWN).fell


def test_the_page_shows_what_was_judged() -> None:
    stored = json.loads(judge.STORED.read_text(encoding="utf-8"))
    text = judge.PAGE.read_text(encoding="utf-8")
    assert set(stored["tables"]) == set(stored["runs"]) == set(judge.PARTS)
    assert judge.page(text, "run", judge.summary(stored["runs"], stored["faults"])) == text
    for name, content in stored["tables"].items():
        assert judge.page(text, name, content) == text
    for names in (rocking.ROBOTS, ground.ROBOTS, holding.ROBOTS, rockers.SOLES):
        for name in names:
            assert f"| {name} |" in text
