"""A robot on tilting ground: on which facet it lies, and over which edge it leaves it.

Owns the slopes under one facet, a rest or a stage of rolling: in the ground's own frame, x and y
level and z up before it is tilted, a slope is w = tan(tilt) (cos heading, sin heading), the place
of D_g relative to the com's foot over the com's height. A facet carries the slopes inside a convex
polygon, its support polygon at that scale, and a slow tilt in one heading is a ray from the middle.
When the robot rocks onto another rest the ground turns under it by the least rotation between the
two normals, which is that about the edge, and the slope remains what it was.
"""

import math
from dataclasses import dataclass

import numpy as np

from lutgen.analysis.stance import Posture
from lutgen.channels import MU, PHI, RHO
from lutgen.vector import Floats

# A length of a vector below this (of unit ones) has no direction.
NOTHING = 1e-12


@dataclass(frozen=True, eq=False)
class Edge:
    """An edge of a rest; on the rest's side of it (N . w - C) cos(tilt) is at most o.

    `normal` (2,) is N, pointing off the rest; `reach` is C, and `push` o, which is zero without
    forces.  `contacts` are the primitives that it runs between, and `beyond` is the facet onto
    which the robot rolls over it, -1 for none.
    """

    normal: Floats
    reach: float
    push: float
    contacts: tuple[int, int]
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

    @property
    def steepest(self) -> float:
        """Heading (rad) in which gravity reaches this edge first."""
        return math.atan2(self.normal[1], self.normal[0])


@dataclass(frozen=True, eq=False)
class Seat:
    """One facet on tilted ground: which it is, the ground's frame in the body, and its edges.

    `frame` (3, 3) takes the ground's frame to the body's: its third column is the ground's upward
    normal.
    """

    rest: int
    frame: Floats
    edges: tuple[Edge, ...]

    def down(self, slopes: Floats) -> Floats:
        """Return gravity in the body frame (j, 3) under slopes w (j, 2)."""
        ground = np.column_stack([slopes, np.full(len(slopes), -1.0)])
        return np.asarray(ground @ self.frame.T)


def seat_on(posture: Posture, rest: int, frame: Floats) -> Seat:
    """Return the posture on one of its stance's facets, the ground's frame (3, 3) turned onto it.

    Under forces each edge counts with its moment, and under an uncertain com its plane leans
    inwards by as much as the com may be off.
    """
    facet, wrench, rho = posture.stance.facets[rest], posture.wrench, posture.recipe.com_uncertainty
    turned = least_rotation(frame[:, 2], -facet.normal) @ frame
    edges = []
    for i in range(len(facet.contacts)):
        j = (i + 1) % len(facet.contacts)
        start, stop = facet.points[i], facet.points[j]
        plane, along = np.cross(start, stop), stop - start
        area, length = float(np.linalg.norm(plane)), float(np.linalg.norm(along))
        if area <= 0.0 or length <= 0.0:
            continue
        plane, along, distance = plane / area, along / length, area / length
        push = float(plane @ wrench[PHI:MU] + (stop - start) @ wrench[MU:RHO] / area)
        if rho > 0.0:
            lean = min(rho / distance, 1.0)
            foot = start - float(start @ along) * along
            plane = math.sqrt(1.0 - lean * lean) * plane - lean * foot / distance
            push *= distance / (distance + math.copysign(rho, push)) if rho < distance else 0.0
        x, y, z = turned.T @ plane
        pair = (facet.contacts[i], facet.contacts[j])
        edges.append(Edge(np.array([-x, -y]), -float(z), push, pair, facet.beyond[i]))
    return Seat(rest, turned, tuple(edges))


def least_rotation(start: Floats, stop: Floats) -> Floats:
    """Return the least rotation (3, 3) that takes one unit vector to another, not opposite one."""
    axis, cosine = np.cross(start, stop), float(start @ stop)
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.asarray(np.eye(3) + cross + cross @ cross / max(1.0 + cosine, NOTHING))


def turn_to(posture: Posture, rest: int, beyond: int) -> float:
    """Return the turn (rad) from one facet to another."""
    here, there = (posture.stance.facets[k].normal for k in (rest, beyond))
    return math.atan2(float(np.linalg.norm(np.cross(here, there))), float(here @ there))
