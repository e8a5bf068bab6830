"""Bound how short an edge of three contacts can be, and if their facet is always a rest.

The three contacts P1, P2, P3, seen from the com, span a cone; E_i = P_i x P_(i+1) are its inward
edge normals, E_1 + E_2 + E_3 is the facet's normal, outward, and V = E_1 . P3 > 0 says that the com
lies above the facet.

Contacts are Chebyshev series in the parameters, to rounding: what can be said of such series holds
over the whole box without sampling it.  A robot of links is a sum of products of sines, cosines and
lengths: its series end, to 1e-13, after a few terms for each axis.  The box is divided into cells;
what is computed at a cell's middle changes on the way to its rim by `steepest` at most.

A series is an array (n_1, ..., n_k, 3): entry a is the coefficient, a point relative to the com, of
T_a1(s_1) ... T_ak(s_k) with s = 2 t - 1, so -1 to 1 over each axis of the box.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.polynomial.chebyshev import chebval, chebvander

from firmware_export.model.exact import Model, combinations, widened
from lutgen.channels import acceptance_of
from lutgen.vector import Floats

# Cells of the grid over the box for the shortest edge.
EDGE_CELLS = 250_000
# Cells that `carries_everywhere` may look at before it gives up.
MOST_CELLS = 300_000


@lru_cache(maxsize=4)
def least_edge_of(model: Model) -> float:
    """Return a lower bound of any edge normal's length over the box, and as far as sensors err.

    0 without one, or if the three contacts' facet is not a rest everywhere.
    """
    if not model.is_tripod or model.recipe.com_uncertainty > 0.0:
        return 0.0
    series = expand(widened(model))
    accept = acceptance_of(model.recipe)
    # Without a limit of rocking the width of a rest has no limit either.
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    if series is None or not carries_everywhere(series, accept.steepest, width):
        return 0.0
    return least_edge(series)


def carries_everywhere(series: Sequence[Floats], least: float, width: float = 0.0) -> bool:
    """Return True if the com is above the contacts' plane and the facet a rest in all postures.

    `series` are the three of `series.expand`; a facet is accepted if -n_z is greater than `least`,
    and a rest if it is at least `width` wide.
    """
    sizes = [greatest(one) for one in series]
    slopes = [steepest(one) for one in series]
    # How much the facet's normal and V can change along each s, summed over the parameters.
    turning = sum(
        float(np.sum(slopes[i] * sizes[i - 2] + sizes[i] * slopes[i - 2])) for i in range(3)
    )
    rising = sum(float(np.sum(slopes[i])) * sizes[i - 2] * sizes[i - 1] for i in range(3))
    # ... and |normal| - width x longest side, which is 0 where the triangle is as wide as that.
    narrowing = turning + width * 2.0 * max(float(np.sum(slope)) for slope in slopes)
    k = series[0].ndim - 1
    middles, half, seen = np.zeros((1, k)), 1.0, 0
    while len(middles):
        seen += len(middles)
        points = [evaluate(one, middles) for one in series]
        edges = [np.cross(points[i], points[i - 2]) for i in range(3)]
        normal = edges[0] + edges[1] + edges[2]
        above = np.sum(edges[0] * points[2], axis=1)
        accepted = -normal[:, 2] - least * np.linalg.norm(normal, axis=1)
        sides = [np.linalg.norm(points[i] - points[i - 2], axis=1) for i in range(3)]
        spare = np.linalg.norm(normal, axis=1) - width * np.max(sides, axis=0)
        if not (np.all(above > 0.0) and np.all(accepted > 0.0) and np.all(spare > 0.0)):
            return False
        open_cells = (above <= half * rising) | (accepted <= half * (1.0 + abs(least)) * turning)
        open_cells |= spare <= half * narrowing
        if seen + np.count_nonzero(open_cells) * 2**k > MOST_CELLS:
            return False
        half /= 2.0
        corners = np.array(list(product((-half, half), repeat=k)))
        middles = (middles[open_cells, None] + corners).reshape(open_cells.sum() * len(corners), k)
    return True


def least_edge(series: Sequence[Floats]) -> float:
    """Return a lower bound of the length of any edge normal over the box, or 0."""
    k = series[0].ndim - 1
    cells = int(EDGE_CELLS ** (1.0 / max(k, 1)) + 1e-9)
    half = 1.0 / cells
    s = (2.0 * np.arange(cells) + 1.0) / cells - 1.0
    points = [on_grid(one, s) for one in series]
    sizes, slopes = [greatest(one) for one in series], [steepest(one) for one in series]
    shortest = math.inf
    for i in range(3):
        slope = slopes[i] * sizes[i - 2] + sizes[i] * slopes[i - 2]
        length = np.linalg.norm(np.cross(points[i], points[i - 2]), axis=-1)
        shortest = min(shortest, float(length.min()) - half * float(np.sum(slope)))
    return max(shortest, 0.0)


# A series has ended where its coefficients are this part of the robot's size.
NEGLIGIBLE = 1e-13
# Nodes with which the end of a series along one axis is looked for; a whole turn needs 30.
LINE_NODES = (9, 17, 33, 65)
LINES = 5
MOST_NODES = 200_000
MOST_NUMBERS = 4_000_000
CHECKS = 256
AGREEMENT = 1e-10


@lru_cache(maxsize=4)
def expand(model: Model) -> tuple[Floats, ...] | None:
    """Return the series of the three contacts, or None where there are no such short series.

    In the order of `rounds`; their shape is (n_1, ..., n_k, 3), with n_j = 1 along an axis on which
    a contact does not depend.
    """
    rng = np.random.default_rng(0)
    centre = np.full(model.k, 0.5)
    size = float(np.abs(_contacts(model, centre[None])).max())
    counts = [_length(model, axis, rng, size) for axis in range(model.k)]
    if None in counts or np.prod([float(n or 1) for n in counts]) > MOST_NODES:
        return None
    lengths = [int(n or 1) for n in counts]
    grid = combinations([chebyshev_nodes(n) for n in lengths])
    series = _contacts(model, (grid + 1.0) / 2.0).reshape(*lengths, 3, 3)
    for axis, n in enumerate(lengths):
        series = _along(series, axis, chebyshev_transform(n))
    order = list(rounds(model))
    result = tuple(trim(series[..., i, :], NEGLIGIBLE * size) for i in order)
    t = rng.random((CHECKS, model.k))
    exact = _contacts(model, t)[:, order]
    close = all(
        np.abs(evaluate(one, 2.0 * t - 1.0) - exact[:, i]).max() <= AGREEMENT * size
        for i, one in enumerate(result)
    )
    return result if close else None


def rounds(model: Model) -> tuple[int, int, int]:
    """Return the recipe's contacts in the order in which P1 . (P2 x P3) > 0 in the box's middle.

    Seen from the com they then go round so that the cross product of each with the next points
    into their cone.
    """
    middle = _contacts(model, np.full((1, model.k), 0.5))[0]
    return (0, 1, 2) if np.linalg.det(middle) > 0.0 else (1, 0, 2)


def _contacts(model: Model, t: Floats) -> Floats:
    """Return the contacts (m, 3, 3) at places t (m, k) in [0, 1]."""
    return model.postures(model.at(t)).centres


def chebyshev_nodes(n: int) -> Floats:
    """Return the n zeros of T_n."""
    return np.asarray(np.cos(np.pi * (np.arange(n) + 0.5) / n))


def chebyshev_transform(n: int) -> Floats:
    """Return the (n, n) matrix from values at the zeros of T_n to coefficients."""
    matrix: Floats = np.asarray(chebvander(chebyshev_nodes(n), n - 1), np.float64).T * (2.0 / n)
    matrix[0] /= 2.0
    return matrix


def _along(array: Floats, axis: int, matrix: Floats) -> Floats:
    """Apply a matrix along one axis."""
    return np.moveaxis(np.tensordot(matrix, array, (1, axis)), 0, axis)


def _length(model: Model, axis: int, rng: np.random.Generator, size: float) -> int | None:
    """Return how many terms the series along an axis have, or None if they do not end."""
    bases = np.vstack([np.full(model.k, 0.5), rng.random((LINES - 1, model.k))])
    for n in LINE_NODES:
        t = np.repeat(bases[:, None], n, axis=1)
        t[..., axis] = (chebyshev_nodes(n) + 1.0) / 2.0
        values = _contacts(model, t.reshape(-1, model.k)).reshape(LINES, n, 9)
        weight = np.abs(_along(values, 1, chebyshev_transform(n))).max(axis=(0, 2))
        above = np.flatnonzero(weight > NEGLIGIBLE * size)
        last = int(above[-1]) if len(above) else 0
        # The last two coefficients must be gone: one alone may vanish by symmetry.
        if last < n - 2:
            return last + 1
    return None


def trim(series: Floats, smallest: float) -> Floats:
    """Cut off the ends of a series in which no coefficient is above `smallest`."""
    for axis in range(series.ndim - 1):
        others = tuple(i for i in range(series.ndim) if i != axis)
        above = np.flatnonzero(np.abs(series).max(axis=others) > smallest)
        series = np.take(series, range(int(above[-1]) + 1 if len(above) else 1), axis)
    return series


def evaluate(series: Floats, s: Floats) -> Floats:
    """Return the values (m, 3) of a series at places s (m, k) in [-1, 1]."""
    # Each place needs as much memory as the series itself.
    at_once, parts = max(1, MOST_NUMBERS // series.size), []
    for begin in range(0, len(s), at_once):
        places = s[begin : begin + at_once]
        value = np.broadcast_to(series[..., None], (*series.shape, len(places)))
        for along in places.T:
            value = chebval(along, value, tensor=False)
        parts.append(value.T)
    return np.concatenate(parts)


def on_grid(series: Floats, s: Floats) -> Floats:
    """Return the values (c, ..., c, 3) of a series on the grid with coordinates s (c,)."""
    for axis in range(series.ndim - 1):
        series = _along(series, axis, np.asarray(chebvander(s, series.shape[axis] - 1)))
    return series


def greatest(series: Floats) -> float:
    """Return a bound of the length of a series anywhere in the box: |T| <= 1."""
    return float(np.linalg.norm(series, axis=-1).sum())


def steepest(series: Floats) -> Floats:
    """Return bounds (k,) of the lengths of the derivatives along each s: |T_n'| <= n^2."""
    sizes = np.linalg.norm(series, axis=-1)
    degrees = np.indices(sizes.shape, dtype=np.float64) ** 2
    return np.array([(sizes * degree).sum() for degree in degrees])
