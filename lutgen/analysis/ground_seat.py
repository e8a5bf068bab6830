"""A rest on tilted ground: over which of its edges, and at which slope, the robot leaves it.

In the ground's own frame, with x and y level and z up before the tilt, a slope is w = tan(tilt)
(cos heading, sin heading): the place of D_g relative to the com's foot, over the com's height.  A
rest carries the slopes inside a convex polygon, its support polygon at that scale, and a slow tilt
in one heading is a ray from the middle.  A roll turns the ground under the robot by the least
rotation between two normals, and the slope remains what it was.
"""

import math
from dataclasses import dataclass

import numpy as np

from lutgen.analysis.posture import Posture
from lutgen.support import edge_after, ends_of, is_inner, rests_at
from lutgen.vector import Floats

# A length of a vector below this (of unit ones) has no direction.
NOTHING = 1e-12
# Headings (rad) nearer than this are one.
SAME = 1e-9
# Lines whose unit normals have a smaller determinant do not cross.
PARALLEL = 1e-14


@dataclass(frozen=True, eq=False)
class Edge:
    """An edge of a rest; on the rest's side of it (N . w - C) cos(tilt) is at most o.

    `normal` (2,) is N, pointing off the rest; `reach` is C, and `push` o, which is zero without
    forces.  `ends` (2, 2) are the slopes at its ends and `held` (2, 2) those at the ends of the
    part over which the robot rolls onto the rest `beyond`; None and -1 where it does not.
    """

    normal: Floats
    reach: float
    push: float
    contacts: tuple[str, str]
    ends: Floats
    held: Floats | None
    beyond: int

    def tilt(self, headings: Floats) -> Floats:
        """Return the tilt (rad) in each heading at which gravity leaves the rest over this edge.

        pi/2 where it does not, below 0 where it has at level already.
        """
        ahead = np.cos(headings) * self.normal[0] + np.sin(headings) * self.normal[1]
        size = np.hypot(ahead, self.reach)
        share = np.clip(self.push / np.maximum(size, NOTHING), -1.0, 1.0)
        found = np.arctan2(self.reach, ahead) + np.arcsin(share)
        return np.where((ahead > 0.0) & (found < math.pi / 2.0), found, math.pi / 2.0)

    def holds(self, slope: Floats) -> bool:
        """Return True if the robot rolls on where gravity passes the edge at a slope (2,)."""
        if self.held is None:
            return False
        along = np.array([-self.normal[1], self.normal[0]])
        low, high = sorted((self.held @ along).tolist())
        return bool(low <= float(slope @ along) <= high)

    @property
    def steepest(self) -> float:
        """Heading (rad) in which gravity reaches this edge first."""
        return math.atan2(self.normal[1], self.normal[0])

    @property
    def least_free(self) -> float:
        """The least tilt (rad) at which the robot tips over it."""
        if self.held is None:
            return least_tilt(*self.ends)
        return min(least_tilt(*pair) for pair in zip(self.ends, self.held, strict=True))


@dataclass(frozen=True, eq=False)
class Seat:
    """One rest on tilted ground: the ground's frame in the body, and the edges of the rest.

    `frame` (3, 3) takes the ground's frame to the body's: its third column is the ground's upward
    normal.  `group` is the number of the rest; rests that noise has made of one are one.
    """

    group: int
    frame: Floats
    edges: tuple[Edge, ...]

    def cuts(self, arc: tuple[float, float], line: Edge | None) -> Floats:
        """Return the ends of an arc and the headings (rad) between where an edge may take over.

        They are those of corners and of where the edges, and `line`, cross as lines.
        """
        lines = self.edges if line is None else (*self.edges, line)
        places = [edge.ends for edge in self.edges]
        places += [edge.held for edge in self.edges if edge.held is not None]
        sides = np.array([[*edge.normal, edge.reach] for edge in lines])
        sides /= np.linalg.norm(sides[:, :2], axis=1, keepdims=True)
        first, second = np.triu_indices(len(lines), 1)
        crossings = np.cross(sides[first], sides[second])
        crossings = crossings[np.abs(crossings[:, 2]) > PARALLEL]
        # N . w = C of both, and a line behind the middle is met in the opposite heading, too.
        places.append(crossings[:, :2] / -crossings[:, 2:])
        found = np.vstack([*places, *(-some for some in places)])
        at = np.sort(np.arctan2(found[:, 1], found[:, 0]))
        at = at[(at > arc[0] + SAME) & (at < arc[1] - SAME)]
        return np.array([arc[0], *at[np.diff(at, prepend=-math.inf) > SAME], arc[1]])


