"""Postures with gravity directions of their own, and |SD_g| beyond the standing region.

Owns the kernel that encoders, certificates and searches share: `evaluate` crosses every posture
with every direction, here each posture has its own.  It also continues the stability factor to
where the robot tips, because a table's nodes there must hold something smooth and a search that
starts there must find its way out.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels.load import measure_recipe
from lutgen.channels.plain import (
    CHANNELS,
    POSTURES_A_THREAD,
    measure,
    refuse_overflow,
    wanted_channels,
)
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import few_threads, njit, prange
from lutgen.recipe import Recipe, forward, radii_and_kinds
from lutgen.support import (
    FACETS,
    FIRST_AXIS,
    HEIGHT,
    PLANE,
    SECOND_AXIS,
    Limit,
    empty_region,
    facet_table,
    find_facets,
    find_region,
    limits,
    pack,
    robot_size,
    supporting_facet,
    vector_at,
)
from lutgen.vector import Bools, Floats, Ints, dot, row

# Rows of `measure_each`: the six channels, and then what goes on beyond the standing region.
ALONG, ASIDE, HEIGHT_BEYOND = len(CHANNELS), len(CHANNELS) + 1, len(CHANNELS) + 2
ROWS = HEIGHT_BEYOND + 1


@njit()
def _measure_posture(
    primitives: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools, out: Floats
) -> int:
    """Fill `out` (9, d) for one posture; return 1 where its facet table was too small."""
    n = primitives.shape[0]
    table, region = facet_table(n), empty_region(n)
    values = np.empty(6)
    find_facets(table, primitives, limit[2])
    find_region(region, table, limit, robot_size(primitives))
    for d in range(gravity_dir.shape[0]):
        g = row(gravity_dir, d)
        measure(region, g, wanted, values)
        for c in range(6):
            out[c, d] = values[c]
        out[ALONG, d] = out[ASIDE, d] = out[HEIGHT_BEYOND, d] = math.nan
        k = supporting_facet(region.plate, region.tally[FACETS], g)
        if k >= 0:
            reach = 1.0 / dot(vector_at(region.plate, k, PLANE), g)
            out[ALONG, d] = dot(vector_at(region.plate, k, FIRST_AXIS), g) * reach
            out[ASIDE, d] = dot(vector_at(region.plate, k, SECOND_AXIS), g) * reach
            out[HEIGHT_BEYOND, d] = region.plate[k, HEIGHT]
    return int(table.tally[1])


@njit(parallel=True)
def measure_each(
    primitives: Floats, gravity_dir: Floats, limit: Limit, wanted: Bools
) -> tuple[NDArray[np.float64], Ints]:
    """Measure m postures under d directions each.

    Parameters
    ----------
    primitives : (m, n, 8) float64
        As `primitive.pack` makes them.
    gravity_dir : (m, d, 3) float64
        Unit directions, pointing down.
    limit : tuple
        See `region.limits`.
    wanted : (6,) bool
        Which of `CHANNELS` to compute; sdg and height are computed always.

    Returns
    -------
    (m, 9, d) float64
        The six channels in the order of `CHANNELS`, then rows ALONG, ASIDE and HEIGHT_BEYOND: the
        in-plane components of D_g - s on the facet whose plane gravity pierces first, and its
        height, NaN where no accepted facet's plane is pierced.
    (m,) int64
        1 where a facet table was too small.
    """
    m = primitives.shape[0]
    out = np.empty((m, ROWS, gravity_dir.shape[1]))
    overflow = np.zeros(m, np.int64)
    for posture in prange(m):
        overflow[posture] = _measure_posture(
            primitives[posture], gravity_dir[posture], limit, wanted, out[posture]
        )
    return out, overflow


def evaluate_each(
    recipe: Recipe,
    params: ArrayLike,
    gravity_dir: ArrayLike,
    channels: Sequence[str] = ("sdg", "tip_angle"),
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of m postures, each under its own gravity direction or directions.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (m, k) array_like
        Geometry parameters, rad or length.
    gravity_dir : (m, 3) or (m, d, 3) array_like
        Directions in the body frame, pointing down, of any length > 0; one or d for each posture.
    channels : sequence of str
        See `stability`.

    Returns
    -------
    dict of str to (m,) or (m, d) float64

    Raises
    ------
    InputError
        For wrong shapes, numbers that are not finite and unknown channels.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> recipe = load_recipe("maps/paper_one.toml")
    >>> level, steep = [0.0, 0.0, -1.0], [-1.0, 0.0, -1.0]
    >>> found = evaluate_each(recipe, [[0.5], [0.5]], [level, steep])
    >>> found["sdg"].round(3), np.degrees(found["tip_angle"]).round(1)
    (array([0.156,   nan]), array([39.8, -5.2]))
    """
    wanted = wanted_channels(channels)
    where = forward(recipe, params)
    directions = np.asarray(gravity_dir, dtype=np.float64)
    each = directions[:, None] if directions.ndim == 2 else directions
    if each.ndim != 3 or each.shape[::2] != (len(where.com), 3):
        raise InputError(
            f"gravity_dir must have one row x, y, z for each of {len(where.com)} postures "
            f"(got the shape {directions.shape})"
        )
    radius, kind = radii_and_kinds(recipe)
    down = np.ascontiguousarray(unit_directions(each))
    if recipe.loaded:
        values, overflow = measure_recipe(recipe, where, down, wanted)
    else:
        with few_threads(len(each), POSTURES_A_THREAD):
            values, overflow = measure_each(
                pack(where.centres, where.axes, radius, kind),
                down,
                limits(recipe.upright, recipe.rock_angle),
                wanted,
            )
    refuse_overflow(recipe.source, overflow, len(kind))
    found = {name: values[:, CHANNELS.index(name)] for name in channels}
    return {
        name: (value[:, 0] if directions.ndim == 2 else value).copy()
        for name, value in found.items()
    }
