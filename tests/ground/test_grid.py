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


def test_a_knot_starts_its_own_cell_and_the_top_knot_ends_the_last_one():
    index, frac, clamped = axis().locate(KNOTS)
    assert index.tolist() == [0, 1, 2, 2]
    assert frac.tolist() == [0.0, 0.0, 0.0, 1.0]
    assert not clamped.any()


def test_values_between_knots_get_the_fraction_of_their_own_cell():
    index, frac, _ = axis().locate([-0.25, 0.125, 1.625])
    assert index.tolist() == [0, 1, 2]
    assert frac.tolist() == [0.75, 0.5, 0.5]


def test_values_outside_the_knots_are_clamped_and_reported():
    index, frac, clamped = axis().locate([-1.0000001, 3.0000001, -np.inf, np.inf, 0.0])
    assert index.tolist() == [0, 2, 0, 2, 1]
    assert frac.tolist() == [0.0, 1.0, 0.0, 1.0, 0.0]
    assert clamped.tolist() == [True, True, True, True, False]


def test_an_axis_of_one_knot_clamps_everything_else_to_it():
    index, frac, clamped = axis([2.0]).locate([1.0, 2.0, 3.0])
    assert index.tolist() == [0, 0, 0]
    assert frac.tolist() == [0.0, 0.0, 0.0]
    assert clamped.tolist() == [True, False, True]


def test_locate_returns_the_index_type_of_numpy_and_keeps_an_empty_input_empty():
    index, frac, clamped = axis().locate([])
    assert (index.dtype, frac.dtype, clamped.dtype) == (np.intp, np.float64, np.bool_)
    assert index.shape == frac.shape == clamped.shape == (0,)


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


@pytest.mark.parametrize(
    "knots", [[0.0, 0.0], [1.0, 0.0], [0.0, np.nan], [0.0, np.inf], [], [[0.0, 1.0]]]
)
def test_knots_that_do_not_increase_are_refused_with_the_axis_and_what_was_given(knots):
    with pytest.raises(InputError, match=r"axis `alpha`: knots must .*\(got .*\); .+\."):
        axis(knots)


def test_a_value_that_is_nan_is_refused_with_its_place():
    with pytest.raises(InputError, match=r"axis `alpha`: value 1 is NaN \(got nan\); pass numbers"):
        axis().locate([0.0, np.nan])


def test_a_table_of_values_is_refused_with_its_shape():
    with pytest.raises(InputError, match=r"got shape \(1, 1\)\); pass a one-dimensional array"):
        axis().locate([[0.0]])


def test_knots_cannot_be_changed_from_outside():
    knots = np.array([0.0, 1.0])
    fixed = axis(knots)
    knots[0] = 9.0
    assert fixed.knots.tolist() == [0.0, 1.0]
    with pytest.raises(ValueError, match="read-only"):
        fixed.knots[0] = 9.0


def test_axes_are_equal_when_name_unit_and_knots_are():
    assert axis() == axis()
    assert hash(axis()) == hash(axis())
    assert axis() != Axis("beta", "rad", KNOTS)
    assert axis() != Axis("alpha", "m", KNOTS)
    assert axis() != axis([-1.0, 0.0, 0.25, 4.0])
    assert axis() != "alpha"


def test_nodes_are_numbered_in_c_order_with_the_last_axis_fastest():
    grid = Grid((Axis("a", "rad", [0, 1]), Axis("b", "m", [10, 20, 30]), Axis("c", "m", [5, 6])))
    assert (grid.shape, grid.size) == ((2, 3, 2), 12)
    by_hand = [[a, b, c] for a in (0, 1) for b in (10, 20, 30) for c in (5, 6)]
    assert grid.params(np.arange(12)).tolist() == by_hand
    assert grid.params([11, 0, 7]).tolist() == [by_hand[11], by_hand[0], by_hand[7]]


def test_a_grid_without_axes_has_one_node_without_parameters():
    assert (Grid(()).shape, Grid(()).size) == ((), 1)
    assert Grid(()).params([0, 0]).shape == (2, 0)


@pytest.mark.parametrize("flat", [[-1], [4], [0, 99]])
def test_node_numbers_outside_the_grid_are_refused(flat):
    with pytest.raises(InputError, match=r"must lie in 0\.\.3 \(got .*\); stay below grid\.size"):
        Grid((axis(),)).params(flat)


@pytest.mark.parametrize("flat", [[0.5], [[0]]])
def test_node_numbers_that_are_no_list_of_integers_are_refused(flat):
    with pytest.raises(InputError, match=r"must be integers of shape \(m,\) \(got .*\); pass"):
        Grid((axis(),)).params(flat)


def test_two_axes_of_one_name_are_refused():
    with pytest.raises(InputError, match=r"different names \(got \['alpha', 'alpha'\]\); rename"):
        Grid((axis(), axis()))
