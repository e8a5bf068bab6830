"""Channels of one posture under one direction of gravity, in float64: their definitions.

`rows` computes the same numbers for a sweep.  All directions are unit vectors in the body frame,
pointing down.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels.angles import JUST_OUTSIDE, tip_angle
from lutgen.channels.energy import axis_energy, energy_margin, segment_energy
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.quantities import CHANNELS, wanted
from lutgen.support import ACCEPTED, ARCS, CONVEX, TIPS, Acceptance, Region, cone_of
from lutgen.vector import (
    Bools,
    Floats,
    Vector,
    along,
    cross,
    dot,
    length,
    read3,
    subtract,
)

SDG, HEIGHT, TIP, MARGIN, ENERGY, SHARE, FACET, STATUS = range(len(CHANNELS))


class Setting(NamedTuple):
    """Settings that all postures of a measurement share: acceptance, and the wanted channels.

    `groups` (n,) are those of `shares.least_share`.
    """

    acceptance: Acceptance
    wanted: NDArray[np.bool_]
    groups: NDArray[np.int64] = np.empty(0, np.int64)


@njit(inline=True)
def axis_margin(start: Vector, stop: Vector, wall: Vector, convex: bool, g: Vector) -> float:
    """Return the horizontal distance from the com to one tip-over axis, positive on its inner side.

    Everything is projected along g.  In a convex region the axis counts as a whole line (McGhee
    and Frank); otherwise as the segment that it is, and the distance is not signed.
    """
    edge = subtract(stop, start)
    across = length(cross(edge, g))
    flat_start = along(start, g, -dot(start, g))
    if across <= 1e-12 * length(edge):
        side = -1.0 if convex else math.copysign(1.0, dot(wall, g))
        return side * length(flat_start)
    if convex:
        return math.copysign(abs(dot(cross(start, stop), g)) / across, dot(wall, g))
    flat_edge = along(edge, g, -dot(edge, g))
    part = -dot(flat_start, flat_edge) / (across * across)
    return length(along(flat_start, flat_edge, min(max(part, 0.0), 1.0)))


@njit(bare=True)
def _margins(
    region: Region, seat: int, standing: bool, g: Vector, wants_energy: bool
) -> tuple[float, float]:
    """Return `margin` and `energy_margin` of a robot that stands on a seat, or tips."""
    count = region.counts
    if count[ACCEPTED] == 0:
        return -math.inf, -math.inf
    convex = count[CONVEX] == 1
    margin = energy = math.inf
    for b in range(count[ARCS]):
        arc = region.arc[b]
        start, stop, wall = read3(arc.start), read3(arc.stop), read3(arc.wall)
        margin = min(margin, axis_margin(start, stop, wall, convex, g))
        if wants_energy:
            rise = axis_energy(start, stop, wall, g) if convex else segment_energy(start, stop, g)
            energy = min(energy, rise)
    if standing:
        if wants_energy and count[ARCS] > 0:
            energy = energy_margin(region, seat, g, energy)
        return max(margin, 0.0), max(energy, 0.0)
    if not convex:
        margin, energy = -margin, -energy
    return min(margin, JUST_OUTSIDE), min(energy, JUST_OUTSIDE)


@njit(bare=True)
def measure(region: Region, g: Vector, wanted: Bools, out: Floats) -> None:
    """Fill `out` with the channels of one direction, in the order of `CHANNELS`.

    `wanted` (bool) skips the costly ones, and `least_share` is left to `shares`.  Outside the
    standing region `sdg` and `height` are NaN, `facet` is -1, `status` is TIPS and the others are
    negative.
    """
    k = cone_of(region, g)
    out[SDG] = out[HEIGHT] = math.nan
    out[FACET], out[STATUS] = -1.0, TIPS
    place = -1
    if k >= 0:
        place = region.cone[k].seat
        seat = region.seat[place]
        one, two = dot(read3(seat.axes[0]), g), dot(read3(seat.axes[1]), g)
        out[SDG] = math.sqrt(one * one + two * two) / dot(read3(seat.plane), g)
        out[HEIGHT] = seat.height
        out[FACET], out[STATUS] = place, region.cone[k].status
    if wanted[TIP]:
        out[TIP] = tip_angle(region, k >= 0, g)
    if wanted[MARGIN] or wanted[ENERGY]:
        out[MARGIN], out[ENERGY] = _margins(region, place, k >= 0, g, wanted[ENERGY])


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
