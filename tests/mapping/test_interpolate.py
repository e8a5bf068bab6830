"""Multilinear interpolation against scipy, at nodes, and beside nodes that are NaN."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from lutgen.mapping.stability_map import interpolate, locate


def random_axes(rng, dimensions):
    return [np.cumsum(rng.uniform(0.2, 1.5, rng.integers(2, 6))) - 2.0 for _ in range(dimensions)]


def random_points(rng, axes, count=200):
    """Points (count, d) anywhere between the ends of the axes."""
    return np.stack([rng.uniform(knots[0], knots[-1], count) for knots in axes], axis=1)


def located(axes, points):
    return [locate(knots, points[:, d]) for d, knots in enumerate(axes)]


def test_a_value_has_the_cell_of_the_knot_below_it_and_what_is_beyond_an_end_is_at_it():
    knots = np.array([-1.0, 0.0, 0.25, 3.0])
    index, frac = locate(knots, np.array([*knots, -0.25, 0.125, 1.625, -1.1, np.inf]))
    assert index.tolist() == [0, 1, 2, 2, 0, 1, 2, 0, 2]
    assert frac.tolist() == [0.0, 0.0, 0.0, 1.0, 0.75, 0.5, 0.5, 0.0, 1.0]
    assert locate(knots[:1], knots)[1].tolist() == [0.0] * 4


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4, 5])
def test_values_are_interpolated_as_scipy_does_and_nodes_are_returned_bit_for_bit(dimensions):
    rng = np.random.default_rng(10 + dimensions)
    axes = random_axes(rng, dimensions)
    values = rng.normal(size=[a.size for a in axes]).astype(np.float32)
    points = random_points(rng, axes)
    got, _ = interpolate(values, located(axes, points))
    want = RegularGridInterpolator(axes, values.astype(np.float64))(points)
    np.testing.assert_allclose(got, want, atol=1e-13)  # sums of 32 numbers of about 1
    # A node, whatever is around it.
    values[rng.random(values.shape) < 0.3] = np.nan
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    got, present = interpolate(values, located(axes, nodes.reshape(-1, dimensions)))
    np.testing.assert_array_equal(got, values.ravel().astype(np.float64))
    np.testing.assert_array_equal(present, ~np.isnan(values.ravel()))


def test_corners_that_are_nan_are_left_out_of_the_mean():
    axes = [np.array([0.0, 1.0])] * 2
    values = np.array([[1.0, 2.0], [np.nan, 4.0]])
    got, present = interpolate(values, located(axes, np.array([[0.25, 0.5], [1.0, 0.25]])))
    # Weights 3/8, 3/8, (1/8), 1/8 at the first point; only the corner 4 counts at the second.
    assert got[0] == pytest.approx((3 * 1.0 + 3 * 2.0 + 1 * 4.0) / 7, rel=1e-15)
    assert got[1] == 4.0
    assert present.tolist() == pytest.approx([7 / 8, 0.25], rel=1e-15)
