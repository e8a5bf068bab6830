"""The tables of one posture: facets, edges, accepted facets, convex cones, and the boundary.

A support facet is a plane that touches three primitives or more, not in a line, with none below.
An edge lies between two corners of a facet; rolling over it, the two contacts there carry the robot
until a third one touches: the facet beyond, whose own edge is the *twin*.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.primitive import RADIUS
from lutgen.vector import dot, read3, row, scale, subtract

# Two lengths that differ by less than this part of the robot's size are the same length.
SAME = 1e-9
# As many as an int64 has bits for, with the sign and one left over.
MAX_PRIMITIVES = 62
# Verdicts of a direction: the values of the channel `status`.
STANDS, ROCKS, TIPS = 0, 1, 2
# Nearer to the normal of a facet that it carries (rad), or than 90 deg less `upright`, the axle of
# a wheel may not be.  For level axles `upright` does the same.
OFF_FACE = math.radians(10.0)
NO_LIMIT = -2.0


def record(vectors: str, numbers: str, integers: str, *others: tuple[Any, ...]) -> Any:
    """Return the type of a row, from the names of its fields by kind."""
    kinds = (vectors, "3f8"), (numbers, "f8"), (integers, "i8")
    return np.dtype([*((name, kind) for names, kind in kinds for name in names.split()), *others])


COUNTS = record("", "", "facets edges accepted cones walls arcs convex shown")
FACET = record("normal", "height", "mask first count place swings")
EDGE = record("point wall", "", "primitive facet twin", ("held", "f8", 2), ("raised", "f8", 2))
SEAT = record("normal plane centroid", "height", "mask facet group is_rest", ("axes", "f8", (2, 3)))
CONE = record("", "", "first count seat status")
ARC = record("start stop wall along amid", "spread", "", ("contacts", "i8", 2))
# A corner of a polygon in a plane, and the inverse factors by which the ends of the edge from it on
# are nearer to the com than the plane is: along an edge they change linearly.
CORNER = record("", "x y begin end", "")
# The axle on a facet: a point and the direction of its line, its com and its share of the mass; and
# which two primitives it stands on.
AXLE_ROW = record("pivot way com", "mass", "first second")


class Acceptance(NamedTuple):
    """Limits of facets and of rocking, as the numbers that kernels compare with.

    `steepest`: a facet is accepted if -n_z is greater than this; one exactly at the limit is
    refused, because a robot that lies on its side does not stand.  `rock_angle` (rad): the largest
    turn of a gap; infinity if every gap counts and landings do not.  `least_height` (length): a
    facet is accepted if the com is higher above it.  `rest_width` (length): a rest is at least this
    wide.  `contact_tolerance` (length): contacts this near to a facet's plane make up its support
    polygon; below 0, minus a part of the posture's own size.  `face`: a wheel that carries a facet
    has at least this sine between its axle and the normal, or it lies on its face.
    """

    steepest: float
    rock_angle: float
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
) -> Acceptance:
    """Return the acceptance of two angles (rad) and three lengths; None is no limit."""
    steepest = NO_LIMIT if upright is None or upright >= math.pi else math.cos(upright) + 1e-9
    return Acceptance(
        steepest,
        math.inf if rock_angle is None or rock_angle >= math.pi else rock_angle,
        least_height,
        rest_width or 0.0,
        contact_tolerance or 0.0,
        min(math.sin(OFF_FACE), max(steepest, 0.0)),
    )


# Rows for as many primitives as there may be: the hull of n points has 2 n - 4 facets, that of n
# spheres grows with the square of n.  Memory that is not touched costs nothing.
_FACETS = MAX_PRIMITIVES * MAX_PRIMITIVES + 8
_EDGES, _SIDES = 3 * _FACETS, 4 * MAX_PRIMITIVES + 4
REGION = np.dtype(
    (
        np.record,
        [
            ("counts", COUNTS),
            ("facet", FACET, _FACETS),
            ("edge", EDGE, _EDGES),
            ("seat", SEAT, _FACETS),
            ("cone", CONE, _FACETS + _EDGES),
            ("wall", "f8", (6 * _EDGES, 3)),
            ("arc", ARC, 2 * _EDGES),
            ("shown", "f8", (MAX_PRIMITIVES, 8)),
            ("source", "i8", MAX_PRIMITIVES),
            ("contacts", "f8", (3, MAX_PRIMITIVES, 3)),
            ("flat", "f8", (MAX_PRIMITIVES, 2)),
            ("polygon", "f8", (_SIDES, 3)),
            ("ids", "i8", _SIDES),
            ("swung", CORNER, (2, _SIDES)),
            ("axle", AXLE_ROW, _FACETS),
        ],
    )
)
# A row of REGION; kernels take it faster than a tuple of arrays.
Region = Any


def empty_region() -> Region:
    """Return room for where one posture stands, reused from posture to posture.

    `counts`: entries in use of the tables below, `convex` is 1 if the region is so, and `shown` the
    primitives that no other one covers.

    `facet`: unit outward `normal`, `height` of the com, bits of the primitives that it touches,
    its first edge and how many, its `place` among the accepted ones, or -1, and if it
    `swings`: an axle stands on it.
    `edge`: contact `point` where it begins and the `primitive` there; unit inward normal of the
    `wall` through it and the com; the `twin` or -1; `held`, the part [low, high] of it over which
    the robot may roll onto the rest beyond, low >= high for none; `raised`, the factors by which
    its ends are nearer to the com than `point`, on the line through a pivot.
    `seat`: the accepted facets by ascending bits of touching primitives: `plane` n / h; `axes`,
    with which the in-plane components of D_g - s are (axes . g) / (plane . g); `centroid` s of the
    support polygon; 1 if it `is_rest`; rests of one `group` are one but for a turn of 2e-4 rad.
    `cone`: `count` walls from `first` on, rests first, then gaps; and the `seat` that counts there.
    `wall`: unit inward normals.
    `arc`: a piece of the boundary from contact point `start` to `stop`, see `region.add_arc`.
    `shown`, `source`: the primitives that none covers, and their rows.
    `axle`: of a facet that `swings`, its axle.
    `contacts`, `flat`, `polygon`, `ids`, `swung`: scratch memory.
    """
    return np.empty(1, REGION)[0]


@njit(bare=True)
def robot_size(primitives: Floats) -> float:
    """Return the greatest distance of a primitive's far side from the com."""
    size = 0.0
    for i in range(primitives.shape[0]):
        centre = row(primitives, i)
        size = max(size, math.sqrt(dot(centre, centre)) + primitives[i, RADIUS])
    return size


