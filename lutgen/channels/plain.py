"""Stability of one posture under one gravity direction.

Owns the definitions of the channels in float64; `scan` computes the same numbers in rows for
a sweep.  All directions are unit vectors in the body frame, pointing down.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels.angles import JUST_OUTSIDE, tip_angle
from lutgen.channels.barrier import LABELS, barrier
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.quantities import CHANNELS, wanted
from lutgen.support import (
    ON_AXIS,
    STANDS,
    TIPS,
    Acceptance,
    FacetTable,
    Region,
    Ridges,
    empty_ridges,
    facets_in,
    find_ridges,
    first_axis_at,
    has_ridges,
    height_at,
    is_convex,
    plane_at,
    second_axis_at,
    segments_in,
    start_at,
    status_of,
    stop_at,
    supporting_facet,
    tip_plane_at,
)
from lutgen.vector import Bools, Floats, Vector, cross, dot, length, scale, subtract

ENERGY = CHANNELS.index("energy_margin")
# Rows of a measurement after those of the channels: how |SD_g| goes on beyond the standing region.
ALONG, ASIDE, HEIGHT_BEYOND = len(CHANNELS), len(CHANNELS) + 1, len(CHANNELS) + 2


class Setting(NamedTuple):
    """What every posture of a measurement shares: which facets count, and channels asked for."""

    acceptance: Acceptance
    wanted: NDArray[np.bool_]


@njit(inline=True)
def axis_margin(start: Vector, stop: Vector, tip_plane: Vector, convex: bool, g: Vector) -> float:
    """Return the horizontal distance from the com to one tip-over axis, positive on its inner side.

    Everything is projected along g.  In a convex region the axis counts as a whole line (McGhee
    and Frank); otherwise as the segment that it is, and the distance is not signed.
    """
    edge = subtract(stop, start)
    across = length(cross(edge, g))
    lever = dot(cross(start, stop), g)
    sign = math.copysign(1.0, dot(tip_plane, g))
    flat_start = subtract(start, scale(g, dot(start, g)))
    if across <= 1e-12 * length(edge):
        return sign * length(flat_start) if not convex else -length(flat_start)
    distance = abs(lever) / across
    if convex:
        return sign * distance
    flat_edge = subtract(edge, scale(g, dot(edge, g)))
    part = -dot(flat_start, flat_edge) / (across * across)
    part = min(max(part, 0.0), 1.0)
    return length(
        (
            flat_start[0] + part * flat_edge[0],
            flat_start[1] + part * flat_edge[1],
            flat_start[2] + part * flat_edge[2],
        )
    )


@njit(inline=True)
def axis_energy(start: Vector, stop: Vector, tip_plane: Vector, g: Vector) -> float:
    """Return how far the com rises while the robot turns over one axis; negative once past it.

    The com turns on a circle of radius rho about the axis; with U the part of `up` orthogonal to
    the axis the rise is rho |U| - R . U (Messuri and Klein; Hirose), R from the axis to the com.
    """
    edge = subtract(stop, start)
    edge = scale(edge, 1.0 / length(edge))
    arm = subtract(scale(edge, dot(start, edge)), start)
    up = subtract(scale(edge, dot(g, edge)), g)
    top = length(arm) * length(up)
    now = dot(arm, up)
    aside = dot(cross(edge, arm), up)
    # Where the com is nearly above the axis top and now are nearly equal: divide instead.
    rise = aside * aside / (top + now) if now > 0.0 else top - now
    return math.copysign(rise, dot(tip_plane, g))


@njit()
def room_for_ridges(primitives: int, wanted: Bools) -> Ridges:
    """Return room for the ridges of so many primitives, or for none where nobody asks for them."""
    return empty_ridges(primitives, LABELS) if wanted[ENERGY] else empty_ridges(0, 0)


@njit()
def find_wanted_ridges(
    ridges: Ridges, table: FacetTable, region: Region, primitives: Floats, wanted: Bools
) -> None:
    """Fill `ridges` where the energy margin is wanted and is not that of one facet alone."""
    if wanted[ENERGY] and has_ridges(region.tally):
        find_ridges(ridges, table, region, primitives)


@njit(bare=True)
def least_barrier(region: Region, ridges: Ridges, k: int, g: Vector, nearest: float) -> float:
    """Return the energy margin of a robot that stands on facet k.

    `nearest`: the least rise over a line of the boundary.  It is the answer where there is one
    facet only, and where no way over edges ends.
    """
    if not has_ridges(region.tally):
        return nearest
    least = barrier(region, ridges, k, g)
    return least if least < math.inf else nearest


@njit()
def measure(region: Region, ridges: Ridges, g: Vector, wanted: Bools, out: Floats) -> None:
    """Fill `out` with the channels of one direction, in the order of `CHANNELS`.

    `ridges` are as `find_wanted_ridges` leaves them.  `wanted` (bool) skips the costly ones.
    Outside the standing region `sdg` and `height` are NaN, `facet` is -1, `status` is TIPS and the
    others are negative.
    """
    count, facet, segment = region.tally, region.facet, region.segment
    k = supporting_facet(facet, facets_in(count), g)
    convex = is_convex(count)
    if convex:
        standing = k >= 0
        for b in range(segments_in(count)):
            standing = standing and dot(tip_plane_at(segment, b), g) >= -ON_AXIS
        # A region with gaps or stages never counts as convex: here all that stands is on rests.
        status = STANDS if standing else TIPS
    else:
        status = status_of(region, k, g)
        standing = status != TIPS
    out[0] = out[1] = math.nan
    out[5] = -1.0
    out[6] = status
    if standing:
        along = dot(first_axis_at(facet, k), g)
        aside = dot(second_axis_at(facet, k), g)
        out[0] = math.sqrt(along * along + aside * aside) / dot(plane_at(facet, k), g)
        out[1] = height_at(facet, k)
        out[5] = k
    if wanted[2]:
        out[2] = tip_angle(count, segment, standing, g)
    if wanted[3] or wanted[4]:
        margin = energy = math.inf
        for b in range(segments_in(count)):
            start, stop = start_at(segment, b), stop_at(segment, b)
            tip_plane = tip_plane_at(segment, b)
            margin = min(margin, axis_margin(start, stop, tip_plane, convex, g))
            rise = axis_energy(start, stop, tip_plane, g)
            energy = min(energy, rise if convex else abs(rise))
        if facets_in(count) == 0:
            margin = energy = -math.inf
        elif standing:
            if wanted[ENERGY]:
                energy = least_barrier(region, ridges, k, g, energy)
            margin, energy = max(margin, 0.0), max(energy, 0.0)
        else:
            if not convex:
                margin, energy = -margin, -energy
            margin, energy = min(margin, JUST_OUTSIDE), min(energy, JUST_OUTSIDE)
        out[3] = margin
        out[4] = energy


@njit()
def go_beyond(region: Region, force: Vector, known: bool, out: Floats) -> None:
    """Fill `out` from ALONG on: the components of D_g - s and the height, inside or outside.

    NaN where they are not `known`, and where the force (the direction of gravity without others)
    leaves through no accepted facet's plane.
    """
    out[ALONG] = out[ASIDE] = out[HEIGHT_BEYOND] = math.nan
    k = supporting_facet(region.facet, facets_in(region.tally), force)
    if k >= 0 and known:
        reach = 1.0 / dot(plane_at(region.facet, k), force)
        out[ALONG] = dot(first_axis_at(region.facet, k), force) * reach
        out[ASIDE] = dot(second_axis_at(region.facet, k), force) * reach
        out[HEIGHT_BEYOND] = height_at(region.facet, k)


def checked_directions(gravity_dir: ArrayLike) -> NDArray[np.float64]:
    """Return (g, 3) unit directions; refuse other shapes, zero length, NaN and infinity."""
    directions = np.asarray(gravity_dir, dtype=np.float64)
    if directions.ndim == 1:
        directions = directions[None, :]
    if directions.ndim != 2 or directions.shape[1] != 3:
        raise InputError(
            f"gravity_dir must have the shape (g, 3) (got {np.shape(gravity_dir)}); "
            "give one row x, y, z per direction"
        )
    return np.ascontiguousarray(unit_directions(directions))


def wanted_channels(channels: Sequence[str]) -> NDArray[np.bool_]:
    """Return the mask over `CHANNELS`; refuse an unknown name."""
    return np.array(wanted(channels))
