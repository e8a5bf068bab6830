"""From facets to the standing region: rests, gaps, tiles, and where the robot tips over.

Owns the assembly of a `Region`.
"""

import math

from lutgen.jit import njit
from lutgen.support.catch import NO_ROLL, REFUSED, REST, STAGE
from lutgen.support.gaps import HIGH, LOW, find_gaps
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
    TILES,
    TIP,
    TIP_PLANE,
    Acceptance,
    Region,
)
from lutgen.support.rest import find_rests
from lutgen.support.strips import Strips, add_strips
from lutgen.support.table import (
    BACK,
    FIRST,
    FOUND,
    MASK,
    NEIGHBOUR,
    PLACE,
    RELATIVE_TOLERANCE,
    VERTEX,
    FacetTable,
    Hull,
    corner_after,
    put,
    vector_at,
)
from lutgen.support.tiles import (
    ROUNDING,
    add_segment,
    add_wall,
    between,
)
from lutgen.vector import Floats, Ints, Vector, cross, dot, length, row, scale, subtract, unit

# Where two rests are nearer than this (rad) to one plane, which of the two a ray pierces first is
# not to be told by their planes, as `raster` does where there are no gaps.
ONE_PLANE = 1e-5
# Part of a corner's distance from the com: as far outside a plane it may be of a region that is
# convex but for noise, and the planes of shorter segments say nothing.
NOISE = 1e-4
# So many times NOISE beyond a short segment another plane must have closed the region, by at least
# this part of NOISE: a sliver's long sides all but never meet.
BESIDE, CLOSED = 4.0, 0.1


@njit(bare=True)
def _enter_facets(region: Region, hull: Hull, kind: Ints, middle: Floats) -> int:
    """Enter the accepted facets in canonical order; return their number.

    `kind` (F,) and `middle` (F, 3), the centroids, are as `find_rests` leaves them.
    """
    facets, facet, span = hull.tally[FOUND], hull.facet, hull.span
    entered, first = region.facet, region.span
    accepted = 0
    for f in range(facets):
        if kind[f] != REFUSED:
            place = accepted
            while place > 0 and span[first[place - 1, SOURCE], MASK] > span[f, MASK]:
                first[place, SOURCE] = first[place - 1, SOURCE]
                place -= 1
            first[place, SOURCE] = f
            accepted += 1
    for k in range(accepted):
        f = first[k, SOURCE]
        span[f, PLACE] = k
        first[k, IS_REST] = 1 if kind[f] == REST else 0
        normal = row(facet, f)
        plane = scale(normal, 1.0 / facet[f, 3])
        centroid = row(middle, f)
        # In-plane axes: the body's x as seen in the plane (its y where x is the normal).
        across = (1.0, 0.0, 0.0) if abs(normal[0]) < 0.9 else (0.0, 1.0, 0.0)
        e1 = unit(subtract(across, scale(normal, dot(across, normal))))
        e2 = cross(normal, e1)
        put(entered, k, PLANE, plane)
        put(entered, k, FIRST_AXIS, subtract(e1, scale(plane, dot(e1, centroid))))
        put(entered, k, SECOND_AXIS, subtract(e2, scale(plane, dot(e2, centroid))))
        put(entered, k, CENTROID, centroid)
        entered[k, HEIGHT] = facet[f, 3]
    return accepted


@njit(inline=True, bare=True)
def _is_short(segment: Floats, b: int) -> bool:
    """Tell whether a boundary segment is so short that noise tells where its plane is."""
    start = vector_at(segment, b, START)
    apart = subtract(vector_at(segment, b, STOP), start)
    return dot(apart, apart) <= NOISE * NOISE * dot(start, start)


@njit(bare=True)
def _is_noise(segment: Floats, segments: int, b: int) -> bool:
    """Tell whether a boundary segment is short, and others close the region all the same.

    Of a region as narrow as that, which is a sliver, every segment counts.
    """
    if not _is_short(segment, b):
        return False
    out = scale(vector_at(segment, b, TIP_PLANE), -BESIDE * NOISE)
    start = unit(vector_at(segment, b, START))
    beyond = (start[0] + out[0], start[1] + out[1], start[2] + out[2])
    for other in range(segments):
        if not _is_short(segment, other):
            inside = dot(vector_at(segment, other, TIP_PLANE), beyond)
            if inside < -CLOSED * NOISE:
                return True
    return False


