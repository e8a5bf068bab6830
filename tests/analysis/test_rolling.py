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
from lutgen.analysis.diagnosis import diagnose, normal_forces
from lutgen.analysis.rolling import held_share, roll_limits, rolling_gravity, rolls
from lutgen.analysis.stance import Posture
from lutgen.analysis.tilt import tilted
from lutgen.cli import main
from lutgen.errors import RecipeError
from lutgen.recipe.recipe import Recipe
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
    # Leaning to the front left the rear right wheel, the only braked one, carries nothing.
    corner = diagnose(Posture(parsed((0, 1, 2)), []), tilted(0.6, math.radians(45.0)))
    assert corner.normal_forces["w3"] == 0.0
    assert rolls(Posture(parsed((0, 1, 2), None), []), tilted(0.6, math.radians(45.0))).all()
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


def by_forces(recipe: Recipe, direction: Floats, sides: int = 360) -> float:
    """Return the largest downhill pull that friction forces balance, per unit of friction.

    A linear programme over the forces themselves; the circle of friction is a polygon inside it.
    """
    posture = Posture(recipe, [])
    facet = posture.stance.facets[int(posture.stance.under(direction[None, :])[0])]
    downhill = direction - (facet.normal @ direction) * facet.normal
    downhill /= np.linalg.norm(downhill)
    load = np.maximum(normal_forces(facet.points, facet.pierced(direction)), 0.0)
    columns = []
    bounds: list[tuple[float | None, float | None]] = []
    rows, limits = [], []
    count = 2 * len(facet.contacts)
    for place, i in enumerate(facet.contacts):
        part = recipe.contacts[i]
        for axis in (downhill, np.cross(facet.normal, downhill)):
            columns.append([axis @ downhill, axis @ np.cross(facet.normal, downhill), 0.0])
            columns[-1][2] = float(facet.normal @ np.cross(facet.points[place], axis))
        if part.rolling and part.kind == "sphere":
            bounds += [(0.0, 0.0), (0.0, 0.0)]
            continue
        bounds += [(None, None), (None, None)]
        for angle in np.arange(sides) * (2.0 * math.pi / sides):
            row = np.zeros(count + 1)
            row[2 * place : 2 * place + 2] = math.cos(angle), math.sin(angle)
            rows.append(row)
            limits.append(load[place] * math.cos(math.pi / sides))
        if part.rolling:
            t = np.cross(posture.disc_axes[i], facet.normal)
            t /= np.linalg.norm(t)
            row = np.zeros(count + 1)
            row[2 * place : 2 * place + 2] = (
                t @ downhill,
                t @ np.cross(facet.normal, downhill),
            )
            rows += [row, -row]
            limits += [0.0, 0.0]
    balance = np.column_stack([np.array(columns).T, [1.0, 0.0, 0.0]])
    best = linprog(
        -np.eye(count + 1)[-1],
        A_ub=np.array(rows),
        b_ub=limits,
        A_eq=balance,
        b_eq=np.zeros(3),
        bounds=[*bounds, (0.0, None)],
    )
    assert best.status == 0
    return float(best.x[-1])


def test_the_held_share_is_what_friction_forces_can_balance() -> None:
    rng = np.random.default_rng(5)
    seen = []
    for rolling, toe in itertools.product(
        [(0,), FRONT, (0, 3), (0, 2), (0, 1, 2), ALL], (0.0, 0.3)
    ):
        recipe = parsed(rolling, 0.8, ball=(0,) if len(rolling) == 1 else (), toe=toe)
        for heading, tilt in zip(
            rng.uniform(0.0, 2.0 * math.pi, 4), (0.1, 0.3, 0.5, 0.6), strict=True
        ):
            direction = tilted(tilt, heading)
            posture = Posture(recipe, [])
            facet = posture.stance.facets[int(posture.stance.under(direction[None, :])[0])]
            share = held_share(posture, facet, direction)
            # The polygon of 360 sides lies inside the circle by 4e-5.
            assert by_forces(recipe, direction) == pytest.approx(share, rel=1e-4, abs=1e-7)
            seen.append(share)
    assert min(seen) < 1e-6
    assert sum(0.05 < share < 0.95 for share in seen) > 20
    assert max(seen) <= 1.0 + 1e-9


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


def moved(rolling: Collection[int], heading: float, tilt: float, friction: float) -> float:
    """Return how far MuJoCo's tricycle goes in a second after gravity has leant over slowly."""
    import mujoco

    wheels = ""
    for i, (x, y) in enumerate(TRICYCLE):
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
        assert ("rolls away     yes" in text) is (rolling == ALL)
        assert ("rolls away     no" in text) is (rolling == REAR)
        assert ("rolling freely tip_angle " in text) is (rolling == ALL)
        assert ("rolling_gravity" in report) is (rolling == ALL)
        if rolling == ALL:
            down = np.array([0.0, 0.2, -1.0])
            angle = diagnose(Posture(parsed(ALL), []), down).channels["tip_angle"]
            assert report["rolling_tip_angle_deg"] == pytest.approx(math.degrees(angle))
            assert report["rolling_gravity"] == pytest.approx(down / np.linalg.norm(down))


def test_polar_draws_the_limit_of_rolling_inside_that_of_sliding() -> None:
    figure = plot.draw("polar", parsed(FRONT))
    lines = {str(line.get_label()): line for line in figure.axes[0].get_lines()}
    around, radius = (np.asarray(part) for part in lines["rolls away"].get_data())
    assert radius[0] == pytest.approx(math.degrees(math.atan(0.4 / 1.4)), abs=1e-5)
    assert (radius[np.isfinite(radius)] < math.degrees(math.atan(0.8)) + 1e-5).all()
    some = np.degrees(roll_limits(Posture(parsed(FRONT), []), around[::12]))
    assert radius[::12] == pytest.approx(some, nan_ok=True)
    free = plot.draw("polar", parsed(ALL, 0.1))
    assert any("rolls" in str(line.get_label()) for line in free.axes[0].get_lines())
    braked = plot.draw("polar", parsed(()))
    assert not any("rolls" in str(line.get_label()) for line in braked.axes[0].get_lines())
