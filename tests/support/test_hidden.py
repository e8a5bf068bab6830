"""Contacts that another one hides: boxes whose corners lie on wheels, in any order and in noise."""

import math

import numpy as np
import pytest

from lutgen.channels import evaluate, evaluate_each
from lutgen.channels.evaluation import measure_primitives
from lutgen.recipe import forward, parse_recipe, radii_and_kinds
from lutgen.support import DISC, POINT, SPHERE, acceptance, empty_region, facet_table, pack, stand
from lutgen.support.hidden import lies_within
from lutgen.support.rest import polygon_width
from tests.fixtures.many_library import postures_of, random_directions
from tests.fixtures.odd_robots import boxed_tracks
from tests.fixtures.recipes import contact, sweep_part

LIMITS = acceptance(math.radians(80), math.radians(30), 0.0, 0.005, 5e-5)
CHANNELS = ("sdg", "tip_angle")
TIPS = 2
DOWN = np.array([[0.0, 0.0, -1.0]])


def rows(*primitives):
    """Return the rows of primitives: centre, axis, radius, kind."""
    centre, axis, radius, kind = zip(*primitives, strict=True)
    axis = np.array(axis, dtype=float)
    size = np.linalg.norm(axis, axis=1, keepdims=True)
    axis = np.divide(axis, size, out=axis, where=size > 0.0)
    return pack(np.array(centre, dtype=float), axis, np.array(radius), np.array(kind))


def point(x, y, z):
    return (x, y, z), (0, 0, 0), 0.0, POINT


def ball(x, y, z, radius):
    return (x, y, z), (0, 0, 0), radius, SPHERE


def disc(x, y, z, radius, axis=(0, 1, 0)):
    return (x, y, z), axis, radius, DISC


def directions(rng, count):
    """Return gravity directions below 70 deg of tilt or so."""
    g = rng.normal(size=(count, 3))
    g[:, 2] = -np.abs(g[:, 2]) - 0.3
    return g / np.linalg.norm(g, axis=1, keepdims=True)


def postures(seed, rng, count=3):
    """Return the primitives of some postures of a robot of boxes and cylinders; one is level."""
    recipe = boxed_tracks(seed)
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    params = low + (high - low) * rng.random((count, len(low)))
    params[0] = 0.0
    where, (radius, kind) = forward(recipe, params), radii_and_kinds(recipe)
    return pack(where.centres, where.axes, radius, kind)


def agree(one, other):
    """Tell whether two answers are the same but for rounding: verdict, |SD_g| and angle inside.

    Outside the angle of a convex region is measured to its planes and that of another to its
    boundary, so it jumps where noise bends an edge by any amount.
    """
    inside, too = one["tip_angle"] >= 0.0, other["tip_angle"] >= 0.0
    near = np.minimum(np.abs(one["tip_angle"]), np.abs(other["tip_angle"])) < 1e-5
    both = inside & too
    return (
        ((inside == too) | near).all()
        and np.abs(one["tip_angle"] - other["tip_angle"])[both].max(initial=0.0) < 1e-4
        and np.abs(one["sdg"] - other["sdg"])[both].max(initial=0.0) < 1e-4
    )


@pytest.mark.parametrize(
    ("inner", "outer", "within"),
    [
        (point(0.3, 0.0, -0.1), disc(0.3, 0.0, 0.0, 0.1), True),
        (point(0.3, 0.0, -0.1001), disc(0.3, 0.0, 0.0, 0.1), False),
        # A disc has no thickness.
        (point(0.3, 0.001, 0.0), disc(0.3, 0.0, 0.0, 0.1), False),
        (point(0.06, 0.0, 0.08), ball(0.0, 0.0, 0.0, 0.1), True),
        (point(0.06, 0.0, 0.081), ball(0.0, 0.0, 0.0, 0.1), False),
        (ball(0.0, 0.0, 0.05, 0.05), ball(0.0, 0.0, 0.0, 0.1), True),
        (ball(0.0, 0.0, 0.06, 0.05), ball(0.0, 0.0, 0.0, 0.1), False),
        # The rim is 0.06 from the axis and 0.08 along it: on the ball.
        (disc(0.0, 0.08, 0.0, 0.06), ball(0.0, 0.0, 0.0, 0.1), True),
        (disc(0.0, 0.081, 0.0, 0.06), ball(0.0, 0.0, 0.0, 0.1), False),
        (disc(0.05, 0.0, 0.0, 0.05, (0, -1, 0)), disc(0.0, 0.0, 0.0, 0.1), True),
        (disc(0.06, 0.0, 0.0, 0.05), disc(0.0, 0.0, 0.0, 0.1), False),
        (disc(0.0, 0.0, 0.0, 0.05, (1, 0, 0)), disc(0.0, 0.0, 0.0, 0.1), False),
        (ball(0.0, 0.0, 0.0, 0.05), disc(0.0, 0.0, 0.0, 0.1), False),
        (point(0.1, 0.2, 0.3), point(0.1, 0.2, 0.3), True),
        (point(0.1, 0.2, 0.3), point(0.1, 0.2, 0.301), False),
        (disc(0.0, 0.0, 0.0, 0.05), point(0.0, 0.0, 0.0), False),
    ],
)
def test_what_lies_within_what(inner, outer, within):
    assert lies_within(rows(inner, outer), 0, 1, 1e-8, 1.0) == within
    assert lies_within(rows(outer, inner), 1, 0, 1e-8, 1.0) == within


