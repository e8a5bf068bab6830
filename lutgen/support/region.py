"""Standing region of one posture: the gravity directions in which the robot does not tip over.

Owns the arrays that describe the region and the test of one direction; `boundary` fills them.  The
region is the union of the cones of the rests and of *tiles*, pieces of the gaps between them in
which the robot is caught.  Its boundary is a list of segments between two points of contact.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.table import FIRST, MOST_CORNERS, MOST_FACETS, vector_at
from lutgen.vector import Floats, Ints, Vector, dot

# Kinds of facet edge.  SHARED: beyond it another rest begins at once.  TIP: any other.
TIP, SHARED = 0, 1
# What `status_of` answers, and the channel `status` holds.
STANDS, ROCKS, TIPS = 0, 1, 2
NO_LIMIT = -2.0
# Entries of Region.tally.
FACETS, SEGMENTS, CONVEX, GAPS, TILES, BLURRED = 0, 1, 2, 3, 4, 5
# First columns of the vectors in Region.facet, Region.edge and Region.segment.
PLANE, FIRST_AXIS, SECOND_AXIS, CENTROID, HEIGHT = 0, 3, 6, 9, 12
POINT, EDGE_PLANE = 0, 3
START, STOP, TIP_PLANE = 0, 3, 6
EDGE_KIND, ACROSS = 0, 1
SOURCE, IS_REST = 1, 2
SLACK = 3
# Nearer to the normal of a facet that it carries (rad) the axle of a wheel may not be.
OFF_FACE = math.radians(10.0)
# Sine within which a direction counts as on a tip-over axis, where the robot stands.  Rounding is
# 1e-15, so all ways to compute a verdict give the same one.
ON_AXIS = 1e-12
# Sine by which a direction may lie beyond an edge that two rests share: no ray slips between them,
# where on either one the edge is elsewhere by up to RELATIVE_TOLERANCE of the size.
SAME_EDGE = 1e-8


class Region(NamedTuple):
    """Standing region of one posture as flat arrays, reused from posture to posture.

    `tally` (6,): accepted facets, boundary segments, 1 if the region is convex, gaps and stages,
    tiles, edges between two rests whose planes are all but one.
    Per facet, in canonical order (ascending bit set of touching primitives): `facet` (F, 13) =
    n/h, so that (n/h) . x = 1 on its plane; two axes with which, for t = 1/((n/h) . g), the
    in-plane components of D_g - s are t (axis . g); centroid s; height h.  `span` (F + 1, 3)
    first edge, index in the facet table, and 1 for a rest.
    Per edge: `edge` (E, 6) = contact point where it begins; the unit inward normal of its edge
    plane, through the edge and the com.  `link` (E, 2) kind, and accepted facet beyond it or -1.
    Per boundary segment: `segment` (B, 9) = two contact points and the unit inward normal of the
    tip-over plane, start x stop pointing inward; `contacts` (B, 2) primitives.
    Per tile: `tile` (T + 1,) its first wall; `wall` (W, 4) a unit inward normal, and the sine by
    which a direction may lie outside where another tile begins.
    """

    tally: NDArray[np.int64]
    facet: NDArray[np.float64]
    span: NDArray[np.int64]
    edge: NDArray[np.float64]
    link: NDArray[np.int64]
    segment: NDArray[np.float64]
    contacts: NDArray[np.int64]
    tile: NDArray[np.int64]
    wall: NDArray[np.float64]


@njit()
def empty_region(primitives: int) -> Region:
    """Return arrays large enough for the region of `primitives` contact primitives."""
    facets, edges = MOST_FACETS * primitives, MOST_CORNERS * primitives
    return Region(
        np.zeros(6, np.int64),
        np.empty((facets, 13)),
        np.zeros((facets + 1, 3), np.int64),
        np.empty((edges, 6)),
        np.empty((edges, 2), np.int64),
        np.empty((4 * edges, 9)),
        np.empty((4 * edges, 2), np.int64),
        np.zeros(2 * edges + 1, np.int64),
        np.empty((8 * edges, 4)),
    )


class Acceptance(NamedTuple):
    """Which facets count and where the robot rocks, as the numbers that kernels compare with.

    `steepest`: a facet is accepted if -n_z is greater than this; one exactly at the limit is
    refused, because a robot that lies on its side does not stand.  `rock_angle` (rad): the largest
    sum of turns from rest to rest; infinity where rolling from facet to facet is never asked about.
    `lowest_up`: from which n_z on the facet search need not go further, see `search.find_facets`.
    `least_height` (length): a facet is accepted if the com is higher above it than this.
    `rest_width` (length): a rest is at least this wide.  `contact_tolerance` (length): contacts
    this near to a facet's plane make up its support polygon.  `face`: a wheel that carries a facet
    has at least this sine between its axle and the normal, or it lies on its face.
    """

    steepest: float
    rock_angle: float
    lowest_up: float
    least_height: float
    rest_width: float
    contact_tolerance: float
    face: float


def acceptance(
    upright: float | None,
    rock_angle: float | None,
    least_height: float = 0.0,
    rest_width: float | None = None,
    contact_tolerance: float | None = None,
    face: float = OFF_FACE,
) -> Acceptance:
    """Return the acceptance of two angles (rad) and three lengths; None is no limit.

    `face` (rad): nearer to a facet's normal, or than 90 deg less `upright`, the axle of a wheel
    that carries it may not be.  Of level axles `upright` says so itself.
    """
    steepest = NO_LIMIT if upright is None or upright >= math.pi else math.cos(upright) + 1e-9
    rock = math.inf if rock_angle is None or rock_angle >= math.pi else rock_angle
    lowest_up = 0.0 if steepest > 0.0 else 2.0
    return Acceptance(
        steepest,
        rock,
        lowest_up,
        least_height,
        rest_width or 0.0,
        contact_tolerance or 0.0,
        min(math.sin(face), max(steepest, 0.0)),
    )


@njit(inline=True, bare=True)
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


@njit(inline=True, bare=True)
def _inside(span: Ints, edge: Floats, link: Ints, k: int, g: Vector) -> bool:
    """Tell whether g lies in the cone of facet k."""
    for e in range(span[k, FIRST], span[k + 1, FIRST]):
        slack = SAME_EDGE if link[e, EDGE_KIND] == SHARED else ON_AXIS
        if dot(vector_at(edge, e, EDGE_PLANE), g) < -slack:
            return False
    return True


@njit(bare=True)
def _on_rest(tally: Ints, span: Ints, edge: Floats, link: Ints, k: int, g: Vector) -> bool:
    """Tell whether g lies in the cone of a rest, most likely in that of facet k."""
    if span[k, IS_REST] == 1 and _inside(span, edge, link, k, g):
        return True
    # Where planes are all but one, rounding may take the next one for that of the rest itself.
    for other in range(tally[FACETS]):
        if other != k and span[other, IS_REST] == 1 and _inside(span, edge, link, other, g):
            return True
    return False


@njit(bare=True)
def _in_tile(tally: Ints, tile: Ints, wall: Floats, g: Vector) -> bool:
    """Tell whether g lies in any tile."""
    for t in range(tally[TILES]):
        inside = True
        for w in range(tile[t], tile[t + 1]):
            if dot(vector_at(wall, w, 0), g) < -max(wall[w, SLACK], ON_AXIS):
                inside = False
                break
        if inside:
            return True
    return False


@njit(inline=True, bare=True)
def status_of(region: Region, k: int, g: Vector) -> int:
    """Return STANDS, ROCKS or TIPS for direction g, whose supporting facet is k."""
    if k < 0:
        return TIPS
    if _on_rest(region.tally, region.span, region.edge, region.link, k, g):
        return STANDS
    return ROCKS if _in_tile(region.tally, region.tile, region.wall, g) else TIPS
