"""What noise, faces of wheels, soles of many wheels and single balls make of the definition."""

import math
from collections.abc import Iterator

import numpy as np
import pytest

import lutgen
from lutgen.analysis import Facet, Posture
from lutgen.channels import evaluate_each
from lutgen.errors import InputError, RecipeError
from lutgen.recipe import Recipe
from tests.fixtures.drawn_robots import car_with_flippers, rocker_bogie
from tests.fixtures.recipes import contact, feet, rigid

TIPS = 2


def status(recipe: Recipe, gravity_dir: np.ndarray) -> np.ndarray:
    """Return the status (d,) of a rigid robot under directions (d, 3)."""
    nothing: list[list[float]] = [[]]
    return np.asarray(lutgen.evaluate(recipe, nothing, gravity_dir, ("status",))["status"][0])


def leaning(tilt: np.ndarray, heading: float = 0.0) -> np.ndarray:
    """Return directions (d, 3) of tilts (deg) in a heading (deg)."""
    t, h = np.radians(tilt), math.radians(heading)
    return np.stack([np.sin(t) * math.cos(h), np.sin(t) * math.sin(h), -np.cos(t)], axis=-1)


def off(rng: np.random.Generator, place: list[float], radius: float, sigma: float) -> str:
    """Return the rest of a wheel's recipe: where it is, its radius and axle, off by noise."""
    axle = np.array([0.0, 1.0, 0.0]) + sigma * rng.standard_normal(3)
    centre = np.array(place) + sigma * rng.standard_normal(3)
    grown = radius + sigma * rng.standard_normal()
    name = f"w{place}".replace(" ", "")
    return contact(name, tuple(centre), float(grown), tuple(axle / np.linalg.norm(axle)))


def car(seed: int, sigma: float, head: str = "") -> Recipe:
    """Return a car on four wheels of two rims each, off by noise (m); 45 deg to all four sides."""
    rng = np.random.default_rng(seed)
    rims = [
        off(rng, [x, y, -0.15], 0.1, sigma)
        for x in (0.25, -0.25)
        for y in (0.25, 0.19, -0.19, -0.25)
    ]
    return lutgen.parse_recipe(rigid("".join(rims), head=head))


def loops(recipe: Recipe) -> Iterator[tuple[float, Facet]]:
    """Yield slivers between two rests that are all but parallel, and the angle (deg) to them."""
    facets = Posture(recipe, []).stance.facets
    for sliver in facets:
        rests = [facets[k] for k in sliver.beyond if k >= 0 and facets[k].is_rest]
        for i, one in enumerate(rests):
            for other in rests[:i]:
                if not sliver.is_rest and one.normal @ other.normal > math.cos(0.01):
                    yield math.degrees(math.acos(one.normal @ sliver.normal)), sliver


@pytest.mark.parametrize("sigma", [1e-6, 1e-5, 1e-4])
def test_a_sliver_between_two_rests_all_but_parallel_is_no_way_to_lean(sigma: float) -> None:
    angles = []
    # The cars of the first hundred that have such a sliver between 5 and 25 deg, at every noise.
    for seed in (31, 34, 36, 38, 40, 41, 42, 75):
        recipe = car(seed, sigma)
        free = car(seed, sigma, "rock_angle = 180.0")
        for angle, sliver in loops(recipe):
            angles.append(angle)
            middle = sliver.points.mean(axis=0)
            under = (middle / np.linalg.norm(middle))[None]
            assert status(recipe, under)[0] == TIPS
            # Where nobody asks how far the robot rolls, the same direction is safe.
            assert status(free, under)[0] != TIPS
        for heading in (0.0, 90.0, 180.0, 270.0):
            # Noise of 0.1 mm moves the limit by 0.02 deg a sigma; a car has four chances to.
            assert (status(recipe, leaning(np.arange(45.2, 80.0, 0.1), heading)) == TIPS).all()
            level = status(recipe, leaning(np.arange(0.0, 44.8, 0.1), heading))
            # The gaps between rests are as narrow as the noise, and where one ends may tip.
            assert (level == TIPS).mean() < 0.01
    assert len([angle for angle in angles if 5.0 < angle < 25.0]) == 8


