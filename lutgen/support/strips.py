"""The strips of all gaps: their tiles, and those of their sides beyond which nothing holds.

Owns the question where one strip's side is another's.  Wheels on one line carry in pairs, so two
strips may run along one rim, one on each side of it; they begin and end at different places, and
where both hold their common side is no boundary.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support.arc import Arc, angle_between, arc_normal
from lutgen.support.gaps import HIGH, LOW
from lutgen.support.primitive import DISC, KIND, RADIUS, support_contact
from lutgen.support.region import Region
from lutgen.support.table import CUTS, NEIGHBOUR, VERTEX, Hull, Workspace, corner_after
from lutgen.support.tiles import MOST_LOST, add_segment, add_strip, between
from lutgen.vector import Floats, Vector, cross, dot, length, row, subtract, unit

# Part of its distance from the com from which on a side of a strip is boundary.
SHORTEST = 1e-5


class Strips(NamedTuple):
    """The strips of a posture's gaps: what two contacts sweep while the robot rolls over them.

    `hull` and `primitives` (n, 8), rows of `primitive.pack`; `gap` (E, 2): which part of each edge
    of the hull holds, see `gaps.find_gaps`; `edges` (2 S,): of each strip the facet that its edge
    belongs to and the corner where the edge begins.
    """

    hull: Hull
    primitives: NDArray[np.float64]
    gap: NDArray[np.float64]
    edges: NDArray[np.int64]


@njit(inline=True, bare=True)
def _arc_of(hull: Hull, f: int, at: int) -> Arc:
    """Return the arc over the edge of facet f that begins at corner `at`."""
    i, j = hull.link[at, VERTEX], hull.link[corner_after(hull.span, f, at), VERTEX]
    return Arc(i, j, row(hull.facet, f), row(hull.facet, hull.link[at, NEIGHBOUR]))


@njit(inline=True, bare=True)
def _ahead(primitives: Floats, m: int, normal: Vector, reference: Vector) -> float:
    """Return how far (sine) the contact of disc m is ahead of a direction on its rim."""
    axle = (primitives[m, 3], primitives[m, 4], primitives[m, 5])
    arm = subtract(support_contact(primitives, m, normal), row(primitives, m))
    return float(dot(cross(reference, arm), axle) / primitives[m, RADIUS])


@njit(inline=True, bare=True)
def _side(primitives: Floats, m: int, opposite: int, normal: Vector) -> float:
    """Return on which side of disc m its strip with another primitive lies: -1 or 1."""
    axle = (primitives[m, 3], primitives[m, 4], primitives[m, 5])
    away = subtract(
        support_contact(primitives, opposite, normal), support_contact(primitives, m, normal)
    )
    return math.copysign(1.0, dot(axle, away))


@njit(bare=True)
def _fraction_at(primitives: Floats, arc: Arc, m: int, reference: Vector) -> float:
    """Return the fraction of an arc at which the contact of disc m has a direction on its rim.

    Outside (0, 1) where it never has.
    """
    low, high = 0.0, 1.0
    under = _ahead(primitives, m, arc.begin, reference)
    over = _ahead(primitives, m, arc.end, reference)
    if under * over >= 0.0:
        return -1.0
    part = 0.0
    for _ in range(60):
        part = low - under * (high - low) / (over - under)
        value = _ahead(primitives, m, arc_normal(primitives, arc, part), reference)
        if abs(value) < 1e-13 or high - low < 1e-14:
            break
        # Illinois: the end that stays counts half.
        if (value > 0.0) == (over > 0.0):
            high, over = part, value
            under *= 0.5
        else:
            low, under = part, value
            over *= 0.5
    return part


@njit(inline=True, bare=True)
def _free_side(gap: Floats, at: int, end: int) -> bool:
    """Tell whether a gap reaches to the rim at this end of its edge."""
    return bool(gap[at, HIGH] == 1.0) if end == 1 else bool(gap[at, LOW] == 0.0)


@njit(bare=True)
def _covered(
    strips: Strips, own: int, m: int, opposite: int, normal: Vector, rock_angle: float
) -> bool:
    """Tell whether a strip on the other side of disc m holds where the contact is at `normal`."""
    hull, primitives, gap, edges = strips
    if primitives[m, KIND] != DISC:
        return False
    reference = unit(subtract(support_contact(primitives, m, normal), row(primitives, m)))
    side = _side(primitives, m, opposite, normal)
    for s in range(edges.shape[0] // 2):
        at = edges[2 * s + 1]
        arc = _arc_of(hull, edges[2 * s], at)
        i, j = arc.i, arc.j
        if s == own or m not in (i, j) or not _free_side(gap, at, 0 if m == i else 1):
            continue
        fraction = _fraction_at(primitives, arc, m, reference)
        if not 0.0 <= fraction <= 1.0:
            continue
        there = arc_normal(primitives, arc, fraction)
        if (
            _side(primitives, m, j if m == i else i, there) != side
            and angle_between(there, normal) <= rock_angle
        ):
            return True
    return False


@njit(inline=True, bare=True)
def _is_long(p: Vector, q: Vector) -> bool:
    """Tell whether a side is longer than noise makes it where contacts lie inside the region.

    A shorter one that is boundary lies between two others that are.
    """
    apart = subtract(q, p)
    return bool(dot(apart, apart) > SHORTEST * SHORTEST * dot(p, p))


@njit(bare=True)
def add_strips(
    region: Region, strips: Strips, rock_angle: float, size: float, work: Workspace
) -> None:
    """Append the tiles of all gaps, and those sides of them beyond which nothing holds."""
    hull, primitives, gap, edges = strips
    span, link = hull.span, hull.link
    outline, cut = work.side, work.begin[0]
    count = edges.shape[0] // 2
    for s in range(count):
        at = edges[2 * s + 1]
        arc = _arc_of(hull, edges[2 * s], at)
        i, j, begin, end = arc
        low, high = gap[at, LOW], gap[at, HIGH]
        cuts = 0
        for t in range(count):
            g, edge = edges[2 * t], edges[2 * t + 1]
            pair = (link[edge, VERTEX], link[corner_after(span, g, edge), VERTEX])
            for m in (i, j):
                if t == s or m not in pair or primitives[m, KIND] != DISC:
                    continue
                for which in range(2):
                    normal = row(hull.facet, g if which == 0 else link[edge, NEIGHBOUR])
                    rim = unit(subtract(support_contact(primitives, m, normal), row(primitives, m)))
                    there = _fraction_at(primitives, arc, m, rim)
                    if 1e-9 < there < 1.0 - 1e-9 and cuts < CUTS:
                        place = cuts
                        while place > 0 and cut[place - 1] > there:
                            cut[place] = cut[place - 1]
                            place -= 1
                        cut[place] = there
                        cuts += 1
        cut[cuts] = 1.0
        start, before = begin, 0.0
        for c in range(cuts + 1):
            if cut[c] - before < 1e-9:
                continue
            stop = end if c == cuts else arc_normal(primitives, arc, cut[c])
            half = arc_normal(primitives, arc, 0.5 * (before + cut[c]))
            goes_on_i = low == 0.0 and _covered(strips, s, i, j, half, rock_angle)
            goes_on_j = high == 1.0 and _covered(strips, s, j, i, half, rock_angle)
            least = min(
                length(support_contact(primitives, i, half)),
                length(support_contact(primitives, j, half)),
            )
            slack = 2.5 * MOST_LOST * size / least
            strip = (low, high, slack if goes_on_i else 0.0, slack if goes_on_j else 0.0)
            points = add_strip(region, primitives, Arc(i, j, start, stop), strip, size, outline)
            for k in range(points - 1):
                p, q = row(outline, k), (outline[k, 3], outline[k, 4], outline[k, 5])
                r = row(outline, k + 1)
                z = (outline[k + 1, 3], outline[k + 1, 4], outline[k + 1, 5])
                if not goes_on_i and _is_long(p, r):
                    add_segment(region, p, r, between(q, z, 0.5), i, i)
                if not goes_on_j and _is_long(q, z):
                    add_segment(region, q, z, between(p, r, 0.5), j, j)
            start, before = stop, cut[c]
