"""Gaps: over which part of an edge between two rests the robot rocks and does not tip over.

One roll, one landing: balanced on the edge, the robot rolls to either end of the arc and must stay
on the rest there.  The cone of a gap has plane walls: seen from the com a rim is no plane, so its
sides are moved in until the balances that are held are outside at every eighth of the way along.
"""

import math

from lutgen.arrays import Floats, Vector
from lutgen.jit import njit
from lutgen.support.facets import find_facets
from lutgen.support.primitive import contact_count, show
from lutgen.support.region import add_arc, add_boundary, add_rests, add_wall, find_rests
from lutgen.support.rolling import Places, arc_between, held_by, roll_over, turned
from lutgen.support.table import (
    ROCKS,
    STANDS,
    Acceptance,
    Region,
    edge_after,
    ends_of,
    is_inner,
    is_same_rest,
    is_slit,
    rests_at,
    robot_size,
    seat_of,
)
from lutgen.vector import along, between, cross, dot, length, read3, scale, subtract, unit

# A side is moved this many times the way to where it should be, SIDE_STEPS times at most.
FURTHER, SIDE_STEPS = 1.05, 4
Sines = tuple[float, float, float, float, float]
# Lagrange's weights of the inner three of five even places, at each eighth of the way, and of the
# two ends.
EIGHTHS = (
    (140.0 / 128.0, -70.0 / 128.0, 28.0 / 128.0, 35.0 / 128.0, -5.0 / 128.0),
    (1.0, 0.0, 0.0, 0.0, 0.0),
    (60.0 / 128.0, 90.0 / 128.0, -20.0 / 128.0, -5.0 / 128.0, 3.0 / 128.0),
    (0.0, 1.0, 0.0, 0.0, 0.0),
    (-20.0 / 128.0, 90.0 / 128.0, 60.0 / 128.0, 3.0 / 128.0, -5.0 / 128.0),
    (0.0, 0.0, 1.0, 0.0, 0.0),
    (28.0 / 128.0, -70.0 / 128.0, 140.0 / 128.0, -5.0 / 128.0, 35.0 / 128.0),
)


@njit(bare=True)
def _landing(
    region: Region, k: int, came: int, gravity: tuple[Vector, Vector], sunk: tuple[float, float]
) -> tuple[float, float]:
    """Return the part [low, high] of [0, 1] for which the robot stays on rest k.

    It came over the edge `came`, with gravity and the com sunk by as much as is given for 0 and 1;
    both are linear between.  Rests of a group are one: edges inside it hold nothing.
    """
    seat, edge = region.seat, region.edge
    low, high = 0.0, 1.0
    for here in range(region.counts.accepted):
        if not is_same_rest(region, here, k):
            continue
        g0, g1 = gravity
        e0, e1 = sunk
        facet = region.facet[seat[here].facet]
        if here != k:
            normal, other = read3(seat[k].normal), read3(seat[here].normal)
            foot = read3(edge[facet.first].point)
            g0, g1 = turned(normal, other, 0.0, g0), turned(normal, other, 0.0, g1)
            e0 -= dot(foot, subtract(g0, gravity[0]))
            e1 -= dot(foot, subtract(g1, gravity[1]))
        for e in range(facet.first, facet.first + facet.count):
            if e == came or is_inner(region, e):
                continue
            start, stop = ends_of(region, e)
            side = subtract(stop, start)
            size = length(side)
            if size == 0.0:
                continue
            lever, axis = scale(cross(start, stop), 1.0 / size), scale(side, 1.0 / size)
            foot = along(start, axis, -dot(start, axis))
            inside = dot(lever, g0), dot(lever, g1)
            above = dot(foot, g0), dot(foot, g1)
            if inside[0] >= max(above[0] + e0, 0.0) and inside[1] >= max(above[1] + e1, 0.0):
                continue  # It is held all along if it is so by (sunk + 2 above + sunk) / 2.
            w0, w1 = held_by(inside, above, (e0, e1))
            low, high = max(low, w0), min(high, w1)
            if not low < high:
                return 1.0, 0.0
    return low, high


@njit(inline=True, bare=True)
def _side(first: Places, second: Places, w: float) -> tuple[Vector, Vector]:
    """Return the ends of a side of a gap: its balance w on the one rest and on the other."""
    return between(first[0], second[0], w), between(first[4], second[4], w)


