"""Wheels that roll freely: what holds the robot, where it rolls away, and how it tips then."""

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import linprog

import lutgen
from lutgen.analysis import hold_limits, holds, may_hold, roll_limits, rolling_gravity, rolls
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.forces import load_corners
from lutgen.analysis.friction import held_share
from lutgen.analysis.posture import Posture
from lutgen.analysis.resistance import BRAKED, least_resistance
from lutgen.analysis.tilt import tilted
from lutgen.support import DISC
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import contact, rigid

LEFT = math.pi / 2.0
# Front left, front right, rear left, rear right; the com half a metre above the ground.
PLACES = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
FRONT, REAR, ALL = (0, 1), (2, 3), (0, 1, 2, 3)


def cart(rolling, friction=0.8, ball=(), toe=0.0, places=PLACES):
    """Return a recipe of wheels; `toe` (rad) turns the left ones about the vertical."""
    wheels = ""
    for i, (x, y) in enumerate(places):
        angle = toe if y > 0.0 else 0.0
        axis = None if i in ball else (-math.sin(angle), math.cos(angle), 0.0)
        wheels += contact(f"w{i}", (x, y, -0.4), 0.1, axis)
        wheels += "rolling = true\n" if i in rolling else ""
    head = "" if friction is None else f"friction = {friction}"
    return rigid(wheels, name="cart", head=head)


def parsed(*arguments, **options):
    return lutgen.parse_recipe(cart(*arguments, **options))


def test_a_cart_braked_at_one_axle_rolls_where_that_axles_load_times_friction_is_too_little():
    # With the nose down by t the rear axle carries (1 - tan t) / 2, uphill, and tan t = 0.8 x that.
    rear_braked, front_braked = math.atan(0.4 / 1.4), math.atan(0.4 / 0.6)
    limits = np.array([rear_braked, front_braked])
    for rolling, expected in ((FRONT, limits), (REAR, limits[::-1])):
        found = roll_limits(Posture(parsed(rolling), []), [0.0, math.pi])
        assert found == pytest.approx(expected, abs=2e-8)  # it is halved to 1e-7 deg


def test_without_brakes_a_cart_rolls_but_straight_across_and_braked_all_over_it_never_rolls():
    down = tilted(math.radians(0.01), np.radians([0.0, 30.0, 89.0, 180.0, 300.0]))
    assert rolls(Posture(parsed(ALL, 0.5), []), down).all()
    assert not rolls(Posture(parsed(ALL, 0.5), []), [[0.0, 0.0, -1.0]]).any()
    assert not rolls(Posture(parsed(()), []), tilted(0.65, np.linspace(0.0, 6.0, 40))).any()
    # Across them friction holds it up to atan 0.5.
    across = tilted([math.atan(0.5) - 1e-6, math.atan(0.5) + 1e-6], LEFT)
    assert rolls(Posture(parsed(ALL, 0.5), []), across).tolist() == [False, True]


def test_without_friction_brakes_hold_whatever_carries_load():
    for rolling in (FRONT, REAR, (0,), (0, 1, 2), (0, 3)):
        gentle = tilted(0.3, np.linspace(0.0, 6.0, 25))
        assert not rolls(Posture(parsed(rolling, None), []), gentle).any()
    # Leaning to the front left the rear right wheel, the only braked one, need not carry anything,
    # and could carry something: whether it does, decides.
    lean = tilted(0.6, math.radians(45.0))
    corner = diagnose(Posture(parsed((0, 1, 2)), []), lean)
    assert corner.normal_forces["w3"] == 0.0
    assert corner.normal_ranges["w3"][1] > 0.1
    assert not holds(Posture(parsed((0, 1, 2), None), []), lean).any()
    assert may_hold(Posture(parsed((0, 1, 2), None), []), lean).all()


def test_a_robot_on_balls_swings_round_its_only_brake():
    # The rear right wheel is braked and the others are balls: gravity has an arm about it.
    caster = parsed((0, 1, 2), None, ball=(0, 1, 2))
    assert rolls(Posture(caster, []), tilted(0.2, [0.0, LEFT, 1.0])).all()
    away = math.atan2(0.4, 0.5)
    assert not rolls(Posture(caster, []), tilted(0.2, [away, away + math.pi])).any()
    assert rolls(Posture(caster, []), tilted(0.2, [away + 1e-3])).all()
    assert rolls(Posture(parsed(ALL, 0.9, ball=ALL), []), tilted(1e-3, [0.0, 2.0, 4.0])).all()


