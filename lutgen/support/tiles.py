"""Tiles: the pieces of gaps in which the robot is caught, and the boundary that they leave.

Owns the sides of gaps.  While the robot rolls over two contacts, each runs along its rim, and what
the two sweep is a gap's strip.  Seen from the com a rim is no plane, so the strip is cut into
pieces with plane walls, and the walls are put where they lose a little of the strip and add nothing
to it: along tangents of the rim where it bulges into the strip, and along its chords where it
bulges outwards.  What is lost is at most `MOST_LOST` of the size.
"""

import math

from lutgen.jit import njit
from lutgen.support.arc import Arc, arc_normal
from lutgen.support.primitive import RADIUS, support_contact
from lutgen.support.region import SEGMENTS, SLACK, START, STOP, TILES, TIP_PLANE, Region
from lutgen.support.table import MOST_PIECES, put
from lutgen.vector import Floats, Vector, cross, dot, length, row, scale, subtract, unit

# Part of the robot's size that a wall may lie within the rim.
MOST_LOST = 2e-4
# Sine by which a direction may lie outside a wall beyond which the region goes on.
ROUNDING = 1e-13
# Sine by which one end of a strip may lie on the hither side of its other end.
FOLDED = 1e-4
# Sides shorter than this part of their distance have no direction.
SHORT = 1e-6


@njit(inline=True, bare=True)
def between(p: Vector, q: Vector, part: float) -> Vector:
    """Return the point at a part of the segment from p to q; the ends come out exactly."""
    if part == 0.0:
        return p
    if part == 1.0:
        return q
    return (
        p[0] + part * (q[0] - p[0]),
        p[1] + part * (q[1] - p[1]),
        p[2] + part * (q[2] - p[2]),
    )


@njit(inline=True, bare=True)
def _is_beyond(
    corner: Floats, edge: tuple[int, int], far: tuple[int, int], low: float, high: float
) -> bool:
    """Tell whether the part [low, high] from one `far` corner to the other is beyond an edge."""
    plane = cross(row(corner, edge[0]), row(corner, edge[1]))
    most = FOLDED * length(plane)
    p = between(row(corner, far[0]), row(corner, far[1]), low)
    q = between(row(corner, far[0]), row(corner, far[1]), high)
    return dot(plane, p) <= most * length(p) and dot(plane, q) <= most * length(q)


@njit(bare=True)
def leads_out(
    corner: Floats, here: tuple[int, int], there: tuple[int, int], low: float, high: float
) -> bool:
    """Tell whether the part [low, high] of a strip lies beyond both its edges, seen from the com.

    `here` and `there`: the rows of `corner` where the contacts i and j touch at both ends of the
    arc.  A com that is next to none above its facets may see one end on the hither side of the
    other: such a strip is folded, and no walls cut it out.
    """
    back = there[1], there[0]
    return _is_beyond(corner, here, there, low, high) and _is_beyond(corner, back, here, low, high)


@njit(inline=True, bare=True)
def add_segment(
    region: Region, start: Vector, stop: Vector, inward: Vector, i: int, j: int
) -> None:
    """Append a boundary segment; the direction `inward` is on the inner side of its plane."""
    tally, segment, contacts = region.tally, region.segment, region.contacts
    normal = cross(start, stop)
    size = length(normal)
    b = tally[SEGMENTS]
    if size > 0.0 and b < segment.shape[0]:
        if dot(normal, inward) < 0.0:
            start, stop = stop, start
            size = -size
        put(segment, b, START, start)
        put(segment, b, STOP, stop)
        put(segment, b, TIP_PLANE, scale(normal, 1.0 / size))
        contacts[b, 0] = i
        contacts[b, 1] = j
        tally[SEGMENTS] = b + 1


@njit(inline=True, bare=True)
def add_wall(wall: Floats, w: int, p: Vector, q: Vector, inner: Vector, slack: float) -> int:
    """Append the wall through the com, p and q, a tile's edge; return the next free row.

    Edges go round a tile counter-clockwise, seen from outside.  Where p and q are all but one, the
    wall stands across the way to `inner`: which way so short an edge goes is rounding.
    """
    apart = subtract(q, p)
    if dot(apart, apart) <= SHORT * SHORT * dot(p, p):
        normal = unit(subtract(inner, scale(p, dot(inner, p) / dot(p, p))))
    else:
        normal = unit(cross(p, q))
    put(wall, w, 0, normal)
    wall[w, SLACK] = slack
    return w + 1


