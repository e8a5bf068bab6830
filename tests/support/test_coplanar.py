"""Contacts in one plane, in one line, at one place or all but so: in any order, one answer."""

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import nnls

import lutgen
from lutgen.recipe import forward, radii_and_kinds
from lutgen.support import DISC, SPHERE, pack
from lutgen.support.facets import SKEW
from lutgen.support.primitive import POINT
from tests.fixtures.odd_robots import odd_robot
from tests.oracles.primitives import unit
from tests.support import postures

LEVEL = np.array([[0.0, 0.0, -1.0]])


def test_without_limits_the_region_is_the_convex_cone_of_the_contacts():
    rng = np.random.default_rng(3)
    stands = asked = 0
    for seed in range(60):
        family = postures.EXACT[seed % len(postures.EXACT)] if seed % 2 else "points"
        make = np.random.default_rng(seed)
        feet = (postures.drawn if family == "points" else postures.exact)(family, make)[:, :3]
        g = postures.below(rng, 30)
        found = lutgen.stability(feet, g, ("tip_angle",))["tip_angle"][0]
        for direction, angle in zip(g, found, strict=True):
            if abs(angle) > 1e-6:
                # Forces that only push at the contacts balance the weight, or none do.
                left = nnls(feet.T, direction)[1]
                assert (left < 1e-9) == (angle > 0.0)
                stands, asked = stands + (angle > 0.0), asked + 1
    assert 0.2 < stands / asked < 0.8


@pytest.mark.parametrize("noise", [0.0, 1e-12, 1e-10, 1e-9, 1e-8, 1e-6])
def test_contacts_a_little_off_a_plane_have_the_stability_factor_of_those_in_it(noise):
    # Defects 4 and 5: a sliver got weight from noise, and the plane of a triangle had its centroid.
    rng = np.random.default_rng(4)
    for seed in range(30):
        flat = postures.exact(
            ("rectangle", "polygon", "in line")[seed % 3], np.random.default_rng(seed)
        )
        off = flat.copy()
        off[:, 2] += noise * rng.uniform(-1.0, 1.0, len(off))
        g = postures.below(rng, 40)
        want, got = postures.read(flat, g), postures.read(off, g)
        # The plane turns by the noise over the width, which is at least 0.2, and the pierced point
        # moves by the height times that; near grazing by more.
        inside = (want["tip_angle"] > 0.05) & (-g[:, 2] > 0.5)
        for name in postures.CHANNELS:
            np.testing.assert_allclose(
                got[name][inside], want[name][inside], 0.0, 40 * noise + 1e-12
            )


def test_a_com_just_above_its_contacts_is_a_quarter_turn_from_tipping():
    feet = np.array([[1, 0.5, -8e-6], [-1, 0.5, -8e-6], [-1, -0.5, -8e-6], [1, -0.5, -8e-6]])
    got = lutgen.stability(feet, LEVEL, ("tip_angle",))["tip_angle"]
    # Defect 3: a sine that rounds to 1 is no missing boundary.
    assert got.item() == pytest.approx(math.pi / 2.0 - 1.6e-5, abs=1e-9)


@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-7, 1e-5, 1e-4])
def test_the_diagonal_of_four_wheels_is_no_axis_where_rocking_is_forbidden(noise):
    # Defect 6: rests that a turn of at most 2e-4 rad joins are one, at any rock_angle.
    rng = np.random.default_rng(6)
    for _ in range(20):
        feet = np.array(
            [[0.5, 0.4, -0.5], [0.5, -0.4, -0.5], [-0.5, -0.4, -0.5], [-0.5, 0.4, -0.5]]
        )
        off = feet + 0.4 * noise * rng.uniform(-1.0, 1.0, feet.shape)
        got = lutgen.stability(off, LEVEL, ("tip_angle", "status"), math.radians(80.0), 0.0)
        assert got["status"].item() == 0
        assert got["tip_angle"].item() == pytest.approx(
            math.atan2(0.4, 0.5), abs=5.0 * noise + 1e-12
        )


def test_the_diagonal_of_a_warped_table_is_an_axis_where_rocking_is_forbidden():
    feet = np.array([[0.5, 0.4, -0.5], [0.5, -0.4, -0.49], [-0.5, -0.4, -0.5], [-0.5, 0.4, -0.49]])
    ahead = unit(np.array([[0.2, 0.1, -1.0]]))
    fixed, free = (
        lutgen.stability(feet, ahead, ("tip_angle",), math.radians(80.0), angle)["tip_angle"].item()
        for angle in (0.0, math.radians(30.0))
    )
    # From (0.2, 0.1, -1) to the plane through the com and the diagonal of slope 0.8.
    normal = unit(np.cross(feet[0], feet[2]))
    assert fixed == pytest.approx(abs(math.asin(normal @ ahead[0])), abs=1e-12)
    assert free > fixed + 0.1


