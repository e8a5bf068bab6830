"""How far the ground under a robot can be tilted slowly, in every heading, before it tips over.

*Ground tilt*: the robot stands on level ground, and the ground is tilted in one heading.  Where
gravity reaches an edge of the rest that it stands on, it rolls onto the rest beyond if the edge is
held there (`lutgen.support.gaps`: one roll, one landing), and tips over if not.  The limit is the
slope of the ground at that moment.  *Body tilt* (`tilt`) is what an accelerometer in the robot
reads: its body turns further than the ground does where it rocks.
"""

import math
from dataclasses import dataclass
from itertools import groupby, pairwise
from operator import itemgetter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.analysis.ground_seat import Edge, Seat, least_tilt, seat_on
from lutgen.analysis.posture import Posture
from lutgen.analysis.tilt import level_frames
from lutgen.channels import evaluate
from lutgen.vector import Floats

# A slope counts as on a rest, and not beyond its edge, within this (rad).
ON = 1e-9
# A heading (rad) so near to where two edges meet, as the worst one is, has the lower limit.
BESIDE = 1e-6
# A bound is lowered by this (rad), some hundred roundings.
ROUNDING = 1e-12
# At which edge the limit is, over which edge the robot goes, and True if it rolls there.
Leaving = tuple[Edge, Edge, bool]


@dataclass(frozen=True, eq=False)
class Piece:
    """Headings from `begin` to `end` (rad) in which the robot tips over one edge of a rest.

    It tips over `over` at the tilt at which gravity reaches `limit`: the same edge, or the one that
    it rolled over if it does not stay on the rest beyond.
    """

    begin: float
    end: float
    limit: Edge
    over: Edge

    def lowest(self) -> tuple[float, float]:
        """Return the least limit (rad) and its heading (rad)."""
        steepest = self.limit.steepest
        turns = np.array([-2.0, 0.0, 2.0]) * math.pi
        inside = [steepest + turn for turn in turns if self.begin < steepest + turn < self.end]
        places = np.array([*inside, self.begin, self.end])
        tilts = self.limit.tilt(places)
        at = int(tilts.argmin())
        return max(float(tilts[at]), 0.0), float(places[at])


