"""The support facets of a posture, found by rolling a plane over every edge (gift wrapping)."""

import math

from lutgen.jit import njit
from lutgen.support.polygon import corners_of, has_bit
from lutgen.support.primitive import (
    DISC,
    KIND,
    POINT,
    fill_contacts,
    support_contact,
    tangent_plane,
)
from lutgen.support.table import EDGES, FACETS, SAME, Region, edge_after, ends_of
from lutgen.support.tilting import tilt, touching
from lutgen.vector import (
    Floats,
    Vector,
    along,
    cross,
    dot,
    length,
    read3,
    row,
    scale,
    subtract,
    unit,
    write3,
)

# A facet is looked for up to this n_z where those that count face down.  Nearer to 0 a plane rolls
# towards the face of a wheel, where its contact is not defined.
HIGHEST = -0.05
# How often a facet that has grown looks for what its new plane touches.
GATHERS = 2
# The bits of all primitives.
ALL = -1
# Normals of one facet differ by less (rad).
ONE_NORMAL = 1e-4
# Contacts of two primitives nearer than so many times SAME are one corner.
ONE_CORNER = 100.0
# A corner that stands out of its neighbours' line by less than so many times SAME is none: rounding
# tells whether it touches both planes beside a row of contacts.
ROW = 10.0
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
def _all_touching(primitives: Floats, region: Region, normal: Vector, i: int, same: float) -> int:
    """Return the bits of all that touch a plane on primitive i."""
    contacts = region.contacts[1]
    fill_contacts(primitives, normal, contacts)
    return touching(contacts, primitives.shape[0], ALL, normal, i, same)


@njit(bare=True)
def _widest_plane(
    primitives: Floats, mask: int, normal: Vector, i: int, same: float
) -> tuple[Vector, bool]:
    """Return the plane on the widest triangle of those that touch one, from i on."""
    origin = support_contact(primitives, i, normal)
    pair, side = (-1, -1), (0.0, 0.0, 0.0)
    for turn in range(2):
        # What is in a row makes no plane.
        most = ROW * same * length(side)
        for k in range(primitives.shape[0]):
            if has_bit(mask, k) and k != i:
                arm = subtract(support_contact(primitives, k, normal), origin)
                size = length(cross(arm, side)) if turn == 1 else length(arm)
                if size > most:
                    most = size
                    pair = (pair[0], k) if turn == 1 else (k, -1)
        if pair[0] < 0:
            return normal, False
        side = subtract(support_contact(primitives, pair[0], normal), origin)
    if pair[1] < 0:
        return normal, False
    return tangent_plane(primitives, i, pair[0], pair[1], side, normal)


@njit(bare=True)
def _bits(mask: int) -> int:
    """Return how many bits are set."""
    count = 0
    while mask != 0:
        mask &= mask - 1
        count += 1
    return count


@njit(bare=True)
def _enter(
    primitives: Floats, region: Region, f: int, normal: Vector, mask: int, same: float
) -> bool:
    """Write facet f with its edges behind all others; tell whether its contacts make a polygon."""
    facet, edge, count = region.facet, region.edge, region.counts
    corners = corners_of(primitives, mask, normal, ROW * same, region)
    first = count[EDGES]
    if corners == 0 or f >= facet.shape[0] or first + corners > edge.shape[0]:
        return False
    write3(facet[f].normal, normal)
    facet[f].mask, facet[f].first, facet[f].count, facet[f].place = mask, first, corners, -1
    height = -math.inf
    for k in range(corners):
        e, point = first + k, support_contact(primitives, region.ids[k], normal)
        write3(edge[e].point, point)
        edge[e].primitive, edge[e].facet, edge[e].twin = region.ids[k], f, -1
        edge[e].held[0], edge[e].held[1] = 1.0, 0.0
        height = max(height, dot(point, normal))
    for e in range(first, first + corners):
        start, stop = read3(edge[e].point), read3(edge[first + (e - first + 1) % corners].point)
        write3(edge[e].wall, unit(cross(start, stop)))
    facet[f].height = height
    count[EDGES] = first + corners
    return True


@njit(bare=True)
def _forget_edges(region: Region, first: int, corners: int) -> None:
    """Take edges out of use: they belong to no facet, and no twin leads to them."""
    edge = region.edge
    for e in range(first, first + corners):
        edge[e].facet = -1
        if edge[e].twin >= 0:
            edge[edge[e].twin].twin = -1


@njit(bare=True)
def _are_one(
    primitives: Floats, region: Region, f: int, normal: Vector, mask: int, same: float
) -> bool:
    """Tell whether a plane and facet f share three contacts that are not in a line."""
    common = region.facet[f].mask & mask
    if _bits(common) < 3 or length(subtract(read3(region.facet[f].normal), normal)) > ONE_NORMAL:
        return False
    return common == mask or corners_of(primitives, common, normal, ROW * same, region) > 0


@njit(bare=True)
def _add_contacts(primitives: Floats, region: Region, f: int, mask: int, same: float) -> None:
    """Add contacts to facet f and write its edges anew."""
    facet = region.facet[f]
    first, corners, normal = facet.first, facet.count, read3(facet.normal)
    mask |= facet.mask
    i = region.edge[first].primitive
    for _ in range(GATHERS):
        better, good = _widest_plane(primitives, mask, normal, i, same)
        normal = better if good else normal
        # What is below the new plane is in it, too.
        mask |= _all_touching(primitives, region, normal, i, same)
    if _enter(primitives, region, f, normal, mask, same):
        _forget_edges(region, first, corners)


