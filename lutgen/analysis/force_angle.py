"""Force-angle stability measure (Papadopoulos and Rey, 1996; in the form of 2000).

Owns that measure alone.  It is no channel of maps: beside `tip_angle` and `margin`, of whose
product it consists, it tells a table nothing new.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.stance import Footing, find_footing
from lutgen.channels import JUST_OUTSIDE, checked_directions, evaluate
from lutgen.recipe import Recipe

__all__ = ["axis_force_angle", "footing_force_angle", "force_angle"]

Floats = NDArray[np.float64]


def axis_force_angle(start: ArrayLike, stop: ArrayLike, force: ArrayLike) -> Floats:
    """Return the force-angle measure of tip-over axes.

    Of an axis with unit direction a, the force's part across it f = (1 - a a^T) F, and the arm l
    from the com to the axis, across it too,

        beta = theta |d| |f|,

    theta the angle from l to f, positive where the force keeps the robot down, and d the
    perpendicular from the axis to the line of f through the com.  |d| |f| is the moment M of the
    force about the axis, so

        beta = theta |M|,  theta = atan2(M, l . f),  M = (start x stop) . F / |stop - start|.

    An arc cosine of a normalised product would leave [-1, 1] by rounding exactly where the com is
    over the axis; this form is 0 to rounding there.

    Parameters
    ----------
    start, stop : (..., 3) array_like
        Ends of the axes relative to the com; start x stop points to the inner side.
    force : (..., 3) array_like
        Resultant force at the com, pointing down for gravity; a unit vector measures in weights.

    Returns
    -------
    (...,) float64
        rad x length x force.  0 where the force passes through the axis, pi |M| at most; near the
        limit it is of second order in the angle.  0 too for a com on the axis.

    Examples
    --------
    A com 1 above the ground and 0.2 beside an axis:

    >>> float(axis_force_angle([-0.2, -0.7, -1], [-0.2, 1.3, -1], [0, 0, -9.81]).round(9))
    0.387290088
    """
    begin, end, pull = (np.asarray(part, dtype=np.float64) for part in (start, stop, force))
    edge = end - begin
    along = edge / np.linalg.norm(edge, axis=-1, keepdims=True)
    arm = begin - (begin * along).sum(axis=-1, keepdims=True) * along
    # Of the arm and not of the end points: an axis may be long and its com near it.
    moment = (np.cross(arm, along) * pull).sum(axis=-1)
    angle = np.arctan2(moment, (arm * pull).sum(axis=-1))
    return np.asarray(angle * np.abs(moment))


def force_angle(recipe: Recipe, params: ArrayLike, gravity_dir: ArrayLike) -> Floats:
    """Return the force-angle measure of one posture under g directions, for its own weight.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (k,) array_like
        Geometry parameters, rad or length.
    gravity_dir : (g, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.

    Returns
    -------
    (g,) float64
        rad x length, for a weight of 1: the smallest over the tip-over axes, with the sign of the
        verdict; infinite without an axis, minus infinity without a support facet.  Where the
        standing region is not convex an axis ends at a corner of the region, and the measure is
        the product of `tip_angle` and `margin`, which it equals on a level axis.
    """
    directions = checked_directions(gravity_dir)
    posture = np.asarray(params, dtype=np.float64)
    wanted = ("tip_angle", "margin")
    found = evaluate(recipe, np.atleast_2d(posture), directions, wanted)
    angle, margin = (found[name][0] for name in wanted)
    return footing_force_angle(find_footing(recipe, posture), directions, angle, margin)


def footing_force_angle(
    footing: Footing, directions: Floats, angle: Floats, margin: Floats
) -> Floats:
    """Return the measure under (g, 3) unit directions whose `tip_angle` and `margin` are known."""
    standing = angle >= 0.0
    if not (footing.facets and len(footing.start)):
        return np.where(standing, np.inf, -np.inf)
    if footing.convex:
        least = axis_force_angle(footing.start, footing.stop, directions[:, None, :]).min(axis=1)
    else:
        least = angle * np.abs(margin)
    return np.asarray(np.where(standing, np.maximum(least, 0.0), np.minimum(least, JUST_OUTSIDE)))
