"""The support facets of a posture, found by rolling a plane over every edge (gift wrapping)."""

import math

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.gather import facet_at, leave_old_edges_out
from lutgen.support.polygon import has_bit
from lutgen.support.primitive import DISC, KIND, POINT, are_alike, fill_contacts, support_contact
from lutgen.support.table import SAME, Region, edge_after, ends_of
from lutgen.support.tilting import Limits, tilt
from lutgen.vector import along, cross, dot, length, read3, row, scale, subtract, unit

# A facet is looked for up to this n_z where those that count face down.  Nearer to 0 a plane rolls
# towards the face of a wheel, where its contact is not defined.
HIGHEST = -0.05
# Contacts of two primitives nearer than so many times SAME are one corner.
ONE_CORNER = 100.0
# A direction to begin with that no robot is built along.
SKEW = (0.0123, -0.0271, -0.9996)
Ends = tuple[int, int]
Start = tuple[int, Vector, Vector]


@njit(bare=True)
def highest_of(primitives: Floats, steepest: float) -> float:
    """Return the greatest n_z of the facets to look for; 2 for all of them.

    Downward facets of points, or of rims, lead to each other; balls among rims break that rule.
    """
    balls = rims = False
    for i in range(primitives.shape[0]):
        balls |= primitives[i, KIND] != POINT and primitives[i, KIND] != DISC
        rims |= primitives[i, KIND] == DISC
    if steepest <= 0.0 or (balls and rims):
        return 2.0
    return max(HIGHEST, -0.5 * steepest)


@njit(bare=True)
def _ends_of_row(primitives: Floats, mask: int, normal: Vector, along_row: Vector) -> Ends:
    """Return the first and the last of the contacts in `mask` along a direction."""
    first, last, least, most = -1, -1, math.inf, -math.inf
    for k in range(primitives.shape[0]):
        if has_bit(mask, k):
            place = dot(support_contact(primitives, k, normal), along_row)
            if place < least:
                first, least = k, place
            if place > most:
                last, most = k, place
    return first, last


@njit(bare=True)
def _roll_over(
    primitives: Floats, region: Region, pair: Ends, start: Start, limits: Limits
) -> tuple[int, bool, Ends]:
    """Roll a plane over a pair of contacts; return the facet beyond, and True if it is enlarged.

    `start`: the bits of what touches, the plane's normal, and the direction to which it is tilted.
    A contact that comes into the row of the pair makes no facet: on the ends of the row the plane
    rolls on.  -1 if there is no facet; and the pair over which the plane came.
    """
    (mask, normal, ahead), same = start, limits.same
    contacts = region.contacts[:, : primitives.shape[0]]
    beyond, grown, before = -1, False, normal
    for _ in range(primitives.shape[0]):
        to, mask, found = tilt(primitives, contacts, pair, mask, normal, ahead, limits)
        if to < 0:
            break
        beyond, grown = facet_at(primitives, region, found, mask, pair[0], same)
        if beyond >= 0:
            break
        normal = found
        arm = subtract(
            support_contact(primitives, pair[1], normal),
            support_contact(primitives, pair[0], normal),
        )
        pair = _ends_of_row(primitives, mask, normal, arm)
        turned = unit(cross(arm, normal))
        ahead = scale(turned, math.copysign(1.0, dot(turned, ahead)))
        fill_contacts(primitives, normal, contacts[0])
    if normal != before:
        fill_contacts(primitives, before, contacts[0])
    return beyond, grown, pair


