"""Wheels that roll freely: what holds the robot, where it rolls away, and how it tips then."""

import itertools
import json
import math
from collections.abc import Collection
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from numpy.typing import NDArray
from scipy.optimize import linprog

import lutgen
from lutgen import plot
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.forces import load_corners
from lutgen.analysis.resistance import BRAKED, least_of_each, least_resistance
from lutgen.analysis.rolling import (
    held_share,
    hold_limits,
    holds,
    may_hold,
    roll_limits,
    rolling_gravity,
    rolls,
)
from lutgen.analysis.stance import Posture
from lutgen.analysis.tilt import tilted
from lutgen.cli import main
from lutgen.errors import InputError, RecipeError
from lutgen.recipe.recipe import Recipe
from lutgen.support import DISC, SPHERE
from tests.fixtures.places import ROOT
from tests.fixtures.recipes import contact, feet, rigid

Floats = NDArray[np.float64]

LEFT, RIGHT = math.pi / 2.0, -math.pi / 2.0
# Front left, front right, rear left, rear right; the com half a metre above the ground.
PLACES = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
FRONT, REAR, ALL = (0, 1), (2, 3), (0, 1, 2, 3)


def cart(
    rolling: Collection[int],
    friction: float | None = 0.8,
    ball: Collection[int] = (),
    toe: float = 0.0,
) -> str:
    """Return a recipe of four wheels; `toe` (rad) turns the left ones about the vertical."""
    wheels = ""
    for i, (x, y) in enumerate(PLACES):
        angle = toe if y > 0.0 else 0.0
        axis = None if i in ball else (-math.sin(angle), math.cos(angle), 0.0)
        wheels += contact(f"w{i}", (x, y, -0.4), 0.1, axis)
        wheels += "rolling = true\n" if i in rolling else ""
    head = "" if friction is None else f"friction = {friction}"
    return rigid(wheels, name="cart", head=head)


def parsed(*arguments: object, **options: object) -> Recipe:
    """Return the same as a recipe."""
    return lutgen.parse_recipe(cart(*arguments, **options))  # type: ignore[arg-type]


def test_a_cart_braked_at_one_axle_rolls_where_that_axles_load_times_friction_is_too_little() -> (
    None
):
    # With the nose down by t the rear axle carries (1 - tan t) / 2, uphill, and tan t = 0.8 x that.
    rear_braked, front_braked = math.atan(0.4 / 1.4), math.atan(0.4 / 0.6)
    # 1e-7 deg is how far the limit is halved.
    assert roll_limits(Posture(parsed(FRONT), []), [0.0, math.pi]) == pytest.approx(
        [rear_braked, front_braked], abs=2e-8
    )
    assert roll_limits(Posture(parsed(REAR), []), [0.0, math.pi]) == pytest.approx(
        [front_braked, rear_braked], abs=2e-8
    )


def test_a_cart_without_brakes_rolls_on_any_slope_but_straight_across_its_wheels() -> None:
    for friction in (0.5, None):
        free = parsed(ALL, friction)
        down = tilted(math.radians(0.01), np.radians([0.0, 30.0, 89.0, 180.0, 300.0]))
        assert rolls(Posture(free, []), down).all()
        assert not rolls(Posture(free, []), [[0.0, 0.0, -1.0]]).any()
    # Across them friction holds it up to atan 0.5.
    across = tilted([math.atan(0.5) - 1e-6, math.atan(0.5) + 1e-6], LEFT)
    assert rolls(Posture(parsed(ALL, 0.5), []), across).tolist() == [False, True]
    assert rolls(Posture(parsed(ALL, None), []), across).tolist() == [False, False]


def test_a_braked_robot_never_rolls() -> None:
    assert not rolls(Posture(parsed(()), []), tilted(0.65, np.linspace(0.0, 6.0, 40))).any()
    assert np.isnan(roll_limits(Posture(parsed(()), []), [0.0, LEFT])).all()


