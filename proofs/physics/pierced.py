"""Which plane a robot touches when it reads a direction of gravity, found without any facets.

The ray from the com along gravity leaves the convex hull of all primitives in one place, and the
plane that supports the hull there is the ground: the robot is on a face of the hull, in balance
over the line between two contacts, or on one ball.  That is the largest t for which t g is a
mixture of points of the primitives, a linear programme with three of them in its basis; a better
point enters, one at a time (column generation), until none is better.  Nothing here has a tolerance
for what a facet is, and nothing is taken from lutgen.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proofs.physics.begin import Start
from proofs.physics.body import DISC, SPHERE, Floats, Posture

Ints = NDArray[np.int64]
# A plane is found when no point is further beyond it than this share of the size: rounding.
FOUND = 1e-14
# Each step on a round part divides its error by four; 1e-14 takes 24 of them.
STEPS = 200
# The first basis: points so many sizes to the side of the com, round all primitives, and so far
# behind it that no plane through one of them is of use.  Where the ray misses the hull, one stays.
ASIDE, BEHIND = 4.0, 1e4
# A basis less wide than this share of the size is a line, on which the robot is in balance: no
# engine, and no robot, stands on a foot of a tenth of a millimetre.
LINE = 3e-4


@dataclass(frozen=True)
class Pierced:
    """Where a ray leaves the hull: the plane, and the three contacts that the ray passes between.

    `basis` (3,) are the contacts' primitives and `points` (3, 3) the points; `width` is the
    triangle's least width.
    """

    normal: Floats
    height: float
    basis: Ints
    points: Floats
    width: float

    def is_line(self, posture: Posture) -> bool:
        """Tell whether the robot is in balance there."""
        return self.width < LINE * posture.size

    def start(self, posture: Posture) -> Start:
        """Return where to put the robot."""
        return Start(self.normal, self.height, self.points, self.is_line(posture))


def reach(posture: Posture, normals: Floats) -> Floats:
    """Return the points (d, n, 3) of all primitives that lie furthest along normals (d, 3)."""
    out = np.broadcast_to(normals[:, None], (len(normals), len(posture.kind), 3)).copy()
    disc = posture.kind == DISC
    axes = posture.axes[disc]
    out[:, disc] -= (normals @ axes.T)[..., None] * axes
    size = np.linalg.norm(out, axis=2, keepdims=True)
    out = np.divide(out, size, out=np.zeros_like(out), where=size > 1e-12)
    radius = np.where(disc | (posture.kind == SPHERE), posture.radius, 0.0)
    return np.asarray(posture.centres + radius[:, None] * out)


def heights(posture: Posture, normals: Floats) -> Floats:
    """Return how far (d, n) each primitive reaches along normals (d, 3)."""
    return np.asarray(np.einsum("dnk,dk->dn", reach(posture, normals), normals))


def least_width(corners: Floats) -> Floats:
    """Return the least width (d,) of triangles (d, 3, 3)."""
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    twice = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    return np.asarray(twice / np.maximum(sides.max(axis=1), 1e-300))


def pierced(posture: Posture, gravity_dir: Floats) -> list[Pierced | None]:
    """Return where the rays along unit directions (d, 3) leave the hull; None where they miss."""
    g = np.asarray(gravity_dir, np.float64)
    count, size = len(g), posture.size
    helper = np.eye(3)[np.argmin(np.abs(g), axis=1)]
    first = np.cross(g, helper)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(g, first)
    turn = 2.0 * np.pi / 3.0 * np.arange(3)
    points = -BEHIND * size * g[:, None] + ASIDE * size * (
        np.cos(turn)[:, None] * first[:, None] + np.sin(turn)[:, None] * second[:, None]
    )
    basis = np.full((count, 3), -1, np.int64)
    share = np.full((count, 3), 1.0 / 3.0)
    normal, open_ = g.copy(), np.ones(count, np.bool_)
    for _ in range(STEPS):
        at = np.flatnonzero(open_)
        if not len(at):
            break
        corner = points[at]
        n = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        long = np.linalg.norm(n, axis=1, keepdims=True)
        # A triangle seen from its edge has no normal; the last one serves.
        n = np.where(long > 1e-18 * size**2, n / np.maximum(long, 1e-300), normal[at])
        n *= np.where(np.einsum("dk,dk->d", n, g[at]) < 0.0, -1.0, 1.0)[:, None]
        normal[at] = n
        far = reach(posture, n)
        high = np.einsum("dnk,dk->dn", far, n)
        best = high.argmax(axis=1)
        row = np.arange(len(at))
        gain = high[row, best] - np.einsum("dk,dk->d", corner[:, 0], n)
        enters = far[row, best]
        # The entering point, seen along gravity, as a mixture of the basis.
        plane = np.stack([first[at], second[at]], axis=1)
        flat = np.einsum("dak,dck->dac", plane, corner)
        system = np.concatenate([flat, np.ones((len(at), 1, 3))], axis=1)
        target = np.concatenate(
            [np.einsum("dak,dk->da", plane, enters), np.ones((len(at), 1))], axis=1
        )
        singular = np.abs(np.linalg.det(system)) < 1e-300
        system[singular] = np.eye(3)
        mix = np.linalg.solve(system, target[..., None])[..., 0]
        ratio = np.where(mix > 1e-12, share[at] / np.where(mix > 1e-12, mix, 1.0), np.inf)
        leaves = ratio.argmin(axis=1)
        step = ratio[row, leaves]
        goes = (gain > FOUND * size) & ~singular & np.isfinite(step)
        open_[at[~goes]] = False
        at, row, step, leaves = at[goes], row[goes], step[goes], leaves[goes]
        new = share[at] - step[:, None] * mix[goes]
        new[np.arange(len(at)), leaves] = step
        share[at] = np.maximum(new, 0.0)
        points[at, leaves] = enters[goes]
        basis[at, leaves] = best[goes]
    high = heights(posture, normal).max(axis=1)
    wide = least_width(points)
    return [
        None
        if (basis[d] < 0).any() or high[d] <= 1e-9 * size
        else Pierced(normal[d], float(high[d]), basis[d], points[d], float(wide[d]))
        for d in range(count)
    ]