@njit(bare=True)
def _begin(primitives: Floats, region: Region, limits: Limits) -> None:
    """Find a first facet: lower a skew plane, and tilt it onto a second and a third primitive."""
    same = limits.same
    normal, middle = unit(SKEW), (0.0, 0.0, 0.0)
    contacts = region.contacts[:, : primitives.shape[0]]
    fill_contacts(primitives, normal, contacts[0])
    i, most = 0, -math.inf
    for k in range(primitives.shape[0]):
        point = row(contacts[0], k)
        middle = along(middle, point, 1.0 / primitives.shape[0])
        if dot(point, normal) > most:
            i, most = k, dot(point, normal)
    # Towards the middle of all contacts there is one to come to.
    across = cross(normal, subtract(middle, row(contacts[0], i)))
    if length(across) <= same:
        across = cross(normal, (0.0, 1.0, 0.0))
    across = unit(across)
    j, mask, level = tilt(
        primitives, contacts, (i, -1), 1 << i, normal, cross(across, normal), limits
    )
    # It may touch a third one at once.
    if j < 0 or facet_at(primitives, region, level, mask, i, same)[0] >= 0:
        return
    arm = subtract(support_contact(primitives, j, level), support_contact(primitives, i, level))
    ahead = unit(cross(arm, level))
    for _ in range(2):
        fill_contacts(primitives, level, contacts[0])
        _roll_over(primitives, region, (i, j), (mask, level, ahead), limits)
        ahead = scale(ahead, -1.0)


@njit(inline=True, bare=True)
def _edge_between(primitives: Floats, region: Region, f: int, i: int, j: int, same: float) -> int:
    """Return the edge of facet f from the contact of primitive i to that of j, or -1.

    Other primitives that touch the plane there may stand for them.
    """
    facet, normal = region.facet[f], read3(region.facet[f].normal)
    begin, end = support_contact(primitives, i, normal), support_contact(primitives, j, normal)
    for e in range(facet.first, facet.first + facet.count):
        start, stop = ends_of(region, e)
        apart = max(length(subtract(start, begin)), length(subtract(stop, end)))
        if apart <= ONE_CORNER * same:
            return e
    return -1


@njit(inline=True, bare=True)
def _pair_up(region: Region, e: int) -> bool:
    """Pair an edge with a single one between the same primitives; return True if there is one."""
    edge, begin, end = region.edge, region.edge[e].primitive, region.edge[edge_after(region, e)]
    for twin in range(region.counts.edges):
        if edge[twin].primitive != end.primitive or edge[twin].facet < 0 or edge[twin].twin >= 0:
            continue
        if edge[edge_after(region, twin)].primitive == begin:
            edge[e].twin, edge[twin].twin = twin, e
            return True
    return False


@njit(bare=True)
def find_facets(primitives: Floats, region: Region, size: float, steepest: float) -> None:
    """Fill the facets and edges of one posture from primitives (n, 8), none covered by another.

    `size` (length) is that of the robot.  Facets count if -n_z is greater than `steepest`; of
    others only those are found that lead there.
    """
    facet, edge, count = region.facet, region.edge, region.counts
    count.facets = count.edges = 0
    same = SAME * size
    rigid = True
    for i in range(1, primitives.shape[0]):
        rigid &= are_alike(primitives, 0, i)
    limits = Limits(highest_of(primitives, steepest), same, rigid)
    _begin(primitives, region, limits)
    contacts = region.contacts[:, : primitives.shape[0]]
    f = 0
    while f < count.facets:
        normal, first, corners = read3(facet[f].normal), facet[f].first, facet[f].count
        fill_contacts(primitives, normal, contacts[0])
        for e in range(first, first + corners):
            # A pair of points carries on one arc alone.
            if edge[e].twin >= 0 or (rigid and _pair_up(region, e)):
                continue
            i, j = edge[e].primitive, edge[edge_after(region, e)].primitive
            start, stop = ends_of(region, e)
            ahead = unit(cross(subtract(stop, start), normal))
            begin = (facet[f].mask, normal, ahead)
            beyond, grown, pair = _roll_over(primitives, region, (i, j), begin, limits)
            if grown and (beyond <= f or facet[f].count == 0):
                # Its edges are new: go back to it, or on if this one is part of it now.
                f = min(f, beyond - 1)
                break
            if beyond < 0 or beyond == f:
                continue
            twin = _edge_between(primitives, region, beyond, pair[1], pair[0], same)
            if twin >= 0 and edge[twin].twin < 0:
                edge[e].twin, edge[twin].twin = twin, e
        f += 1
    leave_old_edges_out(region)
