"""Tables of tilt limits: one posture in the four headings and the worst, or all postures.

*Body tilt* is how far the robot itself turns, as an accelerometer in it reads it (`tilt`); *ground
tilt* the slope of the ground under a robot that rolls from rest to rest on it (`ground_tilt`).
"""

import math
from dataclasses import dataclass
from decimal import ROUND_FLOOR, Decimal
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from lutgen import bounds
from lutgen.analysis.diagnosis import diagnose
from lutgen.analysis.ground_tilt import GroundTilt, ground_tilt
from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt import level_angles, level_frames, tilt_limits, tilted, worst_heading
from lutgen.arrays import Floats, Ints
from lutgen.errors import InputError, reject
from lutgen.recipe import Recipe

FOUR = {
    "nose down": 0.0,
    "left side down": math.pi / 2.0,
    "nose up": math.pi,
    "right side down": -math.pi / 2.0,
}
WORST = "worst heading"


@dataclass(frozen=True)
class HeadingLimit:
    """The limit of one posture in one heading, named by `FOUR` or "worst heading"; angles in rad.

    `heading` is NaN for the worst heading of a robot that tips on level ground, or never; the robot
    stands up to the body tilt `tilt`.  `contacts` are what it then turns over: two contacts, one on
    which it rolls, or none.  `slides` is True if it has slid before, tan(slope) > friction; None
    without a friction coefficient.
    """

    name: str
    heading: float
    tilt: float
    contacts: tuple[str, ...]
    slides: bool | None


@dataclass(frozen=True, eq=False)
class PostureLimits:
    """The limits of one posture (k,): four headings, the worst, and what holds in all of them.

    `headings` and `level` (rad, `tip_angle` at level) are of body tilt against tipping over alone;
    `convention`: counted from the attitude on level ground or from that of a
    level body.  `ground` are the limits of ground tilt, and `slide` (rad) is the slope up to which
    friction holds the robot, all its contacts braked: None where it is not known, or forces act
    beside the weight.
    """

    params: Floats
    headings: tuple[HeadingLimit, ...]
    level: float
    convention: str
    ground: GroundTilt
    slide: float | None

    @property
    def stands(self) -> bool:
        """True if the robot stands at level, if only just: exactly on an axis it does."""
        return self.level >= 0.0 or self.ground.stands

    @property
    def guaranteed(self) -> float:
        """Body tilt (rad) that holds in every heading, see `tilt.level_angles`."""
        return max(self.level, 0.0)

    @property
    def worst(self) -> HeadingLimit:
        """The worst heading of body tilt."""
        return self.headings[-1]

    @property
    def guaranteed_ground(self) -> float:
        """Slope (rad) of the ground up to which the robot stands in every heading.

        It neither tips over nor, where `slide` is known, slides with all its contacts braked.
        """
        tips = self.ground.guaranteed
        return tips if self.slide is None else min(tips, self.slide)


@dataclass(frozen=True, eq=False)
class SweepLimits:
    """Least and largest limits over m postures, `params` (m, k), in `headings` (h,), rad.

    `least` and `most` (h,) are the least and largest tilt (rad) of any posture in each heading,
    `least_at` and `most_at` (h,) rows of `params`: the first posture that has it.  `level` (m,) is
    each posture's `tip_angle` at level, rad.  All of this is body tilt.
    """

    recipe: Recipe
    params: Floats
    headings: Floats
    least: Floats
    most: Floats
    least_at: Ints
    most_at: Ints
    level: Floats

    @cached_property
    def guaranteed(self) -> Floats:
        """Return the tilt that each posture survives in every heading, (m,), rad."""
        return np.maximum(self.level, 0.0)

    @cached_property
    def guaranteed_ground(self) -> Floats:
        """Return the ground tilt that each posture survives in all headings, (m,), rad."""
        found = (ground_tilt(Posture(self.recipe, row)).guaranteed for row in self.params)
        return np.fromiter(found, np.float64, len(self.params))