def test_without_friction_brakes_hold_whatever_carries_load() -> None:
    gentle, steep = (tilted(tilt, np.linspace(0.0, 6.0, 25)) for tilt in (0.3, 0.6))
    for rolling in (FRONT, REAR, (0,), (0, 1, 2), (0, 3)):
        assert not rolls(Posture(parsed(rolling, None), []), gentle).any()
    # Leaning to the front left the rear right wheel, the only braked one, need not carry anything,
    # and could carry something: whether it does, decides.
    lean = tilted(0.6, math.radians(45.0))
    corner = diagnose(Posture(parsed((0, 1, 2)), []), lean)
    assert corner.normal_forces["w3"] == 0.0
    assert corner.normal_ranges["w3"][1] > 0.1
    assert not holds(Posture(parsed((0, 1, 2), None), []), lean).any()
    assert may_hold(Posture(parsed((0, 1, 2), None), []), lean).all()
    # On a tripod without it nothing is open, and it rolls.
    three = "".join(
        contact(f"w{i}", (*PLACES[i], -0.4), 0.1, (0, 1, 0)) + "rolling = true\n" for i in (0, 1, 2)
    )
    assert rolls(Posture(lutgen.parse_recipe(rigid(three)), []), tilted(0.3, 0.7)).all()
    assert not rolls(Posture(parsed(FRONT, None), []), steep).any()


def test_a_robot_on_balls_swings_round_its_only_brake() -> None:
    # The rear right wheel is braked and the others are balls: gravity has an arm about it.
    caster = parsed((0, 1, 2), None, ball=(0, 1, 2))
    assert rolls(Posture(caster, []), tilted(0.2, [0.0, LEFT, 1.0])).all()
    # Straight from the brake to the com there is no arm: it hangs, or is balanced.
    away = math.atan2(0.4, 0.5)
    assert not rolls(Posture(caster, []), tilted(0.2, [away, away + math.pi])).any()
    assert rolls(Posture(caster, []), tilted(0.2, [away + 1e-3])).all()


def test_on_balls_alone_it_rolls_in_every_direction() -> None:
    ball = parsed(ALL, 0.9, ball=ALL)
    headings = np.linspace(0.0, 6.0, 30)
    assert rolls(Posture(ball, []), tilted(1e-3, headings)).all()
    for heading in headings:
        down = rolling_gravity(Posture(ball, []), tilted(0.3, heading))
        assert down == pytest.approx([0.0, 0.0, -1.0], abs=1e-15)


def by_forces(
    posture: Posture, direction: Floats, load: Floats | None = None, sides: int = 360
) -> float:
    """Return the largest downhill pull that friction forces balance, per unit of friction.

    A linear programme over the forces themselves, and without a load over the normal forces, too;
    the circle of friction is a polygon inside it.
    """
    facet = posture.stance.facets[int(posture.stance.under(direction[None, :])[0])]
    frame, points = facet.frame(direction), facet.touching_points
    places, count = points @ frame.T, len(facet.touching)
    # Unknown: forces downhill and across of each contact, the normal forces, the pull.
    width = 3 * count + 1
    rows, limits, same = [], [], []
    for place, i in enumerate(facet.touching):
        part = posture.recipe.contacts[i]
        force = slice(2 * place, 2 * place + 2)
        if part.rolling and part.kind == "sphere":
            for axis in np.eye(2):
                same.append(np.zeros(width))
                same[-1][force] = axis
            continue
        for angle in np.arange(sides) * (2.0 * math.pi / sides):
            rows.append(np.zeros(width))
            rows[-1][force] = math.cos(angle), math.sin(angle)
            rows[-1][2 * count + place] = -math.cos(math.pi / sides)
            limits.append(0.0)
        if part.rolling:
            t = frame @ np.cross(posture.disc_axes[i], facet.normal)
            same.append(np.zeros(width))
            same[-1][force] = t / np.linalg.norm(t)
    balance = np.zeros((3, width))
    balance[0, 0 : 2 * count : 2] = balance[1, 1 : 2 * count : 2] = 1.0
    balance[0, -1] = 1.0
    balance[2, 0 : 2 * count : 2], balance[2, 1 : 2 * count : 2] = -places[:, 1], places[:, 0]
    upright = np.zeros((3, width))
    upright[0, 2 * count : -1] = 1.0
    upright[1:, 2 * count : -1] = (places - facet.pierced(direction) @ frame.T).T
    carried = [(0.0, None)] * count if load is None else [(share, share) for share in load]
    equal = [*same, *balance, *(upright if load is None else [])]
    wanted = np.zeros(len(equal))
    if load is None:
        wanted[-3] = 1.0
    best = linprog(
        -np.eye(width)[-1],
        A_ub=np.array(rows),
        b_ub=limits,
        A_eq=np.array(equal),
        b_eq=wanted,
        bounds=[*[(None, None)] * (2 * count), *carried, (0.0, None)],
    )
    assert best.status == 0
    return float(best.x[-1])


