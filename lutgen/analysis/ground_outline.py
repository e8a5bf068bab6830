"""How far the ground under a robot can be tilted slowly, in every heading, before it tips over.

Owns *ground tilt*: the robot stands on level ground, the ground is tilted in one heading, and where
gravity leaves the rest that it stands on, it rocks onto the next one or tips over.  The limit is
the slope of the ground at that moment.  *Body tilt* (`tilt`) is what an accelerometer in it sees:
where a robot rocks, its body turns further than the ground does.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lutgen.analysis.ground_walk import ON, SAME, Piece, tip_angles, walk
from lutgen.analysis.rocking import Edge, seat_on, turn_to
from lutgen.analysis.stance import Posture
from lutgen.analysis.tilt import level_frames
from lutgen.recipe import Recipe
from lutgen.vector import Floats

# A bound is lowered by this (rad), some hundred roundings.
ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class GroundTilt:
    """The limits of one posture on tilted ground, in all headings; angles in rad.

    `pieces` cover the circle of headings; none of a robot that tips over on level ground.
    `elsewhere` is the tilt below which it does not tip over on any rest that it could rock onto,
    also where a slow tilt from level does not bring it there.
    """

    posture: Posture
    pieces: tuple[Piece, ...]
    elsewhere: float

    def limits(self, headings: ArrayLike) -> Floats:
        """Return the slope (h,) of the ground at tip-over in headings (h,): in [0, pi/2)."""
        return self._at(headings)[0]

    def contacts(self, heading: float) -> tuple[str, ...]:
        """Return the names of the contacts over which the robot tips in a heading."""
        tilt, which = self._at([heading])
        if not self.pieces or tilt[0] <= 0.0:
            return ()
        names = self.posture.recipe.contact_names
        return tuple(dict.fromkeys(names[i] for i in self.pieces[which[0]].over.contacts))

    @property
    def guaranteed(self) -> float:
        """Slope up to which the robot tips over in no heading, whichever of its rests it is on.

        The least limit of all headings, or `elsewhere` if that is less, and a rounding below it.
        """
        return max(min(self.least, self.elsewhere) - ROUNDING, 0.0)

    @property
    def least(self) -> float:
        """The least limit of all headings, that of the worst one."""
        return self._lowest()[0]

    @property
    def worst(self) -> float:
        """Heading of the least limit, of several the nearest to the nose, on the left first.

        NaN where the robot tips on level ground.
        """
        least, heading = self._lowest()
        return heading if least > 0.0 else math.nan

    def _lowest(self) -> tuple[float, float]:
        """Return the least limit and its heading."""
        if not self.pieces:
            return 0.0, math.nan
        found = [piece.lowest() for piece in self.pieces]
        least = min(tilt for tilt, _ in found)
        equal = [math.remainder(at, 2.0 * math.pi) for tilt, at in found if tilt <= least + ON]
        return least, min(equal, key=lambda at: (round(abs(at), 4), -at))

    def _at(self, headings: ArrayLike) -> tuple[Floats, np.ndarray]:
        """Return limits and indices of the pieces (h,)."""
        heading = np.remainder(np.asarray(headings, np.float64) + math.pi, 2.0 * math.pi) - math.pi
        best, which = np.full(heading.shape, math.inf), np.zeros(heading.shape, np.intp)
        for i, piece in enumerate(self.pieces):
            near = (heading >= piece.begin - SAME) & (heading <= piece.end + SAME)
            tilt = np.where(near, np.maximum(piece.limit.tilt(heading), 0.0), math.inf)
            which, best = np.where(tilt < best, i, which), np.minimum(tilt, best)
        return np.where(np.isfinite(best), best, 0.0), which


def ground_tilt(posture: Posture) -> GroundTilt:
    """Return how far the ground under a posture can be tilted in every heading.

    Notes
    -----
    In the plane of slopes (see `rocking`) each rest is a polygon with straight sides, and where the
    robot enters the next one is a straight line, too.  The circle of headings is therefore cut
    where a ray passes a corner, or where such lines cross, and between cuts one edge decides: the
    limit is known in closed form, and so is its minimum.  No heading is a sample.

    The robot rocks over an edge if there is a facet beyond it, if the turns since it last stood on
    a rest still add up to `rock_angle` at most, and if it stands or is caught (`evaluate`) under
    gravity just beyond the edge and as seated behind it.  The last is asked of whole arcs:
    `tip_angle` changes no faster than gravity turns, and is nothing at an edge beyond which the
    robot is not caught.  Where it cannot be shown it counts as tipping.  On a stage of rolling the
    robot lies as long as gravity does.

    A robot can stand on another rest than that onto which a slow tilt from level brings it.  Of
    every rest that it could rock onto from there, or from that under its level body, `tip_angle`
    under gravity along the normal is the distance to the nearest boundary of the standing region,
    so that a slope less than it tips the robot over from none: that is in what is `guaranteed`.

    Under forces the limit is where the robot leaves the rest that it stands on at level.
    """
    frame = level_frames(posture.recipe, posture.row, "plane")[0]
    facets = posture.stance.facets
    if not facets or tip_angles(posture, -frame[None, :, 2])[0] < 0.0:
        return GroundTilt(posture, (), 0.0)
    rest = int(np.argmax([float(facet.normal @ -frame[:, 2]) for facet in facets]))
    seat = seat_on(posture, rest, frame)
    if any(edge.reach + edge.push < -ON for edge in seat.edges):
        # No rest carries it on level ground, where gravity pierces another one by chance.
        return GroundTilt(posture, (), 0.0)
    if posture.recipe.has_wrench:
        pieces = [Piece(*ends, edge, edge, seat) for edge in seat.edges for ends in _half(edge)]
        return GroundTilt(posture, tuple(pieces), math.inf)
    # Also from the rest that it is on with its body level, which may be another one.
    level = np.array([[0.0, 0.0, -1.0]])
    upright = [int(posture.stance.under(level)[0])] if tip_angles(posture, level)[0] >= 0.0 else []
    normals = np.array([facets[k].normal for k in _rests(posture, rest, *upright)])
    return GroundTilt(posture, walk(posture, seat), float(abs(tip_angles(posture, normals)).min()))


def _half(edge: Edge) -> list[tuple[float, float]]:
    """Return the headings that lead towards an edge, as one or two parts of the circle."""
    low, high = edge.steepest - math.pi / 2.0, edge.steepest + math.pi / 2.0
    parts = [(max(low, -math.pi), min(high, math.pi))]
    if low < -math.pi:
        parts.append((low + 2.0 * math.pi, math.pi))
    if high > math.pi:
        parts.append((-math.pi, high - 2.0 * math.pi))
    return parts


def _rests(posture: Posture, *starts: int) -> list[int]:
    """Return rests and all that the robot could rock onto from there, one after the other.

    Between two rests it may pass stages, with turns that add up to `rock_angle` at most.
    """
    facets, most = posture.stance.facets, posture.recipe.rock_angle + SAME
    turned = {rest: 0.0 for rest in starts if rest >= 0}
    waiting = list(turned)
    while waiting:
        k = waiting.pop()
        for beyond in facets[k].beyond:
            turn = math.inf if beyond < 0 else turned[k] + turn_to(posture, k, beyond)
            if turn > most:
                continue
            turn = 0.0 if facets[beyond].is_rest else turn
            if turn < turned.get(beyond, math.inf):
                turned[beyond] = turn
                waiting.append(beyond)
    return [k for k in turned if facets[k].is_rest or k in starts]


def ground_limits(recipe: Recipe, params: ArrayLike, headings: ArrayLike) -> Floats:
    """Return the slopes of the ground at which the robot tips over.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (m, k) array_like
        Postures, rad or length.
    headings : (h,) array_like
        In which the ground falls, rad; 0 is under the nose.

    Returns
    -------
    (m, h) float64
        Radians in [0, pi/2); 0 where the robot tips over on level ground.  See `ground_tilt`.
    """
    rows = np.asarray(params, dtype=np.float64)
    return np.array([ground_tilt(Posture(recipe, row)).limits(headings) for row in rows])
