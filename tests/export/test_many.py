"""Many contacts in C: what it calls safe against the exact evaluation, with and without float."""

import math
import shutil

import numpy as np
import pytest

import lutgen
from lutgen.channels import evaluate_each
from lutgen.recipe import parse_recipe
from tests.fixtures.many_library import (
    Library,
    boundary_points,
    compared,
    postures_of,
    random_directions,
    read_i,
)
from tests.fixtures.places import MAPS
from tests.fixtures.quadruped import quadruped
from tests.fixtures.recipes import steered

pytestmark = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
ROBOTS = ("absolem", "marv", "markhor", "excavator", "articulated", "quadruped")
TIPS = 2


def recipe_of(name):
    """Return a robot of the gallery, the quadruped or the four steered wheels."""
    if name == "quadruped":
        return quadruped()
    return (
        parse_recipe(steered()) if name == "steered" else lutgen.load_recipe(MAPS / f"{name}.toml")
    )


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request):
    return Library(recipe_of(request.param))


def test_no_boundary_point_that_tips_is_called_safe_with_a_third_of_the_guard(robot):
    # Two pairs of flippers alike: the exact definition's pieces lose more there than the guard.
    tight, rng = Library(robot.recipe, guard=3e-5), np.random.default_rng(9)
    params = postures_of(robot.recipe, rng, 80)
    if robot.recipe.name == "marv":
        params[:40] = np.float32(2.8382704) * np.array([1, 1, -1, -1], np.float32)
    found = compared(tight, params, boundary_points(robot.recipe, params, rng, 60))
    assert (~found.stands).mean() > 0.2
    assert (found.told <= found.true).all()


@pytest.mark.parametrize("name", ["absolem", "marv", "markhor", "articulated", "quadruped"])
def test_next_to_nothing_of_what_stands_is_lost_and_nothing_gained(name):
    # Evenly random postures and directions, and those of coarse grids a little off.
    recipe = recipe_of(name)
    robot, rng = Library(recipe), np.random.default_rng(12)
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    params = rng.uniform(low, high, (1600, len(low)))
    step, off = math.radians(7.5), rng.choice([0.0, 1e-6, 1e-4], (800, 1))
    params[:800] = step * np.rint(params[:800] / step) + off * rng.normal(size=(800, len(low)))
    params = np.clip(params, low, high).astype(np.float32)
    g = random_directions(rng, len(params) * 50).reshape(-1, 50, 3).astype(np.float32)
    found = compared(robot, params, g)
    assert found.stands.mean() > 0.1
    lost = (found.stands & ~found.safe).mean()
    assert lost <= (0.003 if name == "marv" else 0.001) * found.stands.mean()


@pytest.mark.parametrize("whole", [False, True])
def test_what_stands_is_told_with_its_angle_and_its_factor(robot, whole):
    rng = np.random.default_rng(6)
    params = postures_of(robot.recipe, rng, 200)
    g = random_directions(rng, 200 * 50).reshape(200, 50, 3)
    step = robot.many.size / 20000
    g = np.rint(g * 16000).astype(np.int16) if whole else g.astype(np.float32)
    channels = ("sdg", "tip_angle", "height", "status")
    truth = evaluate_each(robot.recipe, params.astype(float), g.astype(float), channels)
    got = read_i(robot, params, g, step) if whole else robot.read(params, g)
    safe, stands = got["status"] != TIPS, truth["status"] != TIPS
    assert not (safe & ~stands).any()
    assert not ((got["status"] == 0) & (truth["status"] == 1)).any()
    # Given up: what is within the guard of the boundary, and a gap in thousands.
    assert (stands & ~safe).sum() <= 0.003 * stands.sum()
    error = np.degrees(truth["tip_angle"] - got["tip_angle"])[safe]
    assert error.min() > 0.0
    # The guard is 0.006 deg, of the integer form 0.015, and more is lost next to a gap.
    assert np.percentile(error, 75) < (0.06 if whole else 0.02)
    # Rounding of the integer form: half a step each of D, s and the angle of its walls.
    loose = 10 * step if whole else 1e-5 * robot.many.size
    assert np.percentile(np.abs(truth["sdg"] - got["sdg"])[safe], 99) < loose
    assert np.percentile(np.abs(truth["height"] - got["height"])[safe], 99) < loose


def nearly_level(name):
    """Return a robot and 2,000 of its postures, four contacts 1e-7 to 1e-2 out of one plane."""
    recipe = recipe_of(name)
    rng = np.random.default_rng(4)
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    noise = rng.normal(size=(2000, len(low))) * 10.0 ** rng.uniform(-7, -2, (2000, 1))
    at = rng.uniform(low, high, (2000, len(low)))
    if name == "quadruped":  # four legs alike
        at = np.tile(at[:, :3], 4) + noise
    else:  # headings of any size, nothing twisted
        at[:, 1::2] = noise[:, 1::2]
    return recipe, np.clip(at, low, high).astype(np.float32)


