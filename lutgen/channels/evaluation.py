"""Stability of postures under directions of gravity, exactly: nothing is sampled or interpolated.

`evaluate` crosses every posture with every direction; for `evaluate_each` each posture has its own.
"""

import threading
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.arrays import Floats, Ints
from lutgen.channels.axes import MU, PHI, Axes, empty_axes, find_axes, part
from lutgen.channels.exact import (
    NO_GROUPS,
    SHARE,
    Setting,
    checked_directions,
    measure,
    wanted_channels,
)
from lutgen.channels.loads import measure_loaded, share_of
from lutgen.channels.resting import CONVENTIONS, settled
from lutgen.channels.wrench import acceptance_of, groups_of, primitives_of, wrenches
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import in_threads, njit
from lutgen.parts import ZERO
from lutgen.quantities import CHANNELS
from lutgen.recipe import TOLERANCE, Postures, Recipe, forward, within_limits
from lutgen.support import (
    MAX_PRIMITIVES,
    Acceptance,
    Region,
    acceptance,
    empty_region,
    pack,
    stand,
)
from lutgen.vector import add, row, write3

# Directions of one posture are measured in stretches of this many: a thread takes some of them.
STRETCH = 1024
# A thread is worth its waking for this many postures, half a millisecond of work for a few
# contacts; finding the facets of one takes as long as measuring this many directions.
POSTURES_A_THREAD, DIRECTIONS_A_POSTURE = 256, 64
NOTHING = np.zeros(len(CHANNELS), np.bool_)
_OWN = threading.local()


class Memory(NamedTuple):
    """What the kernels of one thread write: the region of a posture, its axes, and channels."""

    region: Region
    axes: Axes
    values: Floats


def own_memory() -> Memory:
    """Return the memory of this thread; one that is new takes longer than a posture."""
    if not hasattr(_OWN, "memory"):
        _OWN.memory = Memory(empty_region(), empty_axes(), np.empty(len(CHANNELS)))
    memory: Memory = _OWN.memory
    return memory


@njit(bare=True)
def measure_some(
    span: tuple[int, int],
    memory: Memory,
    primitives: Floats,
    wrench: Floats | None,
    gravity_dir: Floats,
    setting: Setting,
    out: Floats,
) -> None:
    """Measure a span of stretches, which count through the directions of posture after posture.

    Parameters as in `measure_postures`; `out` (channels, m, d) has a row for each wanted channel.
    Compiled apart for the weight alone, where `wrench` is None.
    """
    (region, axes, values), (accept, wanted, groups, plane) = memory, setting
    count = gravity_dir.shape[1]
    per_posture = (count + STRETCH - 1) // STRETCH
    current, phi, mu = -1, ZERO, ZERO
    for piece in range(span[0], span[1]):
        posture, first = piece // per_posture, piece % per_posture * STRETCH
        if posture != current:
            current = posture
            stand(region, primitives[posture], accept)
            if wrench is not None:
                find_axes(region, wrench[posture], axes)
                phi, mu = part(wrench[posture], PHI), part(wrench[posture], MU)
        directions = gravity_dir[posture % gravity_dir.shape[0]]
        for d in range(first, min(first + STRETCH, count)):
            g = row(directions, d)
            if plane:
                g = settled(region, phi, mu, g)
                write3(directions[d], g)
            if wrench is None:
                measure(region, g, wanted, values)
            else:
                measure_loaded(region, axes, wrench[posture], g, wanted, values)
            if wanted[SHARE]:
                values[SHARE] = share_of(region, values, add(g, phi), mu, groups)
            place = 0
            for c in range(len(CHANNELS)):
                if wanted[c]:
                    out[place, posture, d] = values[c]
                    place += 1