def test_the_held_shares_are_what_friction_forces_balance_under_the_worst_and_the_best_load() -> (
    None
):
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
            facet = posture.stance.facets[int(posture.stance.under(direction[None, :])[0])]
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
    assert sum(0.05 < every < 0.95 for every, _ in seen) > 8
    assert sum(some - every > 0.1 for every, some in seen) > 8
    assert max(some for _, some in seen) <= 1.0


def test_the_guides_trolley_holds_and_rolls_from_the_tilts_that_the_guide_gives_on() -> None:
    page = (ROOT / "docs/guide/metrics.md").read_text(encoding="utf-8")
    posture = Posture(parsed(FRONT, 0.7), [])
    limits = (hold_limits(posture, [0.0])[0], roll_limits(posture, [0.0])[0])
    said = [f"{math.degrees(limit):.2f} deg" for limit in limits]
    assert said == ["13.78 deg", "14.53 deg"]
    assert all(one in page for one in said)


def test_other_loads_than_every_and_some_are_refused() -> None:
    posture = Posture(parsed(FRONT), [])
    facet = posture.stance.facets[0]
    with pytest.raises(InputError, match=r'must be "every" or "some" \(got .most.\)'):
        held_share(posture, facet, tilted(0.1, 0.0), "most")  # type: ignore[arg-type]


# Three axles: the middle one is on no corner of the polygon.
SIX = [(x, y) for x in (0.5, 0.0, -0.5) for y in (0.4, -0.4)]
MIDDLE, ENDS = (2, 3), (0, 1, 4, 5)


def six(rolling: Collection[int], friction: float | None = 0.7, height: float = 0.5) -> Posture:
    """Return a six-wheeler."""
    wheels = ""
    for i, (x, y) in enumerate(SIX):
        wheels += contact(f"w{i}", (x, y, 0.1 - height), 0.1, (0, 1, 0))
        wheels += "rolling = true\n" if i in rolling else ""
    head = "" if friction is None else f"friction = {friction}"
    return Posture(lutgen.parse_recipe(rigid(wheels, head=head)), [])


def ahead(*slopes: float) -> Floats:
    """Return gravity with the nose down by slopes, given by their tangents."""
    return tilted(np.arctan(slopes), 0.0)


def test_a_six_wheeler_whose_middle_wheels_roll_may_hold_and_does_not_hold_for_certain() -> None:
    # The middle wheels may carry 1 - tan t of the load, and need not carry any.
    down = ahead(0.02, 0.3, 0.6, 0.69)
    assert not holds(six(MIDDLE), down).any()
    assert may_hold(six(MIDDLE), down).all()
    assert not rolls(six(MIDDLE), down).any()
    assert rolls(six(MIDDLE), ahead(0.71)).all()  # beyond 0.7 no load holds
    assert holds(six(MIDDLE), [[0.0, 0.0, -1.0]]).all()
    # With the front wheels rolling they may carry no more than 0.55 of it.
    assert holds(six((0, 1)), ahead(0.1)).all()


def test_a_six_wheeler_braked_in_the_middle_holds_as_far_as_these_wheels_may_carry_it() -> None:
    # D_g is tan t x 0.5 ahead, so that they carry up to 1 - tan t: 0.7 (1 - tan t) = tan t.
    limit = 0.7 / 1.7
    assert may_hold(six(ENDS), ahead(0.02, limit - 1e-7, limit + 1e-7)).tolist() == [1, 1, 0]
    assert rolls(six(ENDS), ahead(0.02, limit - 1e-7, limit + 1e-7)).tolist() == [0, 0, 1]
    assert not holds(six(ENDS), ahead(0.02)).any()
    # 1e-7 deg is how far a limit is halved.
    assert roll_limits(six(ENDS), [0.0]) == pytest.approx([math.atan(limit)], abs=2e-8)
    assert hold_limits(six(ENDS), [0.0])[0] < 2e-8
    # A lower robot leaves its middle more of the load: 0.7 (1 - 0.4 tan t) = tan t.
    low = 0.7 / 1.28
    assert may_hold(six(ENDS, height=0.2), ahead(low - 1e-7, low + 1e-7)).tolist() == [1, 0]


