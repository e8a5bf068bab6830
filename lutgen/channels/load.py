"""The load of each posture of a recipe: resultant of the forces over the weight, com ball.

Owns the step from a recipe's forces to what `loaded` computes with, and the call of its kernel.  A
load is one row of seven numbers: phi (3), the sum of the forces over the weight; mu (3), their
moment about the com over the weight, a length; and the radius rho of the ball in which the
com lies.  Body frame.
"""

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.axes import MU, PHI, RHO
from lutgen.channels.loaded import measure_loaded
from lutgen.channels.plain import DIRECTIONS_A_POSTURE, POSTURES_A_THREAD
from lutgen.chart import STANDARD_GRAVITY
from lutgen.errors import InputError
from lutgen.jit import few_threads
from lutgen.recipe import Postures, Recipe, radii_and_kinds
from lutgen.support import Limit, limits, pack

__all__ = ["MU", "PHI", "RHO", "limits_of", "loads", "measure_recipe", "refuse_forces"]


def loads(recipe: Recipe, postures: Postures) -> NDArray[np.float64]:
    """Return the loads (m, 7) of postures of a recipe.

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
        W = mass x 9.80665 m/s^2, and the com's uncertainty rho (length); zeros without a load.
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


def limits_of(recipe: Recipe, tighter: float = 0.0) -> Limit:
    """Return `region.limits` of a recipe: a facet counts for every com in the ball or not at all.

    `tighter` (rad) is taken from both of its angles.
    """
    upright, rock_angle = recipe.upright - tighter, recipe.rock_angle - tighter
    return limits(upright, rock_angle, recipe.com_uncertainty)


def measure_recipe(
    recipe: Recipe,
    postures: Postures,
    gravity_dir: NDArray[np.float64],
    wanted: NDArray[np.bool_],
    tighter: float = 0.0,
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Measure postures of a loaded recipe; as `loaded.measure_loaded`.

    `gravity_dir` (m, d, 3) or (1, d, 3) are unit directions; `tighter` as in `limits_of`.
    """
    radius, kind = radii_and_kinds(recipe)
    work = len(postures.com) * (1 + gravity_dir.shape[1] // DIRECTIONS_A_POSTURE)
    with few_threads(work, POSTURES_A_THREAD):
        return measure_loaded(
            pack(postures.centres, postures.axes, radius, kind),
            loads(recipe, postures),
            np.ascontiguousarray(gravity_dir),
            limits_of(recipe, tighter),
            wanted,
        )


def refuse_forces(recipe: Recipe, what: str) -> None:
    """Raise InputError for a recipe with forces where `what` knows the weight alone."""
    if recipe.has_wrench:
        names = ", ".join(force.name for force in recipe.forces if force.acts)
        raise InputError(
            f"{recipe.source}: key `robot.force`: {what} counts the weight and no other force (got "
            f"{names}); leave the forces out to see it"
        )
