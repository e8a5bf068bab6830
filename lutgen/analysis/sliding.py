"""What happens before a robot tips: it slides, or a group of contacts carries too little.

All contacts count as braked here.  Sliding never changes the verdict on tipping.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt import level_frames, tilt_limits, tilted
from lutgen.bracket import halve
from lutgen.channels import (
    MU,
    PHI,
    acceptance_of,
    checked_directions,
    empty_axes,
    evaluate,
    find_axes,
    for_each_posture,
    loaded_verdict,
    part,
)
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.parts import Group
from lutgen.recipe import Recipe, forward
from lutgen.support import Acceptance, empty_region, seat_under, stand
from lutgen.vector import Floats, add, cross, dot, length, read3, row

# Tilts between two looks (rad, 0.1 deg): what passes in less may be stepped over.
STEP = math.radians(0.1)
# Halvings of such a step: what begins is then known to 1e-13 rad.
HALVINGS = 35


@njit()
def _slopes_of_some(
    begin: int,
    end: int,
    primitives: Floats,
    wrench: Floats,
    gravity_dir: Floats,
    acceptance: Acceptance,
    out: Floats,
) -> None:
    """Fill `out` (m, d) for postures [begin, end)."""
    region = empty_region(primitives.shape[1])
    axes = empty_axes(region)
    for posture in range(begin, end):
        load = wrench[posture]
        stand(region, primitives[posture], acceptance)
        has_wrench = length(part(load, PHI)) + length(part(load, MU)) > 0.0
        if has_wrench:
            find_axes(region, load, axes)
        for d in range(gravity_dir.shape[1]):
            g = row(gravity_dir[posture], d)
            if has_wrench:
                k = loaded_verdict(region, axes, load, g)[0]
                g = add(g, part(load, PHI))
            else:
                k = seat_under(region, g)
            out[posture, d] = math.nan
            if k >= 0:
                normal = read3(region.seat[k].normal)
                out[posture, d] = math.atan2(length(cross(normal, g)), dot(normal, g))


def slopes(recipe: Recipe, params: ArrayLike, gravity_dir: ArrayLike) -> Floats:
    """Return the slope of the ground under m postures, each with directions of its own.

    Parameters
    ----------
    recipe : Recipe
    params : (m, k) array_like
        Geometry parameters, rad or length.
    gravity_dir : (m, d, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.

    Returns
    -------
    (m, d) float64
        Radians in [0, pi/2): the angle between gravity (with the recipe's forces) and the outward
        normal of the support facet, also where the robot tips; NaN where it has none.
    """
    where = forward(recipe, params)
    directions = np.asarray(gravity_dir, dtype=np.float64)
    if directions.ndim != 3 or directions.shape[::2] != (len(where.com), 3):
        raise InputError(
            f"gravity_dir must have the shape ({len(where.com)}, d, 3) (got {directions.shape}); "
            "give rows x, y, z for each posture"
        )
    found = np.empty(directions.shape[:2])
    units = np.ascontiguousarray(unit_directions(directions))
    for_each_posture(_slopes_of_some, recipe, where, units, acceptance_of(recipe), found)
    return found


def slides_first(recipe: Recipe, params: ArrayLike, gravity_dir: ArrayLike) -> NDArray[np.bool_]:
    """Tell whether friction fails to hold the robot on its support facet.

    Parameters
    ----------
    recipe : Recipe
        The robot, with a friction coefficient mu.
    params : (m, k) array_like
        Geometry parameters, rad or length.
    gravity_dir : (g, 3) array_like
        Directions in the body frame, pointing down, of any length > 0.

    Returns
    -------
    (m, g) bool
        True where the tangent of the slope exceeds mu, all contacts braked; at exactly mu the
        robot holds.  False without a support facet.

    Raises
    ------
    InputError
        Without friction in the recipe, for wrong shapes and numbers that are not finite.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> recipe = load_recipe("maps/three_leg_sphere.toml")  # friction 0.6: 30.96 deg
    >>> middle = [[(p.minimum + p.maximum) / 2.0 for p in recipe.parameters]]
    >>> slides_first(recipe, middle, [[0, 0, -1], [0.59, 0, -1], [0.61, 0, -1]])
    array([[False, False,  True]])
    """
    if recipe.friction is None:
        raise InputError(
            f"{recipe.source}: the recipe has no friction coefficient (got no `robot.friction`); "
            "add one, for example friction = 0.8, to learn where the robot slides."
        )
    directions = checked_directions(gravity_dir)
    m = len(np.asarray(params, dtype=np.float64))
    each = np.broadcast_to(directions, (m, *directions.shape))
    return np.asarray(np.tan(np.nan_to_num(slopes(recipe, params, each))) > recipe.friction)


def first_tilts(
    happens: Callable[[Floats, NDArray[np.intp]], NDArray[np.bool_]],
    headings: ArrayLike,
    until: ArrayLike = math.pi,
    step: float = STEP,
    halvings: int = HALVINGS,
) -> Floats:
    """Return the smallest tilt (h,) in each heading at which something happens, all in rad.

    `happens` takes directions (j, 3) and the headings' indices (j,) and returns (j,) bool.  What
    begins and ends between two looks, a `step` apart, may be missed; the last step is halved.  NaN
    where it does not happen before `until`, a tilt for all headings or for each.
    """
    heading = np.asarray(headings, dtype=np.float64)
    end = np.broadcast_to(np.asarray(until, dtype=np.float64), heading.shape)
    rows = np.arange(heading.size)
    before, after = np.zeros(heading.size), np.full(heading.size, math.nan)
    count = 0
    while rows.size:
        tilt = np.minimum(count * step, end[rows])
        found = happens(tilted(tilt, heading[rows]), rows)
        after[rows[found]] = tilt[found]
        goes_on = ~found & (tilt < end[rows])
        before[rows[~found]] = tilt[~found]
        rows, count = rows[goes_on], count + 1
    between = np.flatnonzero(after > before)
    if between.size:
        _, after[between] = halve(
            lambda middle: happens(tilted(middle, heading[between]), between),
            before[between],
            after[between],
            halvings,
        )
    return after


def share_limits(
    posture: Posture, name: str, share: float, headings: ArrayLike, convention: str = "body"
) -> Floats:
    """Return the tilt in each heading (h,) from which on a group carries less than a share, rad.

    `name` is that of a group or of a contact.  Up to the tilt at which the robot tips at most; 0
    where it carries less on level ground, which `convention` refers to, see `tilt.level_frames`.
    """
    recipe, row = posture.recipe, posture.row
    groups = {one: Group(one, (one,)) for one in recipe.contact_names}
    groups |= {group.name: group for group in recipe.groups}
    if name not in groups or not 0.0 < share <= 1.0:
        raise InputError(
            f"{recipe.source}: a share above 0 and up to 1 of a group or contact is needed (got "
            f"{name}={share:g}); there are {', '.join(groups)}"
        )
    alone = replace(recipe, groups=(groups[name],))
    frame = level_frames(recipe, row, convention)[0]

    def light(directions: Floats, _: NDArray[np.intp]) -> NDArray[np.bool_]:
        found = evaluate(alone, row, directions @ frame.T, ("least_share",))["least_share"][0]
        return np.asarray(~(found >= share))

    end = tilt_limits(recipe, posture.params, headings, convention)
    found = first_tilts(light, headings, end)
    return np.where(np.isnan(found), end, found)


def slide_limits(
    posture: Posture, headings: ArrayLike, convention: str = "body", until: float = math.pi
) -> Floats:
    """Return the tilt in each heading from which on friction does not hold the robot.

    The recipe has a friction coefficient mu; all angles are in rad, and `convention` says what is
    tilted, see `tilt.level_frames`.  The limit (h,) is atan mu where the support facet is level in
    the body; a facet that is not shifts it, to 0 where the robot slides on level ground already.
    NaN where it does not slide before the tilt `until`.
    """
    recipe, row = posture.recipe, posture.row
    frame = level_frames(recipe, row, convention)[0]

    def slides(directions: Floats, _: NDArray[np.intp]) -> NDArray[np.bool_]:
        return np.asarray(slides_first(recipe, row, directions @ frame.T)[0])

    return first_tilts(slides, headings, until)
