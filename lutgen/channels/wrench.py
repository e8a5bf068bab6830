"""Numbers of a recipe for kernels: primitives, the facets that count, and the wrench.

The wrench of each posture: resultant of its forces over the weight, and com ball.

A wrench is one row of seven numbers: phi (3), the sum of the forces over the weight; mu (3), their
moment about the com over the weight, a length; and the radius rho of the ball in which the com
lies.  Body frame.
"""

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.axes import MU, PHI, RHO
from lutgen.chart import STANDARD_GRAVITY
from lutgen.errors import InputError
from lutgen.recipe import Postures, Recipe, contact_tolerance_of, radii_and_kinds, robot_size_of
from lutgen.support import AXLE, FIRST, Acceptance, acceptance, pack

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


def wrenches(recipe: Recipe, postures: Postures) -> NDArray[np.float64]:
    """Return the wrenches (m, 7) of postures of a recipe.

    Parameters
    ----------
    recipe : Recipe
        Its forces are in N and its masses in kg; moments in N times the length unit.
    postures : Postures
        From `kinematics.forward`.

    Returns
    -------
    (m, 7) float64
        Per posture phi = sum f / W and mu = (sum (p - com) x f + moment) / W with the weight
        W = mass x 9.80665 m/s^2, and the com's uncertainty rho (length); zeros without forces.
    """
    result = np.zeros((len(postures.com), 7))
    result[:, RHO] = recipe.com_uncertainty
    if recipe.has_wrench:
        weight = sum(link.mass for link in recipe.links) * STANDARD_GRAVITY
        force = np.array([one.force for one in recipe.forces]) / weight
        moment = np.array([one.moment for one in recipe.forces]) / weight
        turning = np.cross(postures.force_points, force) + moment
        result[:, PHI:MU] = force.sum(axis=0)
        result[:, MU:RHO] = turning.sum(axis=1)
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


def groups_of(recipe: Recipe) -> NDArray[np.int64]:
    """Return the groups (n,) of a recipe as bits of its contacts' rows."""
    bits = {name: 1 << row for row, name in enumerate(recipe.contact_names)}
    groups = (sum(bits[name] for name in {*group.contacts}) for group in recipe.groups)
    return np.array([*groups], np.int64)


def refuse_forces(recipe: Recipe, what: str) -> None:
    """Raise InputError for a recipe with forces where `what` knows the weight alone."""
    if recipe.has_wrench:
        names = ", ".join(force.name for force in recipe.forces if force.acts)
        raise InputError(
            f"{recipe.source}: key `robot.force`: {what} counts the weight and no other force (got "
            f"{names}); leave the forces out to see it"
        )