def test_braked_or_rolling_all_over_a_six_wheeler_is_like_its_four_corners() -> None:
    down = ahead(0.3, 0.7 - 1e-9, 0.7 + 1e-9)
    for verdict in (holds, may_hold):
        assert verdict(six(()), down).tolist() == [1, 1, 0]
        assert not verdict(six(range(6)), down).any()
    assert rolls(six(range(6)), down).all()
    assert not rolls(six(()), down).any()
    aside = tilted(np.arctan([0.5, 0.7 - 1e-6, 0.7 + 1e-6]), LEFT)
    for verdict in (holds, may_hold):
        assert verdict(six(range(6)), aside).tolist() == [1, 1, 0]


def test_a_brake_in_the_line_of_two_wheels_may_hold_what_these_need_not_leave_to_it() -> None:
    # Three contacts in a line along x, the middle one braked, and a foot aside.
    where = [(0.5, 0.4), (0.0, 0.4), (-0.5, 0.4), (0.0, -0.4)]
    robot = ""
    for i, (x, y) in enumerate(where):
        robot += contact(f"w{i}", (x, y, -0.4), 0.1, None)
        robot += "" if i == 1 else "rolling = true\n"
    posture = Posture(lutgen.parse_recipe(rigid(robot, head="friction = 0.8")), [])
    facet = posture.stance.facets[0]
    assert facet.touching == (*facet.contacts, 1)
    # With the left side down by t the line carries (1 + 0.5 tan t / 0.4) / 2: all of it on the
    # brake, below the com, or none.
    for slope in (0.1, 0.5, 0.7):
        direction = tilted(math.atan(slope), LEFT)
        share = held_share(posture, facet, direction, "some")
        assert share == pytest.approx((1.0 + 1.25 * slope) / 2.0, abs=1e-9)  # as far as it searches
        assert held_share(posture, facet, direction) < 1e-9
        found = diagnose(posture, direction)
        assert found.normal_ranges["w1"] == pytest.approx((0.0, share), abs=1e-9)
        assert found.forces_kind == "minimum norm"


def test_every_load_implies_some_and_a_contact_inside_the_polygon_forbids_none() -> None:
    rng = np.random.default_rng(8)
    counts = {"holds": 0, "may only": 0, "rolls": 0, "gained": 0}
    for _ in range(60):
        angles = np.sort(rng.uniform(0.0, 5.6, 4)) + np.arange(4) * 0.2
        corners = np.column_stack([np.cos(angles), np.sin(angles)])
        weights = rng.dirichlet(np.ones(4))
        robot = ""
        for i, (x, y) in enumerate([*corners, weights @ corners]):
            a = rng.uniform(0.0, math.pi)
            axis = None if rng.random() < 0.2 else (math.cos(a), math.sin(a), 0.0)
            one = contact(f"w{i}", (x, y, -0.2), 0.1, axis)
            last = one + ("rolling = true\n" if rng.random() < 0.6 else "")
            robot += last
        fewer = robot.removesuffix(last)
        down = tilted(rng.uniform(0.05, 0.7, 6), rng.uniform(0.0, 6.0, 6))
        answers = []
        for text in (fewer, robot):
            posture = Posture(lutgen.parse_recipe(rigid(text, head="friction = 0.8")), [])
            every, some, away = (f(posture, down) for f in (holds, may_hold, rolls))
            assert not (every & ~some).any()
            assert not (some & away).any()
            answers.append(some)
            counts["holds"] += int(every.sum())
            counts["may only"] += int((some & ~every).sum())
            counts["rolls"] += int(away.sum())
        assert not (answers[0] & ~answers[1]).any()
        counts["gained"] += int((answers[1] & ~answers[0]).sum())
    assert min(counts.values()) > 0, counts


def test_the_share_does_not_depend_on_the_unit_of_length() -> None:
    recipe = parsed((0, 1, 2))
    text = cart((0, 1, 2)).replace('"m"', '"mm"').replace("0.4", "400.0").replace("0.5", "500.0")
    large = lutgen.parse_recipe(text.replace("radius = 0.1", "radius = 100.0"))
    headings = np.radians([10.0, 80.0, 200.0])
    expected = roll_limits(Posture(recipe, []), headings)
    assert roll_limits(Posture(large, []), headings) == pytest.approx(expected, abs=1e-7)
    assert (np.diff(expected) != 0.0).all()