def by_forces(posture, direction, load=None):
    """Return the largest downhill pull that friction forces balance, per unit of friction.

    A linear programme over the forces themselves, and without a load over the normal forces, too;
    the circle of friction is a polygon of 360 sides inside it.
    """
    facet = posture.under(direction)
    frame = facet.frame(direction)
    places, count = facet.touching_points @ frame.T, len(facet.touching)
    turns = np.arange(360) * (2.0 * math.pi / 360)
    rays, owner = [np.empty((0, 2))], list[int]()
    for place, i in enumerate(facet.touching):
        part, fan = posture.recipe.contacts[i], np.stack([np.cos(turns), np.sin(turns)], axis=1)
        if part.rolling and part.kind == "sphere":
            continue
        if part.rolling:
            x, y = frame @ np.cross(posture.placed.axes[0, i], facet.normal)
            fan = (
                np.array([[-y, x], [y, -x]]) / math.hypot(x, y) if part.kind == "disc" else rays[0]
            )
        rays.append(fan)
        owner += [place] * len(fan)
    ray = np.vstack(rays)
    at, pull = places[owner], np.array([[1.0], [0.0], [0.0]])
    # Unknown: strengths along the rays, the normal forces, the pull.
    moments = at[:, 0] * ray[:, 1] - at[:, 1] * ray[:, 0]
    rows = [np.hstack([np.vstack([ray.T, moments]), np.zeros((3, count)), pull])]
    right, carried = [0.0] * 3, [(share, share) for share in load] if load is not None else []
    if load is None:
        upright = np.vstack([np.ones(count), (places - facet.pierced(direction) @ frame.T).T])
        rows.append(np.hstack([np.zeros((3, len(ray))), upright, np.zeros((3, 1))]))
        right, carried = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0], [(0.0, None)] * count
    best = linprog(
        np.append(np.zeros(len(ray) + count), -1.0),
        A_ub=np.hstack([np.eye(count)[:, owner], -np.eye(count), np.zeros((count, 1))]),
        b_ub=np.zeros(count),
        A_eq=np.vstack(rows),
        b_eq=right,
        bounds=[*[(0.0, None)] * len(ray), *carried, (0.0, None)],
    )
    assert best.status == 0
    return float(best.x[-1])


def test_the_held_shares_are_what_friction_forces_balance_under_the_worst_and_the_best_load():
    rng = np.random.default_rng(5)
    seen = []
    kinds = list(itertools.product([(0,), FRONT, (0, 3), (0, 2), (0, 1, 2), ALL], (0.0, 0.3)))
    postures = [
        Posture(parsed(rolling, 0.8, ball=(0,) if len(rolling) == 1 else (), toe=toe), [])
        for rolling, toe in kinds
    ]
    postures += [six(MIDDLE), six(ENDS), six((0, 3))]
    for posture in postures:
        for heading, tilt in zip(rng.uniform(0.0, 2.0 * math.pi, 2), (0.1, 0.5), strict=True):
            direction = tilted(tilt, heading)
            facet = posture.under(direction)
            every = held_share(posture, facet, direction)
            some = held_share(posture, facet, direction, "some")
            assert every <= some + 1e-10  # what a search misses
            # The polygon of 360 sides lies inside the circle by 4e-5.
            assert by_forces(posture, direction) == pytest.approx(some, rel=1e-4, abs=1e-7)
            loads = load_corners(facet.touching_points, facet.pierced(direction))
            worst = min(by_forces(posture, direction, load) for load in loads)
            assert worst == pytest.approx(every, rel=1e-4, abs=1e-7)
            # Mixtures lie between.
            mixed = by_forces(posture, direction, rng.dirichlet(np.ones(len(loads))) @ loads)
            assert every * (1.0 - 1e-4) - 1e-7 <= mixed <= some * (1.0 + 1e-4) + 1e-7
            seen.append((every, some))
    assert min(every for every, _ in seen) < 1e-6
    assert sum(some - every > 0.1 for every, some in seen) > 8
    assert max(some for _, some in seen) <= 1.0


