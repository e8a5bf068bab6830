"""Feet on uneven ground: hand-worked scenes, an oracle of many rays, and what never matters."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from lutgen.analysis import equilibrium
from lutgen.errors import InputError
from tests.fixtures.length import part

DOWN = np.array([0.0, 0.0, -1.0])
SQUARE = np.array([[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0]])
FLAT = np.tile([0.0, 0.0, 1.0], (4, 1))
WALLS = [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]]
DITCH = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]
# The solver's equations hold to 1e-9, and a corner moves by about as much, times a few sizes.
EXACT = 1e-6


def scene(seed, feet):
    """Return points, normals (up to about 60 deg steep), friction and a com at random."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(feet, 3)) * [1.0, 1.0, 0.4]
    normals = rng.normal(size=(feet, 3)) * 0.6 + [0.0, 0.0, 1.0]
    normals[:, 2] = np.abs(normals[:, 2]) + 0.1
    com = points.mean(axis=0) + rng.normal(size=3) * [0.5, 0.5, 0.0] + [0.0, 0.0, 1.0]
    return points, normals, rng.uniform(0.1, 0.9, feet), com


def same_set(a, b, tolerance):
    """Tell whether two sets of corners are the same, in any order."""
    apart = np.linalg.norm(a[:, None] - b[None], axis=2)
    return len(a) == len(b) and bool((apart.min(axis=1) < tolerance).all())


def faults(points, normals, mu, com, found):
    """Return by how much the forces miss the weight, its moment, or a cone."""
    forces = found.forces
    unit = normals / np.linalg.norm(normals, axis=1)[:, None]
    normal = np.einsum("ij,ij->i", forces, unit)
    along = np.linalg.norm(forces - normal[:, None] * unit, axis=1)
    moment = np.cross(points - com, forces).sum(axis=0)
    apart = np.abs(forces.sum(axis=0) + DOWN)
    return max(apart.max(), np.abs(moment).max(), (along - mu * normal).max())


def test_in_a_ditch_the_com_lies_within_eight_tenths_of_its_half_width():
    # Of a foot on a 45 deg wall with mu = 1/2, the cone in the ditch's plane has the edges
    # (1, 1) + (1, -1) / 2 = (3, 1) / 2 and (1, 1) - (1, -1) / 2 = (1, 3) / 2: a force (H, V)
    # towards the middle has H / 3 <= V <= 3 H.  Both feet push with the same H, and V + V' = 1.
    # The com at x needs V' - V = x, so V' = (1 + x) / 2 <= 3 H and V = (1 - x) / 2 >= H / 3.
    # H can be chosen if (1 + x) / 6 <= 3 (1 - x) / 2, that is 10 x <= 8.  The height drops out.
    for height in (-2.0, 5.0):
        found = equilibrium(DITCH, WALLS, 0.5, [0.3, 0.0, height])
        assert found.holds is True
        assert same_set(found.region, np.array([[-0.8, 0.0], [0.8, 0.0]]), EXACT)
        assert (found.margin, found.is_open) == (0.0, False)
        # A pyramid of 256 sides around a cone is wider by 7.5e-5: within that it is undecided.
        for x, y, holds in ((-0.8, 0.0, True), (0.80001, 0.0, None), (0.8008, 0.0, False)):
            assert equilibrium(DITCH, WALLS, 0.5, [x, y, height]).holds is holds
        assert equilibrium(DITCH, WALLS, 0.5, [0.0, 0.01, height]).holds is False


def test_on_flat_ground_polygon_and_slope_are_judged_as_on_one_plane():
    rng = np.random.default_rng(3)
    feet = np.vstack([SQUARE, [[0.2, 0.1, 0.0]]])
    seen = set()
    for _ in range(20):
        com = np.array([*rng.uniform(-1.5, 1.5, 2), 0.7])
        tilt, heading = rng.uniform(0.0, 0.8), rng.uniform(0.0, 6.3)
        down = [math.sin(tilt) * math.cos(heading), math.sin(tilt) * math.sin(heading)]
        down = np.array([*down, -math.cos(tilt)])
        # Where the line of gravity meets the ground.
        foot = com - com[2] / down[2] * down
        inside = bool((np.abs(foot[:2]) <= 1.0).all())
        expected = inside and math.tan(tilt) <= 0.5
        found = equilibrium(feet, np.tile([0.0, 0.0, 2.0], (5, 1)), 0.5, com, down)
        assert found.holds is expected
        seen.add((inside, math.tan(tilt) <= 0.5))
        if math.tan(tilt) <= 0.5:
            assert same_set(found.region, SQUARE @ found.axes.T, EXACT)
            # For those inside the nearest side, as a line, seen along gravity.
            corners, place = found.region, found.axes @ com
            sides = np.roll(corners, -1, axis=0) - corners
            arms = place - corners
            turn = sides[:, 0] * arms[:, 1] - sides[:, 1] * arms[:, 0]
            least = (turn / np.linalg.norm(sides, axis=1)).min()
            assert (found.margin >= 0.0) is inside
            if inside:
                assert found.margin == pytest.approx(least, abs=EXACT)
        else:
            assert found.region.shape == (0, 2)
            assert found.margin == -math.inf
    assert len(seen) == 4
    # Without friction a slope holds nothing, and four feet share a weight evenly, and no better.
    level = equilibrium(SQUARE, FLAT, 0.0, [0.7, 0.0, 1.0])
    assert level.margin == pytest.approx(0.3, abs=EXACT)
    np.testing.assert_array_equal(level.axes, np.eye(3)[:2])
    even = equilibrium(SQUARE, FLAT, 0.5, [0.0, 0.0, 1.0])
    assert even.forces[:, 2] == pytest.approx([0.25] * 4, abs=1e-6)
    steep = equilibrium(SQUARE, np.tile([0.1, 0.0, 1.0], (4, 1)), 0.0, [0.0, 0.0, 1.0])
    assert (steep.holds, len(steep.region), steep.margin) == (False, 0, -math.inf)