@pytest.mark.parametrize("width", [3e-3, 3e-4, 3e-5, 3e-6])
@pytest.mark.parametrize("apart", [1.0, 3e-4, 3e-5])
def test_a_foot_as_small_as_noise_still_tips_to_all_sides(width, apart):
    # Short sides say nothing where others close the region, and everything where none do.
    x, y = apart, 0.5 * width
    feet = np.array([[x, y, -1], [x, -y, -1], [-x, -y, -1], [-x, y, -1]])
    ways = np.radians(np.arange(0, 360, 10.0))
    g = np.stack([np.cos(ways), np.sin(ways), -1.0 + 0.0 * ways], axis=1)
    found = lutgen.stability(feet[None], g, ("tip_angle",))["tip_angle"][0]
    down = lutgen.stability(feet[None], LEVEL, ("tip_angle",))["tip_angle"].item()
    assert (found[np.abs(np.sin(ways)) > 0.1] < 0.0).all()
    assert apart == 1.0 or (found < 0.0).all()
    assert down == pytest.approx(math.atan(min(x, y)), rel=1e-6)


@pytest.mark.parametrize("kind", [POINT, SPHERE, DISC])
def test_a_facet_that_the_first_plane_meets_at_once_is_found(kind):
    # The search begins at the corner in the direction of this skew plane, and tilts it level.
    x, y = 10.0 * SKEW[0], 10.0 * SKEW[1]
    centre = np.array([[x, y, -0.5], [-y, x, -0.5], [-x, -y, -0.5], [y, -x, -0.5]])
    radius = 0.0 if kind == POINT else 0.05
    rows = postures.rows_of(centre, np.tile([0.0, 1.0, 0.0], (4, 1)), radius, kind)
    got = postures.read(rows, LEVEL)
    assert got["status"].item() == 0
    half = math.hypot(x, y) / math.sqrt(2.0)
    assert got["tip_angle"].item() == pytest.approx(math.atan(half / (0.5 + radius)), abs=1e-12)


def test_contacts_that_support_nothing_tip_in_every_direction():
    line = np.array([[0.1, 0, -1], [0.2, 0, -1], [0.4, 0, -1], [-0.4, 0, -1]])
    above = np.array([[1.0, 0, 1], [-1, 1, 1], [-1, -1, 1]])
    g = np.random.default_rng(7).normal(size=(50, 3))
    for feet in (line, np.repeat(line[:1], 3, axis=0)):
        assert (lutgen.stability(feet, g, ("tip_angle",))["tip_angle"] == -math.pi).all()
    got = lutgen.stability(above, g, ("tip_angle",), math.radians(90.0))["tip_angle"]
    assert (got == -math.pi).all()
    # Without a limit they carry a robot that hangs from them.
    assert lutgen.stability(above, -LEVEL, ("tip_angle",))["tip_angle"].item() > 0.4


def test_wheels_and_casters_of_one_radius_in_a_row_hide_no_facet():
    # On its left wheel, wheel, caster; tilted about these three the plane grazes the one amid.
    wheel, caster = [0.0, 1.0, 0.0, 0.2, 2.0], [0.0, 0.0, 0.0, 0.2, 1.0]
    places = [(-0.8, 0.5, wheel), (0.5, 0.5, wheel), (0.6, 0.5, caster), (0.6, -0.5, caster)]
    rows = np.array([[x, y, -0.2, *rest] for x, y, rest in places])
    for order in itertools.permutations(range(4)):
        found = postures.read(rows[list(order)], LEVEL)
        assert found["status"][0] == 0
        # Over the line from the caster on the right to the wheel behind on the left.
        edge = abs(np.cross([1.4, -1.0, 0.0], [0.8, -0.5, 0.0])[2]) / math.hypot(1.4, 1.0)
        assert found["tip_angle"][0] == pytest.approx(math.atan2(edge, 0.4), abs=1e-9)


@pytest.mark.parametrize("seed", [343, 530, 1450, 9012])
def test_facets_of_robots_with_contacts_in_a_row_are_those_of_the_oracle(seed):
    recipe = odd_robot(seed)
    middle = np.array([recipe.home_params])
    ends = [[p.minimum + 0.3 * (p.maximum - p.minimum) for p in recipe.parameters]]
    for params in (middle, ends):
        where, (radius, kind) = forward(recipe, params), radii_and_kinds(recipe)
        (rows,) = pack(where.centres, where.axes, radius, kind)
        postures.assert_every_facet_once(rows, 78.0)
