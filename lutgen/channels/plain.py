"""Stability of one posture under one gravity direction, and over many of both.

Owns the definitions of the six channels in float64; `scan` computes the same numbers in rows for
a sweep.  All directions are unit vectors in the body frame, pointing down.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import few_threads, njit, prange
from lutgen.support import (
    CONVEX,
    FACETS,
    FIRST_AXIS,
    HEIGHT,
    MAX_PRIMITIVES,
    PLANE,
    SECOND_AXIS,
    SEGMENTS,
    START,
    STOP,
    TIP_PLANE,
    Limit,
    Region,
    empty_region,
    facet_table,
    find_facets,
    find_region,
    is_standing,
    limits,
    pack,
    robot_size,
    supporting_facet,
    vector_at,
)
from lutgen.vector import Bools, Floats, Ints, Vector, cross, dot, length, row, scale, subtract

CHANNELS = ("sdg", "height", "tip_angle", "margin", "energy_margin", "facet")
# What a direction just outside the region gets where its distance rounds to zero, so that the
# sign alone always tells the verdict, in float32 too.
JUST_OUTSIDE = -1e-30
# A thread is worth waking for this many postures, half a millisecond of work for a few contacts;
# measuring this many directions takes as long as finding the facets of a posture.
POSTURES_A_THREAD, DIRECTIONS_A_POSTURE = 256, 64


@njit()
def arc_distance(start: Vector, stop: Vector, normal: Vector, g: Vector) -> float:
    """Return the angle (rad) from g to the great-circle arc between two contact directions."""
    if dot(cross(normal, start), g) >= 0.0 and dot(cross(stop, normal), g) >= 0.0:
        return abs(math.asin(min(max(dot(normal, g), -1.0), 1.0)))
    near_start = length(subtract(g, scale(start, 1.0 / length(start))))
    near_stop = length(subtract(g, scale(stop, 1.0 / length(stop))))
    return 2.0 * math.asin(min(0.5 * min(near_start, near_stop), 1.0))


@njit()
def tip_angle(count: Ints, segment: Floats, standing: bool, g: Vector) -> float:
    """Return the signed angular distance (rad) from g to the boundary of the standing region.

    Positive inside; pi where there is no boundary, -pi where there is no region.  For a convex
    region it is the smallest asin(m . g) over the tip-over planes, inside and outside: the angle
    of the force-angle measure of Papadopoulos and Rey for a pure gravity load.
    """
    if count[FACETS] == 0:
        return -math.pi
    if count[SEGMENTS] == 0:
        return math.pi
    if count[CONVEX] == 1:
        lowest = 2.0
        for b in range(count[SEGMENTS]):
            lowest = min(lowest, dot(vector_at(segment, b, TIP_PLANE), g))
        angle = math.asin(min(max(lowest, -1.0), 1.0))
        return max(angle, 0.0) if standing else min(angle, JUST_OUTSIDE)
    nearest = math.pi
    for b in range(count[SEGMENTS]):
        start, stop = vector_at(segment, b, START), vector_at(segment, b, STOP)
        nearest = min(nearest, arc_distance(start, stop, vector_at(segment, b, TIP_PLANE), g))
    return nearest if standing else min(-nearest, JUST_OUTSIDE)


@njit()
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


@njit()
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
def measure(region: Region, g: Vector, wanted: Bools, out: Floats) -> None:
    """Fill `out` (6,) with the channels of one direction, in the order of `CHANNELS`.

    `wanted` (6,) bool skips the costly ones.  Outside the standing region `sdg` and `height` are
    NaN, `facet` is -1 and the others are negative.
    """
    count, plate, segment = region.tally, region.plate, region.segment
    k = supporting_facet(plate, count[FACETS], g)
    convex = count[CONVEX] == 1
    if convex:
        standing = k >= 0
        for b in range(count[SEGMENTS]):
            standing = standing and dot(vector_at(segment, b, TIP_PLANE), g) >= 0.0
    else:
        standing = is_standing(region.span, region.edge, region.link, k, g)
    out[0] = out[1] = math.nan
    out[5] = -1.0
    if standing:
        along = dot(vector_at(plate, k, FIRST_AXIS), g)
        aside = dot(vector_at(plate, k, SECOND_AXIS), g)
        out[0] = math.sqrt(along * along + aside * aside) / dot(vector_at(plate, k, PLANE), g)
        out[1] = plate[k, HEIGHT]
        out[5] = k
    if wanted[2]:
        out[2] = tip_angle(count, segment, standing, g)
    if wanted[3] or wanted[4]:
        margin = energy = math.inf
        for b in range(count[SEGMENTS]):
            start, stop = vector_at(segment, b, START), vector_at(segment, b, STOP)
            tip_plane = vector_at(segment, b, TIP_PLANE)
            margin = min(margin, axis_margin(start, stop, tip_plane, convex, g))
            rise = axis_energy(start, stop, tip_plane, g)
            energy = min(energy, rise if convex else abs(rise))
        if count[FACETS] == 0:
            margin = energy = -math.inf
        elif standing:
            margin, energy = max(margin, 0.0), max(energy, 0.0)
        else:
            if not convex:
                margin, energy = -margin, -energy
            margin, energy = min(margin, JUST_OUTSIDE), min(energy, JUST_OUTSIDE)
        out[3] = margin
        out[4] = energy


@njit()
def _measure_posture(
    primitives: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools, out: Floats
) -> int:
    """Fill `out` (6, g) for one posture; return 1 where its facet table was too small."""
    n = primitives.shape[0]
    table, region = facet_table(n), empty_region(n)
    values = np.empty(6)
    find_facets(table, primitives, limit[2])
    find_region(region, table, limit, robot_size(primitives))
    for d in range(gravity_dir.shape[0]):
        measure(region, row(gravity_dir, d), wanted, values)
        for c in range(6):
            out[c, d] = values[c]
    return int(table.tally[1])


@njit(parallel=True)
def _measure_all(
    primitives: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools
) -> tuple[Floats, Ints]:
    """Return ((m, 6, g) channels, 1 where a facet table was too small)."""
    m = primitives.shape[0]
    out = np.empty((m, 6, gravity_dir.shape[0]))
    overflow = np.zeros(m, np.int64)
    for posture in prange(m):
        overflow[posture] = _measure_posture(
            primitives[posture], gravity_dir, limit, wanted, out[posture]
        )
    return out, overflow


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
    for name in channels:
        if name not in CHANNELS:
            raise InputError(f"unknown channel {name!r}; choose from {', '.join(CHANNELS)}")
    return np.array([name in channels for name in CHANNELS])


def refuse_overflow(source: str, overflow: Ints, contacts: int) -> None:
    """Raise InputError where a facet table was too small."""
    if overflow.any():
        raise InputError(
            f"{source}: a posture has more support facets than its {contacts} contacts can have "
            f"(got it in {int(overflow.sum())} of {overflow.size} postures); check the radii for "
            "overlapping spheres"
        )


def measure_postures(
    centre: NDArray[np.float64],
    axis: NDArray[np.float64],
    radius: NDArray[np.float64],
    kind: NDArray[np.int64],
    gravity_dir: ArrayLike,
    channels: Sequence[str],
    upright: float | None,
    rock_angle: float | None,
) -> dict[str, NDArray[np.float64]]:
    """Return the channels, each (m, g) float64, of m postures of round or pointed contacts.

    `centre` and `axis` are (m, n, 3), relative to the com; `radius` and `kind` (n,) as in
    `primitive`; the angles are in rad, None for no limit.
    """
    wanted = wanted_channels(channels)
    directions = checked_directions(gravity_dir)
    work = len(centre) * (1 + len(directions) // DIRECTIONS_A_POSTURE)
    with few_threads(work, POSTURES_A_THREAD):
        values, overflow = _measure_all(
            pack(centre, axis, radius, kind),
            directions,
            limits(upright, rock_angle),
            wanted,
        )
    if overflow.any():
        raise InputError(
            f"posture {int(np.flatnonzero(overflow)[0])} has more support facets than "
            f"{centre.shape[1]} contacts can have; check its radii for overlapping spheres"
        )
    return {name: values[:, CHANNELS.index(name)].copy() for name in channels}


def stability(
    contacts: ArrayLike,
    gravity_dir: ArrayLike,
    channels: Sequence[str] = ("sdg", "tip_angle"),
    upright: float | None = None,
    rock_angle: float | None = None,
) -> dict[str, NDArray[np.float64]]:
    """Return the stability of m sets of point contacts under g gravity directions.

    Parameters
    ----------
    contacts : (m, n, 3) array_like
        Contact points relative to the com, body frame, any length unit; (n, 3) for one set.
    gravity_dir : (g, 3) array_like
        Directions of gravity in the body frame, pointing down, of any length > 0.
    channels : sequence of str
        Names from `CHANNELS`.
    upright, rock_angle : float, optional
        Limits in rad (see the conventions); None for no limit.

    Returns
    -------
    dict of str to (m, g) float64
        `sdg`, `height`, `margin` and `energy_margin` in the contacts' unit, `tip_angle` in rad.
        Outside the standing region `sdg` and `height` are NaN and the others negative; exactly on
        a tip-over axis `tip_angle` is 0; it is pi for a robot that cannot tip, -pi for contacts
        that support nothing (collinear, or all above the com).

    Raises
    ------
    InputError
        For wrong shapes, numbers that are not finite, fewer than 3 or more than 32 contacts, and
        unknown channels.

    Examples
    --------
    A table of 2 x 1 with its com 1 above the ground, tilted 45 degrees to its long side:

    >>> import numpy as np
    >>> feet = np.array([[1, .5, -1], [-1, .5, -1], [-1, -.5, -1], [1, -.5, -1]])
    >>> reading = stability(feet, [[0, 0, -1], [1, 0, -1]])
    >>> np.degrees(reading["tip_angle"]).round(3)
    array([[26.565,  0.   ]])
    >>> reading["sdg"].round(3)
    array([[0., 1.]])
    """
    points = np.array(contacts, dtype=np.float64)
    if points.ndim == 2:
        points = points[None]
    if points.ndim != 3 or points.shape[2] != 3:
        raise InputError(
            f"contacts must have the shape (m, n, 3) (got {np.shape(contacts)}); "
            "give n points x, y, z for each of m postures"
        )
    if not 3 <= points.shape[1] <= MAX_PRIMITIVES:
        raise InputError(f"a posture needs 3 to {MAX_PRIMITIVES} contacts (got {points.shape[1]})")
    if not np.isfinite(points).all():
        raise InputError("contacts must be finite numbers (got NaN or infinity)")
    n = points.shape[1]
    return measure_postures(
        points,
        np.zeros_like(points),
        np.zeros(n),
        np.zeros(n, np.int64),
        gravity_dir,
        channels,
        upright,
        rock_angle,
    )
