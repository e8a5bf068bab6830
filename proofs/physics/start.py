"""Where a robot is put before it is let go: on a facet, or in balance over a gap.

Owns a second account of gaps, without quadrilaterals: over a gap two round primitives touch a
plane whose normal turns from one facet's to the other's.  Gravity is read in the body frame, so
the attitude that belongs to a direction is the one at which gravity passes through the line
between the two contact points; there, and only there, the robot is in balance.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from proofs.physics.begin import Start
from proofs.physics.body import DISC, SPHERE, Floats, Posture
from proofs.physics.facets import Facet, facets

# Nearer than this (rad, 0.02 deg) to a ridge the engine's softness decides which way a robot
# turns, and it may go on from the next facet: there gravity, which has turned with it in the
# body frame, can be one under which it tips.
RIDGE = math.radians(0.02)


@dataclass(frozen=True)
class Gap:
    """Two accepted facets with a common edge, the primitives `pair`, over which a robot rocks."""

    near: Facet
    far: Facet
    pair: tuple[int, int]


def accepted(posture: Posture) -> list[Facet]:
    """Return the facets that count as upright."""
    every = facets(posture.centres, posture.axes, posture.radius, posture.kind)
    return [f for f in every if -f.normal[2] > math.cos(posture.upright) + 1e-9]


def contact(posture: Posture, index: int, normal: Floats) -> Floats:
    """Return the point of a primitive that lies furthest along a normal."""
    centre, radius = posture.centres[index], posture.radius[index]
    if posture.kind[index] == SPHERE:
        return np.asarray(centre + radius * normal)
    if posture.kind[index] == DISC:
        axis = posture.axes[index]
        radial = normal - axis * (axis @ normal)
        return np.asarray(centre + radius * radial / np.linalg.norm(radial))
    return np.asarray(centre)


def gaps(posture: Posture, found: list[Facet]) -> list[Gap]:
    """Return the pairs of neighbouring facets at most `rock_angle` apart.

    Between points the gap has no width: it is a ridge.
    """
    result = []
    for a, near in enumerate(found):
        for far in found[a + 1 :]:
            angle = 2.0 * math.asin(min(1.0, float(np.linalg.norm(near.normal - far.normal)) / 2))
            if angle > posture.rock_angle:
                continue
            ways = {(far.polygon[k - 1], far.polygon[k]) for k in range(len(far.polygon))}
            for k in range(len(near.polygon)):
                pair = (near.polygon[k - 1], near.polygon[k])
                if pair[::-1] in ways:
                    result.append(Gap(near, far, pair))
    return result


def balance(posture: Posture, gap: Gap, way: float, share: float = math.nan) -> Start:
    """Return the plane that both primitives of a gap touch, `way` (0 to 1) towards the far one."""
    normal = (1.0 - way) * gap.near.normal + way * gap.far.normal
    i, j = gap.pair
    for _ in range(60):
        normal = normal / math.sqrt(float(normal @ normal))
        edge = contact(posture, j, normal) - contact(posture, i, normal)
        lean = float(edge @ normal) / float(edge @ edge)
        normal = normal - edge * lean
        if abs(lean) * posture.size < 1e-15:
            break
    normal = normal / math.sqrt(float(normal @ normal))
    points = np.array([contact(posture, i, normal), contact(posture, j, normal)])
    return Start(normal, float(points[0] @ normal), points, True, share)


def is_free(posture: Posture, plane: Start) -> bool:
    """Tell whether no primitive is below a plane, as it would be round the far side of a robot."""
    n = plane.normal
    reach = max(float(contact(posture, k, n) @ n) for k in range(len(posture.kind)))
    return reach <= plane.height + 1e-9


def balanced(posture: Posture, gap: Gap, gravity_dir: Floats) -> Start | None:
    """Return the plane of a gap on which gravity passes through the line of contact, if any.

    Gravity may pass beyond the ends of the line, by a tenth of it: the robot then turns over one
    of the two contacts.
    """

    def beside(way: float) -> float:
        first, second = balance(posture, gap, way).points
        return float(np.linalg.det([first, second, gravity_dir]))

    if beside(0.0) * beside(1.0) > 0.0:
        return None
    plane = balance(posture, gap, float(brentq(beside, 0.0, 1.0, xtol=1e-13)))
    if not is_free(posture, plane):
        return None
    weights = np.linalg.lstsq(plane.points.T, gravity_dir, rcond=None)[0]
    share = float(weights[1] / weights.sum())
    if weights.sum() <= 0.0 or not -0.1 < share < 1.1:
        return None
    return Start(plane.normal, plane.height, plane.points, True, share)


def on_one(posture: Posture, gravity_dir: Floats) -> bool:
    """Tell whether gravity passes through the one point in which a ball carries the robot.

    That is the small piece between gaps that close into a ring.  No engine can show it: the
    robot is in balance there as a pencil is.
    """
    for i in np.flatnonzero(posture.kind == SPHERE):
        centre, radius = posture.centres[i], posture.radius[i]
        along = float(centre @ gravity_dir)
        depth = along**2 - float(centre @ centre) + radius**2
        if depth > 0.0:
            point = (along + math.sqrt(depth)) * gravity_dir
            normal = (point - centre) / radius
            reach = [float(contact(posture, k, normal) @ normal) for k in range(len(posture.kind))]
            if max(reach) <= float(point @ normal) + 1e-9:
                return True
    return False


def _beyond(plane: Start) -> float:
    return abs(plane.share - 0.5)


def start(posture: Posture, gravity_dir: Floats) -> Start | None:
    """Return where the robot is when it reads a direction of gravity; None without any facet.

    On the accepted facet that the ray pierces; else in balance over a gap; else on the facet
    whose plane the ray pierces first, from which it is about to tip.  On the ridge between two
    facets it is in balance too.
    """
    found = accepted(posture)
    rates = [float(f.normal @ gravity_dir) / f.height for f in found]
    if not rates or max(rates) <= 0.0:
        return None
    facet = found[int(np.argmax(rates))]
    corners = facet.points
    following = np.roll(corners, -1, axis=0)
    walls = np.cross(corners, following)
    inside = walls @ gravity_dir / np.linalg.norm(walls, axis=1)
    near = int(np.argmin(inside))
    if inside[near] < 0.0:
        planes = [balanced(posture, gap, gravity_dir) for gap in gaps(posture, found)]
        best = min((p for p in planes if p is not None), key=_beyond, default=None)
        if best is not None:
            return best
    if abs(inside[near]) < RIDGE:
        pair = {facet.polygon[near], facet.polygon[(near + 1) % len(corners)]}
        around = [gap for gap in gaps(posture, found) if set(gap.pair) == pair]
        if any(facet is gap.near or facet is gap.far for gap in around):
            points = np.array([corners[near], following[near]])
            return Start(facet.normal, facet.height, points, True)
    return Start(facet.normal, facet.height, corners)
