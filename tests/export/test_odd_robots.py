"""Random robots, points, balls and discs of many sizes: C never says more than the definition."""

import shutil

import numpy as np
import pytest

from lutgen.channels import acceptance_of, evaluate_each
from lutgen.recipe import forward, radii_and_kinds
from lutgen.support import ACCEPTED, empty_region, pack, stand
from tests.fixtures.many_library import (
    Library,
    boundary_points,
    postures_of,
    random_directions,
    shown,
)
from tests.fixtures.odd_robots import boxed_tracks, odd_rails, odd_robot, six_feet, two_rims

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
TIPS = 2
# Each was once told a larger angle than the definition has, or safe where it tips: sides of gaps
# beside a ball of another size (32, 71), between rims that turn at different paces or that another
# gap cuts (7, 80, 110, 748), whose roll was too coarse (438, 466), wheels that lie on their faces
# (24, 447, 725), corners of which both walls are behind by rounding (1737), a ball between a wheel
# and another ball that all but touch one plane (1392).
ONCE_WRONG = (7, 24, 32, 71, 80, 110, 438, 447, 466, 725, 748, 1392, 1737)
# On parallel axles: a roll that was summed over the contact that goes the longer way (1045), gaps
# whose far end a com just above its facets sees on the hither side (3271).
ONCE_WRONG_RAILS = (1045, 3271)
# Of any other: the first ones.
SEEDS = sorted({*ONCE_WRONG, *range(4)})
RAILS = sorted({*ONCE_WRONG_RAILS, *range(4)})
ROBOTS = [*((odd_robot, seed) for seed in SEEDS), *((odd_rails, seed) for seed in RAILS)]
# Rolls of the C are parabolas, and its sides of gaps are brought in by products that are not
# normalised: seed 80 is told this much more (rad), all others nothing.
MORE = 3e-5
# Where a wheel lies flatter than this sine its rim runs so fast that the definition draws the side
# of a gap across the rest beside it, and says less than what is left without that gap.
FLAT = 0.3


def flattest(recipe, params):
    """Return the least sine between an axle and an accepted facet, per posture."""
    where, (radius, kind) = forward(recipe, params.astype(float)), radii_and_kinds(recipe)
    region = empty_region(len(radius))
    result = []
    for centres, axes in zip(where.centres, where.axes, strict=True):
        stand(region, pack(centres, axes, radius, kind), acceptance_of(recipe))
        normals = region.seat["normal"][: region.counts[ACCEPTED]]
        sines = np.linalg.norm(np.cross(normals[:, None], axes[None, kind == 2]), axis=-1)
        result.append(sines.min(initial=1.0))
    return np.array(result)


@pytest.mark.parametrize(("make", "seed"), ROBOTS)
def test_no_robot_is_told_more_than_the_definition_says(make, seed, tmp_path):
    recipe, rng = make(seed), np.random.default_rng(seed + 1000)
    count = 150 if recipe.parameters else 1
    params = postures_of(recipe, rng, count) if recipe.parameters else np.zeros((1, 0), np.float32)
    near = boundary_points(recipe, params, rng, 60, 18)
    far = random_directions(rng, count * 60).reshape(count, 60, 3).astype(np.float32)
    g = np.concatenate([near, far], axis=1)
    channels = ("tip_angle", "status")
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), channels)
    robot = Library(recipe, tmp_path)
    assert robot.parallel == (make is odd_rails)
    got = robot.read(params, g)
    assert robot.most["failed"] == 0
    safe, stands = got["status"] != TIPS, truth["status"] != TIPS
    assert not (safe & (truth["tip_angle"] < -MORE)).any()
    plain = flattest(recipe, params) > FLAT
    assert (got["tip_angle"] <= truth["tip_angle"] + MORE)[plain].all()
    # Of random robots some gaps and facets are given up, of those with a wheel on its face rests.
    assert (safe & stands).sum() > (0.0 if seed in (24, 447, 725) else 0.6) * stands.sum()


def test_a_disc_that_lies_on_its_face_carries_nobody(tmp_path):
    # One of its feet is a disc like a coin.
    recipe = odd_robot(24)
    params = np.float32([[2.2], [0.3]])
    g = random_directions(np.random.default_rng(1), 4000).reshape(2, -1, 3).astype(np.float32)
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("status",))["status"]
    got = Library(recipe, tmp_path).read(params, g)["status"]
    assert not ((got != TIPS) & (truth == TIPS)).any()


def test_of_a_gap_of_two_parts_only_the_definitions_is_kept(tmp_path):
    # One edge lets it go over two parts of the line, and what is between them holds longer than
    # what is left beyond.
    recipe, rng = odd_robot(5105), np.random.default_rng(1)
    params = np.full((60, 1), 2.432524, np.float32)
    g = boundary_points(recipe, params, rng, 60)
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle", "status"))
    got = Library(recipe, tmp_path).read(params, g)
    assert not ((got["status"] != TIPS) & (truth["status"] == TIPS)).any()
    assert (got["tip_angle"] <= truth["tip_angle"]).all()


