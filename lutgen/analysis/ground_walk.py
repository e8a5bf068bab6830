"""The way of a robot over its rests while the ground under it is tilted slowly, in all headings.

Owns the walk from the rest on level ground to where the robot tips, for whole arcs of headings at
once: rests are polygons of slopes with straight sides (`rocking`), so that corners and crossings
cut the circle into arcs in which one edge decides.
"""

import math
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

from lutgen.analysis.rocking import Edge, Seat, seat_on, turn_to
from lutgen.analysis.stance import Posture
from lutgen.channels import evaluate
from lutgen.vector import Floats

# Headings (rad) nearer than this are one, and a turn of `rock_angle` may be longer by it.
SAME = 1e-9
TURN = 2.0 * math.pi
# Gravity is looked at this far (rad) beyond an edge, to learn whether the robot rocks there.
BEYOND = 1e-7
# Directions in which that is not known for certain count as tipping in arcs of this length (rad).
FINEST = 1e-4
# Arcs beside each other differ by this in length; fewer than ten looks are lost to it.
FINER = 1.5
# A slope counts as on a rest, and not beyond its edge, within this (rad).
ON = 1e-9
# Room for rounding where `tip_angle` has to cover an arc.
COVERS = 1.05


@dataclass(frozen=True, eq=False)
class Piece:
    """Headings from `begin` to `end` (rad) in which the robot tips over one edge of a rest.

    `seat` is where it stands last and `over` the edge that it then leaves; it tips at the tilt at
    which gravity reaches `limit`, an edge of that rest or, where it rocked and did not come to
    rest, the one at which that began.
    """

    begin: float
    end: float
    limit: Edge
    over: Edge
    seat: Seat

    def lowest(self) -> tuple[float, float]:
        """Return the least limit (rad) and its heading (rad)."""
        steepest = self.limit.steepest
        turns = np.array([-2.0, 0.0, 2.0]) * math.pi
        inside = [steepest + turn for turn in turns if self.begin < steepest + turn < self.end]
        places = np.array([*inside, self.begin, self.end])
        tilts = self.limit.tilt(places)
        at = int(tilts.argmin())
        return max(float(tilts[at]), 0.0), float(places[at])


def walk(posture: Posture, seat: Seat) -> tuple[Piece, ...]:
    """Return where a robot that is seated on level ground tips, in all headings."""
    way = _Walk(posture, [])
    way.stand(_Arrival(seat, -math.pi, math.pi, None, None, 0.0, 0))
    return tuple(way.pieces)


def tip_angles(posture: Posture, down: Floats) -> Floats:
    """Return tip_angle (j,) under directions (j, 3)."""
    return np.asarray(evaluate(posture.recipe, posture.row, down, ("tip_angle",))["tip_angle"][0])


@dataclass(frozen=True, eq=False)
class _Arrival:
    """Headings in which the robot arrives on a rest: where from, and how far it has rocked.

    `line` is the edge that gravity reaches as it arrives, None where it stood there at level;
    `back` are the contacts over which it came.
    """

    seat: Seat
    begin: float
    end: float
    line: Edge | None
    back: tuple[int, int] | None
    turned: float
    steps: int