def measure_postures(
    primitives: Floats,
    gravity_dir: Floats,
    channels: Sequence[str],
    limits: Acceptance,
    wrench: Floats | None = None,
    groups: Ints = NO_GROUPS,
    convention: str = "body",
) -> dict[str, NDArray[np.float64]]:
    """Return the channels (m, d) of m postures under d directions.

    `primitives` (m, n, 8) are rows of `primitive.pack`, relative to the com, `wrench` (m, 7) those
    of `wrench.wrenches`, or None for the weight alone, which is faster; the unit directions
    (m, d, 3) or (1, d, 3) point down; `limits` are of `support.acceptance`, and `groups` (n,) those
    of `shares.least_share`.  Directions (m, d, 3) of the `convention` "plane" are turned into the
    body in place, if they are a writeable C-contiguous array.
    """
    if convention not in CONVENTIONS:
        raise InputError(f"unknown convention {convention!r}; choose from {', '.join(CONVENTIONS)}")
    setting = Setting(limits, wanted_channels(channels), groups, convention == "plane")
    # No row that is not wanted: memory that is touched first takes longer than what fills it.
    out = np.empty((setting.wanted.sum(), len(primitives), gravity_dir.shape[1]))
    stretches = -(-gravity_dir.shape[1] // STRETCH)
    work = 1 + min(gravity_dir.shape[1], STRETCH) // DIRECTIONS_A_POSTURE
    arguments = (primitives, wrench, np.require(gravity_dir, None, ["C", "W"]), setting, out)
    least = max(POSTURES_A_THREAD // work, 1)
    in_threads(measure_some, len(primitives) * stretches, own_memory, *arguments, least=least)
    found = dict(zip(np.array(CHANNELS)[setting.wanted].tolist(), out, strict=True))
    return {name: found[name] for name in channels}


def measure_recipe(
    recipe: Recipe,
    postures: Postures,
    gravity_dir: Floats,
    channels: Sequence[str],
    convention: str = "body",
) -> dict[str, NDArray[np.float64]]:
    """Measure postures that `kinematics.forward` has placed; directions as `measure_postures`."""
    return measure_postures(
        primitives_of(recipe, postures),
        gravity_dir,
        channels,
        acceptance_of(recipe),
        wrenches(recipe, postures) if recipe.loaded else None,
        groups_of(recipe),
        convention,
    )


def region_of(primitives: Floats, limits: Acceptance) -> Region:
    """Return the region of one posture (n, 8)."""
    memory, setting = own_memory()._replace(region=empty_region()), Setting(limits, NOTHING)
    down, out = np.zeros((1, 1, 3)), np.empty((0, 1, 1))
    measure_some((0, 1), memory, primitives[None], None, down, setting, out)
    return memory.region


def stability(
    contacts: ArrayLike,
    gravity_dir: ArrayLike,
    channels: Sequence[str] = ("sdg", "tip_angle"),
    upright: float | None = None,
    rock_angle: float | None = None,
    rest_width: float | None = None,
    contact_tolerance: float | None = None,
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
    rest_width, contact_tolerance : float, optional
        How wide a facet must be for the robot to stand on it, and how near to its plane a contact
        counts to its support polygon, in the contacts' unit; None for 0, and for 1e-4 of the
        greatest distance of a contact from the com.

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
        For wrong shapes, numbers that are not finite, fewer than 3 or more than 62 contacts, and
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
        raise InputError(
            f"a posture needs 3 to {MAX_PRIMITIVES} contacts (got {points.shape[1]}); "
            "give those that can touch the ground"
        )
    if not np.isfinite(points).all():
        raise InputError("contacts must be finite numbers (got NaN or infinity)")
    primitives = pack(points, np.zeros_like(points), 0.0, 0)
    tolerance = -TOLERANCE if contact_tolerance is None else contact_tolerance
    limits = acceptance(upright, rock_angle, 0.0, rest_width, tolerance)
    return measure_postures(primitives, checked_directions(gravity_dir)[None], channels, limits)


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
        Geometry parameters in recipe order, rad or the recipe's length unit, within the recipe's
        limits.
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
        For wrong shapes, numbers that are not finite or beyond their limits, and unknown channels.
    """
    placed = forward(recipe, within_limits(recipe, params))
    return measure_recipe(recipe, placed, checked_directions(gravity_dir)[None], channels)


def evaluate_each(
    recipe: Recipe,
    params: ArrayLike,
    gravity_dir: ArrayLike,
    channels: Sequence[str] = ("sdg", "tip_angle"),
    convention: str = "body",
) -> dict[str, NDArray[np.float64]]:
    """Return the channels of m postures, each under its own gravity direction or directions.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (m, k) array_like
        Geometry parameters, rad or length.
    gravity_dir : (m, 3) or (m, d, 3) array_like
        Directions pointing down, of any length > 0; one or d for each posture.
    channels : sequence of str
        See `stability`.
    convention : {"body", "plane"}
        The frame of the directions, see `body_gravity`.

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
    where = forward(recipe, params)
    directions = np.asarray(gravity_dir, dtype=np.float64)
    each = directions[:, None] if directions.ndim == 2 else directions
    if each.ndim != 3 or each.shape[::2] != (len(where.com), 3):
        raise InputError(
            f"gravity_dir must have one row x, y, z for each of {len(where.com)} postures "
            f"(got the shape {directions.shape})"
        )
    found = measure_recipe(recipe, where, unit_directions(each), channels, convention)
    return found if directions.ndim == 3 else {name: row[:, 0] for name, row in found.items()}


def body_gravity(
    recipe: Recipe, params: ArrayLike, gravity: ArrayLike, convention: str = "body"
) -> NDArray[np.float64]:
    """Return the gravity direction in the body frame of m postures: T_g.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (m, k) array_like
        Geometry parameters, rad or length.
    gravity : (3,) or (m, 3) array_like
        Pointing down, any length > 0; in the frame that the convention names.
    convention : {"body", "plane"}
        F and P of the head of `resting`.

    Returns
    -------
    (m, 3) float64
        Unit vectors.  Under ``"plane"`` the robot rests on the plane with the facet that carries
        it; without one, with the one that comes closest, and the robot tips.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> recipe = load_recipe("maps/paper_one.toml")
    >>> body_gravity(recipe, [[0.75]], [0, 0, -1], "plane").round(3)  # wheel 1 low: nose up
    array([[-0.143,  0.   , -0.99 ]])
    """
    posture = forward(recipe, params)
    count = len(posture.com)
    given = unit_directions(gravity)
    if given.shape not in ((3,), (count, 3)):
        raise InputError(
            f"gravity must have the shape (3,) or ({count}, 3) (got {given.shape}); give one "
            "direction, or one for each posture"
        )
    directions = np.broadcast_to(given, (count, 3)).copy()
    if convention != "body":
        measure_recipe(recipe, posture, directions[:, None], (), convention)
    return directions