@pytest.mark.parametrize(
    ("seed", "angle"), [(5003, 1.917837), (5161, -2.356194), (5225, 2.356194), (5577, -1.904113)]
)
def test_of_three_contacts_in_a_row_both_planes_are_found(seed, angle, tmp_path):
    # Of wheels and balls whose centres are nearly on one line the radii tell how the planes below
    # them lean, and that of their centres is no good begin: whole rests were not found.
    recipe, rng = odd_robot(seed), np.random.default_rng(1)
    params = np.full((60, 1), angle, np.float32)
    g = random_directions(rng, 3600).reshape(60, 60, 3).astype(np.float32)
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle", "status"))
    got = Library(recipe, tmp_path).read(params, g)["status"]
    # Nearer to the boundary than the guard and what rounding takes nobody is told to stand.
    clear = (truth["status"] != TIPS) & (truth["tip_angle"] > 3e-4)
    assert clear.mean() > 0.1
    assert (got[clear] != TIPS).all()


@pytest.mark.parametrize(("shape", "seed"), [("ball", 0), ("disc", 5), ("point", 7)])
def test_six_feet_that_noise_puts_next_to_one_plane_stand_where_they_should(shape, seed, tmp_path):
    # Coordinates with six digits: a foot is within rounding of one plane and not of the next, and
    # of what stood 12 to 46 % was called unsafe where facets of some feet hid that of all.
    recipe, rng = six_feet(shape, seed), np.random.default_rng(5)
    params = postures_of(recipe, rng, 3)
    g = random_directions(rng, 900).reshape(3, 300, 3).astype(np.float32)
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle", "status"))
    got = Library(recipe, tmp_path).read(params, g)
    assert (got["tip_angle"] <= truth["tip_angle"]).all()
    clear = (truth["status"] != TIPS) & (truth["tip_angle"] > 3e-4)
    assert clear.mean() > 0.1
    assert (got["status"][clear] != TIPS).all()


@pytest.mark.parametrize(
    ("seed", "params", "gravity"),
    [
        # Rolls over two edges in a row: each rounds by how much the com rises.
        (4009, (0.17325874,), (-0.68448699, -0.17543611, -0.70760137)),
        # A wheel that leans goes along its rim at an uneven pace: halfway is not in the middle.
        (4029, (2.22512722, -1.87216735, -2.90233254), (0.18634935, 0.68403447, -0.7052452)),
        # Its side of a gap runs nearly along the edge that it comes to.
        (4029, (2.22512722, -1.87216735, -2.90233254), (-0.684814, 0.624925, -0.374831)),
    ],
)
def test_directions_that_were_once_told_more_on_rails(seed, params, gravity, tmp_path):
    recipe, params = odd_rails(seed), np.float32([params])
    g = np.float32([[gravity]])
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle", "status"))
    got = Library(recipe, tmp_path).read(params, g)
    assert (got["tip_angle"] <= truth["tip_angle"] + MORE).all()
    assert (got["status"] == TIPS).all() or (truth["status"] != TIPS).all()


@pytest.mark.parametrize("seed", [0, 6, 28, 109])
def test_corners_on_the_rims_of_wheels_open_no_axis(seed, tmp_path):
    # A sliver between two facets was a
    # rest with the contacts near its plane, and its far edge was taken for the way back: a gap was
    # held that is not, 12 deg above the truth, and once safe where it tips.
    recipe, rng = boxed_tracks(seed), np.random.default_rng(seed + 1000)
    params = postures_of(recipe, rng, 60)
    near = boundary_points(recipe, params, rng, 30, 18)
    far = random_directions(rng, 3600).reshape(60, 60, 3).astype(np.float32)
    g = np.concatenate([near, far], axis=1)
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle", "status"))
    got = Library(shown(recipe), tmp_path).read(params, g)
    safe, stands = got["status"] != TIPS, truth["status"] != TIPS
    assert not (safe & ~stands).any()
    assert (got["tip_angle"] <= truth["tip_angle"]).all()
    # Within the guard of the boundary, where half of these directions are, nobody is said to stand.
    assert safe[stands & (truth["tip_angle"] > 3e-4)].mean() > 0.98


def test_of_a_wheel_of_two_rims_either_may_be_the_corner_of_a_rest(tmp_path):
    # Flippers that are nearly straight down put four pairs of rims next to one plane.  Rounding
    # tells which rim of a pair is a facet's corner, and over the side between both nobody was
    # asked to go: a gap was held 0.07 deg too far.
    recipe, rng = two_rims(), np.random.default_rng(8)
    down = np.where(rng.random((150, 4)) < 0.5, -1.0, 1.0) * np.pi / 2.0
    off = rng.choice([0.0, 0.005, 0.02], (150, 4)) * rng.random((150, 4))
    params = (down * (1.0 - off)).astype(np.float32)
    g = boundary_points(recipe, params, rng, 40, 18)
    truth = evaluate_each(recipe, params.astype(float), g.astype(float), ("tip_angle", "status"))
    robot = Library(recipe, tmp_path)
    got = robot.read(params, g)
    assert robot.most["failed"] == 0
    # The guard is 1e-4; which of two facets a wedge between rims is of may alter as much again.
    safe, stands = got["status"] != TIPS, truth["status"] != TIPS
    assert not (safe & (truth["tip_angle"] < -1e-4)).any()
    assert (got["tip_angle"] <= truth["tip_angle"] + 1e-4)[safe].all()
    assert safe[stands & (truth["tip_angle"] > 1e-3)].mean() > 0.98