@dataclass
class _Walk:
    """Follows a posture from rest to rest, and keeps the pieces in which it tips."""

    posture: Posture
    pieces: list[Piece]

    def stand(self, came: _Arrival) -> None:
        """Follow a robot that arrives on a rest until it has left it in all headings."""
        # Planes that lean inwards for an uncertain com can cut off a side.
        leans = self.posture.recipe.com_uncertainty > 0.0
        edges, cuts = came.seat.edges, [came.begin, *_cuts(came, leans), came.end]
        for begin, end in pairwise(cuts):
            if end - begin <= SAME and end < came.end:
                continue
            middle = (begin + end) / 2.0
            at = 0.0 if came.line is None else float(came.line.tilt(np.array([middle]))[0])
            ahead = np.array([math.cos(middle), math.sin(middle)])
            back = [came.back is not None and set(e.contacts) == set(came.back) for e in edges]
            beyond = [_outside(edge, ahead, at) for edge in edges]
            fresh = [-math.inf if old else far for old, far in zip(back, beyond, strict=True)]
            if came.line is not None and max(fresh) > ON:
                # It does not come to rest here, but goes on over the edge that is furthest behind.
                over = edges[int(np.argmax(fresh))]
                self.leave(came, (begin, end), came.line, over, came.turned)
                continue
            tilts = [float(edge.tilt(np.array([middle]))[0]) for edge in edges]
            # Before an edge that it came over it hangs between two rests until gravity is past it.
            hangs = [old and far > ON for old, far in zip(back, beyond, strict=True)]
            over = edges[int(np.argmin(np.where(hangs, math.pi, tilts)))]
            waits = [e for e, hung in zip(edges, hangs, strict=True) if hung]
            if came.line is not None and any(float(e.normal @ ahead) >= 0.0 for e in waits):
                # A steeper slope only takes it away again: that counts as tipping.
                self.pieces.append(Piece(begin, end, came.line, waits[0], came.seat))
            else:
                # On a stage it lies until gravity leaves that, but what it turned counts on.
                rests = self.posture.stance.facets[came.seat.rest].is_rest
                self.leave(came, (begin, end), over, over, 0.0 if rests else came.turned)

    def leave(
        self,
        came: _Arrival,
        arc: tuple[float, float],
        limit: Edge,
        over: Edge,
        turned: float,
    ) -> None:
        """Follow a robot over an edge: onto the next rest, or it tips."""
        seat, facets = came.seat, self.posture.stance.facets
        if over.beyond >= 0:
            turned += turn_to(self.posture, seat.rest, over.beyond)
        limit_of_turn = self.posture.recipe.rock_angle + SAME
        if over.beyond < 0 or turned > limit_of_turn or came.steps > 2 * len(facets):
            self.pieces.append(Piece(*arc, limit, over, seat))
            return
        there = seat_on(self.posture, over.beyond, seat.frame)
        sure, unsure = self.held(arc, limit, over, seat, there)
        for begin, end in unsure:
            self.pieces.append(Piece(begin, end, limit, over, seat))
        for begin, end in sure:
            self.stand(_Arrival(there, begin, end, limit, over.contacts, turned, came.steps + 1))

    def held(
        self, arc: tuple[float, float], limit: Edge, over: Edge, seat: Seat, there: Seat
    ) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
        """Return the arcs in which the robot stands just beyond an edge and there, and the rest."""
        sure: list[tuple[float, float]] = []
        unsure: list[tuple[float, float]] = []
        open_ = _graded(*arc)
        while open_:
            ends = np.array(open_)
            middle = ends.mean(axis=1)
            places = np.concatenate([middle, ends[:, 0], ends[:, 1]])
            tilts = np.clip(limit.tilt(places), 0.0, math.radians(89.9))
            slopes = (np.tan(tilts) * np.array([np.cos(places), np.sin(places)])).T
            nudge = BEYOND * over.normal / np.linalg.norm(over.normal)
            behind = there.down(slopes)
            downs = np.stack([seat.down(slopes + nudge), behind])
            downs /= np.linalg.norm(downs, axis=2, keepdims=True)
            first, left, right = np.split(downs, 3, axis=1)
            # The way of gravity between two directions of an edge is their great circle.
            reach = np.maximum(
                np.linalg.norm(first - left, axis=2), np.linalg.norm(first - right, axis=2)
            ).max(axis=0)
            held = tip_angles(self.posture, first.reshape(-1, 3)).reshape(2, -1).min(axis=0)
            divided = []
            for (begin, end), far, angle in zip(open_, reach, held, strict=True):
                half = (begin + end) / 2.0
                if angle >= COVERS * far:
                    sure.append((begin, end))
                elif far < FINEST or end - begin < SAME or angle < -far:
                    unsure.append((begin, end))
                else:
                    divided += [(begin, half), (half, end)]
            open_ = divided
        return _joined(sure), _joined(unsure)


def _graded(begin: float, end: float) -> list[tuple[float, float]]:
    """Return an arc in parts that are finer towards its ends, where tipping is near."""
    half = (end - begin) / 2.0
    count = max(math.ceil(math.log(max(half / FINEST, 1.0)) / math.log(FINER)), 0)
    away = half * FINER ** -np.arange(count + 1.0)
    knots = [begin, *(begin + away[::-1]), *(end - away[1:]), end]
    return list(pairwise(knots))


def _outside(edge: Edge, ahead: Floats, tilt: float) -> float:
    """Return how far (the sine of an angle) gravity is beyond an edge in a heading, at a tilt."""
    return float(edge.normal @ ahead) * math.sin(tilt) - edge.reach * math.cos(tilt) - edge.push


def _cuts(came: _Arrival, leans: bool) -> list[float]:
    """Return the headings between which one edge decides: of corners, and where lines cross."""
    edges = came.seat.edges
    pairs = [*combinations(edges, 2)] if leans else [*pairwise((*edges, edges[0]))]
    found = []
    if came.line is not None:
        pairs += [(came.line, edge) for edge in edges]
        turns = (e for e in edges if came.back is not None and set(e.contacts) == set(came.back))
        found += [
            math.remainder(e.steepest + s * math.pi / 2.0, TURN) for e in turns for s in (1, -1)
        ]
    for first, second in pairs:
        system = np.array([first.normal, second.normal])
        if abs(np.linalg.det(system)) <= 1e-14:
            continue
        x, y = np.linalg.solve(system, [first.reach, second.reach])
        # A line of slopes behind the middle is met in the opposite heading, too.
        found += [math.atan2(y, x), math.atan2(-y, -x)]
    return sorted(at for at in found if came.begin + SAME < at < came.end - SAME)


def _joined(arcs: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the arcs in order, those that meet as one."""
    joined: list[tuple[float, float]] = []
    for begin, end in sorted(arcs):
        if joined and begin <= joined[-1][1] + 1e-15:
            joined[-1] = joined[-1][0], end
        else:
            joined.append((begin, end))
    return joined
