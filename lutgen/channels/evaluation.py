"""Stability of postures under directions of gravity, exactly: nothing is sampled or interpolated.

Owns the loop over postures, and the steps to it from contacts and from a recipe.  `evaluate`
crosses every posture with every direction; for `evaluate_each` each posture has its own.  A
measurement also continues the stability factor to where the robot tips, because a table's nodes
there must hold something smooth and a search that starts there must find its way out.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels.axes import MU, PHI, add, empty_axes, find_axes, part
from lutgen.channels.block import BLOCK, empty_block, measure_block, worth_blocks
from lutgen.channels.loaded import measure_loaded
from lutgen.channels.plain import (
    HEIGHT_BEYOND,
    Setting,
    checked_directions,
    go_beyond,
    measure,
    refuse_overflow,
    wanted_channels,
)
from lutgen.channels.wrench import acceptance_of, wrenches
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import in_threads, njit
from lutgen.quantities import CHANNELS
from lutgen.recipe import Postures, Recipe, forward, radii_and_kinds
from lutgen.support import (
    MAX_PRIMITIVES,
    acceptance,
    empty_region,
    facet_table,
    pack,
    stand,
)
from lutgen.vector import Floats, length, row

# Pieces of work for a thread: this many directions of one posture.
STRETCH = 2048
# A thread is worth waking for this many postures, half a millisecond of work for a few contacts;
# measuring this many directions takes as long as finding the facets of a posture.
POSTURES_A_THREAD, DIRECTIONS_A_POSTURE = 256, 128
ROWS = HEIGHT_BEYOND + 1


@njit()
def measure_some(
    begin: int,
    end: int,
    primitives: Floats,
    wrench: Floats | None,
    gravity_dir: Floats,
    setting: Setting,
    out: Floats,
) -> int:
    """Measure stretches [begin, end), which count through the directions of posture after posture.

    Parameters and `out` as in `measure_postures`.  Returns how many of the postures that begin
    there have more facets than a table holds.  Compiled apart for the weight alone, where wrench
    is None: whoever needs no forces does not wait for their machine code.
    """
    acceptance, wanted = setting
    n, count = primitives.shape[1], gravity_dir.shape[1]
    per_posture = (count + STRETCH - 1) // STRETCH
    table, region = facet_table(n), empty_region(n)
    if wrench is not None:
        axes = empty_axes(region)
    room, values = empty_block(), np.empty(ROWS)
    current, overflow = -1, 0
    for piece in range(begin, end):
        posture, first = piece // per_posture, piece % per_posture * STRETCH
        if posture != current:
            current = posture
            too_many = stand(table, region, primitives[posture], acceptance)
            overflow += too_many if first == 0 else 0
            if wrench is not None:
                find_axes(region, wrench[posture], axes)
        directions = gravity_dir[posture % gravity_dir.shape[0], first : first + STRETCH]
        if wrench is None and worth_blocks(region.tally, wanted, directions.shape[0]):
            for at in range(0, directions.shape[0], BLOCK):
                some = directions[at : at + BLOCK]
                measure_block(region, some, wanted, room, posture, first + at, out)
        else:
            for d in range(directions.shape[0]):
                g = row(directions, d)
                if wrench is None:
                    measure(region, g, wanted, values)
                else:
                    least_cosine = acceptance.least_cosine
                    measure_loaded(region, axes, wrench[posture], least_cosine, g, wanted, values)
                for c in range(len(CHANNELS)):
                    if wanted[c]:
                        out[c, posture, first + d] = values[c]
        if out.shape[0] > len(CHANNELS):
            for d in range(directions.shape[0]):
                force, known = row(directions, d), True
                if wrench is not None:
                    force = add(force, part(wrench[posture], PHI))
                    known = length(part(wrench[posture], MU)) == 0.0
                go_beyond(region, force, known, values)
                for c in range(len(CHANNELS), ROWS):
                    out[c, posture, first + d] = values[c]
    return overflow


def measure_postures(
    primitives: Floats,
    wrench: Floats | None,
    gravity_dir: Floats,
    setting: Setting,
    rows: int = len(CHANNELS),
) -> tuple[NDArray[np.float64], int]:
    """Measure m postures under d directions, (rows, m, d); count those with too many facets.

    `primitives` (m, n, 8) are rows of `primitive.pack`, `wrench` (m, 7) those of `wrench.wrenches`,
    or None for the weight alone, which is faster; the unit directions (m, d, 3) or (1, d, 3) point
    down.  The rows are the channels in the order of `CHANNELS`, filled where they are wanted; if
    there are `ROWS`, also ALONG, ASIDE and HEIGHT_BEYOND: the in-plane components of D_g - s on the
    facet whose plane gravity pierces first, and its height, NaN where no accepted facet's plane is
    pierced, and under a moment.  What nobody wants is never touched and takes no memory.
    """
    out = np.empty((rows, len(primitives), gravity_dir.shape[1]))
    directions = np.ascontiguousarray(gravity_dir)
    stretches = -(-gravity_dir.shape[1] // STRETCH)
    long = min(gravity_dir.shape[1], STRETCH)
    least = max(POSTURES_A_THREAD // (1 + long // DIRECTIONS_A_POSTURE), 1)
    arguments = (primitives, wrench, directions, setting, out)
    return out, in_threads(measure_some, len(primitives) * stretches, *arguments, least=least)


def for_each_posture(
    kernel: Callable[..., int], recipe: Recipe, postures: Postures, *arguments: object
) -> None:
    """Call ``kernel(begin, end, primitives, wrench, *arguments)`` on parts of a recipe's postures.

    It returns how many of [begin, end) have more facets than a table holds, which none may have.
    """
    primitives = pack(postures.centres, postures.axes, *radii_and_kinds(recipe))
    everything = (primitives, wrenches(recipe, postures), *arguments)
    overflow = in_threads(kernel, len(primitives), *everything, least=POSTURES_A_THREAD)
    refuse_overflow(recipe.source, overflow, *primitives.shape[:2])


def measure_recipe(
    recipe: Recipe,
    postures: Postures,
    gravity_dir: NDArray[np.float64],
    wanted: NDArray[np.bool_],
    tighter: float = 0.0,
    rows: int = len(CHANNELS),
) -> NDArray[np.float64]:
    """Measure postures of a recipe, (rows, m, d); see `measure_postures`.

    `tighter` (rad) is taken from `upright` and from `rock_angle`.
    """
    radius, kind = radii_and_kinds(recipe)
    values, overflow = measure_postures(
        pack(postures.centres, postures.axes, radius, kind),
        wrenches(recipe, postures) if recipe.loaded else None,
        gravity_dir,
        Setting(acceptance_of(recipe, tighter), wanted),
        rows,
    )
    refuse_overflow(recipe.source, overflow, values.shape[1], len(kind))
    return values


def measure_primitives(
    primitives: Floats,
    gravity_dir: ArrayLike,
    channels: Sequence[str],
    upright: float | None,
    rock_angle: float | None,
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of m postures of any primitives; parameters and result as `stability`.

    `primitives` (m, n, 8) float64 are rows of `primitive.pack`, relative to the com.
    """
    directions = checked_directions(gravity_dir)[None]
    setting = Setting(acceptance(upright, rock_angle), wanted_channels(channels))
    values, overflow = measure_postures(primitives, None, directions, setting)
    refuse_overflow("contacts", overflow, *primitives.shape[:2])
    return {name: values[CHANNELS.index(name)] for name in channels}


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
    primitives = pack(points, np.zeros_like(points), 0.0, 0)
    return measure_primitives(primitives, gravity_dir, channels, upright, rock_angle)