def test_rolling_straight_it_tips_under_gravity_without_its_part_along_the_wheels() -> None:
    down = np.array([0.6, 0.3, -1.0]) / math.sqrt(1.45)
    free = rolling_gravity(Posture(parsed(ALL), []), down)
    assert free == pytest.approx(np.array([0.0, 0.3, -1.0]) / math.sqrt(1.09), abs=1e-15)
    # Held on that slope it tips over its nose (0.5 ahead, 0.5 high) from 45 deg on; rolling never.
    steep = tilted(math.radians(50.0), 0.0)
    rolling = rolling_gravity(Posture(parsed(ALL), []), steep)
    assert rolling is not None
    angle = lutgen.evaluate(parsed(ALL), [[]], [steep, rolling], ("tip_angle",))["tip_angle"][0]
    assert angle[0] == pytest.approx(math.radians(-5.0), abs=1e-12)
    assert angle[1] == pytest.approx(math.atan(0.4 / 0.5), abs=1e-12)


TRICYCLE = [(0.6, 0.05), (-0.4, 0.45), (-0.35, -0.4)]


def moved(
    rolling: Collection[int],
    heading: float,
    tilt: float,
    friction: float,
    places: list[tuple[float, float]] = TRICYCLE,
) -> float:
    """Return how far MuJoCo's wheels go in a second after gravity has leant over slowly."""
    import mujoco

    wheels = ""
    for i, (x, y) in enumerate(places):
        look = f'type="ellipsoid" size="0.1 0.02 0.1" friction="{friction} 0 0"'
        place = f'pos="{x} {y} -0.4"'
        if i in rolling:
            hinge = f'<joint type="hinge" axis="0 1 0" armature="1e-6"/><geom {look} mass="0.02"/>'
            wheels += f"<body {place}>{hinge}</body>"
        else:
            wheels += f'<geom {place} {look} mass="1e-6"/>'
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><option timestep="0.001" integrator="implicitfast" solver="Newton" '
        'iterations="100" tolerance="1e-12" cone="elliptic" impratio="100"/>'
        '<default><geom solref="0.004 1" solimp=".99 .999 1e-4" condim="3"/></default><worldbody>'
        f'<geom type="plane" size="9 9 1" pos="0 0 -0.5" friction="{friction} 0 0"/><body>'
        '<freejoint/><inertial pos="0 0 0" mass="20" diaginertia="1 1.5 2"/>'
        f"{wheels}</body></worldbody></mujoco>"
    )
    state, start = mujoco.MjData(model), np.zeros(7)
    for step in range(2500):
        model.opt.gravity[:] = 9.81 * tilted(tilt * min(1.0, step / 1500), heading)
        mujoco.mj_step(model, state)
        if step == 1500:
            start = state.qpos[:7].copy()
    # A shift in m, and half of the quaternion's change: a robot that swings round moves too.
    return float(np.abs(state.qpos[:7] - start).max())


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize(
    ("rolling", "heading"),
    [((0,), 35.0), ((1,), 180.0), ((2,), 215.0), ((0, 1), 0.0), ((1, 2), 0.0)],
)
def test_wheels_on_hinges_roll_away_from_the_same_tilt_on(
    rolling: tuple[int, ...], heading: float
) -> None:
    contacts = ""
    for i, (x, y) in enumerate(TRICYCLE):
        contacts += contact(f"w{i}", (x, y, -0.4), 0.1, (0, 1, 0))
        contacts += "rolling = true\n" if i in rolling else ""
    recipe = lutgen.parse_recipe(rigid(contacts, head="friction = 0.8"))
    limit = float(roll_limits(Posture(recipe, []), np.radians([heading]))[0])
    assert math.radians(2.0) < limit < math.atan(0.8) - math.radians(1.0)
    below, beyond = (
        moved(rolling, math.radians(heading), limit + math.radians(side), 0.8)
        for side in (-0.4, 0.4)
    )
    assert below < 0.002
    assert beyond > 0.01