# Three axles: the middle one is on no corner of the polygon.
SIX = [(x, y) for x in (0.5, 0.0, -0.5) for y in (0.4, -0.4)]
MIDDLE, ENDS = (2, 3), (0, 1, 4, 5)


def six(rolling):
    return Posture(parsed(rolling, 0.7, places=SIX), [])


def ahead(*slopes):
    """Return gravity with the nose down by slopes, given by their tangents."""
    return tilted(np.arctan(slopes), 0.0)


def test_a_six_wheeler_braked_in_the_middle_holds_as_far_as_these_wheels_may_carry_it():
    # D_g is tan t x 0.5 ahead, so that they carry up to 1 - tan t: 0.7 (1 - tan t) = tan t.
    limit = 0.7 / 1.7
    assert may_hold(six(ENDS), ahead(0.02, limit - 1e-7, limit + 1e-7)).tolist() == [1, 1, 0]
    assert rolls(six(ENDS), ahead(0.02, limit - 1e-7, limit + 1e-7)).tolist() == [0, 0, 1]
    assert not holds(six(ENDS), ahead(0.02)).any()
    assert roll_limits(six(ENDS), [0.0]) == pytest.approx([math.atan(limit)], abs=2e-8)
    assert hold_limits(six(ENDS), [0.0])[0] < 2e-8


def test_rolling_straight_it_tips_under_gravity_without_its_part_along_the_wheels():
    down = np.array([0.6, 0.3, -1.0]) / math.sqrt(1.45)
    free = rolling_gravity(Posture(parsed(ALL), []), down)
    assert rolling_gravity(Posture(parsed(ALL, ball=ALL), []), down) == pytest.approx([0, 0, -1])
    assert free == pytest.approx(np.array([0.0, 0.3, -1.0]) / math.sqrt(1.09), abs=1e-15)
    # Held on that slope it tips over its nose (0.5 ahead, 0.5 high) from 45 deg on; rolling never.
    steep = tilted(math.radians(50.0), 0.0)
    rolling = rolling_gravity(Posture(parsed(ALL), []), steep)
    angle = lutgen.evaluate(parsed(ALL), [[]], [steep, rolling], ("tip_angle",))["tip_angle"][0]
    assert angle[0] == pytest.approx(math.radians(-5.0), abs=1e-12)
    assert angle[1] == pytest.approx(math.atan(0.4 / 0.5), abs=1e-12)
    # None with a brake, with toed wheels, and with one axle and two balls that swing downhill.
    assert rolling_gravity(Posture(parsed((0, 1, 2)), []), steep) is None
    assert rolling_gravity(Posture(parsed(ALL, toe=0.1), []), steep) is None
    tail = Posture(parsed(ALL, ball=REAR), [])
    assert rolling_gravity(tail, steep) is not None
    assert rolling_gravity(tail, tilted(0.2, 0.4)) is None


def test_the_guide_says_from_which_tilts_on_it_may_hold_and_rolls():
    page = (ROOT / "docs/guide/metrics.md").read_text(encoding="utf-8")
    posture = Posture(parsed(FRONT, 0.7), [])
    for limit, said in ((hold_limits, "13.78 deg"), (roll_limits, "14.53 deg")):
        assert f"{math.degrees(limit(posture, [0.0])[0]):.2f} deg" == said
        assert said in page


def test_a_wheel_that_rolls_a_rounding_off_straight_across_hides_no_minimum():
    # cos(pi/2) is 6e-17: the place where such a wheel alone costs least is 1e7 robots away.
    straight = math.cos(math.pi / 2.0)
    roll = np.array([[straight, 1.0]] * 3)
    arm = np.array([[-1.0, -0.22923384], [-0.79232514, 0.85038073], [0.98083124, 0.09360786]])
    motion, load = np.array([float(DISC), BRAKED, float(DISC)]), np.array([[0.25, 0.36, 0.39]])
    # Least about the braked wheel, where only the two others cost, across their rolling.
    turn = 1.0 / arm[1, 1]
    expected = 0.25 * abs(1.0 - turn * arm[0, 1]) + 0.39 * abs(1.0 - turn * arm[2, 1])
    found = least_resistance(motion, load, arm, roll)
    assert found == pytest.approx(expected, abs=1e-13)  # what the search leaves open
