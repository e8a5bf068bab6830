"""Limits before a robot tips: it slides, it rolls away, or a group of contacts carries too little.

Sliding and the loads of groups count all contacts as braked, and never change the verdict on
tipping.

A contact with ``rolling = true`` takes no force along its rolling direction: a disc none along
axis x normal, a sphere none at all.  Where statics leaves the normal forces open the robot *holds*
if it does under every load that balances, and *may hold* if it does under some; it *rolls* where
it does under none.  The verdict on tipping is that of the robot held in place.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.forces import load_corners, normal_forces
from lutgen.analysis.posture import Facet, Posture
from lutgen.analysis.resistance import BRAKED, least_resistance
from lutgen.analysis.tilt import level_frames, tilt_limits, tilted
from lutgen.arrays import Bools
from lutgen.bracket import halve
from lutgen.channels import checked_directions, evaluate
from lutgen.errors import InputError, reject
from lutgen.parts import Group
from lutgen.support import DISC, SPHERE
from lutgen.vector import Floats

# Tilts between two looks (rad, 0.1 deg): what passes in less may be stepped over.
STEP = math.radians(0.1)
# Halvings of such a step: what begins is then known to 1e-13 rad.
HALVINGS = 35
# Shares and slopes (rad) below these are rounding.
NOTHING, LEVEL = 1e-6, 1e-9
# A share is found to some 1e-12; what holds within this of it does not hold for certain.
UNSURE = 1e-10
# For the limit of rolling: tilt (rad, 2 deg) between two looks, halved to 1e-7 deg.
ROLL_STEP, ROLL_HALVINGS = math.radians(2.0), 24

Loads = Literal["every", "some"]


def first_tilts(
    posture: Posture,
    happens: Callable[[Floats], Bools],
    headings: ArrayLike,
    convention: str = "body",
    step: float = STEP,
    halvings: int = HALVINGS,
) -> tuple[Floats, Floats]:
    """Return the smallest tilt (h,) in each heading at which something happens, and the end (h,).

    The end is the tilt at which the robot tips over; all are in rad.

    `happens` takes directions (j, 3) in the body and returns (j,) bool.  An interval within one
    `step` may be missed; the last step is halved.  NaN where it does
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

    def light(down: Floats) -> Bools:
        found = evaluate(alone, posture.row, down, ("least_share",))["least_share"][0]
        return np.asarray(~(found >= share))

    return np.fmin(*first_tilts(posture, light, headings, convention))


def slide_limits(posture: Posture, headings: ArrayLike, convention: str = "body") -> Floats:
    """Return the tilt in each heading (h,) from which on friction does not hold the robot, rad.

    The recipe has a friction coefficient mu.  The limit is atan mu where the support facet is level
    in the body; a facet that is not shifts it, to 0 where the robot slides on level ground already.
    NaN where it tips over first.  `convention` is that of `tilt.level_frames`.
    """
    recipe, push = posture.recipe, posture.wrench["phi"]
    if recipe.friction is None:
        what = "the recipe has no friction coefficient"
        way_out = "add one, for example friction = 0.8, to learn where the robot slides"
        reject(recipe.source, what, "no `robot.friction`", way_out, InputError)
    mu = recipe.friction
    normals = np.array([facet.normal for facet in posture.facets]).reshape(-1, 3)

    def slides(down: Floats) -> Bools:
        facet = evaluate(recipe, posture.row, down, ("facet",))["facet"][0]
        found, on = np.zeros(len(down), np.bool_), facet >= 0.0
        normal, force = normals[facet[on].astype(int)], down[on] + push
        across = np.linalg.norm(np.cross(normal, force), axis=1)
        found[on] = across > mu * (normal * force).sum(axis=1)
        return found

    return first_tilts(posture, slides, headings, convention)[0]


def held_share(posture: Posture, facet: Facet, direction: Floats, loads: Loads = "every") -> float:
    """Return the share of friction that holds the robot against gravity's pull downhill.

    Under given normal forces the robot holds its place while tan(slope) <= mu x share.  The share
    is the least, over all motions downhill in the contact plane (shifts and turns), of what
    friction takes from them over what it would take with every contact braked: by the theorem of
    virtual power friction forces balance gravity, a unit vector (3,), if and only if no motion
    gains more than it costs.

    ``"every"`` load that balances and does not pull has at least this share (least at one of
    `load_corners`), ``"some"`` has it.  Over a gap, where no load balances, both are of the
    `normal_forces` that push.  1 without a rolling contact among the facet's, and on level ground.
    """
    contacts = [posture.recipe.contacts[i] for i in facet.touching]
    level = float(np.linalg.norm(facet.along(direction))) < LEVEL
    if level or not any(one.rolling for one in contacts):
        return 1.0
    frame = facet.frame(direction)
    points, pierced = facet.touching_points, facet.pierced(direction)
    corners = load_corners(points, pierced)
    if not len(corners):
        pushing = np.maximum(normal_forces(points, pierced), 0.0)
        corners = pushing[None] / pushing.sum()
    arm = points @ frame.T
    arm = arm / np.abs(arm).max()
    roll = np.cross(posture.placed.axes[0, list(facet.touching)], facet.normal) @ frame.T
    size = np.linalg.norm(roll, axis=1, keepdims=True)
    roll = roll / np.where(size > 0.0, size, 1.0)
    free = [DISC if one.kind == "disc" else SPHERE for one in contacts]
    motion = np.where([one.rolling for one in contacts], free, BRAKED)
    # Each load by itself, or all mixtures of them.
    parts = np.vsplit(corners, len(corners)) if loads == "every" else [corners]
    least = 1.0
    for part in parts:
        able = (part > 0.0).any(axis=0)
        share = least_resistance(motion[able], part[:, able], arm[able], roll[able])
        least = min(least, float(share))
    return least