def evaluate(
    recipe: Recipe,
    params: ArrayLike,
    gravity_dir: ArrayLike,
    channels: Sequence[str] = ("sdg", "tip_angle"),
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of m postures under g gravity directions.

    Parameters
    ----------
    recipe : Recipe
        From `load_recipe` or `parse_recipe`.
    params : (m, k) array_like
        Geometry parameters in recipe order, rad or the recipe's length unit; they may lie outside
        the recipe's ranges.
    gravity_dir : (g, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.
    channels : sequence of str
        See `stability`.

    Returns
    -------
    dict of str to (m, g) float64
        As for `stability`, with the recipe's `upright` and `rock_angle`, its forces and the
        uncertainty of its com; with one of those `energy_margin` is NaN.

    Raises
    ------
    InputError
        For wrong shapes, numbers that are not finite and unknown channels.
    """
    return measure_moved(recipe, forward(recipe, params), gravity_dir, channels)


def measure_moved(
    recipe: Recipe, postures: Postures, gravity_dir: ArrayLike, channels: Sequence[str]
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of postures that `kinematics.forward` has placed; see `evaluate`."""
    wanted = wanted_channels(channels)
    directions = checked_directions(gravity_dir)[None]
    values = measure_recipe(recipe, postures, directions, wanted)
    return {name: values[CHANNELS.index(name)] for name in channels}


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
    values = measure_recipe(recipe, where, unit_directions(each), wanted)
    if directions.ndim == 2:
        values = values[:, :, 0]
    return {name: values[CHANNELS.index(name)] for name in channels}