@pytest.mark.parametrize("seed", range(40))
def test_the_order_of_contacts_changes_nothing(seed):
    # Of 100 such postures 12 had another answer in another order; a few lost their region.
    rng = np.random.default_rng(seed)
    g = directions(rng, 100)
    for primitives in postures(seed, rng):
        first = measure_primitives(primitives[None], g, CHANNELS, LIMITS)
        assert np.isfinite(first["tip_angle"]).all()
        for _ in range(4):
            other = np.ascontiguousarray(primitives[rng.permutation(len(primitives))])
            assert agree(first, measure_primitives(other[None], g, CHANNELS, LIMITS))


@pytest.mark.parametrize("noise", [1e-15, 1e-12, 1e-10, 1e-9, 1e-8])
def test_noise_that_no_sensor_tells_changes_nothing(noise):
    # Of 100 such postures 40 had another answer for their rounding.
    rng = np.random.default_rng(1)
    g = directions(rng, 100)
    for seed in range(20):
        for primitives in postures(seed, rng):
            first = measure_primitives(primitives[None], g, CHANNELS, LIMITS)
            shaken = primitives.copy()
            shaken[:, :3] += rng.normal(size=(len(shaken), 3)) * noise
            assert agree(first, measure_primitives(shaken[None], g, CHANNELS, LIMITS))


@pytest.mark.parametrize("noise", [1e-7, 3e-7])
def test_places_of_six_decimals_change_no_answer(noise):
    # A corner that sticks out of a rim by a micrometre carried half a millimetre beside it: of such
    # robots one in eight had another angle or |SD_g| than as it was drawn.  And where a robot tips
    # the angle to a region that noise bends was that to its boundary and no longer to its planes:
    # of one direction in ten it was another one, by up to 16 deg.
    for seed in range(30):
        drawn, printed = boxed_tracks(seed), boxed_tracks(seed, noise)
        rng = np.random.default_rng(seed)
        params = postures_of(drawn, rng, 30).astype(float)
        g = random_directions(rng, 30 * 40).reshape(30, 40, 3)
        names = (*CHANNELS, "status")
        a, b = (evaluate_each(robot, params, g, names) for robot in (drawn, printed))
        clear = np.abs(a["tip_angle"]) > 1e-4
        stands = (a["status"] != TIPS) & clear
        assert ((b["status"] != TIPS) == (a["status"] != TIPS))[clear].all()
        np.testing.assert_allclose(
            b["tip_angle"][clear], a["tip_angle"][clear], rtol=0.0, atol=2e-3
        )
        np.testing.assert_allclose(b["sdg"][stands], a["sdg"][stands], rtol=0.0, atol=1e-3)


def test_corners_on_the_rims_leave_a_robot_of_wheels_as_it_is():
    wheels = [disc(x, y, -0.3, 0.1) for x in (-0.4, 0.4) for y in (-0.2, 0.2)]
    corners = [point(x, y, z) for x in (-0.4, 0.4) for y in (-0.2, 0.2) for z in (-0.4, -0.2)]
    g = directions(np.random.default_rng(1), 500)
    alone = measure_primitives(rows(*wheels)[None], g, CHANNELS, LIMITS)
    assert 0.2 < (alone["tip_angle"] > 0.0).mean() < 0.8
    for robot in (wheels + corners, corners + wheels):
        both = measure_primitives(rows(*robot)[None], g, CHANNELS, LIMITS)
        for name in CHANNELS:
            np.testing.assert_allclose(both[name], alone[name], rtol=0.0, atol=1e-12)


def test_contacts_keep_their_numbers_where_some_are_hidden():
    wheels = [disc(x, y, -0.3, 0.1) for x in (-0.4, 0.4) for y in (-0.2, 0.2)]
    corners = [point(x, y, -0.4) for x in (-0.4, 0.4) for y in (-0.2, 0.2)]
    table, region = facet_table(8), empty_region(8)
    stand(table, region, rows(*corners, *wheels), LIMITS)
    # The wheels are 4 to 7; the corners on their rims carry nothing.
    named = region.contacts[: region.tally[1]]
    assert set(named.ravel()) == {4, 5, 6, 7}