def seat_on(posture: Posture, k: int, frame: Floats) -> Seat:
    """Return the posture on its accepted facet k, the ground's frame (3, 3) turned onto it.

    Facets of one group are one rest, each with a frame of its own: their common edges are left out.
    Under forces each edge counts with its moment, and under an uncertain com its plane leans
    inwards by as much as the com may be off; under either no edge has a part that is held.
    """
    region, seats = posture.region, posture.seats
    group = seats[k]["group"]
    turned = least_rotation(frame[:, 2], -seats[k]["normal"]) @ frame
    edges = []
    for other in np.flatnonzero((seats["group"] == group) & (seats["is_rest"] == 1)):
        there = least_rotation(turned[:, 2], -seats[other]["normal"]) @ turned
        facet = region.facet[seats[other]["facet"]]
        for e in range(facet["first"], facet["first"] + facet["count"]):
            beyond = rests_at(region, e)[1]
            start, stop = (np.array(end) for end in ends_of(region, e))
            if not is_inner(region, e) and np.linalg.norm(np.cross(start, stop)) > 0.0:
                edges.append(_edge(posture, e, beyond, (start, stop), there))
    return Seat(int(group), turned, tuple(edges))


def _edge(
    posture: Posture, e: int, beyond: int, ends: tuple[Floats, Floats], frame: Floats
) -> Edge:
    """Return edge e of the region between two contact points, `beyond` it a rest or -1."""
    region, wrench, rho = posture.region, posture.wrench, posture.recipe.com_uncertainty
    start, stop = ends
    plane, along = np.cross(start, stop), stop - start
    area, length = float(np.linalg.norm(plane)), float(np.linalg.norm(along))
    plane, along, distance = plane / area, along / length, area / length
    push = float(plane @ wrench["phi"] + (stop - start) @ wrench["mu"] / area)
    if rho > 0.0:
        lean = min(rho / distance, 1.0)
        foot = start - float(start @ along) * along
        plane = math.sqrt(1.0 - lean * lean) * plane - lean * foot / distance
        push *= distance / (distance + math.copysign(rho, push)) if rho < distance else 0.0
    x, y, z = frame.T @ plane
    held = None
    low, high = region.edge[e]["held"]
    if beyond >= 0 and low < high and not posture.recipe.loaded:
        points = start + np.array([[low], [high]]) * (stop - start)
        here, there = (region.seat[k]["normal"] for k in rests_at(region, e))
        wall = region.edge[region.edge[e]["twin"]]["wall"]
        # A low com under large wheels balances between the two rests: not past the edge then.
        if (points @ least_rotation(here, there).T @ wall >= 0.0).all():
            held = _slopes(points, frame)
    primitives = (region.edge[i]["primitive"] for i in (e, edge_after(region, e)))
    i, j = (posture.recipe.contact_names[region.source[primitive]] for primitive in primitives)
    where, onto = _slopes(np.array(ends), frame), -1 if held is None else beyond
    return Edge(np.array([-x, -y]), -float(z), push, (i, j), where, held, onto)


def _slopes(points: Floats, frame: Floats) -> Floats:
    """Return the slopes (j, 2) under which gravity pierces points (j, 3)."""
    seen = points @ frame
    return np.asarray(seen[:, :2] / -seen[:, 2:])


def least_tilt(start: Floats, stop: Floats) -> float:
    """Return the least tilt (rad) on a straight line between two slopes."""
    side = stop - start
    place = -float(start @ side) / max(float(side @ side), NOTHING**2)
    return math.atan(float(np.linalg.norm(start + min(max(place, 0.0), 1.0) * side)))


def least_rotation(start: Floats, stop: Floats) -> Floats:
    """Return the least rotation (3, 3) that takes one unit vector to another, not opposite one."""
    axis, cosine = np.cross(start, stop), float(start @ stop)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / max(1.0 + cosine, NOTHING))
