"""Gather what touches a plane into a facet, and unite the planes that are one facet."""

import math

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.polygon import corners_of, has_bit
from lutgen.support.primitive import fill_contacts, support_contact, tangent_plane
from lutgen.support.table import Region
from lutgen.support.tilting import ALL, touching
from lutgen.vector import cross, dot, length, read3, subtract, unit, write3

# How often an enlarged facet looks for what its new plane touches.
GATHERS = 2
# Normals of one facet differ by less (rad).
ONE_NORMAL = 1e-4
# A corner that stands out of its neighbours' line by less than so many times SAME is left out:
# rounding decides if it touches both planes beside a row of contacts.
ROW = 10.0


@njit(bare=True)
def all_touching(primitives: Floats, region: Region, normal: Vector, i: int, same: float) -> int:
    """Return the bits of all that touch a plane on primitive i."""
    contacts = region.contacts[1, : primitives.shape[0]]
    fill_contacts(primitives, normal, contacts)
    return touching(contacts, ALL, normal, i, same)


@njit(bare=True)
def _widest_plane(
    primitives: Floats, mask: int, normal: Vector, i: int, same: float
) -> tuple[Vector, bool]:
    """Return the plane on the widest triangle of those that touch one, from i on."""
    origin = support_contact(primitives, i, normal)
    pair, side = (-1, -1), (0.0, 0.0, 0.0)
    for turn in range(2):
        # Contacts in a row make no plane.
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
def bit_count(mask: int) -> int:
    """Return how many bits are set."""
    count = 0
    while mask != 0:
        mask &= mask - 1
        count += 1
    return count


@njit(inline=True, bare=True)
def write_edge(region: Region, e: int, f: int, primitive: int, point: Vector) -> None:
    """Begin edge e of facet f at a corner: it has no twin, and no part of it is held."""
    edge = region.edge[e]
    write3(edge.point, point)
    edge.primitive, edge.facet, edge.twin = primitive, f, -1
    edge.held[0], edge.held[1] = 1.0, 0.0
    edge.raised[0] = edge.raised[1] = 1.0


@njit(inline=True, bare=True)
def _enter(
    primitives: Floats, region: Region, f: int, normal: Vector, mask: int, same: float
) -> bool:
    """Write facet f with its edges behind all others; True if its contacts make a polygon."""
    facet, edge, count = region.facet, region.edge, region.counts
    corners = corners_of(primitives, mask, normal, ROW * same, region)
    first = count.edges
    if corners == 0 or f >= facet.shape[0] or first + corners > edge.shape[0]:
        return False
    write3(facet[f].normal, normal)
    facet[f].mask, facet[f].first, facet[f].count, facet[f].place = mask, first, corners, -1
    facet[f].swings = 0
    height = -math.inf
    for k in range(corners):
        e, point = first + k, support_contact(primitives, region.ids[k], normal)
        write_edge(region, e, f, region.ids[k], point)
        height = max(height, dot(point, normal))
    for e in range(first, first + corners):
        start, stop = read3(edge[e].point), read3(edge[first + (e - first + 1) % corners].point)
        write3(edge[e].wall, unit(cross(start, stop)))
    facet[f].height = height
    count.edges = first + corners
    return True


@njit(bare=True)
def forget_edges(region: Region, first: int, corners: int) -> None:
    """Take edges out of use: they belong to no facet, and no twin leads to them."""
    edge = region.edge
    for e in range(first, first + corners):
        edge[e].facet = -1
        if edge[e].twin >= 0:
            edge[edge[e].twin].twin = -1


@njit(inline=True, bare=True)
def _are_one(
    primitives: Floats, region: Region, f: int, normal: Vector, mask: int, same: float
) -> bool:
    """Return True if a plane and facet f share three contacts that are not in a line."""
    common = region.facet[f].mask & mask
    if (
        bit_count(common) < 3
        or length(subtract(read3(region.facet[f].normal), normal)) > ONE_NORMAL
    ):
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
        # Contacts below the new plane are in it, too.
        mask |= all_touching(primitives, region, normal, i, same)
    if _enter(primitives, region, f, normal, mask, same):
        forget_edges(region, first, corners)


@njit(bare=True)
def _grow(primitives: Floats, region: Region, f: int, mask: int, same: float) -> None:
    """Add contacts to facet f, and the facets that are then one with it."""
    facet = region.facet
    _add_contacts(primitives, region, f, mask, same)
    other = 0
    while other < region.counts.facets:
        normal, mask = read3(facet[f].normal), facet[f].mask
        if other == f or not _are_one(primitives, region, other, normal, mask, same):
            other += 1
            continue
        mask = facet[other].mask
        forget_edges(region, facet[other].first, facet[other].count)
        facet[other].mask, facet[other].count, facet[other].height = 0, 0, -1.0
        _add_contacts(primitives, region, f, mask, same)
        other = 0


@njit(inline=True, bare=True)
def facet_at(
    primitives: Floats, region: Region, normal: Vector, mask: int, i: int, same: float
) -> tuple[int, bool]:
    """Return the facet with a normal that touches i, known or new, and True if it is enlarged.

    `mask`: the bits of all that it touches.  -1 where they are in a line.  All primitives within
    `same` (length) of its plane are in it, and planes that share three contacts which are not in a
    line are one facet.
    """
    facet, count = region.facet, region.counts
    if bit_count(mask) > 3:
        better, good = _widest_plane(primitives, mask, normal, i, same)
        if good:
            normal = better
            mask = all_touching(primitives, region, normal, i, same)
    for f in range(count.facets):
        if _are_one(primitives, region, f, normal, mask, same):
            grown = facet[f].mask & mask != mask
            if grown:
                _grow(primitives, region, f, mask, same)
            return f, grown
    f = count.facets
    if not _enter(primitives, region, f, normal, mask, same):
        return -1, False
    count.facets = f + 1
    return f, False


@njit(bare=True)
def leave_old_edges_out(region: Region) -> None:
    """Move the edges of enlarged facets to the place of their old ones."""
    edge, count, kept = region.edge, region.counts, 0
    for e in range(count.edges):
        if edge[e].facet < 0:
            continue
        if kept < e:
            edge[kept] = edge[e]
            facet = region.facet[edge[e].facet]
            facet.first = kept if facet.first == e else facet.first
            if edge[kept].twin >= 0:
                edge[edge[kept].twin].twin = kept
        kept += 1
    count.edges = kept
