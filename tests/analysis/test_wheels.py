"""Wheel speeds: textbook robots, rolling without slip in space, and motions that are impossible."""

import math

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import lutgen
from lutgen.analysis import Posture, diagnose, wheel_speeds
from lutgen.errors import InputError
from tests.fixtures.recipes import feet, rigid, tripod

LEFT = (0.0, 1.0, 0.0)
# Sums and products of a few numbers of order 1.
ROUNDING = 1e-12


def wheel(name, axis=LEFT, radius=0.1, extra=""):
    return (
        f'[[robot.wheel]]\ncontact = "{name}"\nradius = {radius!r}\n'
        f"axis = [{', '.join(repr(float(c)) for c in axis)}]\n{extra}\n"
    )


def robot(points, wheels, unit="m"):
    """Return a rigid robot of point contacts P1, P2, ... with wheels; its com is the origin."""
    return lutgen.parse_recipe(rigid(feet(points) + wheels, unit=unit), "robot.toml")


def speeds(motion):
    assert all(w.touches for w in motion.wheels)
    return [w.speed for w in motion.wheels]


def car():
    """Wheelbase 1.5, track 0.8, the com 0.6 ahead of the fixed rear axle, radius 0.2."""
    points = [(0.9, 0.4, -0.5), (0.9, -0.4, -0.5), (-0.6, 0.4, -0.5), (-0.6, -0.4, -0.5)]
    front = wheel("P1", radius=0.2, extra="steered = true")
    front += wheel("P2", radius=0.2, extra="steered = true")
    return robot(points, front + wheel("P3", radius=0.2) + wheel("P4", radius=0.2))


def test_mecanum_wheels_obey_the_matrix_of_textbooks():
    box = [(0.3, 0.2, -0.1), (0.3, -0.2, -0.1), (-0.3, 0.2, -0.1), (-0.3, -0.2, -0.1)]
    rollers = enumerate((-45, 45, 45, -45), 1)
    mecanum = "".join(wheel(f"P{i}", extra=f"rollers = {g}") for i, g in rollers)
    # Front left, front right, rear left, rear right; half lengths 0.3 + 0.2.
    matrix = np.array([[1, -1, -0.5], [1, 1, 0.5], [1, 1, -0.5], [1, -1, 0.5]]) / 0.1
    for motion in ([0.7, 0.0, 0.0], [0.0, -0.4, 0.0], [0.0, 0.0, 2.0], [0.3, 0.2, -1.0]):
        found = wheel_speeds(Posture(robot(box, mecanum), []), motion[:2], motion[2])
        assert speeds(found) == pytest.approx((matrix @ motion).tolist(), abs=ROUNDING)
        assert found.possible
        assert found.category == "3 DoF, non-steered"


SQUARE = [(0.5, 0.5, -0.4), (-0.5, 0.5, -0.4), (-0.5, -0.5, -0.4), (0.5, -0.5, -0.4)]
STEERED = "steered = true"
ASLANT, ACROSS = (1, 1, 0), (1, 0, 0)
# Wheels on the corners of a square, from the front left on anticlockwise, and what they leave:
# degrees of freedom.
STRUCTURES = [
    ([(LEFT, STEERED)] * 4, 3),
    ([(LEFT, STEERED)], 3),
    ([(LEFT, "")], 2),
    ([(LEFT, ""), (LEFT, STEERED)], 2),
    ([(ACROSS, ""), (LEFT, STEERED)], 2),
    ([(LEFT, "")] * 4, 1),
    ([(ASLANT, ""), (ACROSS, ""), (LEFT, STEERED)], 1),
    # Three axles that cross in a point, and three that do not.
    ([(ASLANT, ""), ((1, -1, 0), ""), (ASLANT, "")], 1),
    ([(ASLANT, ""), (ACROSS, ""), (LEFT, ""), (LEFT, STEERED)], 0),
]


def test_the_structure_is_what_the_wheels_leave():
    for wheels, expected in STRUCTURES:
        text = "".join(wheel(f"P{i}", axis, extra=e) for i, (axis, e) in enumerate(wheels, 1))
        found = wheel_speeds(Posture(robot(SQUARE, text), []), (0.0, 0.0), 0.0)
        assert found.dof == expected
        assert found.steered is (STEERED in text)
    # The last one cannot move: rest is its nearest motion.
    motion = wheel_speeds(Posture(robot(SQUARE, text), []), (1.0, 0.0), 0.0)
    assert (motion.possible, motion.nearest_yaw_rate) == (False, 0.0)
    assert motion.nearest_velocity == (0.0, 0.0)


