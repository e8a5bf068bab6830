"""How far a posture can be tilted in each heading before it tips over.

Owns the words tilt and heading: gravity at tilt t and heading psi is
(sin t cos psi, sin t sin psi, -cos t) in the body frame, so heading 0 is nose down, +90 deg left
side down, 180 deg nose up and -90 deg right side down.  It draws nothing.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.errors import InputError
from lutgen.evaluation import evaluate
from lutgen.recipe import Recipe

__all__ = ["tilt_limits", "tilted"]

# A tip-over region crossed in less than this tilt (rad, 0.005 deg) may be stepped over.
SHORTEST_STEP = math.radians(0.005)
# Halvings of an interval of at most pi: the limit is then known to 1e-13 rad.
HALVINGS = 45


def tilted(tilt: ArrayLike, heading: ArrayLike) -> NDArray[np.float64]:
    """Return gravity directions at a tilt and a heading.

    Parameters
    ----------
    tilt, heading : array_like
        Radians, of shapes that broadcast to one shape.

    Returns
    -------
    (..., 3) float64
        Unit vectors in the body frame, pointing down.

    Examples
    --------
    >>> tilted(math.pi / 2, [0.0, math.pi / 2]).round(12).tolist()
    [[1.0, 0.0, -0.0], [0.0, 1.0, -0.0]]
    """
    t, psi = np.broadcast_arrays(np.asarray(tilt, np.float64), np.asarray(heading, np.float64))
    return np.stack([np.sin(t) * np.cos(psi), np.sin(t) * np.sin(psi), -np.cos(t)], axis=-1)


def tilt_limits(recipe: Recipe, params: ArrayLike, headings: ArrayLike) -> NDArray[np.float64]:
    """Return the largest tilt before tip-over in each heading.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (k,) array_like
        One posture, rad or length.
    headings : (h,) array_like
        Headings of the tilt in rad.

    Returns
    -------
    (h,) float64
        Radians: the robot stands at every tilt from 0 up to it.  0 where it tips on level ground
        already, pi where it never tips.

    Notes
    -----
    `tip_angle` is 1-Lipschitz in gravity, so no tip-over lies within `tip_angle` of a standing
    direction: the walk from level ground steps exactly that far, and at least `SHORTEST_STEP`,
    until it has passed the limit, and then halves the last step.
    """
    posture = np.asarray(params, dtype=np.float64)
    heading = np.asarray(headings, dtype=np.float64)
    if posture.ndim != 1 or heading.ndim != 1 or not np.isfinite(heading).all():
        raise InputError(
            f"tilt limits need one posture (k,) and finite headings (h,) (got shapes "
            f"{posture.shape} and {heading.shape}); pass one row of params and headings in rad."
        )

    def reading(rows: NDArray[np.intp], tilt: NDArray[np.float64]) -> NDArray[np.float64]:
        directions = tilted(tilt, heading[rows])
        angle = evaluate(recipe, posture[None, :], directions, ("tip_angle",))["tip_angle"]
        return np.asarray(angle[0])

    stands = np.zeros(heading.size)
    tips = np.full(heading.size, math.nan)
    walking = np.arange(heading.size)
    reach = reading(walking, stands)
    tips[reach < 0.0] = 0.0
    walking, reach = walking[reach >= 0.0], reach[reach >= 0.0]
    while walking.size:
        ahead = np.minimum(stands[walking] + np.maximum(reach, SHORTEST_STEP), math.pi)
        reach = reading(walking, ahead)
        fallen = reach < 0.0
        tips[walking[fallen]] = ahead[fallen]
        stands[walking[~fallen]] = ahead[~fallen]
        goes_on = ~fallen & (ahead < math.pi)
        walking, reach = walking[goes_on], reach[goes_on]
    between = np.flatnonzero(tips > stands)
    for _ in range(HALVINGS if between.size else 0):
        middle = (stands[between] + tips[between]) / 2.0
        fallen = reading(between, middle) < 0.0
        tips[between[fallen]] = middle[fallen]
        stands[between[~fallen]] = middle[~fallen]
    return stands
