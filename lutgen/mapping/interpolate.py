"""Interpolate multilinearly in float64: the reference for every decoder."""

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Lower knot (m,) and place inside the cell (m,), 0 to 1, on an axis; the lower knot may be the last
# where the place is 0.
Place = tuple[NDArray[np.intp], NDArray[np.float64]]


def locate(knots: NDArray[np.float64], values: NDArray[np.float64]) -> Place:
    """Return the cells of values (m,) and the places in them; what is beyond an end is at it."""
    if len(knots) == 1:
        return np.zeros(len(values), np.intp), np.zeros(len(values))
    index = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, len(knots) - 2)
    low, high = knots[index], knots[index + 1]
    return index, np.clip((values - low) / (high - low), 0.0, 1.0)


def _corners(
    values: NDArray[Any], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...]
) -> Iterator[tuple[NDArray[Any], NDArray[np.float64]]]:
    """Yield the values (m,) at each of the 2^d corners of the queries' cells, and their weights.

    Corners that weigh nothing for every query are left out.  The weights of a query add up to 1,
    and at a node the node's weight is exactly 1.
    """
    for corner in product((False, True), repeat=len(places)):
        index: list[NDArray[np.intp]] = []
        weight = np.ones(len(places[-1][0]))
        for (lower, frac), upper in zip(places, reversed(corner), strict=True):
            # Where frac is 0 the upper knot may not exist and does not count.
            index.append(np.where(frac > 0.0, lower + 1, lower) if upper else lower)
            weight *= frac if upper else 1.0 - frac
        if (weight > 0.0).any():
            yield values[(*index[:-2], *extra, *index[-2:])], weight


def interpolate(
    values: NDArray[np.floating], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...] = ()
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return means (m,) of the cells' corners that are not NaN, and the shares (m,) of these.

    The axes of `values` are in the order of `places`, whose last two are v and u, with those of
    `extra` in between, taken as they are: the face of each query (m,).  A result is NaN where no
    corner with a weight is a number; a share is 1 away from the tip-over boundary.
    """
    total, present = np.zeros((2, len(places[-1][0])))
    for node, weight in _corners(values, places, extra):
        usable = ~np.isnan(node) & (weight > 0.0)
        total += np.where(usable, node * weight, 0.0)
        present += np.where(usable, weight, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        # Where all corners count the weights add up to 1 but for rounding, which stays out.
        whole = present > 1.0 - 1e-12
        return np.where(whole, total, total / present), np.where(whole, 1.0, present)


def worst(
    values: NDArray[np.uint8], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...] = ()
) -> NDArray[np.uint8]:
    """Return the largest value (m,) among the corners of each query's cell that have a weight."""
    largest = np.zeros(len(places[-1][0]), np.uint8)
    for node, weight in _corners(values, places, extra):
        largest = np.where(weight > 0.0, np.maximum(largest, node), largest)
    return largest