@njit(inline=True, bare=True)
def edge_after(region: Region, e: int) -> int:
    """Return the edge that follows on e, counter-clockwise seen from outside."""
    facet = region.facet[region.edge[e].facet]
    return e + 1 if e + 1 < facet.first + facet.count else int(facet.first)


@njit(inline=True, bare=True)
def ends_of(region: Region, e: int) -> tuple[Vector, Vector]:
    """Return the points between which an edge lies: contacts, or on the way to a pivot."""
    edge, after = region.edge, edge_after(region, e)
    begin, end = edge[e].raised[0], edge[e].raised[1]
    return scale(read3(edge[e].point), begin), scale(read3(edge[after].point), end)


@njit(inline=True, bare=True)
def seat_of(region: Region, e: int) -> int:
    """Return the accepted facet that an edge belongs to, or -1."""
    return int(region.facet[region.edge[e].facet].place)


@njit(inline=True, bare=True)
def rests_at(region: Region, e: int) -> tuple[int, int]:
    """Return the rests on both sides of an edge; -1, -1 unless there are two."""
    here, twin = seat_of(region, e), region.edge[e].twin
    there = seat_of(region, twin) if twin >= 0 else -1
    if here < 0 or there < 0 or not (region.seat[here].is_rest and region.seat[there].is_rest):
        return -1, -1
    return here, there


@njit(inline=True, bare=True)
def is_inner(region: Region, e: int) -> bool:
    """Return True if an edge lies between two rests of one group."""
    here, there = rests_at(region, e)
    return bool(there >= 0 and region.seat[here].group == region.seat[there].group)


@njit(inline=True, bare=True)
def is_same_rest(region: Region, here: int, k: int) -> bool:
    """Return True if an accepted facet is a rest of the group of rest k."""
    seat = region.seat
    return bool(seat[here].is_rest == 1 and seat[here].group == seat[k].group)


@njit(inline=True, bare=True)
def is_slit(region: Region, e: int) -> bool:
    """Return True if an edge and its twin are one line: both contacts stay where they are."""
    a, b = ends_of(region, e)
    d, c = ends_of(region, region.edge[e].twin)
    x, y = subtract(a, c), subtract(b, d)
    return dot(x, x) + dot(y, y) <= SAME * SAME * (dot(a, a) + dot(b, b))
