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
from lutgen.channels import MU, PHI, evaluate
from lutgen.errors import InputError, reject
from lutgen.parts import Group
from lutgen.vector import Floats

# Tilts between two looks (rad, 0.1 deg): what passes in less may be stepped over.
STEP = math.radians(0.1)
# Halvings of such a step: what begins is then known to 1e-13 rad.
HALVINGS = 35


def first_tilts(
    posture: Posture,
    happens: Callable[[Floats], NDArray[np.bool_]],
    headings: ArrayLike,
    convention: str = "body",
    step: float = STEP,
    halvings: int = HALVINGS,
) -> tuple[Floats, Floats]:
    """Return the smallest tilt (h,) in each heading at which something happens, and the end (h,).

    The end is the tilt at which the robot tips over; all are in rad.

    `happens` takes directions (j, 3) in the body and returns (j,) bool.  What begins and ends
    between two looks, a `step` apart, may be missed; the last step is halved.  NaN where it does
    not happen before the end.  `convention` is that of `tilt.level_frames`.
    """
    heading = np.asarray(headings, dtype=np.float64)
    frame = level_frames(posture.recipe, posture.row, convention)[0]
    end = tilt_limits(posture.recipe, posture.params, heading, convention)
    rows = np.arange(heading.size)
    before, after = np.zeros(heading.size), np.full(heading.size, math.nan)
    count = 0
    while rows.size:
        tilt = np.minimum(count * step, end[rows])
        found = happens(tilted(tilt, heading[rows]) @ frame.T)
        after[rows[found]] = tilt[found]
        goes_on = ~found & (tilt < end[rows])
        before[rows[~found]] = tilt[~found]
        rows, count = rows[goes_on], count + 1
    between = np.flatnonzero(after > before)
    if between.size:
        _, after[between] = halve(
            lambda middle: happens(tilted(middle, heading[between]) @ frame.T),
            before[between],
            after[between],
            halvings,
        )
    return after, end


def share_limits(
    posture: Posture, name: str, share: float, headings: ArrayLike, convention: str = "body"
) -> Floats:
    """Return the tilt in each heading (h,) from which on a group carries less than a share, rad.

    `name` is that of a group or of a contact.  Up to the tilt at which the robot tips at most; 0
    where it carries less on level ground, which `convention` refers to, see `tilt.level_frames`.
    """
    recipe = posture.recipe
    groups = {one: Group(one, (one,)) for one in recipe.contact_names}
    groups |= {group.name: group for group in recipe.groups}
    if name not in groups or not 0.0 < share <= 1.0:
        what = "a share above 0 and up to 1 of a group or contact is needed"
        way_out = f"there are {', '.join(groups)}"
        reject(recipe.source, what, f"{name}={share:g}", way_out, InputError)
    alone = replace(recipe, groups=(groups[name],))

    def light(down: Floats) -> NDArray[np.bool_]:
        found = evaluate(alone, posture.row, down, ("least_share",))["least_share"][0]
        return np.asarray(~(found >= share))

    return np.fmin(*first_tilts(posture, light, headings, convention))


def slide_limits(posture: Posture, headings: ArrayLike, convention: str = "body") -> Floats:
    """Return the tilt in each heading (h,) from which on friction does not hold the robot, rad.

    The recipe has a friction coefficient mu.  The limit is atan mu where the support facet is level
    in the body; a facet that is not shifts it, to 0 where the robot slides on level ground already.
    NaN where it tips over first.  `convention` is that of `tilt.level_frames`.
    """
    recipe, push = posture.recipe, posture.wrench[PHI:MU]
    if recipe.friction is None:
        what = "the recipe has no friction coefficient"
        way_out = "add one, for example friction = 0.8, to learn where the robot slides"
        reject(recipe.source, what, "no `robot.friction`", way_out, InputError)
    mu = recipe.friction
    normals = np.array([facet.normal for facet in posture.stance.facets]).reshape(-1, 3)

    def slides(down: Floats) -> NDArray[np.bool_]:
        facet = evaluate(recipe, posture.row, down, ("facet",))["facet"][0]
        found, on = np.zeros(len(down), np.bool_), facet >= 0.0
        normal, force = normals[facet[on].astype(int)], down[on] + push
        across = np.linalg.norm(np.cross(normal, force), axis=1)
        found[on] = across > mu * (normal * force).sum(axis=1)
        return found

    return first_tilts(posture, slides, headings, convention)[0]