@pytest.mark.needs("mujoco")
@pytest.mark.parametrize("rolling", [MIDDLE, ENDS, (0, 1), (2, 3, 4, 5)])
def test_six_wheels_on_hinges_stay_where_they_hold_and_go_where_they_roll(
    rolling: tuple[int, ...],
) -> None:
    stayed = set()
    for slope in (0.1, 0.35, 0.5, 0.69):
        way = moved(rolling, 0.0, math.atan(slope), 0.7, SIX)
        # What springs give is microns, and what rolls or slips goes centimetres in a second; what
        # lies between creeps, and says nothing.
        assert way < 0.01 or not holds(six(rolling), ahead(slope)).any()
        assert way > 0.002 or may_hold(six(rolling), ahead(slope)).all()
        stayed |= {True} if way < 0.002 else {False} if way > 0.01 else set()
    assert stayed == {True, False}


def test_no_free_rolling_with_a_brake_with_toed_wheels_or_where_it_would_turn() -> None:
    ahead, aslant = tilted(0.2, 0.0), tilted(0.2, 0.4)
    assert rolling_gravity(Posture(parsed((0, 1, 2)), []), ahead) is None
    assert rolling_gravity(Posture(parsed(ALL, toe=0.1), []), ahead) is None
    # One axle and two balls: ahead it rolls straight, aslant the balls swing downhill.
    tail = parsed(ALL, ball=REAR)
    assert rolling_gravity(Posture(tail, []), ahead) is not None
    assert rolling_gravity(Posture(tail, []), aslant) is None
    assert rolling_gravity(Posture(parsed(ALL), []), aslant) is not None


def test_the_verdict_channels_and_maps_do_not_know_of_rolling() -> None:
    directions = tilted(0.4, np.linspace(0.0, 6.0, 20))
    free = lutgen.evaluate(parsed(ALL), [[]], directions, ("sdg", "tip_angle", "margin"))
    braked = lutgen.evaluate(parsed(()), [[]], directions, ("sdg", "tip_angle", "margin"))
    for name, values in free.items():
        assert values.tobytes() == braked[name].tobytes()


@pytest.mark.parametrize(
    ("what", "said"),
    [
        (feet([(1, 0, -1), (-1, 1, -1)]) + contact("P3", (-1, -1, -1)) + "rolling = true\n",
         "key `robot.contact[3].rolling`: needs a radius above 0"),
        (contact("a", (1, 0, -1), 0.1) + 'rolling = "yes"\n' + feet([(-1, 1, -1), (-1, -1, -1)]),
         "key `robot.contact[1].rolling`: must be true or false (got 'yes')"),
    ],
)  # fmt: skip
def test_rolling_is_refused_on_points_and_as_anything_but_true_or_false(
    what: str, said: str
) -> None:
    with pytest.raises(RecipeError) as caught:
        lutgen.parse_recipe(rigid(what))
    assert said in str(caught.value)


def test_eval_says_whether_it_rolls_and_how_it_tips_then(tmp_path: Path) -> None:
    file = tmp_path / "cart.toml"
    asked = ["eval", str(file), "-g", "0.1,0.2,-1"]
    for rolling in (ALL, REAR, ()):
        file.write_text(cart(rolling), encoding="utf-8")
        report = json.loads(CliRunner().invoke(main, [*asked, "--json"]).stdout)
        text = CliRunner().invoke(main, asked).stdout
        assert report.get("rolls") is {ALL: True, REAR: False, (): None}[rolling]
        assert (
            report.get("holds") is report.get("may_hold") is {ALL: False, REAR: True}.get(rolling)
        )  # type: ignore[call-overload]
        assert ("rolls away     yes" in text) is (rolling == ALL)
        assert ("rolls away     no" in text) is (rolling == REAR)
        assert ("rolling freely tip_angle " in text) is (rolling == ALL)
        assert ("rolling_gravity" in report) is (rolling == ALL)
        if rolling == ALL:
            down = np.array([0.0, 0.2, -1.0])
            angle = diagnose(Posture(parsed(ALL), []), down).channels["tip_angle"]
            assert report["rolling_tip_angle_deg"] == pytest.approx(math.degrees(angle))
            assert report["rolling_gravity"] == pytest.approx(down / np.linalg.norm(down))


