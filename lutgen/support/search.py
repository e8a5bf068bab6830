"""One posture, from primitives to its standing region.

Owns the choice of the search: closed form for parallel axes, the hull for points, rolling for the
rest; round ones without what lies within another one.
"""

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.boundary import find_region
from lutgen.support.hidden import STICKS_OUT, renumber, show
from lutgen.support.hull import find_point_facets
from lutgen.support.primitive import KIND, POINT
from lutgen.support.rails import find_rail_facets
from lutgen.support.region import Acceptance, Region
from lutgen.support.rounds import find_round_facets
from lutgen.support.table import DOUBT, OVERFLOW, FacetTable, Workspace, robot_size
from lutgen.support.unite import unite
from lutgen.vector import Floats

# Times that a search which loses its way is begun anew, the second time without what sticks out ten
# times as far: a corner that all but lies on a rim touches next to it, and no double has the digits
# to tell which of them a third one touches with.
LOOKS = 2


@njit(bare=True)
def _find_round(
    work: Workspace, primitives: NDArray[np.float64], lowest_up: float, size: float
) -> bool:
    """Search for facets of any primitives; tell whether all arcs found their ends."""
    if lowest_up <= 0.0 and find_rail_facets(work, primitives, size):
        return True
    return bool(find_round_facets(work, primitives, lowest_up, size))


@njit(bare=True)
def find_facets(
    work: Workspace, primitives: NDArray[np.float64], lowest_up: float, size: float
) -> None:
    """Fill the pieces of `work` with the complex of one posture, see the three searches.

    Parameters
    ----------
    work : Workspace
        Overwritten; `unite` goes on from there.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    lowest_up : float
        Facets are wanted whose normal's z is below this: 0 for those that face down, 2 for all.
    size : float
        Size of the robot (length).
    """
    n = primitives.shape[0]
    round_ones = 0
    for i in range(n):
        round_ones += primitives[i, KIND] != POINT
    tally = work.pieces.tally
    tally[DOUBT] = 0
    if round_ones == 0:
        find_point_facets(work, primitives, lowest_up, size)
        if tally[DOUBT] == 0:
            return
    number = work.counts[5]
    last, sticks_out = n + 1, STICKS_OUT
    for _ in range(LOOKS):
        shown = show(primitives, sticks_out, size, work.shown, number)
        if shown < last:
            last = shown
            if shown == n:
                agreed = _find_round(work, primitives, lowest_up, size)
            else:
                agreed = _find_round(work, work.shown[:shown], lowest_up, size)
                renumber(work.pieces, number)
            if agreed:
                break
        sticks_out *= 10.0


@njit(bare=True)
def stand(table: FacetTable, region: Region, primitives: Floats, acceptance: Acceptance) -> int:
    """Find the facets and the standing region of one posture.

    Parameters
    ----------
    table, region : FacetTable, Region
        Overwritten; as `facet_table` and `empty_region` make them for so many primitives.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    acceptance : Acceptance
        Which facets count, what a rest is and how far the robot rocks.

    Returns
    -------
    int
        1 where the table was too small, which only spheres that overlap oddly do.
    """
    size = robot_size(primitives)
    find_facets(table.work, primitives, acceptance.lowest_up, size)
    unite(table, primitives, size)
    find_region(region, table, primitives, acceptance, size)
    return int(table.hull.tally[OVERFLOW])
