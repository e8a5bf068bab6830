"""Axis and Grid: cells, fractions, clamping and the order of nodes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lutgen.errors import InputError
from lutgen.grid import Axis, Grid

KNOTS = [-1.0, 0.0, 0.25, 3.0]


def axis(knots=KNOTS):
    return Axis("alpha", "rad", knots)


def test_a_value_has_the_cell_of_the_knot_below_it_and_its_fraction():
    index, frac, clamped = axis().locate([*KNOTS, -0.25, 0.125, 1.625])
    assert index.tolist() == [0, 1, 2, 2, 0, 1, 2]
    assert frac.tolist() == [0.0, 0.0, 0.0, 1.0, 0.75, 0.5, 0.5]
    assert not clamped.any()
    index, frac, clamped = axis().locate([-1.0000001, 3.0000001, -np.inf, np.inf])
    assert (index.tolist(), frac.tolist()) == ([0, 2, 0, 2], [0.0, 1.0, 0.0, 1.0])
    assert clamped.all()
    assert axis([2.0]).locate([1.0, 2.0, 3.0])[2].tolist() == [True, False, True]


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=9, unique=True).map(sorted),
    st.lists(st.floats(-2e3, 2e3), min_size=1, max_size=20),
)
def test_cell_and_fraction_give_the_clamped_value_back(knots, values):
    index, frac, clamped = axis(knots).locate(values)
    low, high = np.array(knots)[index], np.array(knots)[index + 1]
    wanted = np.clip(values, knots[0], knots[-1])
    # One subtraction, one division, one product and one sum, each of magnitude <= 2e3.
    np.testing.assert_allclose(low + frac * (high - low), wanted, rtol=0, atol=2e-12)
    assert ((frac >= 0.0) & (frac <= 1.0)).all()
    np.testing.assert_array_equal(clamped, wanted != values)


def test_nodes_are_numbered_in_c_order_with_the_last_axis_fastest():
    grid = Grid((Axis("a", "rad", [0, 1]), Axis("b", "m", [10, 20, 30]), Axis("c", "m", [5, 6])))
    assert (grid.shape, grid.size) == ((2, 3, 2), 12)
    by_hand = [[a, b, c] for a in (0, 1) for b in (10, 20, 30) for c in (5, 6)]
    assert grid.params(np.arange(12)).tolist() == by_hand
    assert grid.params([11, 0, 7]).tolist() == [by_hand[11], by_hand[0], by_hand[7]]
    assert (Grid(()).shape, Grid(()).size, Grid(()).params([0, 0]).shape) == ((), 1, (2, 0))


def test_axes_are_equal_when_name_unit_and_knots_are_and_nobody_can_change_them():
    assert axis() == axis()
    assert hash(axis()) == hash(axis())
    for other in (Axis("beta", "rad", KNOTS), Axis("alpha", "m", KNOTS), axis([-1.0, 0.0])):
        assert axis() != other
    with pytest.raises(ValueError, match="read-only"):
        axis().knots[0] = 9.0


def test_what_is_no_axis_no_value_and_no_node_is_refused():
    for knots in ([0.0, 0.0], [1.0, 0.0], [0.0, np.nan], [0.0, np.inf], [], [[0.0, 1.0]]):
        with pytest.raises(InputError, match=r"axis `alpha`: knots must .*\(got .*\); .+\."):
            axis(knots)
    with pytest.raises(InputError, match=r"axis `alpha`: value 1 is NaN \(got nan\); pass numbers"):
        axis().locate([0.0, np.nan])
    with pytest.raises(InputError, match=r"shape \(1, 1\)\); pass a one-dimensional array"):
        axis().locate([[0.0]])
    for flat in ([-1], [0, 99]):
        with pytest.raises(InputError, match=r"must lie in 0\.\.3 \(got .*\); stay below"):
            Grid((axis(),)).params(flat)
    for flat in ([0.5], [[0]]):
        with pytest.raises(InputError, match=r"must be integers of shape \(m,\) \(got .*\); pass"):
            Grid((axis(),)).params(flat)
    with pytest.raises(InputError, match=r"different names \(got \['alpha', 'alpha'\]\); rename"):
        Grid((axis(), axis()))