def missing(points, normals, mu, com):
    """Return the length of the least wrench that is missing: by rays, 1000 of each cone."""
    unit = normals / np.linalg.norm(normals, axis=1)[:, None]
    turns = np.linspace(0.0, 2.0 * math.pi, 1000, endpoint=False)
    rays = []
    for point, normal, rough in zip(points, unit, mu, strict=True):
        across = np.linalg.svd(normal[None])[2][1:]
        fan = normal + rough * np.stack([np.cos(turns), np.sin(turns)], axis=1) @ across
        rays.append(np.hstack([fan, np.cross(point - com, fan)]))
    return nnls(np.vstack(rays).T, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0])[1]


def test_forces_along_rays_of_the_cones_agree_where_they_can_tell():
    told = {True: 0, False: 0}
    undecided = 0
    for seed in range(part(30)):
        points, normals, mu, com = scene(seed, 2 + seed % 4 + (seed > 3))
        gap = missing(points, normals, mu, com)
        if 1e-5 < gap < 1e-2:
            # A polygon of rays is 5e-6 narrower than its cone, lutgen's pyramid 7.5e-5 wider.
            undecided += 1
            continue
        expected = gap <= 1e-5
        assert equilibrium(points, normals, mu, com).holds is expected, seed
        told[expected] += 1
    assert undecided <= part(30) // 5
    assert min(told.values()) >= part(30) // 5


def test_forces_balance_the_weight_within_their_cones_and_the_regions_corners_hold():
    for seed in range(part(3, 3)):
        points, normals, mu, _ = scene(seed, 4)
        region = equilibrium(points, normals, mu, [0.0, 0.0, 1.0]).region
        middle = region.mean(axis=0)
        com = np.array([*middle, 1.0])
        found = equilibrium(points, normals, mu, com)
        assert found.holds is True
        assert found.margin > 0.0
        # The tolerance of missing wrench is 1e-7 of weight x size, and sizes are below 4.
        assert faults(points, normals, mu, com, found) < 1e-6
        # What lies farther out does not hold: the gap is 1e-4 of the diameter, the pyramids' 1.2e-3
        # of the friction moves a side by a multiple of that.
        for corner in region[:: len(region) // 2]:
            for factor, holds in ((0.999, True), (1.1, False)):
                place = middle + factor * (corner - middle)
                assert equilibrium(points, normals, mu, [*place, 0.0]).holds is holds
        # More friction holds more.
        rough = equilibrium(points, normals, 1.5 * mu, com).region
        assert (np.ptp(rough, axis=0) > np.ptp(region, axis=0)).all()


@settings(max_examples=part(40, 8))
@given(seed=st.integers(0, 10_000))
def test_turning_scaling_and_renaming_change_nothing(seed):
    rng = np.random.default_rng(seed)
    points, normals, mu, com = scene(seed, int(rng.integers(1, 4)))
    turn = Rotation.random(random_state=seed).as_matrix()
    order = rng.permutation(len(points))
    scale, shift = 10.0 ** rng.uniform(-3.0, 3.0), rng.normal(size=3)
    before = equilibrium(points, normals, mu, com)
    moved = [scale * (part + shift) @ turn.T for part in (points[order], com)]
    turned = normals[order] @ turn.T * rng.uniform(0.1, 9.0, (len(points), 1))
    after = equilibrium(moved[0], turned, mu[order], moved[1], 9.81 * turn @ DOWN)
    # A scene at the very limit may be told apart by rounding; none of these is.
    assert after.holds is before.holds
    assert after.is_open is before.is_open or before.is_open
    if not before.is_open:
        if math.isfinite(before.margin):
            # Both are known to 1e-4 of their diameter, from other sides, and pyramids of 64 sides
            # keep their edges uphill.
            near = 1e-3 * max(np.ptp(before.region, axis=0).max(), 1.0)
            assert after.margin / scale == pytest.approx(before.margin, abs=near)
        else:
            assert after.margin == before.margin


def test_what_is_wrong_is_said_in_one_sentence():
    good = {"points": SQUARE, "normals": FLAT, "friction": 0.5, "com": [0, 0, 1]}
    for name, value in (
        ("points", np.empty((0, 3))),
        ("points", np.full((4, 3), 1e200)),
        ("normals", FLAT[:3]),
        ("normals", np.zeros((4, 3))),
        ("friction", -0.1),
        ("friction", 1e9),
        ("friction", [0.5, 0.5]),
        ("friction", math.nan),
        ("com", [0.0, 1.0]),
        ("gravity_dir", [0.0, 0.0, 0.0]),
    ):
        with pytest.raises(InputError, match=r"(friction from 0 to 1e|direction).*\(got "):
            equilibrium(**(good | {name: value}))


def test_a_com_that_is_held_far_beyond_the_search_has_no_boundary_near():
    # Feet pressed between two walls, friction above 1: they hold any arm.
    points = [[-1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0]]
    walls = [[1, 0, 0], [1, 0, 0], [-1, 0, 0], [-1, 0, 0]]
    for far in (10.0, 1e4):
        found = equilibrium(points, walls, 1.5, [far, 0.0, 0.0])
        assert found.holds
        assert found.is_open
        assert found.margin > 0.0