def rounded_down(angle: float, decimals: int = 2) -> float:
    """Return a limit in deg rounded down, so that what is printed holds, too.

    Exact in decimals: 100 x 52.149999999999999 is 5215 in float64.

    Examples
    --------
    >>> rounded_down(22.765, 1), rounded_down(52.149999999999999)
    (22.7, 52.14)
    """
    return float(Decimal(angle).quantize(Decimal(1).scaleb(-decimals), ROUND_FLOOR))


def even_headings(count: int) -> Floats:
    """Return `count` evenly spaced headings (rad) from the nose to the left, (count,).

    It is a multiple of 4, so that the four named headings are among them.
    """
    if count < 4 or count % 4:
        way_out = "nose, tail and both sides are then among them"
        reject("headings", "their number must be a multiple of 4", count, way_out, InputError)
    bounds.check(count, bounds.HEADINGS, "the headings", "use fewer")
    return np.arange(count, dtype=np.float64) * (2.0 * math.pi / count)


def posture_limits(posture: Posture, convention: str = "plane") -> PostureLimits:
    """Return the limits of one posture.

    With convention ``"plane"`` body tilt is counted from how the robot stands on level ground, with
    ``"body"`` from where its own z axis is vertical.  Ground tilt has no such choice.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> found = posture_limits(Posture(load_recipe("maps/absolem.toml"), np.radians([90, 90])))
    >>> [(row.name, round(math.degrees(row.tilt), 1)) for row in found.headings[::3]]
    [('nose down', 59.0), ('right side down', 57.7)]
    >>> found.worst.contacts
    ('right_track_rear', 'left_track_rear')
    """
    recipe, params = posture.recipe, posture.params
    level = float(level_angles(recipe, posture.row, convention)[0])
    headings = dict(FOUR)
    worst = worst_heading(posture, convention)
    known = [*headings.values(), *([] if math.isnan(worst) else [worst])]
    tilts = tilt_limits(recipe, params, np.array(known), convention).tolist()
    if math.isnan(worst):
        tilts.append(max(level, 0.0))
    elif min(tilts) < tilts[-1]:
        # A tie that rounding decided the other way.
        tilts[-1] = min(tilts)
        worst = known[tilts.index(tilts[-1])]
    headings[WORST] = worst
    frame = level_frames(recipe, posture.row, convention)[0]
    rows = [
        _row(posture, frame, name, heading, tilt)
        for (name, heading), tilt in zip(headings.items(), tilts, strict=True)
    ]
    # Exact on one plane, whichever contacts carry.
    mu = None if recipe.has_wrench else recipe.friction
    slide = None if mu is None else math.atan(mu)
    return PostureLimits(params, tuple(rows), level, convention, ground_tilt(posture), slide)


def _row(posture: Posture, frame: Floats, name: str, heading: float, tilt: float) -> HeadingLimit:
    """Return what happens at a limit."""
    if tilt >= math.pi:
        return HeadingLimit(name, heading, tilt, (), None)
    down = tilted(tilt, 0.0 if math.isnan(heading) else heading)
    state = diagnose(posture, frame @ down)
    axis = None if state.least_stable is None else state.tip_over_axes[state.least_stable]
    names = () if axis is None else tuple(dict.fromkeys(axis.names))
    return HeadingLimit(name, heading, tilt, names, state.slides)


def sweep_limits(
    recipe: Recipe, params: ArrayLike, headings: ArrayLike, convention: str = "plane"
) -> SweepLimits:
    """Return the least and largest limits over postures (m, k) in headings (h,)."""
    rows = np.asarray(params, dtype=np.float64)
    heading = np.asarray(headings, dtype=np.float64)
    tilts = tilt_limits(recipe, rows, heading, convention)
    least_at, most_at = _first(tilts, -1.0), _first(tilts, 1.0)
    across = np.arange(len(heading))
    least, most = tilts[least_at, across], tilts[most_at, across]
    level = level_angles(recipe, rows, convention)
    return SweepLimits(recipe, rows, heading, least, most, least_at, most_at, level)


def _first(tilts: Floats, sign: float) -> Ints:
    """Return the first posture of the largest sign * tilt in each heading, but for rounding."""
    value = sign * tilts
    return np.asarray((value >= value.max(axis=0) - 1e-12).argmax(axis=0))
