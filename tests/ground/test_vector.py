"""Rotations and their angles, axes and the order of nodes."""

import math

import numpy as np
import pytest

from lutgen.grid import Axis, Grid
from lutgen.vector import angles, rotation


def test_the_angles_of_a_rotation_give_it_back_also_where_two_axes_fall_together():
    rng = np.random.default_rng(5)
    cases = [*rng.uniform(-math.pi, math.pi, (200, 3)).tolist()]
    cases += [[a, p, b] for p in (math.pi / 2, -math.pi / 2) for a, b in rng.normal(size=(20, 2))]
    for roll, pitch, yaw in cases:
        matrix = rotation((roll, pitch, yaw))
        # 1e-8: within 1e-9 of the pole the rest of the pitch is dropped.
        assert np.allclose(rotation(angles(matrix)), matrix, rtol=0, atol=1e-8)


KNOTS = [-1.0, 0.0, 0.25, 3.0]


def test_nodes_are_numbered_in_c_order_with_the_last_axis_fastest():
    grid = Grid((Axis("a", "rad", [0, 1]), Axis("b", "m", [10, 20, 30]), Axis("c", "m", [5, 6])))
    assert (grid.shape, grid.size) == ((2, 3, 2), 12)
    by_hand = [[a, b, c] for a in (0, 1) for b in (10, 20, 30) for c in (5, 6)]
    assert grid.params(np.arange(12)).tolist() == by_hand
    assert grid.params([11, 0, 7]).tolist() == [by_hand[11], by_hand[0], by_hand[7]]
    assert (Grid(()).shape, Grid(()).size, Grid(()).params([0, 0]).shape) == ((), 1, (2, 0))


def test_axes_are_equal_when_name_unit_and_knots_are_and_nobody_can_change_them():
    axis = Axis("alpha", "rad", KNOTS)
    assert axis == Axis("alpha", "rad", list(KNOTS))
    for other in (("beta", "rad", KNOTS), ("alpha", "m", KNOTS), ("alpha", "rad", [-1.0, 0.0])):
        assert axis != Axis(*other)
    with pytest.raises(ValueError, match="read-only"):
        axis.knots[0] = 9.0