def test_eval_and_metrics_say_where_it_depends_on_how_the_contacts_share_the_load(
    tmp_path: Path,
) -> None:
    file = tmp_path / "cart.toml"
    file.write_text(cart(FRONT, 0.7), encoding="utf-8")
    # At 14 deg nose down the brakes carry (1 - tan t) / 2 at the rear; on one of them it turns.
    down = ["eval", str(file), "-g", f"{math.tan(math.radians(14.0))},0,-1"]
    report = json.loads(CliRunner().invoke(main, [*down, "--json"]).stdout)
    assert (report["holds"], report["may_hold"], report["rolls"]) == (False, True, False)
    assert "rolls away     may: it depends on how" in CliRunner().invoke(main, down).stdout
    low, high = report["normal_forces_range"]["w2"]
    assert low == pytest.approx(0.0, abs=1e-12)
    assert high == pytest.approx((1.0 - math.tan(math.radians(14.0))) / 2.0, abs=1e-12)
    around = ["metrics", str(file), "--tilt", "14", "--headings", "2"]
    rows = CliRunner().invoke(main, around).stdout.splitlines()
    assert [row.split()[-1] for row in rows[1:]] == ["holds", "yes", "may", "yes"]
    entries = json.loads(CliRunner().invoke(main, [*around, "--json"]).stdout)["headings"]
    assert [(one["holds"], one["may_hold"]) for one in entries] == [(False, True), (True, True)]
    file.write_text(cart(()), encoding="utf-8")
    assert "holds" not in CliRunner().invoke(main, around).stdout


def test_polar_draws_the_limit_of_rolling_inside_that_of_sliding() -> None:
    figure = plot.draw("polar", parsed(FRONT))
    lines = {str(line.get_label()): line for line in figure.axes[0].get_lines()}
    x, y = (np.asarray(part) for part in lines["rolls away"].get_data())
    around, radius = np.arctan2(-x, y), 90.0 * np.hypot(x, y)
    assert radius[0] == pytest.approx(math.degrees(math.atan(0.4 / 1.4)), abs=1e-5)
    assert (radius[np.isfinite(radius)] < math.degrees(math.atan(0.8)) + 1e-5).all()
    known = np.isfinite(radius)
    some = np.degrees(roll_limits(Posture(parsed(FRONT), []), around[known][::12]))
    assert radius[known][::12] == pytest.approx(some, abs=1e-6)
    sure = 90.0 * np.hypot(*(np.asarray(part) for part in lines["may roll away"].get_data()))
    assert sure[0] == pytest.approx(np.degrees(hold_limits(Posture(parsed(FRONT), []), [0.0]))[0])
    assert sure[0] < radius[0] - 0.5
    free = plot.draw("polar", parsed(ALL, 0.1))
    assert any("rolls" in str(line.get_label()) for line in free.axes[0].get_lines())
    braked = plot.draw("polar", parsed(()))
    assert not any("rolls" in str(line.get_label()) for line in braked.axes[0].get_lines())


def test_a_wheel_that_rolls_a_rounding_off_straight_across_hides_no_minimum() -> None:
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


def test_the_worst_of_many_loads_has_the_least_resistance_of_all_asked_one_by_one() -> None:
    rng = np.random.default_rng(7)
    apart = 0
    for _ in range(200):
        k = int(rng.integers(3, 7))
        motion = rng.choice([BRAKED, float(DISC), float(SPHERE)], k, p=[0.4, 0.5, 0.1])
        loads = rng.dirichlet(np.ones(k), 6) * (rng.random((6, k)) < 0.6)
        loads = loads[loads.sum(axis=1) > 0.3]
        loads /= loads.sum(axis=1, keepdims=True)
        arm, angle = rng.uniform(-1.0, 1.0, (k, 2)), rng.uniform(0.0, 2.0 * math.pi, k)
        roll = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        # Loads on brakes alone are held whatever balances them.
        alone = [
            least_resistance(motion, load[None], arm, roll)
            for load in loads
            if (motion[load > 0.0] != BRAKED).any()
        ]
        together = least_of_each(motion, loads, arm, roll)
        # What rolls costs 1e-12 of its load, also where it carries none but rounding.
        assert together == pytest.approx(min([1.0, *alone]), abs=1e-11)
        apart += max(alone, default=0.0) - together > 0.1
    assert apart > 50