def holds(posture: Posture, gravity_dir: ArrayLike) -> Bools:
    """Return True if one posture holds its place under every load that balances, (g,).

    True where it stands under `gravity_dir` (g, 3) (down, body frame, any length > 0) and friction
    keeps it from sliding and rolling: tan(slope) <= mu x `held_share`, and on level ground.
    Without a friction coefficient braked contacts that carry load never slip.  Forces are refused.
    """
    return _verdicts(posture, gravity_dir, "every")[1]


def may_hold(posture: Posture, gravity_dir: ArrayLike) -> Bools:
    """Return True if one posture holds its place under some load that balances; else as `holds`.

    Where it may hold and does not hold for every load, the answer depends on how the contacts share
    the weight, on springs and on what is a little longer or shorter.
    """
    return _verdicts(posture, gravity_dir, "some")[1]


def rolls(posture: Posture, gravity_dir: ArrayLike) -> Bools:
    """Return True if one posture rolls away under every load that balances, (g,), see `holds`.

    True where it stands on a contact that rolls and does not even `may_hold`, also where it slides
    first; false where it tips and on level ground.  False is no promise that it stays.
    """
    _, stays, rolling = _verdicts(posture, gravity_dir, "some")
    return np.asarray(rolling & ~stays)


def _verdicts(posture: Posture, gravity_dir: ArrayLike, loads: Loads) -> tuple[Bools, Bools, Bools]:
    """Return where it stands, is held there, and stands on a contact that rolls, (g,) each."""
    directions = checked_directions(gravity_dir)
    posture.refuse_forces()
    recipe = posture.recipe
    angle = evaluate(recipe, posture.row, directions, ("tip_angle",))["tip_angle"][0]
    stands, (stays, rolling) = angle >= 0.0, np.zeros((2, len(angle)), np.bool_)
    for d in np.flatnonzero(stands):
        facet = posture.under(directions[d])
        if facet is None:
            continue
        rolling[d] = any(recipe.contacts[i].rolling for i in facet.touching)
        share = held_share(posture, facet, directions[d], loads)
        slope = math.acos(min(1.0, float(facet.normal @ directions[d])))
        if rolling[d] and slope > LEVEL:
            share += UNSURE if loads == "some" else -UNSURE
        if recipe.friction is None:
            stays[d] = share >= NOTHING
        else:
            stays[d] = slope <= LEVEL or math.tan(slope) <= recipe.friction * share
    return stands, stays, rolling


def roll_limits(posture: Posture, headings: ArrayLike) -> Floats:
    """Return the tilt (h,) in each heading (h,) from which on the robot rolls away, rad.

    The tilts are looked at every 2 deg; NaN where it tips over before it rolls.  Up to there it
    may hold; up to `hold_limits` it does.
    """
    turns = partial(rolls, posture)
    return first_tilts(posture, turns, headings, step=ROLL_STEP, halvings=ROLL_HALVINGS)[0]


def hold_limits(posture: Posture, headings: ArrayLike) -> Floats:
    """Return the tilt (h,) in each heading (h,) from which on it does not hold for certain, rad.

    As `roll_limits`, except that the limit is there for a robot that slides, too; 0 where it holds
    on level ground alone.
    """

    def gives(down: Floats) -> Bools:
        stands, stays, _ = _verdicts(posture, down, "every")
        return np.asarray(stands & ~stays)

    return first_tilts(posture, gives, headings, step=ROLL_STEP, halvings=ROLL_HALVINGS)[0]


def rolling_gravity(posture: Posture, gravity_dir: ArrayLike) -> Floats | None:
    """Return the direction (3,) of gravity and inertia together while the robot rolls freely.

    With massless wheels nothing resists along the common rolling direction t: what remains to tip
    the robot is g - (g . t) t; on balls, which roll in every direction, the part along the facet's
    normal.  `gravity_dir` (3,) is in the body frame, pointing down, of any length > 0.

    None where the robot does not roll freely and straight: a contact of its support facet is
    braked, the discs roll in different directions, or the slope also pulls sideways with all discs
    on one axle.
    """
    down = checked_directions(gravity_dir)
    posture.refuse_forces()
    recipe, facet, direction = posture.recipe, posture.under(down[0]), down[0]
    if facet is None or not all(recipe.contacts[i].rolling for i in facet.touching):
        return None
    discs = [i for i in facet.touching if recipe.contacts[i].kind == "disc"]
    remainder = float(facet.normal @ direction) * facet.normal
    if discs:
        roll = np.cross(posture.placed.axes[0, discs], facet.normal)
        roll /= np.linalg.norm(roll, axis=1, keepdims=True)
        aside = np.cross(facet.normal, roll[0])
        if np.abs(roll @ aside).max() > NOTHING:
            return None
        sideways = float(aside @ direction)
        places = facet.touching_points[[facet.touching.index(i) for i in discs]] @ roll[0]
        if abs(sideways) > LEVEL and np.ptp(places) < NOTHING * np.abs(facet.points).max():
            return None
        remainder = remainder + sideways * aside
    return np.asarray(remainder / np.linalg.norm(remainder))
