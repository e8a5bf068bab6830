"""The four methods on plain functions, of which the minimum is known."""

import numpy as np
import pytest

from lutgen.search.methods import multistart, nelder_mead

BOX = np.array([[-3.0, 5.0], [0.0, 2.0]])


class Counted:
    """A cost function that keeps the rows that it was asked for."""

    def __init__(self, function):
        self.function = function
        self.rows = []

    def __call__(self, points):
        """Return the costs."""
        self.rows.extend(points.copy())
        return self.function(points)


def bowl(points):
    """Return a quadratic with its minimum at (1, 1, ...)."""
    return np.asarray(((points - 1.0) ** 2 * np.arange(1, points.shape[1] + 1)).sum(axis=1))


def waves(points):
    """Return Rastrigin's function about (0.7, 0.7, ...): one minimum in each unit square."""
    x = points - 0.7
    return np.asarray((x**2 - np.cos(2.0 * np.pi * x) + 1.0).sum(axis=1))


@pytest.mark.parametrize("start", [(-3.0, 0.0), (1.0, 1.0), (4.9, 0.01)])
def test_nelder_mead_ends_at_the_minimum_from_anywhere_and_counts(start):
    cost = Counted(bowl)
    steps = nelder_mead(cost, BOX, np.array(start))
    # The last simplex is 2e-6 of the bounds, which are 8 and 2 wide.
    assert steps[-1].params == pytest.approx([1.0, 1.0], abs=2e-5)
    assert steps[-1].evaluations == len(cost.rows)
    costs = [step.value for step in steps]
    assert costs == sorted(costs, reverse=True)
    assert bowl(steps[-1].params[None, :])[0] == pytest.approx(steps[-1].value, abs=1e-15)
    assert (np.array(cost.rows) >= BOX[:, 0]).all()
    assert (np.array(cost.rows) <= BOX[:, 1]).all()
    edge = nelder_mead(lambda x: x[:, 0] - x[:, 1], BOX, np.array([2.0, 1.0]))[-1]
    assert edge.params == pytest.approx([-3.0, 2.0], abs=2e-5)
    # It goes the same way in any unit and with any zero.
    plain, scale, shift = nelder_mead(waves, BOX, np.array(start))[-1], 1e3, -1024.0
    other = nelder_mead(
        lambda x: waves(x / scale - shift), (BOX + shift) * scale, (np.array(start) + shift) * scale
    )[-1]
    assert other.params / scale - shift == pytest.approx(plain.params, abs=2e-5)


@pytest.mark.parametrize("k", [1, 2])
def test_multistart_finds_the_lowest_of_many_minima_from_anywhere(k):
    box = np.array([[-4.0, 5.0]] * k)
    random = np.random.default_rng(k)
    lost = 0
    for seed in range(10):
        start = random.uniform(-4.0, 5.0, k)
        cost = Counted(waves)
        steps = multistart(cost, box, start, seed)
        assert steps[-1].params == pytest.approx([0.7] * k, abs=1e-4)
        assert steps[-1].evaluations == len(cost.rows)
        costs = [step.value for step in steps]
        assert costs == sorted(costs, reverse=True)
        # The caller's own start is one of those refined.
        assert any((row == start).all() for row in cost.rows)
        lost += bool(nelder_mead(waves, box, start)[-1].value > 0.1)
    # A guard that any method passes proves nothing.
    assert lost >= 3
