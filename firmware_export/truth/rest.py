"""Whether the facet of three contacts is a rest in every posture, and how short an edge can be.

Both questions divide the box into cells, compute at the cells' middles and add what a function
can change on the way to a cell's rim, from `series.steepest`.

The three contacts P1, P2, P3, seen from the com, span a cone; E_i = P_i x P_(i+1) are its inward
edge normals, E_1 + E_2 + E_3 is the facet's normal, outward, and V = E_1 . P3 > 0 says that the com
lies above the facet.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import product

import numpy as np

from firmware_export.truth.model import Model, widened
from firmware_export.truth.series import evaluate, expand, greatest, on_grid, steepest
from lutgen.channels import acceptance_of
from lutgen.vector import Floats

# Cells of the grid over the box for the shortest edge.
EDGE_CELLS = 250_000
# Cells that `carries_everywhere` may look at before it gives up.
MOST_CELLS = 300_000


@lru_cache(maxsize=4)
def least_edge_of(model: Model) -> float:
    """Return a lower bound of any edge normal's length over the box, and a sensor's slack beyond.

    0 where there is none, or where the three contacts' facet is not a rest everywhere.
    """
    if not model.is_tripod or model.recipe.com_uncertainty > 0.0:
        return 0.0
    series = expand(widened(model))
    accept = acceptance_of(model.recipe)
    # Where nobody asks how far the robot rolls, a stage is as good as a rest.
    width = accept.rest_width if math.isfinite(accept.rock_angle) else 0.0
    if series is None or not carries_everywhere(series, accept.steepest, width):
        return 0.0
    return least_edge(series)


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
    k = series[0].ndim - 1
    cells = int(EDGE_CELLS ** (1.0 / max(k, 1)) + 1e-9)
    half = 1.0 / cells
    s = (2.0 * np.arange(cells) + 1.0) / cells - 1.0
    points = [on_grid(one, s) for one in series]
    sizes, slopes = [greatest(one) for one in series], [steepest(one) for one in series]
    shortest = math.inf
    for i in range(3):
        slope = slopes[i] * sizes[i - 2] + sizes[i] * slopes[i - 2]
        length = _edge_lengths(points[i], points[i - 2])
        shortest = min(shortest, float(length.min()) - half * float(np.sum(slope)))
    return max(shortest, 0.0)


def _edge_lengths(a: Floats, b: Floats) -> Floats:
    """Return the lengths of vector products; `numpy.cross` takes four times as long."""
    a, b = (np.ascontiguousarray(np.moveaxis(one, -1, 0)) for one in (a, b))
    edge = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
    return np.asarray(np.sqrt(edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2]))