@njit(bare=True)
def _is_convex(region: Region, accepted: int) -> bool:
    """Tell whether every corner of every rest is inside every tip-over plane, but for noise."""
    span, edge, segment = region.span, region.edge, region.segment
    for b in range(region.tally[SEGMENTS]):
        if _is_noise(segment, region.tally[SEGMENTS], b):
            continue
        normal = vector_at(segment, b, TIP_PLANE)
        for k in range(accepted):
            if span[k, IS_REST] == 0:
                continue
            for e in range(span[k, FIRST], span[k + 1, FIRST]):
                point = vector_at(edge, e, POINT)
                depth = dot(normal, point)
                if depth < 0.0 and depth < -NOISE * length(point):
                    return False
    return True


@njit(bare=True)
def _leave_short_out(region: Region) -> None:
    """Take the segments out of a convex region's boundary whose planes are noise."""
    tally, segment, contacts = region.tally, region.segment, region.contacts
    kept = 0
    for b in range(tally[SEGMENTS]):
        # All that is not short has been kept, or is still to come.
        if not _is_noise(segment, tally[SEGMENTS], b):
            for c in range(segment.shape[1]):
                segment[kept, c] = segment[b, c]
            contacts[kept, 0], contacts[kept, 1] = contacts[b, 0], contacts[b, 1]
            kept += 1
    tally[SEGMENTS] = kept


@njit(bare=True)
def _add_edge(
    region: Region,
    p: Vector,
    q: Vector,
    inward: Vector,
    part: tuple[float, float],
    pair: tuple[int, int],
) -> None:
    """Append what a gap leaves of an edge from p to q as boundary: all but [low, high] of it."""
    low, high = part
    i, j = pair
    if low >= high:
        add_segment(region, p, q, inward, i, j)
        return
    if low > 0.0:
        add_segment(region, p, between(p, q, low), inward, i, j)
    if high < 1.0:
        add_segment(region, between(p, q, high), q, inward, i, j)


@njit(bare=True)
def _add_stage(region: Region, hull: Hull, gap: Floats, f: int) -> None:
    """Append a stage as a tile: the polygon of those parts of its edges that gaps hold."""
    tally, tile, wall = region.tally, region.tile, region.wall
    span, corner, link = hull.span, hull.corner, hull.link
    begin, end = span[f, FIRST], span[f + 1, FIRST]
    x = y = z = 0.0
    edges = 0
    for at in range(begin, end):
        if gap[at, LOW] < gap[at, HIGH]:
            edges += 1
            p, q = row(corner, at), row(corner, corner_after(span, f, at))
            half = between(p, q, 0.5 * (gap[at, LOW] + gap[at, HIGH]))
            x, y, z = x + half[0], y + half[1], z + half[2]
    if edges < 2 or tally[TILES] + 1 >= tile.shape[0]:
        return
    middle = (x / edges, y / edges, z / edges)
    w = tile[tally[TILES]]
    for at in range(begin, end):
        if not gap[at, LOW] < gap[at, HIGH] or w + 2 > wall.shape[0]:
            continue
        following = corner_after(span, f, at)
        p, q = row(corner, at), row(corner, following)
        here, there = between(p, q, gap[at, LOW]), between(p, q, gap[at, HIGH])
        w = add_wall(wall, w, here, there, middle, ROUNDING)
        ahead = following
        while not gap[ahead, LOW] < gap[ahead, HIGH]:
            ahead = corner_after(span, f, ahead)
        beyond = between(
            row(corner, ahead), row(corner, corner_after(span, f, ahead)), gap[ahead, LOW]
        )
        if ahead == following and gap[at, HIGH] == 1.0 and gap[ahead, LOW] == 0.0:
            continue
        w = add_wall(wall, w, there, beyond, middle, 0.0)
        i, j = link[following, VERTEX], link[ahead, VERTEX]
        add_segment(region, there, beyond, middle, i, j)
    tally[TILES] += 1
    tile[tally[TILES]] = w


