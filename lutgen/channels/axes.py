"""Tip-over axes of one posture under a wrench: what a force and an uncertain com do to each.

Owns the functionals.  Let g be the unit gravity direction and, over the weight W, phi the sum of
the forces and mu their moment about the com.  The moment of weight and forces about the axis from p
to q is, over W |p x q| / |q - p|,

    L(g) = m . (g + phi) + (q - p) . mu / |p x q|,    m = unit(p x q),

which is m . g + o with a constant o: a small circle on the sphere of g.  A com delta away adds
e . (delta x g) / d, e the axis's unit vector and d its distance from the com.  For all deltas
within rho the plane of the axis turns inward by beta, sin(beta) = rho / d (exact without a force),
and o counts over d + rho where it helps and over d - rho where it hurts (a bound from below).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.jit import njit
from lutgen.support import (
    STANDS,
    Region,
    across,
    edge_plane_at,
    edges_at,
    facets_in,
    is_rest_at,
    is_shared,
    plane_at,
    point_at,
    segments_in,
    start_at,
    status_of,
    stop_at,
    tip_plane_at,
)
from lutgen.vector import Floats, Vector, cross, dot, length, scale, subtract, unit

# First columns of a wrench: phi, mu, rho.
PHI, MU, RHO = 0, 3, 6
# First columns of the rows of Axes.
NORMAL, ALONG, TOWARDS, DISTANCE, MOMENT, OFFSET = 0, 3, 6, 9, 10, 11
SINE, COSINE, BOUND, NEAREST = 12, 13, 14, 15
# An offset of 1 or more never lets the robot tip over that axis, -1 or less always.
NEVER, ALWAYS = 1.0, -1.0


class Axes(NamedTuple):
    """Edges of facets and boundary of a posture's standing region under its wrench.

    `edge_plane` (E, 16) per edge of a facet and `axis` (B, 16) per boundary segment: m; e; unit
    vector from the com towards the axis; d; the moment's part of L; o; sine and cosine of beta; o
    with the uncertainty's bound; least distance of the segment from the com.
    `ends` (B, 4, 3): without a moment, the directions g under which the resultant goes through the
    ends of a segment; NaN for none.
    """

    edge_plane: NDArray[np.float64]
    axis: NDArray[np.float64]
    ends: NDArray[np.float64]


@njit()
def empty_axes(region: Region) -> Axes:
    """Return arrays large enough for the region."""
    segments = region.segment.shape[0]
    return Axes(
        np.zeros((region.edge.shape[0], 16)),
        np.empty((segments, 16)),
        np.empty((segments, 4, 3)),
    )


@njit(inline=True)
def add(a: Vector, b: Vector) -> Vector:
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit(inline=True)
def part(wrench: Floats, column: int) -> Vector:
    """Return phi or mu of a wrench."""
    return wrench[column], wrench[column + 1], wrench[column + 2]


@njit()
def corner_direction(point: Vector, phi: Vector, sign: float) -> Vector:
    """Return the unit g with g + phi = s point and s > 0, or NaN.

    There are two where the force is larger than the weight; `sign` chooses.
    """
    square = dot(point, point)
    along = dot(point, phi)
    root = along * along - square * (dot(phi, phi) - 1.0)
    if not (root >= 0.0 and square > 0.0):
        return math.nan, math.nan, math.nan
    s = (along + sign * math.sqrt(root)) / square
    if not s > 0.0:
        return math.nan, math.nan, math.nan
    return unit(subtract(scale(point, s), phi))


@njit()
def _enter(start: Vector, stop: Vector, normal: Vector, wrench: Floats, out: Floats) -> None:
    """Fill the row of the axis from start to stop, whose plane has the inward unit `normal`."""
    mu, rho = part(wrench, MU), wrench[RHO]
    along = unit(subtract(stop, start))
    foot = subtract(start, scale(along, dot(start, along)))
    d = length(foot)
    moment = dot(along, mu) / d if d > 0.0 else 0.0
    offset = dot(normal, part(wrench, PHI)) + moment
    sine = min(rho / d, 1.0) if d > 0.0 else 1.0
    out[NORMAL], out[NORMAL + 1], out[NORMAL + 2] = normal
    out[ALONG], out[ALONG + 1], out[ALONG + 2] = along
    out[TOWARDS], out[TOWARDS + 1], out[TOWARDS + 2] = unit(foot)
    out[DISTANCE], out[MOMENT], out[OFFSET] = d, moment, offset
    out[SINE], out[COSINE] = sine, math.sqrt(1.0 - sine * sine)
    out[BOUND] = offset
    if rho > 0.0:
        # The least o d / |a - delta|: the axis is between d - rho and d + rho away.
        out[BOUND] = offset * d / (d + rho)
        if offset < 0.0:
            out[BOUND] = offset * d / (d - rho) if d > rho else ALWAYS
    between = dot(start, along) <= 0.0 <= dot(stop, along)
    out[NEAREST] = d if between else min(length(start), length(stop))


@njit()
def enter_edge_planes(region: Region, wrench: Floats, edge_plane: Floats) -> None:
    """Fill the rows of the edges of the facets."""
    for k in range(facets_in(region.tally)):
        begin, end = edges_at(region.span, k)
        for e in range(begin, end):
            p = point_at(region.edge, e)
            q = point_at(region.edge, e + 1 if e + 1 < end else begin)
            _enter(p, q, edge_plane_at(region.edge, e), wrench, edge_plane[e])


@njit()
def find_axes(region: Region, wrench: Floats, axes: Axes) -> None:
    """Fill `axes` from the region and the wrench (7,) of one posture."""
    enter_edge_planes(region, wrench, axes.edge_plane)
    for b in range(segments_in(region.tally)):
        start, stop = start_at(region.segment, b), stop_at(region.segment, b)
        _enter(start, stop, tip_plane_at(region.segment, b), wrench, axes.axis[b])
        for root in range(4):
            point = start if root < 2 else stop
            g = corner_direction(point, part(wrench, PHI), 1.0 if root % 2 == 0 else -1.0)
            axes.ends[b, root, 0], axes.ends[b, root, 1], axes.ends[b, root, 2] = g


@njit()
def rest(region: Region, edge_plane: Floats, force: Vector, first: int) -> tuple[int, int]:
    """Return the facet on which the robot comes to rest under a resultant, and its status.

    Begins on facet `first`.  L of its edges tells where the zero-moment point is: beyond an edge
    that another rest shares, that one is next, for which L of the edge is the opposite; beyond any
    other edge the robot rocks if the force points into a tile, and tips if not.  Going round
    a corner for ever, which only a twist makes possible, is no tipping.  Tiles do without the
    moment: with one the verdict is not this one.
    """
    k = first
    edge, link = region.edge, region.link
    for _ in range(facets_in(region.tally) + 1):
        beyond = -1
        outside = not is_rest_at(region.span, k)
        for e in range(*edges_at(region.span, k)):
            lever = dot(edge_plane_at(edge, e), force) + edge_plane[e, MOMENT]
            if is_shared(link, e):
                if lever < -1e-12:
                    beyond = across(link, e)
            elif lever < 0.0:
                outside = True
        if outside:
            return k, status_of(region, k, force)
        if beyond < 0:
            return k, STANDS
        k = beyond
    return first, STANDS


@njit()
def pierced_first(region: Region, force: Vector, mu: Vector) -> int:
    """Return the accepted facet whose plane the resultant's central line leaves first, or -1.

    The line has the direction of the force and goes through (force x mu) / |force|^2.
    """
    square = dot(force, force)
    best = -1
    nearest = math.inf
    if square < 1e-24:
        return best
    through = scale(cross(force, mu), 1.0 / square)
    for k in range(facets_in(region.tally)):
        plane = plane_at(region.facet, k)
        rate = dot(plane, force)
        if rate > 0.0:
            reach = (1.0 - dot(plane, through)) / rate
            if reach < nearest - 1e-12 * abs(nearest) or best < 0:
                best, nearest = k, reach
    return best


@njit()
def zero_moment_point(plane: Vector, force: Vector, mu: Vector) -> Vector:
    """Return D - com = (h F + n x mu) / (n . F) on a facet's plane, `plane` = n / h.

    F = g + phi.  About D the moment of weight and forces has no part in the plane.
    """
    return scale(add(force, cross(plane, mu)), 1.0 / dot(plane, force))
