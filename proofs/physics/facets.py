"""Support facets as Python objects, for proofs and tests; the product has tables of them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.support import edges_at
from lutgen.support.primitive import pack, support_height
from lutgen.support.search import find_facets
from lutgen.support.table import RELATIVE_TOLERANCE, VERTEX, facet_table, robot_size
from lutgen.support.unite import unite


class Facet(NamedTuple):
    """One support facet, for people: see `facets`."""

    normal: NDArray[np.float64]
    height: float
    touching: tuple[int, ...]
    polygon: tuple[int, ...]
    points: NDArray[np.float64]


def facets(
    centre: NDArray[np.float64],
    axis: NDArray[np.float64],
    radius: NDArray[np.float64],
    kind: NDArray[np.int64],
) -> list[Facet]:
    """Return every support facet that has the com above it, whichever way it faces.

    Parameters
    ----------
    centre, axis : (n, 3) float64
        Centres relative to the com and unit axes (zeros unless a disc), body frame.
    radius, kind : (n,)
        Radius (length) and 0 point, 1 sphere, 2 disc.

    Returns
    -------
    list of Facet
        In ascending order of the bit set of touching primitives.  Empty when all contacts are
        collinear or the com is in or outside every facet's plane.
    """
    primitives = pack(centre, axis, radius, kind)
    table = facet_table(len(primitives))
    size = robot_size(primitives)
    find_facets(table.work, primitives, 2.0, size)
    unite(table, primitives, size)
    hull = table.hull
    tolerance = RELATIVE_TOLERANCE * size
    found = []
    for f in range(hull.tally[0]):
        if hull.facet[f, 3] > tolerance:
            corners = slice(*edges_at(hull.span, f))
            normal = tuple(hull.facet[f, :3].tolist())
            heights = [support_height(primitives, i, normal) for i in range(len(primitives))]
            found.append(
                Facet(
                    hull.facet[f, :3].copy(),
                    float(hull.facet[f, 3]),
                    tuple(i for i, h in enumerate(heights) if h > hull.facet[f, 3] - tolerance),
                    tuple(int(i) for i in hull.link[corners, VERTEX]),
                    hull.corner[corners].copy(),
                )
            )
    return sorted(found, key=lambda facet: sum(1 << i for i in facet.touching))