@njit(bare=True)
def _grow(primitives: Floats, region: Region, f: int, mask: int, same: float) -> None:
    """Add contacts to facet f, and the facets that are then one with it."""
    facet = region.facet
    _add_contacts(primitives, region, f, mask, same)
    other = 0
    while other < region.counts[FACETS]:
        normal, mask = read3(facet[f].normal), facet[f].mask
        if other == f or not _are_one(primitives, region, other, normal, mask, same):
            other += 1
            continue
        mask = facet[other].mask
        _forget_edges(region, facet[other].first, facet[other].count)
        facet[other].mask, facet[other].count, facet[other].height = 0, 0, -1.0
        _add_contacts(primitives, region, f, mask, same)
        other = 0


@njit(bare=True)
def facet_at(
    primitives: Floats, region: Region, normal: Vector, i: int, same: float
) -> tuple[int, bool]:
    """Return the facet with a normal that touches i, known or new, and whether it has grown.

    -1 where its contacts are in a line.  What is within `same` (length) of its plane is in it, and
    planes that share three contacts which are not in a line are one facet.
    """
    facet, count = region.facet, region.counts
    mask = _all_touching(primitives, region, normal, i, same)
    if _bits(mask) > 3:
        better, good = _widest_plane(primitives, mask, normal, i, same)
        if good:
            normal = better
            mask = _all_touching(primitives, region, normal, i, same)
    for f in range(count[FACETS]):
        if _are_one(primitives, region, f, normal, mask, same):
            grown = facet[f].mask & mask != mask
            if grown:
                _grow(primitives, region, f, mask, same)
            return f, grown
    f = count[FACETS]
    if not _enter(primitives, region, f, normal, mask, same):
        return -1, False
    count[FACETS] = f + 1
    return f, False


@njit(bare=True)
def _leave_old_edges_out(region: Region) -> None:
    """Move the edges of facets that have grown up to where their old ones were."""
    edge, count, kept = region.edge, region.counts, 0
    for e in range(count[EDGES]):
        if edge[e].facet < 0:
            continue
        if kept < e:
            edge[kept] = edge[e]
            facet = region.facet[edge[e].facet]
            facet.first = kept if facet.first == e else facet.first
            if edge[kept].twin >= 0:
                edge[edge[kept].twin].twin = kept
        kept += 1
    count[EDGES] = kept


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
    primitives: Floats, region: Region, pair: Ends, start: Start, limits: tuple[float, float]
) -> tuple[int, bool, Ends]:
    """Roll a plane over a pair of contacts; return the facet beyond, and whether it has grown.

    `start`: the bits of what touches, the plane's normal, and the direction to which it is tilted.
    A contact that comes into the row of the pair makes no facet: on the ends of the row the plane
    rolls on.  -1 if there is no facet; and the pair over which the plane came.
    """
    (mask, normal, ahead), same = start, limits[1]
    beyond, grown, before = -1, False, normal
    for _ in range(primitives.shape[0]):
        to, found = tilt(primitives, region.contacts, pair, mask, normal, ahead, limits)
        if to < 0:
            break
        beyond, grown = facet_at(primitives, region, found, pair[0], same)
        if beyond >= 0:
            break
        normal = found
        arm = subtract(
            support_contact(primitives, pair[1], normal),
            support_contact(primitives, pair[0], normal),
        )
        mask = _all_touching(primitives, region, normal, pair[0], same) | 1 << to
        pair = _ends_of_row(primitives, mask, normal, arm)
        turned = unit(cross(arm, normal))
        ahead = scale(turned, math.copysign(1.0, dot(turned, ahead)))
        fill_contacts(primitives, normal, region.contacts[0])
    if normal != before:
        fill_contacts(primitives, before, region.contacts[0])
    return beyond, grown, pair


@njit(bare=True)
def _begin(primitives: Floats, region: Region, limits: tuple[float, float]) -> None:
    """Find a first facet: lower a skew plane, and tilt it onto a second and a third primitive."""
    same = limits[1]
    normal, middle = unit(SKEW), (0.0, 0.0, 0.0)
    contacts = region.contacts
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
    j, level = tilt(primitives, contacts, (i, -1), 1 << i, normal, cross(across, normal), limits)
    if j < 0:
        return
    arm = subtract(support_contact(primitives, j, level), support_contact(primitives, i, level))
    ahead = unit(cross(arm, level))
    for _ in range(2):
        fill_contacts(primitives, level, contacts[0])
        mask = touching(contacts[0], primitives.shape[0], ALL, level, i, same)
        _roll_over(primitives, region, (i, j), (mask, level, ahead), limits)
        ahead = scale(ahead, -1.0)


@njit(bare=True)
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


@njit(bare=True)
def find_facets(primitives: Floats, region: Region, size: float, steepest: float) -> None:
    """Find the support facets of one posture.

    Parameters
    ----------
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com, none covered by another.
    region : Region
        Its facets and edges are filled.
    size : float
        Of the robot (length).
    steepest : float
        Facets count if -n_z is greater than this; of others only those are found that lead there.
    """
    facet, edge, count = region.facet, region.edge, region.counts
    count[FACETS] = count[EDGES] = 0
    same = SAME * size
    limits = (highest_of(primitives, steepest), same)
    _begin(primitives, region, limits)
    contacts = region.contacts
    f = 0
    while f < count[FACETS]:
        normal, first, corners = read3(facet[f].normal), facet[f].first, facet[f].count
        fill_contacts(primitives, normal, contacts[0])
        for e in range(first, first + corners):
            if edge[e].twin >= 0:
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
    _leave_old_edges_out(region)
