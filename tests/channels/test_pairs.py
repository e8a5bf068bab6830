"""Every way to a reading: `evaluate_each` is the diagonal of `evaluate`, sweeps agree with both."""

import numpy as np
import pytest

import lutgen
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.posture import Posture
from lutgen.channels import evaluate_each
from lutgen.channels.scan import Scanner
from lutgen.errors import InputError
from lutgen.quantities import CHANNELS
from tests.fixtures.pulled import moving
from tests.fixtures.recipes import ALL_CHANNELS, rover, tripod


@pytest.mark.parametrize(
    "recipe",
    [lutgen.parse_recipe(tripod()), lutgen.parse_recipe(rover()), moving()],
    ids=["points", "discs with gaps", "loaded points"],
)
def test_pairs_are_the_diagonal_of_all_and_what_a_diagnosis_says(recipe):
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
    for k in range(40):
        found = diagnose(Posture(recipe, params[k]), down[k])
        assert found.standing is bool(pairs["tip_angle"][k] >= 0.0)
        for name in CHANNELS:
            # Compiled for one direction and for many: the last bits may differ, and near a tip-over
            # axis they are all there is.
            np.testing.assert_allclose(
                found.channels[name], pairs[name][k], rtol=1e-9, atol=1e-12, err_msg=name
            )


def test_each_posture_may_have_several_directions_of_its_own():
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


def test_directions_that_are_not_one_per_posture_are_refused():
    recipe = lutgen.parse_recipe(tripod())
    with pytest.raises(InputError, match=r"for each of 2 postures \(got the shape \(1, 3\)\)"):
        evaluate_each(recipe, [[0.2, 0.1], [0.3, 0.1]], [[0, 0, -1]])
    with pytest.raises(InputError, match="unknown channel 'sgd'"):
        evaluate_each(recipe, [[0.2, 0.1]], [[0, 0, -1]], ("sgd",))


def test_sweeps_of_loaded_robots_read_what_evaluate_reads():
    recipe = moving()
    params = recipe.grid.params(np.arange(recipe.grid.size))
    g = recipe.chart.directions().reshape(-1, 3)
    names = ("sdg", "height", "tip_angle", "margin", "facet")
    got = lutgen.evaluate(recipe, params, g, names)
    assert (got["tip_angle"] >= 0).any()
    assert (got["tip_angle"] < 0).any()
    scanner = Scanner(recipe, recipe.chart, names)
    for first, last in ((0, scanner.rows), (2, 5)):
        out = np.full(
            (len(CHANNELS), len(params) * (last - first) * recipe.chart.nodes), 7.0, np.float32
        )
        scanner.fill(params, first, last, out)
        for name in names:
            want = got[name].reshape(len(params), scanner.rows, -1)[:, first:last]
            mapped = out[CHANNELS.index(name)]
            assert (mapped == want.ravel().astype(np.float32)).sum() == np.isfinite(want).sum()
