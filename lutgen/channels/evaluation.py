"""Stability of postures under directions of gravity, exactly: nothing is sampled or interpolated.

`evaluate` crosses every posture with every direction; for `evaluate_each` each posture has its own.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.arrays import Floats
from lutgen.channels.axes import WRENCH
from lutgen.channels.exact import checked_directions
from lutgen.channels.measuring import measure_postures
from lutgen.chart import STANDARD_GRAVITY, unit_directions
from lutgen.errors import InputError
from lutgen.recipe import (
    TOLERANCE,
    Postures,
    Recipe,
    contact_tolerance_of,
    forward,
    radii_and_kinds,
    robot_size_of,
    within_limits,
)
from lutgen.support import AXLE, FIRST, MAX_PRIMITIVES, Acceptance, acceptance, pack

# Part of the robot's size: the least width of a rest (see docs/reference/conventions.md).
REST_WIDTH = 0.01


def primitives_of(recipe: Recipe, postures: Postures) -> NDArray[np.float64]:
    """Return the primitives (m, n + 2 a, 8) of postures of a recipe.

    They are its contacts and its axles that swing, see the head of `support.primitive`.
    """
    parts = [pack(postures.centres, postures.axes, *radii_and_kinds(recipe))]
    names = recipe.contact_names
    for k, axle in enumerate(recipe.axles):
        i, j = (names.index(name) for name in axle.contacts)
        share, com = postures.axle_shares[:, k, None], postures.axle_coms[:, k]
        points = np.stack([postures.pivots[:, k], -share / (1.0 - share) * com], axis=1)
        lines = np.stack([postures.pivot_axes[:, k], np.zeros_like(com)], axis=1)
        numbers = np.hstack([np.full_like(share, FIRST * i + j), 1.0 - share])
        parts.append(pack(points, lines, numbers, AXLE))
    return np.concatenate(parts, axis=1)


def wrenches(recipe: Recipe, postures: Postures) -> NDArray[Any]:
    """Return the wrenches (m,), rows of WRENCH, of postures of a recipe, body frame.

    phi = sum f / W and mu = (sum (p - com) x f + moment) / W, W = mass x 9.80665 m/s^2; the recipe
    has forces in N, masses in kg, and moments in N times the length unit.
    """
    result = np.zeros(len(postures.com), WRENCH)
    result["rho"] = recipe.com_uncertainty
    if recipe.has_wrench:
        weight = sum(link.mass for link in recipe.links) * STANDARD_GRAVITY
        force = np.array([one.force for one in recipe.forces]) / weight
        moment = np.array([one.moment for one in recipe.forces]) / weight
        turning = np.cross(postures.force_points, force) + moment
        result["phi"] = force.sum(axis=0)
        result["mu"] = turning.sum(axis=1)
    return result


def acceptance_of(recipe: Recipe) -> Acceptance:
    """Return the acceptance of a recipe: a facet counts for every com in the ball or not at all."""
    size = robot_size_of(recipe)
    return acceptance(
        recipe.upright,
        recipe.rock_angle,
        recipe.com_uncertainty,
        REST_WIDTH * size if recipe.rest_width is None else recipe.rest_width,
        contact_tolerance_of(recipe),
    )


def refuse_forces(recipe: Recipe, what: str) -> None:
    """Raise InputError for a recipe with forces where `what` knows the weight alone."""
    if recipe.has_wrench:
        names = ", ".join(force.name for force in recipe.forces if force.acts)
        raise InputError(
            f"{recipe.source}: key `robot.force`: {what} counts the weight and no other force (got "
            f"{names}); leave the forces out to see it"
        )


def measure_recipe(
    recipe: Recipe,
    postures: Postures,
    gravity_dir: Floats,
    channels: Sequence[str],
    convention: str = "body",
) -> dict[str, NDArray[np.float64]]:
    """Measure postures that `kinematics.forward` has placed; directions as `measure_postures`."""
    # Groups are bits of their contacts' rows.
    bits = {name: 1 << row for row, name in enumerate(recipe.contact_names)}
    groups = [sum(bits[name] for name in {*group.contacts}) for group in recipe.groups]
    return measure_postures(
        primitives_of(recipe, postures),
        gravity_dir,
        channels,
        acceptance_of(recipe),
        wrenches(recipe, postures) if recipe.loaded else None,
        np.array(groups, np.int64),
        convention,
    )


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

    As `evaluate`, but `params` (m, k) may be beyond their limits, and `gravity_dir` is (m, 3) or
    (m, d, 3), in the frame that `convention` names, see `body_gravity`; so are the channels, (m,)
    or (m, d).

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
    """Return the gravity direction in the body frame of m postures: T_g, unit vectors (m, 3).

    `params` (m, k) are rad or length; `gravity`, (3,) or (m, 3), points down, of any length > 0, in
    the frame that the `convention` names: F, "body", and P, "plane", of the head of `resting`.
    Under P the robot rests on the plane with the facet that carries it; without one, with the one
    that comes closest, and it tips.

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
