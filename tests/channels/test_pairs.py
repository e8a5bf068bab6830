"""Each posture under its own gravity: `evaluate_each` is the diagonal of `evaluate`."""

import numpy as np
import pytest

import lutgen
from lutgen.channels.evaluation import evaluate_each, measure_recipe
from lutgen.channels.plain import ALONG, ASIDE, HEIGHT_BEYOND
from lutgen.errors import InputError
from lutgen.recipe.kinematics import forward
from tests.fixtures.recipes import ALL_CHANNELS, rover, tripod


@pytest.mark.parametrize("text", [tripod(), rover()], ids=["points", "discs with gaps"])
def test_pairs_are_the_diagonal_of_all_postures_under_all_directions(text: str) -> None:
    recipe = lutgen.parse_recipe(text)
    random = np.random.default_rng(1)
    low = np.array([p.minimum for p in recipe.parameters])
    high = np.array([p.maximum for p in recipe.parameters])
    params = random.uniform(low, high, (60, len(low)))
    down = random.normal(0.0, 0.7, (60, 3)) - [0.0, 0.0, 1.0]
    pairs = evaluate_each(recipe, params, down, ALL_CHANNELS)
    crossed = lutgen.evaluate(recipe, params, down, ALL_CHANNELS)
    # A guard that never sees the robot tip, or stand, sees half.
    assert 10 < (pairs["tip_angle"] < 0.0).sum() < 50
    for name in ALL_CHANNELS:
        # Bit for bit: both run the same kernel on the same numbers.
        np.testing.assert_array_equal(pairs[name], np.diagonal(crossed[name]), err_msg=name)


def test_each_posture_may_have_several_directions_of_its_own() -> None:
    recipe = lutgen.parse_recipe(tripod())
    random = np.random.default_rng(2)
    params = random.uniform([0.0, -0.5], [0.6, 0.8], (5, 2))
    down = random.normal(0.0, 0.7, (5, 7, 3)) - [0.0, 0.0, 1.0]
    together = evaluate_each(recipe, params, down, ALL_CHANNELS)
    for d in range(7):
        one = evaluate_each(recipe, params, down[:, d], ALL_CHANNELS)
        for name in ALL_CHANNELS:
            np.testing.assert_array_equal(together[name][:, d], one[name], err_msg=name)
    for shape in ((5, 7, 2), (4, 7, 3), (5, 1, 7, 3), (3,)):
        with pytest.raises(InputError, match="one row x, y, z for each of 5 postures"):
            evaluate_each(recipe, params, np.ones(shape))


def test_the_length_of_gravity_does_not_matter() -> None:
    recipe = lutgen.parse_recipe(tripod())
    params, down = [[0.2, 0.1], [0.3, -0.2]], np.array([[0.0, 0.5, -1.0], [0.1, 0.0, -1.0]])
    one = evaluate_each(recipe, params, down, ("sdg",))["sdg"]
    # 4 is a power of two: the unit vectors are the same to the last bit.
    np.testing.assert_array_equal(evaluate_each(recipe, params, 4.0 * down, ("sdg",))["sdg"], one)


def test_the_stability_factor_goes_on_beyond_the_standing_region_on_the_same_plane() -> None:
    recipe = lutgen.parse_recipe(tripod())
    posture = forward(recipe, [[0.3, 0.1]])
    tilts = np.radians(np.linspace(0.0, 70.0, 141))
    down = np.stack([-np.sin(tilts), 0.0 * tilts, -np.cos(tilts)], axis=1)
    found = measure_recipe(recipe, posture, down[None], np.ones(6, dtype=bool), beyond=True)
    values = {row: value[0] for row, value in found.items()}
    sdg, height = values[0], values[1]
    stands = ~np.isnan(sdg)
    assert 20 < stands.sum() < 120
    beyond = np.hypot(values[ALONG], values[ASIDE])
    # The in-plane components of D_g - s; a square root and two products.
    np.testing.assert_allclose(beyond[stands], sdg[stands], rtol=1e-12)
    np.testing.assert_array_equal(values[HEIGHT_BEYOND][stands], height[stands])
    # D_g - s on the plane of the three feet, from the definitions.
    feet = posture.centres[0]
    normal = np.cross(feet[1] - feet[0], feet[2] - feet[0])
    pierced = down * (normal @ feet[0] / (down @ normal))[:, None]
    expected = np.linalg.norm(pierced - feet.mean(axis=0), axis=1)
    np.testing.assert_allclose(beyond, expected, rtol=1e-11)  # cancels near the centroid


def test_directions_that_are_not_one_per_posture_are_refused() -> None:
    recipe = lutgen.parse_recipe(tripod())
    with pytest.raises(InputError, match=r"for each of 2 postures \(got the shape \(1, 3\)\)"):
        evaluate_each(recipe, [[0.2, 0.1], [0.3, 0.1]], [[0, 0, -1]])
    with pytest.raises(InputError, match="unknown channel 'sgd'"):
        evaluate_each(recipe, [[0.2, 0.1]], [[0, 0, -1]], ("sgd",))