def test_a_steered_wheel_turns_by_less_than_a_quarter_either_way():
    for vx, vy, steering, speed in (
        (-1.0, 0.0, 0.0, -10.0),
        (0.0, -1.0, 90.0, -10.0),
        (-1e-17, 1.0, 90.0, 10.0),
        (-1.0, 1.0, -45.0, -10.0 * math.sqrt(2.0)),
        (0.0, 0.0, 0.0, 0.0),
    ):
        one = Posture(robot(SQUARE, wheel("P1", extra=STEERED)), [])
        (found,) = wheel_speeds(one, (vx, vy), 0.0).wheels
        assert found.steering == pytest.approx(math.radians(steering), abs=ROUNDING)
        assert found.speed == pytest.approx(speed, abs=ROUNDING)


def material_velocities(recipe, params, gravity, axles, motion):
    """Return per wheel the velocity (3,) of the rim at the ground, and t; and the normal."""
    found = diagnose(Posture(recipe, params), gravity)
    n = -found.facet.normal
    x = np.array([1.0, 0.0, 0.0]) - n[0] * n
    x /= np.linalg.norm(x)
    linear = motion.velocity[0] * x + motion.velocity[1] * np.cross(n, x)
    rims, rolling = [], []
    for one, done, axle in zip(recipe.wheels, motion.wheels, axles, strict=True):
        corner = found.facet.contacts.index(recipe.contact_names.index(one.contact))
        turned = Rotation.from_rotvec((done.steering or 0.0) * n).apply(axle)
        t = np.cross(turned, n) / np.linalg.norm(np.cross(turned, n))
        here = linear + motion.yaw_rate * np.cross(n, found.facet.points[corner])
        # The rim runs backward under the wheel.
        rims.append(here - (done.speed or 0.0) * one.radius * t)
        rolling.append(t)
    return rims, rolling, n


def test_rims_rest_on_the_ground_in_random_postures_and_on_random_slopes():
    rng = np.random.default_rng(1)
    for _ in range(100):
        axes = rng.normal(size=(3, 3))
        gamma = float(rng.uniform(-70.0, 70.0))
        text = wheel("front", axes[0], 0.2, STEERED) + wheel("left", axes[1], 0.3)
        text += wheel("right", axes[2], 0.1, f"rollers = {gamma!r}")
        recipe = lutgen.parse_recipe(tripod(contacts=text))
        params = [float(rng.uniform(0.0, 0.6)), math.radians(rng.uniform(-40.0, 50.0))]
        gravity = np.array([*rng.uniform(-0.2, 0.2, 2), -1.0])
        velocity, yaw_rate = rng.normal(size=2), float(rng.normal())
        motion = wheel_speeds(Posture(recipe, params), velocity, yaw_rate, gravity)
        units = axes / np.linalg.norm(axes, axis=1)[:, None]
        # The front wheel's leg turns with the swing about z.
        axles = [Rotation.from_euler("z", params[1]).apply(units[0]), units[1], units[2]]
        rims, rolling, n = material_velocities(recipe, params, gravity, axles, motion)
        steered, fixed, swedish = rims
        assert steered == pytest.approx(np.zeros(3), abs=1e-11)  # speeds of up to 10
        # A fixed wheel is dragged sideways by its slip, and by nothing along itself.
        slip = motion.wheels[1].slip
        assert fixed == pytest.approx(slip * np.cross(n, rolling[1]), abs=1e-11)
        assert motion.slip == pytest.approx(abs(slip))
        # A roller gives way across its axis only; tan(70 deg) enlarges rounding.
        roller = Rotation.from_rotvec(math.radians(gamma) * n).apply(rolling[2])
        assert float(swedish @ roller) == pytest.approx(0.0, abs=1e-10)
        assert min(abs(s) for s in speeds(motion)) > 0.0


def test_a_slope_that_rocks_the_robot_lifts_another_wheel():
    points = [(1.0, 0.0, -0.5), (0.0, 0.8, -0.5), (-1.0, 0.0, -0.45), (0.0, -0.8, -0.5)]
    # The rear wheel's axle would lock the robot.
    wheels = wheel("P1", extra="rollers = 0") + wheel("P2") + wheel("P3", (1, 0, 0)) + wheel("P4")
    recipe = robot(points, wheels)
    forward = wheel_speeds(Posture(recipe, []), (1.0, 0.0), 0.0, (0.2, 0.0, -1.0))
    assert forward.possible
    assert [w.touches for w in forward.wheels] == [True, True, False, True]
    lifted = forward.wheels[2]
    assert (lifted.contact, lifted.speed, lifted.steering, lifted.slip) == ("P3", None, None, None)
    assert forward.category == "2 DoF, non-steered"
    back = wheel_speeds(Posture(recipe, []), (1.0, 0.0), 0.0, (-0.2, 0.0, -1.0))
    assert [w.touches for w in back.wheels] == [False, True, True, True]
    assert back.category == "1 DoF, non-steered"
    # The rear wheel is dragged across, the others roll.
    assert back.slip == pytest.approx(1.0, rel=ROUNDING)


