"""How the arrays of a region and of its facets are read from outside this room.

Owns nothing: the columns belong to `region`, `table` and `primitive`, which alone know their
numbers.
"""

from lutgen.jit import njit
from lutgen.support.primitive import KIND, RADIUS
from lutgen.support.region import (
    ACROSS,
    BLURRED,
    CENTROID,
    CONVEX,
    EDGE_KIND,
    EDGE_PLANE,
    FACETS,
    FIRST_AXIS,
    GAPS,
    HEIGHT,
    IS_REST,
    PLANE,
    POINT,
    SECOND_AXIS,
    SEGMENTS,
    SHARED,
    SOURCE,
    START,
    STOP,
    TIP_PLANE,
)
from lutgen.support.table import FIRST, MASK, VERTEX, vector_at
from lutgen.vector import Floats, Ints, Vector


@njit(inline=True, bare=True)
def facets_in(tally: Ints) -> int:
    """Return how many facets are accepted; `tally` of a region."""
    return int(tally[FACETS])


@njit(inline=True, bare=True)
def segments_in(tally: Ints) -> int:
    """Return how many segments the boundary has."""
    return int(tally[SEGMENTS])


@njit(inline=True, bare=True)
def is_convex(tally: Ints) -> bool:
    """Tell whether the region is convex."""
    return bool(tally[CONVEX] == 1)


@njit(inline=True, bare=True)
def gaps_in(tally: Ints) -> int:
    """Return how many gaps and stages there are."""
    return int(tally[GAPS])


@njit(inline=True, bare=True)
def blurred_in(tally: Ints) -> int:
    """Return how many edges join two rests whose planes are all but one."""
    return int(tally[BLURRED])


@njit(inline=True, bare=True)
def plane_at(facet: Floats, k: int) -> Vector:
    """Return n/h of accepted facet k, so that (n/h) . x = 1 on its plane (1/length)."""
    return vector_at(facet, k, PLANE)


@njit(inline=True, bare=True)
def first_axis_at(facet: Floats, k: int) -> Vector:
    """Return the first of the axes w with which D_g - s is (w . g) / ((n/h) . g)."""
    return vector_at(facet, k, FIRST_AXIS)


@njit(inline=True, bare=True)
def second_axis_at(facet: Floats, k: int) -> Vector:
    """Return the second of these axes."""
    return vector_at(facet, k, SECOND_AXIS)


@njit(inline=True, bare=True)
def centroid_at(facet: Floats, k: int) -> Vector:
    """Return the centroid s of accepted facet k (length)."""
    return vector_at(facet, k, CENTROID)


@njit(inline=True, bare=True)
def height_at(facet: Floats, k: int) -> float:
    """Return the com's height over accepted facet k (length)."""
    return float(facet[k, HEIGHT])


@njit(inline=True, bare=True)
def is_rest_at(span: Ints, k: int) -> bool:
    """Tell whether accepted facet k is a rest; `span` of a region."""
    return bool(span[k, IS_REST] == 1)


@njit(inline=True, bare=True)
def source_at(span: Ints, k: int) -> int:
    """Return which facet of the table accepted facet k is."""
    return int(span[k, SOURCE])


@njit(inline=True, bare=True)
def edges_at(span: Ints, k: int) -> tuple[int, int]:
    """Return the first edge of facet k and the one after its last; `span` of a region or table."""
    return int(span[k, FIRST]), int(span[k + 1, FIRST])


@njit(inline=True, bare=True)
def point_at(edge: Floats, e: int) -> Vector:
    """Return the contact point at which edge e begins (length)."""
    return vector_at(edge, e, POINT)


@njit(inline=True, bare=True)
def edge_plane_at(edge: Floats, e: int) -> Vector:
    """Return the unit inward normal of the plane through edge e and the com."""
    return vector_at(edge, e, EDGE_PLANE)


@njit(inline=True, bare=True)
def is_shared(link: Ints, e: int) -> bool:
    """Tell whether another rest begins at once beyond edge e; `link` of a region."""
    return bool(link[e, EDGE_KIND] == SHARED)


@njit(inline=True, bare=True)
def across(link: Ints, e: int) -> int:
    """Return the accepted facet beyond edge e, or -1."""
    return int(link[e, ACROSS])


@njit(inline=True, bare=True)
def start_at(segment: Floats, b: int) -> Vector:
    """Return where boundary segment b begins (length)."""
    return vector_at(segment, b, START)


@njit(inline=True, bare=True)
def stop_at(segment: Floats, b: int) -> Vector:
    """Return where boundary segment b ends (length)."""
    return vector_at(segment, b, STOP)


@njit(inline=True, bare=True)
def tip_plane_at(segment: Floats, b: int) -> Vector:
    """Return the unit inward normal of the plane through boundary segment b and the com."""
    return vector_at(segment, b, TIP_PLANE)


@njit(inline=True, bare=True)
def vertex_at(link: Ints, e: int) -> int:
    """Return the primitive at which edge e begins; `link` of a facet table."""
    return int(link[e, VERTEX])


@njit(inline=True, bare=True)
def touching_at(span: Ints, f: int) -> int:
    """Return the bit set of the primitives that facet f touches; `span` of a facet table."""
    return int(span[f, MASK])


@njit(inline=True, bare=True)
def radius_at(primitives: Floats, i: int) -> float:
    """Return the radius of primitive i (length)."""
    return float(primitives[i, RADIUS])


@njit(inline=True, bare=True)
def kind_at(primitives: Floats, i: int) -> int:
    """Return the kind of primitive i: POINT, SPHERE or DISC of `primitive`."""
    return int(primitives[i, KIND])


def with_one_segment(tally: Ints) -> Ints:
    """Return the `tally` of a region that has but one boundary segment."""
    alone = tally.copy()
    alone[SEGMENTS] = 1
    return alone