@njit(inline=True, bare=True)
def _side_wall(first: Places, second: Places, w: float) -> Vector:
    """Return the unit normal of the wall through a side and the com, towards greater w."""
    start, stop = _side(first, second, w)
    return unit(cross(start, stop))


@njit(inline=True, bare=True)
def _inside(wall: Vector, first: Places, second: Places, w: float) -> Sines:
    """Return how far the balances w along an arc are inside a wall, at five even places."""
    return (
        dot(wall, between(first[0], second[0], w)),
        dot(wall, between(first[1], second[1], w)),
        dot(wall, between(first[2], second[2], w)),
        dot(wall, between(first[3], second[3], w)),
        dot(wall, between(first[4], second[4], w)),
    )


@njit(bare=True)
def _moved_in(first: Places, second: Places, w: float, other: float) -> float:
    """Return a side w moved towards the `other` one until the curve of its balances is outside."""
    sign, weight, balance = 1.0 if other > w else -1.0, 1.0, w
    there = _inside(scale(_side_wall(first, second, other), sign), first, second, balance)
    for _ in range(SIDE_STEPS):
        here = _inside(scale(_side_wall(first, second, w), sign), first, second, balance)
        share = 0.0
        for k in range(len(EIGHTHS)):
            near, far = _at_eighth(here, EIGHTHS[k]), _at_eighth(there, EIGHTHS[k])
            if near > 0.0 > far:
                share = max(share, near / (near - weight * far))
        if share == 0.0:
            break
        w += (other - w) * FURTHER * share
        weight *= 0.5  # The rule of Illinois, as the other end stays.
    return w


@njit(inline=True, bare=True)
def _at_eighth(sines: Sines, weights: Sines) -> float:
    """Return the polynomial through five even places at an eighth of the way."""
    inner = weights[0] * sines[1] + weights[1] * sines[2] + weights[2] * sines[3]
    return inner + weights[3] * sines[0] + weights[4] * sines[4]


@njit(bare=True)
def _add_gap(
    region: Region, e: int, first: Places, second: Places, part: tuple[float, float]
) -> tuple[float, float]:
    """Add the cones and the sides of a gap; return the part of the edge that is held.

    There are two, divided where both planes are pierced at once: the rest that gravity pierces
    first gives `sdg` and `height`.
    """
    low = _moved_in(first, second, part[0], part[1])
    high = _moved_in(first, second, part[1], part[0])
    if not low < high:
        return 1.0, 0.0
    p0, q0 = _side(first, second, low)
    p1, q1 = _side(first, second, high)
    left, right = unit(cross(p0, q0)), unit(cross(q1, p1))
    least = min(min(dot(left, p1), dot(left, q1)), min(dot(right, p0), dot(right, q0)))
    if not least > 0.0:
        return 1.0, 0.0  # Twisted.
    edge, seat, cone, count = region.edge, region.seat, region.cone, region.counts
    here, there = seat_of(region, e), seat_of(region, edge[e].twin)
    cut = unit(subtract(read3(seat[here].plane), read3(seat[there].plane)))
    for side in range(2):
        k = count.cones
        cone[k].first, cone[k].count, cone[k].status = count.walls, 5, ROCKS
        cone[k].seat = here if side == 0 else there
        add_wall(region, left)
        add_wall(region, right)
        add_wall(region, unit(cross(second[0], first[0])))
        add_wall(region, unit(cross(first[4], second[4])))
        add_wall(region, cut if side == 0 else scale(cut, -1.0))
        count.cones = k + 1
    i, j = edge[e].primitive, edge[edge_after(region, e)].primitive
    add_arc(region, p0, q0, (i, i))
    add_arc(region, q1, p1, (j, j))
    return low, high


@njit(bare=True)
def _add_joint(region: Region, e: int, first: Places, second: Places) -> None:
    """Add the cone between two rests of a group: all that is between their edges.

    It is too narrow for walls through both ends of a contact's way, so its ends are walls across
    the edge, through the end that is further in.
    """
    cone, count = region.cone, region.counts
    k, side = count.cones, unit(subtract(second[0], first[0]))
    cone[k].first, cone[k].count, cone[k].status = count.walls, 6, STANDS
    cone[k].seat = seat_of(region, e)
    for end in range(2):
        start, stop = first[4 * end], second[4 * end]
        add_wall(region, unit(along(side, start, -dot(side, start) / dot(start, start))))
        add_wall(region, unit(along(scale(side, -1.0), stop, dot(side, stop) / dot(stop, stop))))
    add_wall(region, unit(cross(second[0], first[0])))
    add_wall(region, unit(cross(first[4], second[4])))
    count.cones = k + 1