@njit(bare=True)
def find_region(
    region: Region, table: FacetTable, primitives: Floats, acceptance: Acceptance, size: float
) -> None:
    """Fill `region` from the facets of one posture.

    Parameters
    ----------
    region : Region
        Overwritten.
    table : FacetTable
        As `unite.unite` leaves it.
    primitives : (n, 8) float64
        Rows of `primitive.pack`, relative to the com.
    acceptance : Acceptance
        Which facets count, what a rest is and how far the robot rocks.
    size : float
        Size of the robot, for the tolerances (length).
    """
    hull = table.hull
    facets = hull.tally[FOUND]
    facet, span, corner, link = hull.facet, hull.span, hull.corner, hull.link
    tally, first, edge, about = region.tally, region.span, region.edge, region.link
    tolerance = RELATIVE_TOLERANCE * size
    accept = Acceptance(
        acceptance.steepest,
        acceptance.rock_angle,
        acceptance.lowest_up,
        max(acceptance.least_height, tolerance),
        acceptance.rest_width,
        acceptance.contact_tolerance,
        acceptance.face,
    )
    work = table.work
    kind, middle = work.counts[0, :facets], work.normals
    find_rests(hull, primitives, accept, size, kind, middle, work)
    asked = accept.rock_angle < math.inf
    rests = 0
    for f in range(facets):
        # Where nobody asks how far the robot rolls, a stage is as good as a rest.
        if kind[f] == STAGE and not asked:
            kind[f] = REST
        rests += kind[f] == REST
    if rests == 0:
        # Stages alone lead nowhere: the region is empty, not one without a boundary.
        kind[:] = REFUSED
    accepted = _enter_facets(region, hull, kind, middle)
    tally[FACETS], tally[SEGMENTS], tally[GAPS], tally[TILES] = accepted, 0, 0, 0
    tally[BLURRED] = 0
    region.tile[0] = 0
    first[0, FIRST] = 0
    gap = table.held[: span[facets, FIRST]]
    if asked:
        limits = (accept.rock_angle + 1e-12, max(0.5 * accept.rest_width, tolerance))
        find_gaps(hull, primitives, kind, limits, gap, work)
    else:
        gap[:, LOW], gap[:, HIGH] = 0.0, 1.0
    strips = work.counts[1]
    count = held = 0
    e = 0
    for k in range(accepted):
        f = first[k, SOURCE]
        if kind[f] == STAGE:
            tally[GAPS] += 1
            _add_stage(region, hull, gap, f)
        for at in range(span[f, FIRST], span[f + 1, FIRST]):
            following = corner_after(span, f, at)
            p, q = row(corner, at), row(corner, following)
            edge_plane = unit(cross(p, q))
            put(edge, e, POINT, p)
            put(edge, e, EDGE_PLANE, edge_plane)
            about[e, EDGE_KIND], about[e, ACROSS] = TIP, -1
            other, back = link[at, NEIGHBOUR], link[at, BACK]
            i, j = link[at, VERTEX], link[following, VERTEX]
            part = (1.0, 0.0)
            if other >= 0 and back >= 0 and other != f and kind[other] != REFUSED:
                about[e, ACROSS] = span[other, PLACE]
                moved = length(subtract(row(corner, back), q)) + length(
                    subtract(row(corner, corner_after(span, other, back)), p)
                )
                part = (gap[at, LOW], gap[at, HIGH])
                rests_both = kind[f] == REST and kind[other] == REST
                turn = length(subtract(row(facet, f), row(facet, other)))
                if moved <= tolerance:
                    if rests_both:
                        about[e, EDGE_KIND] = SHARED
                        tally[BLURRED] += turn < ONE_PLANE
                elif part[0] < part[1]:
                    held += not (rests_both and turn <= NO_ROLL)
                    tally[GAPS] += 1
                    if f < other:
                        strips[2 * count], strips[2 * count + 1] = f, at
                        count += 1
            if kind[f] == REST:
                _add_edge(region, p, q, edge_plane, part, (i, j))
            e += 1
        first[k + 1, FIRST] = e
    if count > 0:
        found = Strips(hull, primitives, gap, strips[: 2 * count])
        add_strips(region, found, accept.rock_angle, size, work)
    # A stage that no gap leads over is no part of the region, and says nothing about its shape; nor
    # does a turn between rests that are one but for noise.
    tally[CONVEX] = 1 if held == 0 and _is_convex(region, accepted) else 0
    if tally[CONVEX] == 1:
        _leave_short_out(region)
