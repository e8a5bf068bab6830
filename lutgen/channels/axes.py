"""Tip-over axes of one posture under a wrench: what a force and an uncertain com do to each.

Let g be the unit gravity direction and, over the weight W, phi the sum of the forces and mu their
moment about the com.  The moment of weight and forces about the axis from p to q is, over
W |p x q| / |q - p|,

    L(g) = m . (g + phi) + (q - p) . mu / |p x q|,    m = unit(p x q),

which is m . g + o with a constant o: a small circle on the sphere of g.  A com delta away adds
e . (delta x g) / d, e the axis's unit vector and d its distance from the com.  For all deltas
within rho the plane of the axis turns inward by beta, sin(beta) = rho / d (exact without a force),
and o counts over d + rho where it helps and over d - rho where it hurts (a bound from below).
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Vector
from lutgen.jit import njit
from lutgen.support import REGION, Region, ends_of, record, rests_at
from lutgen.vector import add, along, cross, dot, length, read3, scale, subtract, unit, write3

# Forces and their moment about the com, over the weight, and the radius of the com's ball.
WRENCH = record("phi mu", "rho", "")
# A row of WRENCH.
Wrench = Any
# An offset of 1 or more never lets the robot tip over that axis, -1 or less always.
NEVER, ALWAYS = 1.0, -1.0
# How far the zero-moment point may be beyond an edge that two rests share (sine).
SHARED = 1e-12

# m; e; unit vector from the com towards the axis; d; the moment's part of L; o; sine and cosine of
# beta; o with the uncertainty's bound; least distance of the segment from the com; and, without a
# moment, the directions under which the resultant goes through its ends, NaN for none.
VECTORS, NUMBERS = "normal along towards", "distance moment offset sine cosine bound nearest"
AXIS = record(VECTORS, NUMBERS, "", ("ends", "f8", (4, 3)))


class Axes(NamedTuple):
    """Edges of facets and arcs of the boundary of a posture under its wrench, rows of AXIS."""

    edge: NDArray[np.void]
    arc: NDArray[np.void]


def empty_axes() -> Axes:
    """Return arrays large enough for any region."""
    edge, arc = (REGION[name].shape[0] for name in ("edge", "arc"))
    return Axes(np.empty(edge, AXIS), np.empty(arc, AXIS))


@njit()
def corner_direction(point: Vector, phi: Vector, sign: float) -> Vector:
    """Return the unit g with g + phi = s point and s > 0, or NaN.

    There are two where the force is larger than the weight; `sign` chooses.
    """
    square = dot(point, point)
    ahead = dot(point, phi)
    root = ahead * ahead - square * (dot(phi, phi) - 1.0)
    if not (root >= 0.0 and square > 0.0):
        return math.nan, math.nan, math.nan
    s = (ahead + sign * math.sqrt(root)) / square
    if not s > 0.0:
        return math.nan, math.nan, math.nan
    return unit(subtract(scale(point, s), phi))


@njit(bare=True)
def moment_about(ends: tuple[Vector, Vector], mu: Vector) -> float:
    """Return the part of L that a moment has about the axis between two contact points."""
    start, side = ends[0], unit(subtract(ends[1], ends[0]))
    d = length(along(start, side, -dot(start, side)))
    return dot(side, mu) / d if d > 0.0 else 0.0


@njit(bare=True)
def _enter(axes: NDArray[np.void], at: int, ends: tuple[Vector, Vector], wrench: Wrench) -> None:
    """Fill row `at` with the axis between two contact points; its normal is filled already."""
    start, stop = ends
    axis = axes[at]
    normal, phi, mu, rho = read3(axis.normal), read3(wrench.phi), read3(wrench.mu), wrench.rho
    side = unit(subtract(stop, start))
    foot = along(start, side, -dot(start, side))
    d, moment = length(foot), moment_about(ends, mu)
    offset = dot(normal, phi) + moment
    sine = min(rho / d, 1.0) if d > 0.0 else 1.0
    write3(axis.along, side)
    write3(axis.towards, unit(foot))
    axis.distance, axis.moment, axis.offset = d, moment, offset
    axis.sine, axis.cosine, axis.bound = sine, math.sqrt(1.0 - sine * sine), offset
    if rho > 0.0:
        # The least o d / |a - delta|: the axis is between d - rho and d + rho away.
        axis.bound = offset * d / (d + rho)
        if offset < 0.0:
            axis.bound = offset * d / (d - rho) if d > rho else ALWAYS
    inside = dot(start, side) <= 0.0 <= dot(stop, side)
    axis.nearest = d if inside else min(length(start), length(stop))
    for root in range(4):
        point, sign = start if root < 2 else stop, 1.0 if root % 2 == 0 else -1.0
        write3(axis.ends[root], corner_direction(point, phi, sign))


@njit(bare=True)
def find_axes(region: Region, wrench: Wrench, axes: Axes) -> None:
    """Fill `axes` from the region and the wrench of one posture."""
    for e in range(region.counts.edges):
        write3(axes.edge[e].normal, read3(region.edge[e].wall))
        _enter(axes.edge, e, ends_of(region, e), wrench)
    for b in range(region.counts.arcs):
        arc = region.arc[b]
        write3(axes.arc[b].normal, read3(arc.wall))
        _enter(axes.arc, b, (read3(arc.start), read3(arc.stop)), wrench)


@njit(bare=True)
def lowest_lever(region: Region, k: int, force: Vector, mu: Vector) -> float:
    """Return how far a resultant is inside the nearest side of seat k, negative outside.

    Without forces it is the sine of the angle from gravity to that side.  A side that two rests
    share is let go of by `SHARED`.
    """
    lowest = 1.0
    facet = region.facet[region.seat[k].facet]
    for e in range(facet.first, facet.first + facet.count):
        lever = dot(read3(region.edge[e].wall), force) + moment_about(ends_of(region, e), mu)
        if rests_at(region, e)[1] >= 0 and lever > -SHARED:
            lever = max(lever, 0.0)
        lowest = min(lowest, lever)
    return lowest


@njit()
def zero_moment_point(plane: Vector, force: Vector, mu: Vector) -> Vector:
    """Return D - com = (h F + n x mu) / (n . F) on a facet's plane, `plane` = n / h.

    F = g + phi.  About D the moment of weight and forces has no part in the plane.
    """
    return scale(add(force, cross(plane, mu)), 1.0 / dot(plane, force))