def test_a_rail_goes_on_to_the_wheel_that_it_begins_within():
    # At a pitch of -90 deg the corner at the wheel's foremost point and the wheel are level; from
    # there on the wheel is lower, and nowhere goes through the corner's level.
    side = [point(-0.25, 0.1, -0.35), disc(-0.2, 0.1, -0.35, 0.05), point(0.25, 0.1, -0.35)]
    robot = [((x, y * way, z), *rest) for (x, y, z), *rest in side for way in (1, -1)]
    height = measure_primitives(rows(*robot)[None], DOWN, ("height",), LIMITS)["height"][0, 0]
    # From the corners ahead, level with the wheels' centres 0.45 m behind, a tangent to the wheels.
    lean = math.asin(0.05 / 0.45)
    assert height == pytest.approx(0.35 * math.cos(lean) + 0.25 * math.sin(lean))


def test_a_box_and_a_ball_stand_the_same_in_any_order_and_nearly_the_same_a_little_on():
    # Of a box's corners the fractions of one number that told them apart add up to the same across
    # both diagonals, so a face was cut along both, and half of its cuts were tip-over axes.
    corners = [(x, y, z) for x in (0.2, -0.2) for y in (0.15, -0.15) for z in (-0.15, -0.25)]
    gravity = np.array([[0.5, 0.0, -1.0]])
    rng = np.random.default_rng(1)
    last = None
    for travel in np.linspace(0.0, 0.02, 41):
        names = rng.permutation(9)
        parts = [contact(f"c{k}", corner) for k, corner in enumerate(corners)]
        parts.append(contact("ball", (0.4, 0.0, -0.2 + travel), 0.05))
        text = '[robot]\nname = "box"\nlength_unit = "m"\nrock_angle = 30\nupright = 80\n'
        text += '[[robot.link]]\nname = "body"\nmass = 5.5\ncom = [0.0182, 0.0, 0.0455]\n'
        recipe = parse_recipe(text + "".join(parts[k] for k in names) + sweep_part())
        angle = evaluate(recipe, [[]], gravity, ("tip_angle",))["tip_angle"][0, 0]
        assert angle > math.radians(10.0)
        assert last is None or abs(angle - last) < math.radians(0.5)
        last = angle


def test_a_polygon_is_as_wide_as_it_is_where_two_of_its_points_are_one():
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0.2, 0], [0, 0.2, 0]])
    up = (0.0, 0.0, 1.0)
    assert polygon_width(square, 0, 4, up) == pytest.approx(0.2)
    for angle in np.linspace(0.0, 2.0 * math.pi, 25):
        twin = square[2] + 1e-16 * np.array([math.cos(angle), math.sin(angle), 0.0])
        points = np.insert(square, 3, twin, axis=0)
        assert polygon_width(points, 0, 5, up) == pytest.approx(0.2)


def test_a_stage_that_no_gap_leads_over_says_nothing_about_the_shape_of_the_region():
    # A wheel in the plane of a box's side, its lowest point on the box's edge: noise makes a sliver
    # of a stage there.  Beyond a corner the angle is measured to the planes, as without the wheel.
    box = [point(x, y, z) for x in (0.2, -0.2) for y in (0.3, -0.3) for z in (-0.4, -0.3)]
    plain = rows(*box, disc(-0.1, 0.06, -0.2, 0.1, (1, 0, 0)))
    wheel = rows(*box, disc(-0.2, 0.06, -0.3, 0.1, (1, 0, 0)))
    g = directions(np.random.default_rng(1), 400)
    expected = measure_primitives(plain[None], g, ("tip_angle",), LIMITS)["tip_angle"]
    rng = np.random.default_rng(2)
    assert (expected < -0.1).any()
    for _ in range(20):
        order = np.ascontiguousarray(wheel[rng.permutation(len(wheel))])
        found = measure_primitives(order[None], g, ("tip_angle",), LIMITS)["tip_angle"]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9)


def test_contacts_that_noise_puts_on_several_planes_leave_no_axis_inside():
    # Next to the ends of an edge between two rests nobody looked whether the robot is caught.
    box = [point(x, y, -0.25) for x in (0.1, -0.1) for y in (0.25, -0.25)]
    box += [point(0.0, 0.15, -0.25), disc(0.1, -0.1, -0.15, 0.1, (1, 0, 0))]
    plain = rows(*box)
    g = directions(np.random.default_rng(3), 400)
    expected = measure_primitives(plain[None], g, CHANNELS, LIMITS)
    rng = np.random.default_rng(4)
    for noise in (1e-9, 1e-8, 3e-8, 1e-7):
        for _ in range(10):
            shaken = plain.copy()
            shaken[:, :3] += rng.normal(size=(len(plain), 3)) * noise
            assert agree(expected, measure_primitives(shaken[None], g, CHANNELS, LIMITS))
