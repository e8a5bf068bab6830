"""Interpolate multilinearly in float64: the reference for every decoder."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Place = tuple[NDArray[np.intp], NDArray[np.float64]]


def cell_corners(
    places: Sequence[Place],
) -> list[tuple[tuple[NDArray[np.intp], ...], NDArray[np.float64]]]:
    """Return the 2^d corners of each query's cell with their weights, (indices, weight (m,)).

    `places` are per axis the lower knot (m,) and the place inside the cell (m,), as `Axis.locate`
    gives them; an index may stand on the last knot where frac is 0.  Corners that weigh nothing
    for every query are left out.  The weights of a query add up to 1, and at a node the node's
    weight is exactly 1.
    """
    corners: list[tuple[tuple[NDArray[np.intp], ...], NDArray[np.float64]]] = []
    for corner in range(1 << len(places)):
        index: list[NDArray[np.intp]] = []
        weight = np.ones(places[0][0].shape) if places else np.ones(1)
        for axis, (lower, frac) in enumerate(places):
            if corner >> axis & 1:
                # Where frac is 0 the upper knot may not exist and does not count.
                index.append(np.where(frac > 0.0, lower + 1, lower))
                weight = weight * frac
            else:
                index.append(lower)
                weight = weight * (1.0 - frac)
        if (weight > 0.0).any():
            corners.append((tuple(index), weight))
    return corners


def interpolate(
    values: NDArray[np.floating], places: Sequence[Place], extra: tuple[NDArray[np.intp], ...] = ()
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interpolate, leaving NaN nodes out; return results (m,) and shares (m,).

    The axes of `values` are in the order of `places` (see `cell_corners`), whose last two are v and
    u, with those of `extra` in between, taken as they are: the face of each query (m,).  A result
    is the mean of the cell's corners that are not NaN, with their weights made to add up to 1, and
    NaN where no corner with a weight is a number.  A share is that of the weight that was on
    numbers: 1 away from the tip-over boundary.
    """
    queries = len(places[-1][0])
    total = np.zeros(queries)
    present = np.zeros(queries)
    for index, weight in cell_corners(places):
        node = values[(*index[:-2], *extra, *index[-2:])].astype(np.float64)
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
    """Return the largest value (m,) among the corners of each query's cell that have a weight.

    Parameters as for `interpolate`.
    """
    largest = np.zeros(len(places[-1][0]), np.uint8)
    for index, weight in cell_corners(places):
        node = values[(*index[:-2], *extra, *index[-2:])]
        largest = np.where(weight > 0.0, np.maximum(largest, node), largest)
    return largest