@njit(bare=True)
def _held(
    region: Region, e: int, normals: Places, first: Places, second: Places
) -> tuple[float, float]:
    """Return the part [low, high] of an edge from which the robot stays, whichever way it rolls."""
    here, twin = seat_of(region, e), region.edge[e].twin
    start, stop, (twist, sunk) = normals[0], normals[4], roll_over(normals, first)
    g0, g1 = turned(start, stop, twist, first[0]), turned(start, stop, twist, second[0])
    below = dot(sunk, first[0]), dot(sunk, second[0])
    low, high = _landing(region, seat_of(region, twin), twin, (g0, g1), below)
    if not low < high:
        return 1.0, 0.0
    g0, g1 = turned(stop, start, -twist, first[4]), turned(stop, start, -twist, second[4])
    w0, w1 = _landing(region, here, e, (g0, g1), (-dot(sunk, g0), -dot(sunk, g1)))
    return max(low, w0), min(high, w1)


@njit(bare=True)
def _find_gap(primitives: Floats, region: Region, e: int, one: bool, free: bool) -> bool:
    """Find the held part of an edge between two rests, and add the gap if it has any width.

    Returns True if the robot rocks there.
    """
    edge, seat = region.edge, region.seat
    twin = edge[e].twin
    normals = read3(seat[seat_of(region, e)].normal), read3(seat[seat_of(region, twin)].normal)
    slit, (a, b), (c, d) = is_slit(region, e), ends_of(region, e), ends_of(region, twin)
    pair = edge[e].primitive, edge[edge_after(region, e)].primitive
    first, second = (a, a, a, a, d), (b, b, b, b, c)
    path = (normals[0], normals[1], normals[1], normals[1], normals[1])
    if not slit:
        # Other contacts of the rest may stand for the two at its corners.
        path, one_way, other_way = arc_between(primitives, pair, normals)
        first = (a, one_way[1], one_way[2], one_way[3], d)
        second = (b, other_way[1], other_way[2], other_way[3], c)
    low, high = 0.0, 1.0
    if not (one or free):
        low, high = _held(region, e, path, first, second)
    if one and not slit:
        _add_joint(region, e, first, second)
    elif low < high and not slit:
        low, high = _add_gap(region, e, first, second, (low, high))
    if low < high:
        edge[e].held[0], edge[e].held[1] = low, high
        edge[twin].held[0], edge[twin].held[1] = 1.0 - high, 1.0 - low
    return low < high and not slit and not one


@njit(bare=True)
def find_gaps(primitives: Floats, region: Region, accept: Acceptance) -> int:
    """Find the held part of every edge between two rests, and add the gaps to the region.

    Rests of one group are one at any `rock_angle`; if it is infinite, all of an edge is held.
    Returns how many gaps have an area in which the robot rocks.
    """
    edge, seat = region.edge, region.seat
    free = accept.rock_angle == math.inf
    # The turn of a gap may be longer by rounding.
    least = -2.0 if free else math.cos(accept.rock_angle + 1e-12)
    gaps = 0
    for e in range(region.counts.edges):
        here, there = rests_at(region, e)
        if there < 0 or edge[e].twin < e:
            continue
        one = is_inner(region, e)
        if one or dot(read3(seat[here].normal), read3(seat[there].normal)) >= least:
            gaps += _find_gap(primitives, region, e, one, free)
    return gaps


@njit(bare=True)
def stand(region: Region, primitives: Floats, accept: Acceptance) -> None:
    """Overwrite a region with that of one posture: rows (n, 8) of `primitive.pack`."""
    contacts = contact_count(primitives)
    places, axles = primitives[:contacts], primitives[contacts:]
    size = robot_size(places)
    count = show(places, size, region.shown, region.source)
    region.counts.shown = count
    shown = region.shown[:count]
    find_facets(shown, region, size, accept.steepest)
    find_rests(shown, axles, region, accept, size)
    add_rests(region)
    add_boundary(region, find_gaps(shown, region, accept))
