"""Which facets are rests: the support polygon of each, its centroid and its width.

Owns the classes of facets.  The polygon is that of all contacts within `contact_tolerance` of the
plane, so four wheels whose positions are off by a little make up one rectangle.
"""

import math

from lutgen.jit import njit
from lutgen.support.catch import REFUSED, REST, STAGE
from lutgen.support.polygon import area_centroid, outline
from lutgen.support.primitive import sine_to_axle, support_contact, support_height
from lutgen.support.region import Acceptance
from lutgen.support.table import (
    FIRST,
    FOUND,
    MASK,
    RELATIVE_TOLERANCE,
    VERTEX,
    Hull,
    Workspace,
    put,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract, unit


@njit(bare=True)
def polygon_width(points: Floats, begin: int, end: int, normal: Vector) -> float:
    """Return the least width of a convex polygon of rows [begin, end) in any direction (length).

    Points that are one but for rounding give an edge any direction; across it the polygon is no
    narrower than it is, as both sides are measured.
    """
    least = math.inf
    for at in range(begin, end):
        origin = row(points, at)
        along = subtract(row(points, at + 1 if at + 1 < end else begin), origin)
        inward = unit(cross(normal, along))
        furthest = nearest = 0.0
        for other in range(begin, end):
            depth = dot(subtract(row(points, other), origin), inward)
            furthest, nearest = max(furthest, depth), min(nearest, depth)
        if length(along) > 0.0:
            least = min(least, furthest - nearest)
    return least if least < math.inf else 0.0


@njit(inline=True, bare=True)
def is_accepted(facet: Floats, f: int, acceptance: Acceptance) -> bool:
    """Tell whether the com is above a facet and the facet below the body."""
    return bool(facet[f, 3] > acceptance.least_height and -facet[f, 2] > acceptance.steepest)


@njit(bare=True)
def is_on_a_face(hull: Hull, primitives: Floats, f: int, acceptance: Acceptance) -> bool:
    """Tell whether a wheel that carries facet f lies on its face: nobody stands on that."""
    normal, span, link = row(hull.facet, f), hull.span, hull.link
    for at in range(span[f, FIRST], span[f + 1, FIRST]):
        if sine_to_axle(primitives, link[at, VERTEX], normal) < acceptance.face:
            return True
    return False


@njit(bare=True)
def find_rests(
    hull: Hull,
    primitives: Floats,
    acceptance: Acceptance,
    size: float,
    kind: Ints,
    centroid: Floats,
    work: Workspace,
) -> None:
    """Fill `kind` (F,), and of accepted facets `centroid` (F, 3) and the touching bits."""
    facets, facet, span, corner = hull.tally[FOUND], hull.facet, hull.span, hull.corner
    n = primitives.shape[0]
    points, polygon, flat = work.points, work.polygon, work.flat
    order, rank = work.counts[2], work.counts[3]
    near = max(acceptance.contact_tolerance, RELATIVE_TOLERANCE * size)
    for f in range(facets):
        kind[f] = REFUSED
        if not is_accepted(facet, f, acceptance) or is_on_a_face(hull, primitives, f, acceptance):
            continue
        normal = row(facet, f)
        across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
        first = unit(subtract(across, scale(normal, dot(across, normal))))
        second = cross(normal, first)
        touching, mask = 0, 0
        for i in range(n):
            if (
                facet[f, 3] - support_height(primitives, i, normal) <= near
                or span[f, MASK] >> i & 1
            ):
                point = support_contact(primitives, i, normal)
                put(points, touching, 0, point)
                flat[touching, 0], flat[touching, 1] = dot(first, point), dot(second, point)
                touching += 1
                mask |= 1 << i
        span[f, MASK] = mask
        corners = min(outline(flat, touching, order, rank), n)
        for c in range(corners):
            put(polygon, c, 0, row(points, order[c]))
        width = polygon_width(polygon, 0, corners, normal) if corners >= 3 else 0.0
        kind[f] = REST if width > 0.0 and width >= acceptance.rest_width else STAGE
        middle = area_centroid(polygon, 0, corners) if corners >= 3 else (math.nan, 0.0, 0.0)
        if math.isnan(middle[0]):
            x = y = z = 0.0
            share = 1.0 / (span[f + 1, FIRST] - span[f, FIRST])
            for at in range(span[f, FIRST], span[f + 1, FIRST]):
                x, y, z = (
                    x + share * corner[at, 0],
                    y + share * corner[at, 1],
                    z + share * corner[at, 2],
                )
            middle = (x, y, z)
        put(centroid, f, 0, middle)
