"""Contacts that another one covers: boxes whose corners lie on wheels, in any order and noise."""

import math
from functools import partial

import numpy as np
import pytest

from lutgen.recipe import forward, radii_and_kinds
from lutgen.support import acceptance, empty_region, lies_within, pack, stand
from tests.fixtures.odd_robots import boxed_tracks
from tests.oracles.standing import Limits
from tests.support.postures import DISC, POINT, SPHERE, below
from tests.support.postures import read as posture_read

LIMITS = Limits(math.radians(80), math.radians(30), 0.005, 5e-5)
CHANNELS = ("sdg", "tip_angle")
ENDS = ("minimum", "maximum")
DOWN = np.array([[0.0, 0.0, -1.0]])


def rows(*primitives):
    """Return the rows of primitives: centre, axis, radius, kind."""
    return np.array([[*centre, *axis, radius, kind] for centre, axis, radius, kind in primitives])


def point(x, y, z):
    return (x, y, z), (0, 0, 0), 0.0, POINT


def ball(x, y, z, radius):
    return (x, y, z), (0, 0, 0), radius, SPHERE


def disc(x, y, z, radius, axis=(0, 1, 0)):
    return (x, y, z), axis, radius, DISC


read = partial(posture_read, channels=CHANNELS, limits=LIMITS)


def agree(one, other):
    """Tell whether two answers are the same but for rounding: verdict, |SD_g| and angle inside."""
    inside, too = one["tip_angle"] >= 0.0, other["tip_angle"] >= 0.0
    near = np.minimum(np.abs(one["tip_angle"]), np.abs(other["tip_angle"])) < 1e-5
    both = inside & too
    off = [np.abs(one[name] - other[name])[both].max(initial=0.0) for name in CHANNELS]
    return bool(((inside == too) | near).all() and max(off) < 1e-4)


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


@pytest.mark.parametrize("noise", [0.0, 1e-12, 1e-10, 1e-8])
def test_neither_order_nor_noise_that_no_sensor_tells_changes_an_answer(noise):
    rng = np.random.default_rng(1)
    for seed in range(12):
        recipe, g = boxed_tracks(seed), below(rng, 60)
        low, high = (np.array([getattr(p, end) for p in recipe.parameters]) for end in ENDS)
        params = low + (high - low) * rng.random((3, len(low)))
        params[0] = 0.0
        where = forward(recipe, params)
        for primitives in pack(where.centres, where.axes, *radii_and_kinds(recipe)):
            first = read(primitives, g)
            assert np.isfinite(first["tip_angle"]).all()
            for _ in range(2):
                shaken = primitives[rng.permutation(len(primitives))].copy()
                shaken[:, :3] += noise * rng.normal(size=(len(shaken), 3))
                assert agree(first, read(shaken, g))


WHEELS = [disc(x, y, -0.3, 0.1) for x in (-0.4, 0.4) for y in (-0.2, 0.2)]


def test_corners_on_the_rims_leave_a_robot_of_wheels_as_it_is():
    corners = [point(x, y, z) for x in (-0.4, 0.4) for y in (-0.2, 0.2) for z in (-0.4, -0.2)]
    g = below(np.random.default_rng(1), 500)
    alone = read(rows(*WHEELS), g)
    assert 0.2 < (alone["tip_angle"] > 0.0).mean() < 0.8
    for robot in (WHEELS + corners, corners + WHEELS):
        both = read(rows(*robot), g)
        for name in CHANNELS:
            np.testing.assert_allclose(both[name], alone[name], rtol=0.0, atol=1e-12)


def test_contacts_keep_their_numbers_where_some_are_covered():
    corners = [point(x, y, -0.4) for x in (-0.4, 0.4) for y in (-0.2, 0.2)]
    region = empty_region()
    stand(region, rows(*corners, *WHEELS), acceptance(*LIMITS[:2], 0.0, *LIMITS[2:]))
    # The wheels are 4 to 7; the corners on their rims carry nothing.
    named = region.source[region.arc[: region.counts.arcs]["contacts"]]
    assert set(named.ravel().tolist()) == {4, 5, 6, 7}


def test_a_rail_goes_on_to_the_wheel_that_it_begins_within():
    # At a pitch of -90 deg the corner at the wheel's foremost point and the wheel are level.
    side = [point(-0.25, 0.1, -0.35), disc(-0.2, 0.1, -0.35, 0.05), point(0.25, 0.1, -0.35)]
    robot = [((x, y * way, z), *rest) for (x, y, z), *rest in side for way in (1, -1)]
    found = read(rows(*robot), DOWN, channels=("height",))
    # From the corners ahead, level with the wheels' centres 0.45 m behind, a tangent to the wheels.
    lean = math.asin(0.05 / 0.45)
    assert found["height"].item() == pytest.approx(0.35 * math.cos(lean) + 0.25 * math.sin(lean))


def test_a_wheel_in_the_plane_of_a_boxs_side_changes_nothing_in_any_order():
    wheel = disc(-0.2, 0.06, -0.3, 0.1, (1, 0, 0))
    box = [point(x, y, z) for x in (0.2, -0.2) for y in (0.3, -0.3) for z in (-0.4, -0.3)]
    g = below(np.random.default_rng(1), 400)
    expected = read(rows(*box, disc(-0.1, 0.06, -0.2, 0.1, (1, 0, 0))), g)["tip_angle"]
    rng = np.random.default_rng(2)
    assert (expected < -0.1).any()
    for _ in range(20):
        found = read(rng.permutation(rows(*box, wheel)), g)["tip_angle"]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9)


def test_contacts_that_noise_puts_on_several_planes_leave_no_axis_inside():
    box = [point(x, y, -0.25) for x in (0.1, -0.1) for y in (0.25, -0.25)]
    plain = rows(*box, point(0.0, 0.15, -0.25), disc(0.1, -0.1, -0.15, 0.1, (1, 0, 0)))
    g = below(np.random.default_rng(3), 400)
    expected, rng = read(plain, g), np.random.default_rng(4)
    for noise in (1e-9, 1e-8, 3e-8, 1e-7):
        for _ in range(10):
            shaken = plain.copy()
            shaken[:, :3] += rng.normal(size=(len(plain), 3)) * noise
            assert agree(expected, read(shaken, g))