def test_a_robot_on_its_back_has_its_left_where_the_ground_sees_it():
    points = [(0.5, 0.5, 0.3), (0.5, -0.5, 0.3), (-0.5, 0.0, 0.3)]
    text = rigid(feet(points) + wheel("P1") + wheel("P2"), head="upright = 180")
    motion = wheel_speeds(Posture(lutgen.parse_recipe(text), []), (1.0, -0.5), 1.0, (0.0, 0.0, 1.0))
    # Up is -z, so left is -y: P1 is the right wheel, and a spin about +y drives backward.
    assert speeds(motion) == pytest.approx([-15.0, -5.0], rel=ROUNDING)
    assert motion.possible


def test_slip_is_the_smallest_that_any_speeds_and_steering_can_reach():
    recipe = car()
    rng = np.random.default_rng(2)
    for _ in range(5):
        velocity, yaw_rate = rng.normal(size=2), float(rng.normal())
        motion = wheel_speeds(Posture(recipe, []), velocity, yaw_rate)
        assert not motion.possible

        def rims(tried, velocity=velocity, yaw_rate=yaw_rate):
            rests = []
            for i, (x, y) in enumerate([(0.9, 0.4), (0.9, -0.4), (-0.6, 0.4), (-0.6, -0.4)]):
                angle = tried[4 + i] if i < 2 else 0.0
                here = velocity + yaw_rate * np.array([-y, x])
                rests.append(here - 0.2 * tried[i] * np.array([np.cos(angle), np.sin(angle)]))
            return np.concatenate(rests)

        # Steered wheels have two settings of each motion; start at several.
        starts = rng.normal(size=(6, 6)) * 3.0
        best = min(least_squares(rims, start).cost for start in starts)
        assert motion.slip == pytest.approx(math.sqrt(2.0 * best), rel=1e-6)  # the search's own
        assert math.hypot(*(w.slip or 0.0 for w in motion.wheels)) == pytest.approx(motion.slip)


def test_the_nearest_motion_is_the_closest_of_all_that_the_car_can_do():
    recipe = car()
    size = math.hypot(0.9, 0.4)  # the farthest wheel
    rng = np.random.default_rng(3)
    for _ in range(5):
        vx, vy, yaw_rate = rng.normal(size=3)
        motion = wheel_speeds(Posture(recipe, []), (vx, vy), yaw_rate)

        # A car drives v and turns w about its rear axle, 0.6 behind the com.
        def distance(tried, asked=(vx, vy, yaw_rate)):
            v, w = tried
            return [v - asked[0], 0.6 * w - asked[1], size * (w - asked[2])]

        v, w = least_squares(distance, [0.0, 0.0], xtol=1e-15, ftol=1e-15, gtol=1e-15).x
        found = (*motion.nearest_velocity, motion.nearest_yaw_rate)
        assert found == pytest.approx((v, 0.6 * w, w), abs=1e-7)  # the search's own
        again = wheel_speeds(Posture(recipe, []), motion.nearest_velocity, motion.nearest_yaw_rate)
        assert again.possible
        assert again.nearest_velocity == motion.nearest_velocity


def test_a_motion_typed_with_six_digits_is_possible_and_one_with_four_is_not():
    # Turning about the right rear wheel at 1/3 rad/s: v = 0.4 / 3, and 0.6 / 3 sideways.
    assert wheel_speeds(Posture(car(), []), (0.133333, 0.2), 0.333333).possible
    found = wheel_speeds(Posture(car(), []), (0.1333, 0.2), 0.3333)
    assert not found.possible
    assert found.slip == pytest.approx(2e-5 * math.sqrt(2.0), rel=1e-9)


def test_what_cannot_be_computed_is_refused_with_the_way_out():
    standing = robot(SQUARE, wheel("P2", (0, 0, 1)))
    with pytest.raises(InputError, match=r"wheel on P2 cannot roll, .*normal .*correct its `axis`"):
        wheel_speeds(Posture(standing, []), (1.0, 0.0), 0.0)
    nose = [(0.4, 0.5, 0.0), (0.4, -0.5, 0.5), (0.4, -0.5, -0.5)]
    text = rigid(feet(nose) + wheel("P1"), head="upright = 180")
    with pytest.raises(InputError, match=r"x axis is normal to the ground, .*; choose another"):
        wheel_speeds(Posture(lutgen.parse_recipe(text), []), (1.0, 0.0), 0.0, (1, 0, 0))
    moves = (((1.0, math.nan), 0.0), ((1e308, 0.0), 0.0), ((1.0,), 0.0), ((1.0, 0.0), math.inf))
    for velocity, yaw_rate in moves:
        with pytest.raises(InputError, match=r"velocity must be two numbers, and yaw_.* \(got \[1"):
            wheel_speeds(Posture(car(), []), velocity, yaw_rate)