@dataclass(frozen=True, eq=False)
class GroundTilt:
    """The limits of one posture on tilted ground, in all headings; angles in rad.

    `pieces` cover the circle of headings; none of a robot that tips over on level ground.
    `elsewhere` is a tilt below which it tips over on no rest that it could roll onto, for any
    headings in which the ground was tilted before.
    """

    pieces: tuple[Piece, ...]
    elsewhere: float

    def limits(self, headings: ArrayLike) -> Floats:
        """Return the slope (h,) of the ground at tip-over in headings (h,): in [0, pi/2)."""
        return self._at(headings)[0]

    def contacts(self, heading: float) -> tuple[str, ...]:
        """Return the names of the contacts over which the robot tips in a heading.

        None where it tips on level ground.
        """
        if not self.pieces or math.isnan(heading):
            return ()
        return tuple(dict.fromkeys(self.pieces[self._at([heading])[1][0]].over.contacts))

    @property
    def stands(self) -> bool:
        """True if the robot stands on level ground, if only just."""
        return len(self.pieces) > 0

    @property
    def guaranteed(self) -> float:
        """Slope up to which the robot tips over in no heading, after any others.

        It holds for ground that has not been steeper since the robot stood on level ground: once it
        has rolled onto another rest on a steeper slope, it may have less left there.
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
        return self._lowest()[1]

    def _lowest(self) -> tuple[float, float]:
        """Return the least limit and its heading."""
        if not self.pieces:
            return 0.0, math.nan
        found = [piece.lowest() for piece in self.pieces]
        least = min(tilt for tilt, _ in found)
        equal = [math.remainder(at, 2.0 * math.pi) for tilt, at in found if tilt <= least + ON]
        return least, min(equal, key=lambda at: (round(abs(at), 4), -at))

    def _at(self, headings: ArrayLike) -> tuple[Floats, NDArray[np.intp]]:
        """Return limits and indices of the pieces (h,)."""
        heading = np.remainder(np.asarray(headings, np.float64) + math.pi, 2.0 * math.pi) - math.pi
        best, which = np.full(heading.shape, math.inf), np.zeros(heading.shape, np.intp)
        for i, piece in enumerate(self.pieces):
            near = (heading >= piece.begin - BESIDE) & (heading <= piece.end + BESIDE)
            tilt = np.where(near, np.maximum(piece.limit.tilt(heading), 0.0), math.inf)
            which, best = np.where(tilt < best, i, which), np.minimum(tilt, best)
        return np.where(np.isfinite(best), best, 0.0), which


def ground_tilt(posture: Posture) -> GroundTilt:
    """Return how far the ground under a posture can be tilted in every heading.

    In the plane of slopes (see `ground_seat`) each rest is a polygon with straight sides, and the
    robot arrives on the next one along a straight line, too.  The circle of headings is therefore
    cut where a ray passes a corner or an end of a held part, and where lines cross.  One edge
    decides between cuts: the limit is known in closed form, and so is its minimum.  A robot that
    comes back to a rest on the way counts as tipping, and so does one that arrives beyond an edge
    of the rest.  Under forces or with an uncertain com the limit is where the robot leaves the rest
    that it stands on at level.
    """
    frame = level_frames(posture.recipe, posture.row, "plane")[0]
    seats = posture.seats
    rests = np.flatnonzero(seats["is_rest"] == 1)
    if not len(rests) or _facet_under(posture, -frame[:, 2]) < 0:
        return GroundTilt((), 0.0)
    seat = seat_on(posture, int(rests[np.argmax(seats["normal"][rests] @ -frame[:, 2])]), frame)
    if any(edge.reach + edge.push < -ON for edge in seat.edges):
        # No rest carries it on level ground, where gravity pierces another one by chance.
        return GroundTilt((), 0.0)
    if posture.recipe.loaded:
        pieces = [Piece(-math.pi, math.pi, edge, edge) for edge in seat.edges]
        return GroundTilt(tuple(pieces), math.inf)
    starts, upright = {seat.group}, _facet_under(posture, np.array([0.0, 0.0, -1.0]))
    if upright >= 0:
        # Also from the rest that it is on with its body level, which may be another one.
        starts.add(int(seats[upright]["group"]))
    pieces = _tilted(posture, seat, (-math.pi, math.pi), None, ())
    return GroundTilt(tuple(pieces), _elsewhere(posture, frame, starts))


def _facet_under(posture: Posture, down: Floats) -> int:
    """Return the facet on which a posture stands or rocks under a direction (3,); -1: it tips."""
    found = evaluate(posture.recipe, posture.row, down[None], ("facet",))["facet"]
    return int(found[0, 0])


def _tilted(
    posture: Posture,
    seat: Seat,
    arc: tuple[float, float],
    line: Edge | None,
    before: tuple[int, ...],
) -> list[Piece]:
    """Return where a robot tips that comes to a rest over an edge `line`, in an arc of headings.

    `line` is None where it stands there on level ground; `before` are the rests that it has left.
    """
    pieces, gone = [], (*before, seat.group)
    ends = seat.cuts(arc, line)
    found = zip(_leaves(seat, line, (ends[:-1] + ends[1:]) / 2.0), pairwise(ends), strict=True)
    for (limit, over, rolls), run in groupby(found, itemgetter(0)):
        arcs = [one for _, one in run]
        part = float(arcs[0][0]), float(arcs[-1][1])
        there = seat_on(posture, over.beyond, seat.frame) if rolls else seat
        if there.group in gone:
            pieces.append(Piece(*part, limit, over))
        else:
            pieces += _tilted(posture, there, part, over, gone)
    return pieces


def _leaves(seat: Seat, line: Edge | None, headings: Floats) -> list[Leaving]:
    """Return how a robot that came over an edge `line` leaves a rest in each heading (h,)."""
    ahead = np.stack([np.cos(headings), np.sin(headings)], axis=1)
    tilts = np.array([edge.tilt(headings) for edge in seat.edges])
    slopes = np.tan(np.maximum(tilts.min(axis=0), 0.0))[:, None] * ahead
    nearest = [seat.edges[i] for i in tilts.argmin(axis=0)]
    found = [(e, e, e.holds(slope)) for e, slope in zip(nearest, slopes, strict=True)]
    if line is not None:
        arrived = np.tan(line.tilt(headings))[:, None] * ahead
        # How far beyond each edge: the tangent of an angle, roughly.
        outside = np.array([arrived @ edge.normal - edge.reach for edge in seat.edges])
        for k in np.flatnonzero(outside.max(axis=0) > ON):
            found[k] = line, seat.edges[outside[:, k].argmax()], False
    return found


def _elsewhere(posture: Posture, frame: Floats, starts: set[int]) -> float:
    """Return a slope below which the robot tips over on no rest that it could roll onto.

    It leaves a rest that it starts on over the nearest point of a held part at the earliest.  Once
    it has rolled it swings, and may roll on over any part that is held before gravity is there:
    then the least tilt to a part that is not held, of all rests to which such rolls lead, is what
    is left, but never less than the slope of the first roll.
    """
    seats = posture.seats
    rests = [int(k) for k in np.flatnonzero(seats["is_rest"] == 1)]
    one_each = {int(seats[k]["group"]): k for k in rests}
    edges = {group: seat_on(posture, k, frame).edges for group, k in one_each.items()}
    least = {group: min(edge.least_free for edge in of) for group, of in edges.items()}
    found = [least[group] for group in starts]
    rolls = [
        (here, int(seats[edge.beyond]["group"]), least_tilt(*edge.held))
        for here, of in edges.items()
        for edge in of
        if edge.held is not None
    ]
    # As many rolls as there are rests lead to any of them.
    for _ in one_each:
        for here, there, _slope in rolls:
            least[here] = min(least[here], least[there])
    first = [max(slope, least[there]) for here, there, slope in rolls if here in starts]
    return min(found + first)