def on_its_side(seed: int, sigma: float, upright: float) -> Recipe:
    """Return a six-wheeler whose wheels are a triangle on each side: it can lie on their faces."""
    rng = np.random.default_rng(seed)
    text = "".join(
        off(rng, [x, y, 0.05 if x else -0.1], 0.1, sigma)
        for x in (0.25, 0.0, -0.25)
        for y in (0.2, -0.2)
    )
    return lutgen.parse_recipe(rigid(text, head=f"upright = {upright}"))


@pytest.mark.parametrize("sigma", [0.0, 1e-6, 1e-4, 1e-3])
def test_nobody_stands_on_the_faces_of_wheels_unless_upright_lets_noise_decide(
    sigma: float,
) -> None:
    sideways = np.concatenate(
        [leaning(np.arange(60.0, 100.0, 1.0), side) for side in (90.0, -90.0)]
    )
    safe = {
        upright: [
            bool((status(on_its_side(s, sigma, upright), sideways) != TIPS).any())
            for s in range(12)
        ]
        for upright in (80.0, 90.0)
    }
    assert not any(safe[80.0])
    # The normals are at 90 deg but for the noise, which falls on either side of the limit.
    assert any(safe[90.0]) == (sigma > 0.0)


def sole(count: int, step: float) -> tuple[Recipe, float]:
    """Return a sole of two rails of wheels on an arc of 0.5 m, and its limit (deg) by geometry."""
    angles = math.radians(step) * (np.arange(count) - (count - 1) / 2.0)
    centres = [(0.48 * math.sin(a), 0.1 - 0.48 * math.cos(a)) for a in angles]
    text = "".join(
        contact(f"w{k}{side}", (x, y, z), 0.02, (0, 1, 0))
        for k, (x, z) in enumerate(centres)
        for side, y in (("l", 0.25), ("r", -0.25))
    )
    last = float(angles[-2:].mean())
    x, z = centres[-1][0] + 0.02 * math.sin(last), centres[-1][1] - 0.02 * math.cos(last)
    return lutgen.parse_recipe(rigid(text)), math.degrees(math.atan2(x, -z))


@pytest.mark.parametrize(("count", "step"), [(20, 1.0), (20, 3.3), (31, 0.3), (31, 2.2)])
def test_a_sole_of_many_wheels_stands_until_gravity_passes_the_last_one(
    count: int, step: float
) -> None:
    recipe, limit = sole(count, step)
    tilts = np.arange(0.0, 80.0, 0.05)
    safe = status(recipe, leaning(tilts)) != TIPS
    # Beyond the last facet it rolls on the last wheels, onto nothing; a step of the walk.
    assert tilts[safe].max() == pytest.approx(limit, abs=0.06)
    # Where it is in balance between two facets on the wheels themselves it may count as tipping:
    # their arcs are 4 % of the sole.
    assert safe[tilts <= limit].mean() > 0.95


def test_more_contacts_than_can_be_asked_are_refused_with_a_way_out() -> None:
    with pytest.raises(RecipeError, match=r"3 to 62 contacts \(got 120\).*every few degrees"):
        sole(60, 1.12)
    with pytest.raises(InputError, match=r"3 to 62 contacts \(got 63\); give those that"):
        lutgen.stability(np.zeros((1, 63, 3)), [[0.0, 0.0, -1.0]])


FEET = np.array([(x, y, -0.3) for x in (0.3, -0.3) for y in (0.25, -0.25)])


