"""The four methods on plain functions, and how far each parameter may be off."""

import math

import numpy as np
import pytest

import lutgen
from lutgen.search.methods import STEPS, acceptable_range, half_widths, multistart, nelder_mead
from tests.fixtures.recipes import contact, feet, link, parameter, rigid

WIDE = np.array([[-3.0, 5.0], [0.0, 2.0]])


def counted(function):
    """Return a cost function, and the list of the rows that it is asked for."""
    rows = []

    def cost(points):
        rows.extend(points.copy())
        return function(points)

    return cost, rows


def bowl(points):
    """Return a quadratic with its minimum at (1, 1, ...)."""
    return np.asarray(((points - 1.0) ** 2 * np.arange(1, points.shape[1] + 1)).sum(axis=1))


def waves(points):
    """Return Rastrigin's function about (0.7, 0.7, ...): one minimum in each unit square."""
    x = points - 0.7
    return np.asarray((x**2 - np.cos(2.0 * np.pi * x) + 1.0).sum(axis=1))


@pytest.mark.parametrize("start", [(-3.0, 0.0), (1.0, 1.0), (4.9, 0.01)])
def test_nelder_mead_ends_at_the_minimum_from_anywhere_and_counts(start):
    cost, rows = counted(bowl)
    steps = nelder_mead(cost, WIDE, np.array(start))
    # The last simplex is 2e-6 of the bounds, which are 8 and 2 wide.
    assert steps[-1].params == pytest.approx([1.0, 1.0], abs=2e-5)
    assert steps[-1].evaluations == len(rows)
    costs = [step.value for step in steps]
    assert costs == sorted(costs, reverse=True)
    assert bowl(steps[-1].params[None, :])[0] == pytest.approx(steps[-1].value, abs=1e-15)
    assert (np.array(rows) >= WIDE[:, 0]).all()
    assert (np.array(rows) <= WIDE[:, 1]).all()
    edge = nelder_mead(lambda x: x[:, 0] - x[:, 1], WIDE, np.array([2.0, 1.0]))[-1]
    assert edge.params == pytest.approx([-3.0, 2.0], abs=2e-5)
    # It goes the same way in any unit and with any zero.
    plain, scale, shift = nelder_mead(waves, WIDE, np.array(start))[-1], 1e3, -1024.0
    other = nelder_mead(
        lambda x: waves(x / scale - shift),
        (WIDE + shift) * scale,
        (np.array(start) + shift) * scale,
    )[-1]
    assert other.params / scale - shift == pytest.approx(plain.params, abs=2e-5)


@pytest.mark.parametrize("k", [1, 2])
def test_multistart_finds_the_lowest_of_many_minima_from_anywhere(k):
    box = np.array([[-4.0, 5.0]] * k)
    random = np.random.default_rng(k)
    lost = 0
    for seed in range(10):
        start = random.uniform(-4.0, 5.0, k)
        cost, rows = counted(waves)
        steps = multistart(cost, box, start, seed)
        assert steps[-1].params == pytest.approx([0.7] * k, abs=1e-4)
        assert steps[-1].evaluations == len(rows)
        costs = [step.value for step in steps]
        assert costs == sorted(costs, reverse=True)
        # The caller's own start is one of the points, but for rounding.
        assert np.abs(np.array(rows) - start).max(axis=1).min() < 1e-12
        lost += bool(nelder_mead(waves, box, start)[-1].value > 0.1)
    # A guard that any method passes proves nothing.
    assert lost >= 3


def tent(points):
    return np.asarray(np.abs(points) @ [1.0, 2.0][: points.shape[1]])


def test_the_range_ends_where_the_cost_reaches_the_limit_and_the_others_are_kept():
    box = np.array([[-10.0, 10.0], [-10.0, 10.0]])
    # At (1, 0.5) the cost is 2; 4 is reached at x = +-3 and y = +-1.5.
    found = acceptable_range(tent, np.array([1.0, 0.5]), box, 4.0)
    # 36 halvings of a step of 11/256.
    assert found == pytest.approx(np.array([[-3.0, 3.0], [-1.5, 1.5]]), abs=1e-12)
    # The end that is returned is itself acceptable.
    assert tent(np.array([[found[0, 0], 0.5], [found[0, 1], 0.5]])).max() <= 4.0
    # At the bounds at the latest, and a geometry on its bound has no room on that side.
    found = acceptable_range(tent, np.array([2.0]), np.array([[-1.0, 2.0]]), 9.0)
    assert found.tolist() == [[-1.0, 2.0]]
    # None where the geometry itself exceeds the limit; NaN is no acceptable cost either.
    assert np.isnan(acceptable_range(tent, np.array([0.5]), box[:1], 0.4)).all()
    assert np.isnan(acceptable_range(lambda x: x[:, 0] * np.nan, np.array([0.5]), box, 0.4)).all()


def test_delta_is_the_distance_to_the_nearer_end_that_is_no_bound():
    for interval, delta in (
        ((2.0, 6.0), 1.0),  # 3 - 2 and 6 - 3: the smaller
        ((0.0, 6.0), 3.0),  # reaches the lower bound, which limits nothing
        ((2.0, 10.0), 1.0),
        ((0.0, 10.0), 7.0),  # all is acceptable
    ):
        found = half_widths(np.array([interval]), np.array([3.0]), np.array([[0.0, 10.0]]))
        assert found.tolist() == [delta]


def test_the_first_violation_ends_the_range_though_the_cost_falls_again():
    box = np.array([[0.0, 10.0]])
    found = acceptable_range(lambda x: np.sin(x[:, 0]), np.array([0.0]), box, 0.5)
    assert found[0] == pytest.approx([0.0, math.pi / 6.0], abs=1e-11)
    # One wider than a step is never stepped over.
    width = 10.0 / STEPS * 1.01
    for place in np.linspace(1.0, 9.0 - width, 37):
        wall = acceptable_range(
            lambda x, at=place: ((x[:, 0] > at) & (x[:, 0] < at + width)).astype(float),
            np.array([0.0]),
            box,
            0.5,
        )
        assert wall[0, 1] == pytest.approx(place, abs=1e-11)


def test_all_that_stands_is_acceptable_without_a_limit():
    # A table whose front feet slide out: it stands while the com is behind them.
    text = parameter("reach", -0.5, 3.0, "m") + link(
        "slide", "body", ("prismatic", (1, 0, 0), "reach")
    )
    text += feet([(-1.0, 1.0, -1.0), (-1.0, -1.0, -1.0)]) + contact(
        "front", (0, 0, -1), link="slide"
    )
    text = rigid(text, samples="reach = 8")
    found = lutgen.optimum(lutgen.parse_recipe(text), [0, 0, -1], "map")
    # |SD_g| = |reach - 2| / 3 is least at the node 2; it stands for reach >= 0.
    assert found.params == pytest.approx([2.0], abs=1e-12)
    assert found.acceptable[0] == pytest.approx([0.0, 3.0], abs=1e-8)  # facets end at 1e-9
    assert found.delta == pytest.approx([2.0], abs=1e-8)
