"""How far postures can be tilted in each heading before they tip over.

Gravity at tilt t and heading psi is (sin t cos psi, sin t sin psi, -cos t) in the body frame, so
heading 0 is nose down, +90 deg left side down, 180 deg nose up and -90 deg right side down.  Under
convention "plane" (see `resting`) the same holds in the frame of the level ground that the posture
stands on, z its normal: the tilt is then that of the ground, as long as the robot does not rock
onto another facet.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.ground import gravity_transform
from lutgen.analysis.posture import Posture
from lutgen.arrays import Floats, Ints
from lutgen.channels import body_gravity, evaluate, evaluate_each
from lutgen.recipe import Recipe

# A tip-over region crossed in less than this tilt (rad, 0.005 deg) may be stepped over.
SHORTEST_STEP = math.radians(0.005)
# Shortest steps in a row: five degrees.
MOST_CREPT = 1000
# The limit is known to this (rad), a few hundred times the rounding of tip_angle.
KNOWN = 1e-13
# Where `tip_angle` falls to this (rad) between two directions that stand, an axis lies between two
# rests onto which the robot does not rock; that is looked for in so many rounds.
TOUCHES, ROUNDS = 1e-11, 4
# Readings at once: bounds the memory of many postures.
AT_ONCE = 200_000
# The search for the worst heading: first pieces of the circle, how fine they get (rad), and how
# many are looked into at a time, which only a region that is round itself ever has.
PIECES, FINEST, MOST = 72, 1e-6, 20_000
# Headings are equally bad within this (rad).
EQUAL = 1e-12


def tilted(tilt: ArrayLike, heading: ArrayLike) -> Floats:
    """Return gravity directions (..., 3), unit, at tilts and headings (rad) of one shape (...)."""
    t, psi = np.broadcast_arrays(np.asarray(tilt, np.float64), np.asarray(heading, np.float64))
    return np.stack([np.sin(t) * np.cos(psi), np.sin(t) * np.sin(psi), -np.cos(t)], axis=-1)


def level_frames(recipe: Recipe, params: ArrayLike, convention: str = "body") -> Floats:
    """Return the frames in which postures (m, k) are tilted, (m, 3, 3).

    Each is a rotation into the body frame: the identity for ``"body"``, and for ``"plane"`` the
    least one that takes z to the upward normal of the level ground under the robot.
    """
    rows = np.asarray(params, dtype=np.float64)
    down = body_gravity(recipe, rows, [0.0, 0.0, -1.0], convention)
    if convention == "body":
        return np.broadcast_to(np.eye(3), (len(down), 3, 3))
    return np.array([gravity_transform(-one) for one in down]).reshape(-1, 3, 3)


def tilt_limits(
    recipe: Recipe, params: ArrayLike, headings: ArrayLike, convention: str = "body"
) -> Floats:
    """Return the largest tilt before tip-over in each heading.

    The robot stands at every tilt from 0 up to the limit (rad): (h,) for headings (h,), rad, and
    one posture (k,), or (m, h) for several (m, k).  0 where it tips on level ground already, pi
    where it never tips.  `convention`: ``"body"`` or the ground, ``"plane"``, is tilted
    from level.

    Notes
    -----
    `tip_angle` changes no faster than gravity turns, so no tip-over lies within `tip_angle` of a
    standing direction: the walk from level ground steps exactly that far, and at least
    `SHORTEST_STEP`, until it has passed the limit; false position then finds it in the last step.
    Where two rests share an edge over which the robot may not roll (`gaps`), it stands on both
    sides and falls as gravity passes the edge: `tip_angle` is zero there, and that is the limit.
    So is where it has been nearer than `SHORTEST_STEP` to a boundary for `MOST_CREPT` steps.  One
    that is exactly on an axis at level stands, and its limit is where it tips next.
    """
    posture = np.asarray(params, dtype=np.float64)
    heading = np.asarray(headings, dtype=np.float64)
    rows = posture[None, :] if posture.ndim == 1 else posture
    count = max(AT_ONCE // max(heading.size, 1), 1)
    parts = [
        _Pairs(recipe, some, level_frames(recipe, some, convention), heading).limits()
        for some in (rows[i : i + count] for i in range(0, len(rows), count))
    ]
    limits = np.concatenate(parts) if parts else np.empty((0, heading.size))
    return limits[0] if posture.ndim == 1 else limits


@dataclass(frozen=True)
class _Pairs:
    """Postures (m, k) in their frames (m, 3, 3) times headings (h,), counted row by row."""

    recipe: Recipe
    rows: Floats
    frames: Floats
    heading: Floats

    def tip_angle(self, pairs: Ints, tilt: Floats) -> Floats:
        """Return tip_angle (n,) of ascending pairs (n,), each at a tilt of its own."""
        posture, heading = np.divmod(pairs, self.heading.size)
        open_ones, row = np.unique(posture, return_inverse=True)
        # Packed to the left: a posture with one open heading costs few directions, not all.
        place = np.arange(len(pairs)) - np.searchsorted(posture, open_ones)[row]
        down = np.tile([0.0, 0.0, -1.0], (len(open_ones), place.max(initial=0) + 1, 1))
        down[row, place] = tilted(tilt, self.heading[heading])
        down = np.einsum("mij,mdj->mdi", self.frames[open_ones], down)
        found = evaluate_each(self.recipe, self.rows[open_ones], down, ("tip_angle",))
        return np.asarray(found["tip_angle"][row, place])

    def lowest(self, pairs: Ints, begin: Floats, end: Floats) -> tuple[Floats, Floats]:
        """Return the tilts (n,) between two at which `tip_angle` is least, and how much it is.

        It falls towards an axis and rises behind it, in short steps linearly and equally fast.
        """
        for _ in range(ROUNDS):
            before, after = self.tip_angle(pairs, begin), self.tip_angle(pairs, end)
            rate = np.maximum((before + after) / np.maximum(end - begin, KNOWN), KNOWN)
            at = np.clip(begin + before / rate, begin, end)
            least = self.tip_angle(pairs, at)
            reach = np.maximum(2.0 * least / rate, KNOWN)
            begin, end = np.maximum(at - reach, begin), np.minimum(at + reach, end)
        return at, least

    def limits(self) -> Floats:
        """Return the limits (m, h)."""
        everything = np.arange(len(self.rows) * self.heading.size)
        stands = np.zeros(everything.size)
        reach = self.tip_angle(everything, stands)
        # Where it tips and by how much; the same place as `stands` until it has been found.
        tips, beyond, crept = stands.copy(), stands.copy(), np.zeros(everything.size, np.intp)
        walking = np.flatnonzero(reach >= 0.0)
        while walking.size:
            near, left = stands[walking], reach[walking]
            ahead = np.minimum(near + np.maximum(left, SHORTEST_STEP), math.pi)
            found, forced = self.tip_angle(walking, ahead), left < SHORTEST_STEP
            passed = found >= 0.0
            stands[walking] = np.where(passed, ahead, near)
            reach[walking] = np.where(passed, found, left)
            tips[walking], beyond[walking] = ahead, np.where(passed, 0.0, found)
            goes_on = passed & (ahead < math.pi)
            crosses = np.flatnonzero(forced & passed & ((near > 0.0) | (left > TOUCHES)))
            at, least = self.lowest(walking[crosses], near[crosses], ahead[crosses])
            axis = least <= TOUCHES
            crosses, at, least = crosses[axis], at[axis], least[axis]
            some, wedge = walking[crosses], least < 0.0
            # A wedge narrower than the step: its near side is where the robot tips.
            stands[some] = np.where(wedge, near[crosses], at)
            reach[some] = np.where(wedge, left[crosses], reach[some])
            tips[some], beyond[some] = at, np.where(wedge, least, 0.0)
            goes_on[crosses] = False
            crept[walking] = np.where(forced, crept[walking] + 1, 0)
            # It goes along its boundary: that is its limit, though it may stand further on.
            ends = walking[goes_on & (crept[walking] >= MOST_CREPT)]
            tips[ends] = stands[ends]
            walking = walking[goes_on & (crept[walking] < MOST_CREPT)]
        rounds = 0
        while (open_ones := np.flatnonzero(tips - stands > KNOWN)).size:
            low, high, left = stands[open_ones], tips[open_ones], reach[open_ones]
            # Between straight lines false position is done in two rounds: the second one looks just
            # beside the first.  Every third halves, so that a kink cannot make it slow.
            share = 0.5 if rounds % 3 == 2 else left / (left - beyond[open_ones])
            guess = np.clip(low + (high - low) * share, low + KNOWN / 2.0, high - KNOWN / 2.0)
            found = self.tip_angle(open_ones, guess)
            passed = found >= 0.0
            stands[open_ones] = np.where(passed, guess, low)
            tips[open_ones] = np.where(passed, high, guess)
            reach[open_ones] = np.where(passed, found, left)
            beyond[open_ones] = np.where(passed, beyond[open_ones], found)
            rounds += 1
        return stands.reshape(len(self.rows), self.heading.size)


def level_angles(recipe: Recipe, params: ArrayLike, convention: str = "body") -> Floats:
    """Return `tip_angle` (m,), rad, of postures (m, k) at level: negative where they tip there.

    It is the tilt that a posture survives in every heading: the cap of that radius around level
    holds no tip-over, between headings as little as on them, and in the heading of the nearest
    boundary point it is the limit itself.  Where `tip_angle` is only known from below, so is this.
    """
    rows = np.asarray(params, dtype=np.float64)
    parts = [np.empty(0)]
    for i in range(0, len(rows), AT_ONCE):
        part = rows[i : i + AT_ONCE]
        down = np.tile([0.0, 0.0, -1.0], (len(part), 1))
        found = evaluate_each(recipe, part, down, ("tip_angle",), convention)
        parts.append(found["tip_angle"])
    return np.concatenate(parts)


def worst_heading(posture: Posture, convention: str = "body") -> float:
    """Return the heading (rad, -pi to pi) in which a posture tips over first.

    If several are equally bad, it is the one nearest to the nose, on the left first.  NaN where the
    robot tips on level ground or is on an axis there, and where it never tips.

    On the circle of headings at the tilt of `level_angles`, `tip_angle` is zero in the worst
    heading and changes by at most sin(tilt) per rad.  Pieces of the circle in which it can
    therefore not be as low as seen elsewhere are dropped, and the others are divided: no heading
    is missed, however narrow.
    """
    recipe, row = posture.recipe, posture.row
    tilt = float(level_angles(recipe, row, convention)[0])
    if not 0.0 < tilt < math.pi:
        return math.nan
    frame = level_frames(recipe, row, convention)[0]
    width = 2.0 * math.pi / PIECES
    middle = width * (np.arange(PIECES) - PIECES // 2 + 1)
    while True:
        down = tilted(tilt, middle) @ frame.T
        angle = evaluate(recipe, row, down, ("tip_angle",))["tip_angle"][0]
        if width <= FINEST:
            break
        kept = np.flatnonzero(angle - math.sin(tilt) * width / 2.0 <= np.abs(angle).min())
        kept = np.sort(kept[np.argsort(angle[kept], kind="stable")[:MOST]])
        # Three parts, so that the middle of a piece stays one of the headings looked at.
        middle = (middle[kept, None] + width / 3.0 * np.array([-1.0, 0.0, 1.0])).ravel()
        width /= 3.0
    lowest = np.abs(angle).min()
    equal = middle[np.abs(angle) <= lowest + EQUAL]
    # Rounded, because the left and the right one of a pair differ in their last digits.
    nearest = equal[np.lexsort((-np.sign(equal), np.abs(equal).round(4)))[0]]
    beside = np.where(np.abs(middle - nearest) < 1e-4, np.abs(angle), math.inf)
    worst = float(middle[beside.argmin()])
    # At a corner where a tip-over axis ends the limit jumps: of what was found, the side that tips.
    sides = worst + 2.0 * FINEST * np.array([0.0, 1.0, -1.0])
    tilts = tilt_limits(recipe, row, sides, convention)[0]
    if tilts[0] - tilts.min() > 10.0 * FINEST:
        worst = float(sides[tilts.argmin()])
    return math.remainder(worst, 2.0 * math.pi)
