"""How far the ground under a robot can be tilted slowly, in every heading, before it tips over.

Owns *ground tilt*: the robot stands on level ground, the ground is tilted in one heading, and where
gravity leaves the rest that it stands on, it rocks onto the next one or tips over.  The limit is
the slope of the ground at that moment.  *Body tilt* (`tilt`) is what an accelerometer in it sees:
where a robot rocks, its body turns further than the ground does.
"""

import math
from dataclasses import dataclass
from heapq import heappop, heappush

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
# A robot that rocks by less than this (rad), as between the halves of a rectangle that noise has
# split, does not swing.
SWINGS = 0.01


@dataclass(frozen=True, eq=False)
class GroundTilt:
    """The limits of one posture on tilted ground, in all headings; angles in rad.

    `pieces` cover the circle of headings; none of a robot that tips over on level ground.
    `elsewhere` is the tilt below which it does not tip over on any facet that it could rock onto,
    also where the ground is turned under it as it pleases and not tilted from level at once.
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
        """Slope up to which the robot tips over in no heading, whatever headings came before.

        The least limit of all headings, or `elsewhere` if that is less, and a rounding below it.
        It holds for ground that has not been steeper since the robot stood on level ground: once it
        has rocked onto another rest on a steeper slope, it may have less left there.
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

    Ground whose heading changes can bring the robot onto other rests than a tilt from level does.
    There it is not before the least slope at which it gets there, over whichever edges (once it has
    rocked it swings, and the slope of that first time is all that counts), and of each
    facet `tip_angle` under gravity along the normal is the distance to the nearest boundary of the
    standing region, so that a slope less than it tips the robot over from none.  The larger of the
    two, and of these the least over all facets that it could get to from level ground or from the
    rest under its level body, is in what is `guaranteed`.

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
    return GroundTilt(posture, walk(posture, seat), _elsewhere(posture, frame, rest, *upright))


def _half(edge: Edge) -> list[tuple[float, float]]:
    """Return the headings that lead towards an edge, as one or two parts of the circle."""
    low, high = edge.steepest - math.pi / 2.0, edge.steepest + math.pi / 2.0
    parts = [(max(low, -math.pi), min(high, math.pi))]
    if low < -math.pi:
        parts.append((low + 2.0 * math.pi, math.pi))
    if high > math.pi:
        parts.append((-math.pi, high - 2.0 * math.pi))
    return parts


def _elsewhere(posture: Posture, frame: Floats, *starts: int) -> float:
    """Return the slope below which the robot tips over on no facet that it could rock onto.

    On each it is not before the least slope at which it gets there, and what tips it there is its
    `tip_angle` under gravity along the normal at least.  Between two rests it may pass stages, with
    turns that add up to `rock_angle` at most.  A robot that has rocked swings, and may go on before
    gravity leaves the facet: from then on the slope at which it rocked first is all that is known.
    """
    facets, most = posture.stance.facets, posture.recipe.rock_angle + SAME
    waiting = [(0.0, False, 0.0, k) for k in starts]
    arrived: dict[int, float] = {}
    turned: dict[tuple[int, bool], float] = {}
    while waiting:
        slope, swings, turn, k = heappop(waiting)
        if turn >= turned.get((k, swings), math.inf):
            continue
        turned[k, swings] = turn
        arrived.setdefault(k, slope)
        for edge in seat_on(posture, k, frame).edges:
            rolls = math.inf if edge.beyond < 0 else turn_to(posture, k, edge.beyond)
            if turn + rolls <= most:
                leaves = 0.0 if swings else float(edge.tilt(np.array([edge.steepest]))[0])
                whole = 0.0 if facets[edge.beyond].is_rest else turn + rolls
                label = (max(slope, leaves), swings or rolls > SWINGS, whole, edge.beyond)
                heappush(waiting, label)
    normals = np.array([facets[k].normal for k in arrived])
    tips = abs(tip_angles(posture, normals))
    return float(np.maximum(tips, list(arrived.values())).min())


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