@pytest.mark.parametrize("name", ["articulated", "quadruped", "steered"])
def test_wheels_and_feet_that_stand_nearly_in_one_plane_carry_as_in_the_definition(name):
    # What sensors of a level robot say.
    recipe, params = nearly_level(name)
    g = random_directions(np.random.default_rng(5), len(params) * 40).reshape(-1, 40, 3)
    found = compared(Library(recipe), params, g.astype(np.float32))
    assert found.stands.mean() > 0.15
    assert (found.stands & ~found.safe).sum() <= 0.002 * found.stands.sum()
    short = np.degrees(found.true - found.told)[found.safe]
    # The guard is 0.006 deg.  Where arcs are a thousandth of a degree rounding moves the ends of
    # gaps between feet by a thousandth of their length.
    assert np.percentile(short, 99) < 0.02
    assert short.max() < (0.5 if name == "quadruped" else 0.05)


def test_a_steep_first_facet_leads_to_those_on_the_far_side_of_the_robot():
    # The plane turns by more than a right angle from there before it faces up.
    steep = [
        [-28.5, 79.9, -123.3, 4.9, -13.8, -41.9, -29.0, 48.8, -55.6, -12.2, -19.2, -136.3],
        [-29.8, 38.7, -139.0, 30.0, 47.4, -53.8, -19.4, 21.5, -139.5, -10.1, 45.3, -68.8],
        [-11.6, 11.1, -129.0, 10.0, 40.1, -43.7, -26.2, -13.8, -128.5, -10.1, -6.5, -59.5],
    ]
    params = np.radians(steep).astype(np.float32)
    g = random_directions(np.random.default_rng(6), 3 * 2000).reshape(3, 2000, 3)
    found = compared(Library(recipe_of("quadruped")), params, g.astype(np.float32))
    assert (found.stands.sum(axis=1) > 200).all()
    assert (found.stands & ~found.safe).sum() <= 0.002 * found.stands.sum()


@pytest.mark.parametrize("whole", [False, True])
def test_how_far_a_robot_has_tipped_is_never_less_than_the_truth(robot, whole):
    rng = np.random.default_rng(8)
    params = postures_of(robot.recipe, rng, 200)
    g = random_directions(rng, 200 * 50).reshape(200, 50, 3)
    g = np.rint(g * 16000).astype(np.int16) if whole else g.astype(np.float32)
    truth = evaluate_each(robot.recipe, params.astype(float), g.astype(float), ("tip_angle",))
    got = read_i(robot, params, g, 1e-4) if whole else robot.read(params, g)
    # The integer form tells a sine: of what has tipped by more than a right angle, -1.
    both = (got["status"] == TIPS) & (truth["tip_angle"] < 0) & (truth["tip_angle"] > -np.pi / 2)
    late = np.degrees(truth["tip_angle"] - got["tip_angle"])[both]
    assert late.min() > 0.0
    # Measured to the island that is pierced, which is mostly the nearest; -pi where none is.
    assert np.median(late) < 0.2


@pytest.mark.parametrize("scarce", [{"arcs": 3}, {"corners": 4}, {"gaps": 1}], ids=str)
def test_what_finds_no_room_is_given_up_and_nothing_else(robot, scarce):
    rng = np.random.default_rng(7)
    params, g = postures_of(robot.recipe, rng, 120), random_directions(rng, 100)
    few = Library(robot.recipe, ("-O0",), **scarce)
    whole, got = robot.read(params, g), few.read(params, g)
    safe, could = got["status"] != TIPS, whole["status"] != TIPS
    assert not (safe & ~could).any()
    # The side of a gap may be so short that its direction is known to a thousandth: told nearer.
    assert (got["tip_angle"] <= whole["tip_angle"] + 2e-5)[safe].all()
    failed = (few.most["failed"] > 0, (got["status"] != whole["status"]).any())
    # A posture without its boundary tips in every direction, and any other reads as it does.
    if "arcs" in scarce:
        assert failed == (True, True)
        differ = (got["status"] != whole["status"]).any(axis=1)
        assert not safe[differ].any()
    else:
        assert not failed[0]
        assert safe.any()
        assert "corners" in scarce or failed[1] == (robot.most["gaps"] > 1)


def test_answers_do_not_depend_on_the_unit_of_length(robot):
    rng = np.random.default_rng(3)
    params, g = postures_of(robot.recipe, rng, 200), random_directions(rng, 10_000)
    g = g.reshape(200, 50, 3)
    metres, placed = robot.read(params, g), robot.placed(params)
    flat = placed.reshape(len(placed), -1)
    flat[:, : 4 * len(robot.order)] *= 1024.0  # The power of two next to millimetres: no rounding.
    lengths, many = ("size", "least_height", "rest_width", "tolerance"), robot.many
    robot.many = type(many).from_buffer_copy(many)
    for name in lengths:
        setattr(robot.many, name, 1024.0 * getattr(many, name))
    robot.placed = lambda params: placed
    try:
        other = robot.read(params, g)
    finally:
        robot.many = many
        del robot.placed
    assert other["status"].tobytes() == metres["status"].tobytes()
    assert other["tip_angle"].tobytes() == metres["tip_angle"].tobytes()
