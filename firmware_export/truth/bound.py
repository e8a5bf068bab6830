"""What holds for three contacts in every posture of the box, not only in those that were sampled.

Owns the proof that one accepted facet carries the robot everywhere, and the bound of the error
of the polynomials in the verdict.  Both divide the box into cells, compute at the cells' middles
and add what a function can change on the way to a cell's rim, from `series.steepest`.

The three contacts P1, P2, P3, seen from the com, span a cone; E_i = P_i x P_(i+1) are its inward
edge normals, E_1 + E_2 + E_3 is the facet's normal, outward, and V = E_1 . P3 > 0 says that the com
lies above the facet.

Argument of the guard.  The exact tip angle is min_i asin(m_i . g) with m_i = E_i / |E_i|, the
runtime's the same with M_i from the polynomials.  asin(m . g) is g's distance from a great circle
and changes by no more than its pole turns, so the two differ by at most the greatest angle
between m_i and M_i.  Let D = F - E, F the polynomials' edge normal, l a lower bound of |E| and |F|
and _j a derivative along s_j.  Then

    |(M - m)_j| <= (|D_j| + 2 |E_j| |D| / l) / l

since (I - M M') F_j / |F| - (I - m m') E_j / |E| has the three parts D_j / |F|, the turn of the
projection times |E_j| / |F| (at most |D| / l) and the change of 1 / |E| (at most |D| / l^2).
"""

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from firmware_export.truth.model import Model
from firmware_export.truth.series import difference, evaluate, greatest, on_grid, steepest
from lutgen.vector import Floats

GUARD_CELLS = 250_000
# Cells that the proof of `carries_everywhere` may look at before it gives up.
MOST_CELLS = 300_000
HALF_UNIT = 2.0**-24


def carries_everywhere(series: Sequence[Floats], least: float, width: float = 0.0) -> bool:
    """Tell whether the com is above the contacts' plane and the facet a rest in all postures.

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
    """Return a lower bound of the length of any edge normal over the box; 0 where there is none."""
    return _edge_angle(series, series)[1]


def polynomial_guard(model: Model, series: Sequence[Floats], shortened: Sequence[Floats]) -> float:
    """Return a bound (rad) of the runtime's error in the tip angle; pi where there is none.

    The angle between exact and polynomial edge normals (see the head of this file) and an
    allowance for single precision.
    """
    angle, least = _edge_angle(series, shortened)
    if least <= 0.0:
        return math.pi
    return min(math.pi, angle + _rounding(model, shortened, least))


def _parts(points: Floats) -> list[Floats]:
    """Return the coordinates of points (..., 3), each in one piece."""
    return [np.ascontiguousarray(points[..., column]) for column in range(3)]


def _across(a: Sequence[Floats], b: Sequence[Floats]) -> list[Floats]:
    """Return the coordinates of vector products; `numpy.cross` takes four times as long."""
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def _size(a: Sequence[Floats]) -> Floats:
    return np.asarray(np.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]))


def _edge_angle(series: Sequence[Floats], shortened: Sequence[Floats]) -> tuple[float, float]:
    """Return bounds: greatest angle (rad) between edge normals, least length of any of them."""
    k = series[0].ndim - 1
    cells = int(GUARD_CELLS ** (1.0 / max(k, 1)) + 1e-9)
    half = 1.0 / cells
    s = (2.0 * np.arange(cells) + 1.0) / cells - 1.0
    exact, rough = ([_parts(on_grid(one, s)) for one in three] for three in (series, shortened))
    wrong = [difference(a, b) for a, b in zip(shortened, series, strict=True)]
    sizes, slopes = [greatest(one) for one in series], [steepest(one) for one in series]
    errors, error_slopes = [greatest(one) for one in wrong], [steepest(one) for one in wrong]
    worst, shortest = 0.0, math.inf
    for i in range(3):
        j = i - 2
        # Bounds over the whole box of |E_j|, |D| and |D_j|.
        slope = slopes[i] * sizes[j] + sizes[i] * slopes[j]
        off = errors[i] * sizes[j] + (sizes[i] + errors[i]) * errors[j]
        off_slope = (
            error_slopes[i] * (sizes[j] + errors[j])
            + errors[i] * (slopes[j] + error_slopes[j])
            + slopes[i] * errors[j]
            + sizes[i] * error_slopes[j]
        )
        true_edge, rough_edge = _across(exact[i], exact[j]), _across(rough[i], rough[j])
        true_length, rough_length = _size(true_edge), _size(rough_edge)
        least = float(min(true_length.min(), rough_length.min()))
        least -= half * float(np.sum(slope + off_slope))
        if least <= 0.0:
            return math.pi, 0.0
        turned = zip(true_edge, rough_edge, strict=True)
        chord = _size([b / rough_length - a / true_length for a, b in turned])
        change = (off_slope + 2.0 * slope * off / least) / least
        bound = float(chord.max()) + half * float(np.sum(change))
        worst = max(worst, 2.0 * math.asin(min(1.0, bound / 2.0)))
        shortest = min(shortest, least)
    return worst, shortest


def _rounding(model: Model, shortened: Sequence[Floats], least: float) -> float:
    """Return an allowance (rad) for single precision, from the query to the tip angle.

    In units of 2^-24.  A contact: one of its size for each term, 4 n^2 of it for T_n by its
    recurrence, and 8 and twice the limits' size over the span for s, times the slope along s.  An
    edge normal: both its contacts' and 4 of its size for the cross product.  The rest (place on
    the chart and its rim of 1e-6, scalar product, root, quotients, arcsine): 40 in all.
    """
    size = max(greatest(one) for one in shortened)
    limits = np.maximum(np.abs(model.lower), np.abs(model.upper)) / (model.upper - model.lower)
    contact = max(
        float(np.sum(steepest(one) * (8.0 + 2.0 * limits)))
        + size * (one.size / 3.0 + 4.0 * max(one.shape[:-1], default=1) ** 2)
        for one in shortened
    )
    edge = (2.0 * contact + 4.0 * size) * size / least
    return HALF_UNIT * (edge + 40.0)