@njit(bare=True)
def strip_pieces(primitives: Floats, arc: Arc, size: float) -> int:
    """Return into how many pieces the strip of an arc must be cut."""
    i, j, begin, end = arc
    furthest = 0.0
    for side in range(2):
        m = i if side == 0 else j
        radius = primitives[m, RADIUS]
        if radius > 0.0:
            chord = length(
                subtract(support_contact(primitives, m, begin), support_contact(primitives, m, end))
            )
            furthest = max(furthest, chord * chord / (8.0 * radius))
    if furthest <= MOST_LOST * size:
        return 1 if furthest > 1e-9 * size else 0
    return min(MOST_PIECES, 1 + int(math.sqrt(furthest / (MOST_LOST * size))))


@njit(inline=True, bare=True)
def _beyond_rim(primitives: Floats, m: int, p: Vector, before: Vector, after: Vector) -> Vector:
    """Return where the tangents of a rim at `before` and `after` meet, beyond a point p."""
    centre = row(primitives, m)
    radius = primitives[m, RADIUS]
    half = max(length(subtract(p, before)), length(subtract(after, p))) / radius
    # The chord of half the piece has the half angle 2 asin(half / 2).
    cosine = 1.0 - 0.5 * half * half
    arm = subtract(p, centre)
    grown = 1.0 / max(cosine, 0.5)
    return centre[0] + grown * arm[0], centre[1] + grown * arm[1], centre[2] + grown * arm[2]


@njit(bare=True)
def side_point(
    primitives: Floats, m: int, opposite: int, begin: Vector, here: Vector, end: Vector
) -> Vector:
    """Return a corner of the strip's outline on the rim of m, at the normal `here` of a piece.

    `begin` and `end` are the normals of the piece; `opposite` carries on the other side.
    """
    p = support_contact(primitives, m, here)
    if primitives[m, RADIUS] <= 0.0:
        return p
    before, after = support_contact(primitives, m, begin), support_contact(primitives, m, end)
    chord = cross(before, after)
    across = support_contact(primitives, opposite, here)
    if dot(chord, p) * dot(chord, across) <= 0.0:
        return p
    return _beyond_rim(primitives, m, p, before, after)


@njit(bare=True)
def add_strip(
    region: Region,
    primitives: Floats,
    arc: Arc,
    strip: tuple[float, float, float, float],
    size: float,
    outline: Floats,
) -> int:
    """Append the tiles of the strip that the contacts of an arc sweep.

    `strip`: the part [low, high] of the segment between the contacts that counts, and by which sine
    the tiles may be left on the side of i and on that of j.  `outline` (MOST_PIECES + 2, 6)
    receives the points of both sides; returns how many there are of each.
    """
    tally, tile, wall = region.tally, region.tile, region.wall
    i, j, begin, end = arc
    low, high, near_slack, far_slack = strip
    pieces = strip_pieces(primitives, arc, size)
    before = begin
    put(outline, 0, 0, support_contact(primitives, i, begin))
    put(outline, 0, 3, support_contact(primitives, j, begin))
    for k in range(pieces):
        here = arc_normal(primitives, arc, (k + 0.5) / pieces)
        after = end if k + 1 == pieces else arc_normal(primitives, arc, (k + 1.0) / pieces)
        put(outline, k + 1, 0, side_point(primitives, i, j, before, here, after))
        put(outline, k + 1, 3, side_point(primitives, j, i, before, here, after))
        before = after
    put(outline, pieces + 1, 0, support_contact(primitives, i, end))
    put(outline, pieces + 1, 3, support_contact(primitives, j, end))
    for k in range(pieces + 2):
        p, q = row(outline, k), (outline[k, 3], outline[k, 4], outline[k, 5])
        put(outline, k, 0, between(p, q, low))
        put(outline, k, 3, between(p, q, high))
    w = tile[tally[TILES]]
    for k in range(pieces + 1):
        if tally[TILES] + 1 >= tile.shape[0] or w + 4 > wall.shape[0]:
            break
        p, q = row(outline, k), (outline[k, 3], outline[k, 4], outline[k, 5])
        r, s = row(outline, k + 1), (outline[k + 1, 3], outline[k + 1, 4], outline[k + 1, 5])
        w = add_wall(wall, w, q, p, r, ROUNDING)
        w = add_wall(wall, w, p, r, q, near_slack)
        w = add_wall(wall, w, r, s, p, ROUNDING)
        w = add_wall(wall, w, s, q, p, far_slack)
        tally[TILES] += 1
        tile[tally[TILES]] = w
    return pieces + 2
