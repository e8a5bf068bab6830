"""Oracle for the energy margin of point contacts: the robot is rolled over the ground.

The ground is the plane on which the robot lies at first, and gravity is fixed to it.  The robot
turns about the line through two of its contacts until another one touches; its next facet is
whatever touches then.  No facet beyond an edge, no path of gravity in the body is ever looked up:
bodies are turned by rotation matrices and heights read off a grid of angles.
"""

from math import cos, inf, pi

import numpy as np
from scipy.spatial.transform import Rotation

from tests.oracles.points import Floats, convex_polygon, distinct, size_of

# Angles (rad) at which the com's height is read: a circle's top is missed by 1/8 of its square.
GRID = 1e-3
# Contacts this near to the ground, in parts of the size, touch it: rolling keeps 1e-14.
TOUCH = 1e-9


def rises(com: Floats, axis: Floats, foot: Floats, angle: float, up: Floats) -> Floats:
    """Return how far the com has risen on a grid of angles from 0 to `angle`, both included."""
    angles = np.linspace(0.0, angle, 2 + int(angle / GRID))[:, None]
    arm = com - foot
    turned = (
        arm * np.cos(angles)
        + np.cross(axis, arm) * np.sin(angles)
        + axis * (axis @ arm) * (1.0 - np.cos(angles))
    )
    return np.asarray((turned - arm) @ up)


def least_barrier(
    contacts: Floats, start: Floats, gravity: Floats, upright: float = pi, depth: int = 4
) -> float:
    """Return the least rise of the com on any way of at most `depth` rolls that tips it over.

    `contacts` (n, 3) relative to the com; `start` (3,) outward normal of the plane that they lie
    on.  Planes whose normal is not less than `upright` (rad) from the body's -z do not count: the
    robot tips over as if they were not there.
    """
    points = distinct(contacts)
    size = size_of(points)
    level = float((points @ start).max())
    up, ground = -gravity, -start
    best = inf

    def roll(
        turned: Floats, com: Floats, raised: float, peak: float, been: tuple[frozenset[int], ...]
    ) -> None:
        nonlocal best
        placed = com + points @ turned.T
        height = placed @ ground + level
        flat = [int(i) for i in np.flatnonzero(np.abs(height) < TOUCH * size)]
        east = placed[flat[1]] - placed[flat[0]]
        east = east / np.linalg.norm(east)
        polygon = convex_polygon(
            placed[flat] @ np.stack((east, np.cross(ground, east)), axis=1), TOUCH * size
        )
        corners = [flat[c] for c in polygon]
        for one, two in zip(corners, corners[1:] + corners[:1], strict=True):
            foot, axis = placed[one], placed[two] - placed[one]
            axis = axis / np.linalg.norm(axis)
            # Counter-clockwise seen from above: the outside is to the right of the edge.
            outside = np.cross(axis, ground)
            lift, out = (placed - foot) @ ground, (placed - foot) @ outside
            falls = [
                float(np.arctan2(lift[i], out[i])) for i in range(len(points)) if i not in flat
            ]
            sinks = float(np.arctan2((com - foot) @ ground, (com - foot) @ outside))
            turn = min([*falls, sinks])
            spin = Rotation.from_rotvec(axis * turn).as_matrix()
            after, moved = spin @ turned, foot + spin @ (com - foot)
            # The body's z axis, seen from the ground.
            over = turn == sinks or not float(after[:, 2] @ ground) > cos(upright)
            turn = sinks if over else turn
            way = rises(com, axis, foot, turn, up)
            top = max(peak, raised + float(way.max()))
            if top >= best:
                continue
            if over:
                best = top
                continue
            height = (moved + points @ after.T) @ ground + level
            touching = frozenset(int(i) for i in np.flatnonzero(np.abs(height) < TOUCH * size))
            if touching not in been and len(been) < depth:
                roll(after, moved, raised + float(way[-1]), top, (*been, touching))

    lying = frozenset(int(i) for i in np.flatnonzero(level - points @ start < TOUCH * size))
    roll(np.eye(3), np.zeros(3), 0.0, 0.0, (lying,))
    return best
