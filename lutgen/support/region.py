"""Standing region of one posture: the gravity directions in which the robot does not tip over.

Owns the arrays that describe the region and the test of one direction; `boundary` fills them.  The
region is the union of the cones of the accepted facets and of the gaps between two facets over
whose common edge the robot only rocks.  Its boundary is a list of segments between two contact
points: tip-over axes, and the short sides of gaps.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.hull import FIRST
from lutgen.vector import Floats, Ints, Vector, dot

# Kinds of facet edge.  TIP: beyond it the robot tips.  SHARED: beyond it another accepted facet
# begins at once.  GAP: beyond it the robot rocks over two round contacts onto another facet.
TIP, SHARED, GAP = 0, 1, 2
NO_LIMIT = -2.0
# Entries of Region.tally.
FACETS, SEGMENTS, CONVEX, GAPS = 0, 1, 2, 3
# First columns of the vectors in Region.facet, Region.edge and Region.segment.
PLANE, FIRST_AXIS, SECOND_AXIS, CENTROID, HEIGHT = 0, 3, 6, 9, 12
POINT, EDGE_PLANE, SIDE_FROM, SIDE_TO = 0, 3, 6, 9
START, STOP, TIP_PLANE = 0, 3, 6
EDGE_KIND, ACROSS = 0, 1
SOURCE = 1


class Region(NamedTuple):
    """Standing region of one posture as flat arrays, reused from posture to posture.

    `tally` (4,): accepted facets, boundary segments, 1 if the region is convex, gaps.
    Per facet, in canonical order (ascending bit set of touching primitives): `facet` (F, 13) =
    n/h, so that (n/h) . x = 1 on its plane; two axes with which, for t = 1/((n/h) . g), the
    in-plane components of D_g - s are t (axis . g); centroid s; height h.  `span` (F + 1, 2)
    first edge, and index in the facet table.
    Per edge: `edge` (E, 12) = contact point where it begins; the unit inward normal of its edge
    plane, through the edge and the com; for gaps the unit inward normals of its two sides,
    zero where a side is no limit.  `link` (E, 2) kind, and accepted facet beyond it or -1.
    Per boundary segment: `segment` (B, 9) = two contact points and the unit inward normal of the
    tip-over plane, start x stop pointing inward; `contacts` (B, 2) primitives.
    """

    tally: NDArray[np.int64]
    facet: NDArray[np.float64]
    span: NDArray[np.int64]
    edge: NDArray[np.float64]
    link: NDArray[np.int64]
    segment: NDArray[np.float64]
    contacts: NDArray[np.int64]


@njit()
def empty_region(primitives: int) -> Region:
    """Return arrays large enough for the region of `primitives` contact primitives."""
    facets = 8 * primitives
    edges = 24 * primitives
    return Region(
        np.zeros(4, np.int64),
        np.empty((facets, 13)),
        np.zeros((facets + 1, 2), np.int64),
        np.empty((edges, 12)),
        np.empty((edges, 2), np.int64),
        np.empty((3 * edges, 9)),
        np.empty((3 * edges, 2), np.int64),
    )


class Acceptance(NamedTuple):
    """Which facets count and where the robot rocks, as the numbers that kernels compare with.

    `steepest`: a facet is accepted if -n_z is greater than this; one exactly at the limit is
    refused, because a robot that lies on its side does not stand.  `least_cosine`: the robot rocks
    between facets whose normals have at least this scalar product.  `lowest_up`: from which n_z on
    the facet search need not go further, see `rounds.find_facets`.  `least_height` (length): a
    facet is accepted if the com is higher above it than this.
    """

    steepest: float
    least_cosine: float
    lowest_up: float
    least_height: float


def acceptance(
    upright: float | None, rock_angle: float | None, least_height: float = 0.0
) -> Acceptance:
    """Return the acceptance of two angles (rad, None = no limit) and a height (length)."""
    steepest = NO_LIMIT if upright is None or upright >= math.pi else math.cos(upright) + 1e-9
    least_cosine = NO_LIMIT if rock_angle is None else math.cos(rock_angle) - 1e-12
    lowest_up = 0.0 if steepest > 0.0 else 2.0
    return Acceptance(steepest, least_cosine, lowest_up, least_height)


@njit(inline=True)
def vector_at(array: Floats, index: int, column: int) -> Vector:
    """Return the three components that begin in a column of a packed row."""
    return array[index, column], array[index, column + 1], array[index, column + 2]


@njit(inline=True)
def supporting_facet(facet: Floats, facets: int, g: Vector) -> int:
    """Return the accepted facet whose plane the ray along g pierces first, or -1.

    The robot's hull lies above all its facets' planes, so the plane pierced first is the one of
    the facet where the ray leaves the hull.  Ties go to the lower index.
    """
    best = -1
    nearest = 0.0
    for k in range(facets):
        rate = dot(vector_at(facet, k, PLANE), g)
        if rate > nearest * (1.0 + 1e-12):
            nearest = rate
            best = k
    return best


@njit()
def is_standing(span: Ints, edge: Floats, link: Ints, k: int, g: Vector) -> bool:
    """Tell whether direction g, whose supporting facet is k, lies in the standing region.

    The far side of a gap needs no test: beyond the middle of it another facet supports.
    """
    if k < 0:
        return False
    inside = True
    for e in range(span[k, FIRST], span[k + 1, FIRST]):
        if link[e, EDGE_KIND] == SHARED or dot(vector_at(edge, e, EDGE_PLANE), g) >= 0.0:
            continue
        inside = False
        if (
            link[e, EDGE_KIND] == GAP
            and dot(vector_at(edge, e, SIDE_FROM), g) >= 0.0
            and dot(vector_at(edge, e, SIDE_TO), g) >= 0.0
        ):
            return True
    return inside