@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-5])
@pytest.mark.parametrize("rock_angle", [0.0, 30.0, 180.0])
def test_over_a_single_ball_a_robot_tips_and_beside_its_patch_it_stands(
    noise: float, rock_angle: float
) -> None:
    rng = np.random.default_rng(3)
    centre, radius = np.array([0.0, 0.0, -0.16]) + noise * rng.standard_normal(3), 0.2
    places = FEET + noise * rng.standard_normal(FEET.shape)
    text = feet(places.tolist()) + contact("ball", tuple(centre), radius)
    recipe = lutgen.parse_recipe(rigid(text, head=f"rock_angle = {rock_angle}"))
    tried = np.concatenate(
        [leaning(np.linspace(0.0, 30.0, 61), h) for h in np.arange(0.0, 360.0, 9.0)]
    )
    # Where the ray leaves the ball, and how far the lowest foot is above the plane there (m).
    along = tried @ centre
    beyond = along + np.sqrt(along**2 + radius**2 - centre @ centre)
    normal = (beyond[:, None] * tried - centre) / radius
    above = (beyond[:, None] * tried * normal).sum(axis=1) - (normal @ places.T).max(axis=1)
    found = lutgen.evaluate(recipe, [[]], tried, ("status", "tip_angle"))
    # Nearer to the patch's rim than this (m) either may be said.
    alone = above > 1e-6
    assert (found["status"][0][alone] == TIPS).all()
    # The patch is a hole in the region: what is left to its rim, and no more, is in `tip_angle`.
    assert (found["tip_angle"][0][alone] < 0.0).all()
    assert np.degrees(found["tip_angle"][0][alone]).min() > -15.0
    assert 100 < alone.sum() < 1500
    # Beyond the four facets' corners on the ball it stands: on three contacts, also at no rock.
    assert (status(recipe, leaning(np.arange(16.0, 38.0), 0.0)) != TIPS).all()


def tip_angles(recipe: Recipe, params: np.ndarray, gravity_dir: np.ndarray) -> np.ndarray:
    """Return the tip angle (m,) of postures (m, k) under one direction each (m, 3)."""
    g = np.asarray(gravity_dir)[:, None]
    return np.asarray(evaluate_each(recipe, params, g, ("tip_angle",))["tip_angle"][:, 0])


def test_no_ray_slips_between_two_rests_that_rounding_tilts() -> None:
    # Flippers of two rims, straight down on three sides: the diagonal that two rests share goes
    # through the com's foot, and is 7e-13 m elsewhere on the one than on the other.  A robot that
    # stands level, and by 35 deg to all sides, was said to tip by 35 deg.
    posture = [-1.5707154, -1.5707999, 1.5707999, 1.1126823]
    rng = np.random.default_rng(1)
    aside = np.array([0.0, *(10.0 ** rng.uniform(-12, -6, 40))])[:, None] * rng.normal(size=(41, 3))
    g = np.array([0.0, 0.0, -1.0]) + aside * [1, 1, 0]
    found = tip_angles(car_with_flippers(), np.tile(posture, (41, 1)), g)
    np.testing.assert_allclose(found, 0.61075017, rtol=0.0, atol=1e-5)


def test_a_robot_does_not_go_round_and_round_over_rests_that_are_one_but_for_noise() -> None:
    # Five wheels of a rover are next to one plane, in three rests that turns of 4e-6 rad join round
    # the foot of one wheel.  None of the edges between them is higher than the com has been, so the
    # roll went over them in turn until it counted as lost.
    posture = np.array([-0.0925897, 0.1297626, 0.0809596, 0.2555615])
    gravity_dir = np.array([-0.2772653, -0.5194992, -0.8082355])
    near = np.concatenate([[posture], posture + 1e-5 * np.concatenate([np.eye(4), -np.eye(4)])])
    found = tip_angles(rocker_bogie(), near, np.tile(gravity_dir, (9, 1)))
    np.testing.assert_allclose(found, 0.15117, rtol=0.0, atol=2e-5)


@pytest.mark.parametrize("width", [3e-3, 3e-4, 3e-5, 3e-6])
@pytest.mark.parametrize("apart", [1.0, 3e-4, 3e-5])
def test_a_foot_as_small_as_noise_still_tips_to_all_sides(width: float, apart: float) -> None:
    # Short segments say nothing where others close the region, and everything where none do.
    half = 0.5 * width
    feet_at = np.array(
        [[apart, half, -1], [apart, -half, -1], [-apart, -half, -1], [-apart, half, -1]]
    )
    ways = np.radians(np.arange(0, 360, 10.0))
    g = np.stack([np.cos(ways), np.sin(ways), -1.0 + 0.0 * ways], axis=1)
    found = lutgen.stability(feet_at[None], g, ("tip_angle",))["tip_angle"][0]
    down = lutgen.stability(feet_at[None], [[0.0, 0.0, -1.0]], ("tip_angle",))["tip_angle"][0, 0]
    assert (found[np.abs(np.sin(ways)) > 0.1] < 0.0).all()
    assert apart == 1.0 or (found < 0.0).all()
    assert down == pytest.approx(math.atan(min(half, apart)), rel=1e-6)
