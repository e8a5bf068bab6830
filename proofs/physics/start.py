"""Which plane a robot touches when it reads a direction of gravity, found without any facets.

The ray from the com along gravity leaves the convex hull of all primitives in one place, and the
plane that supports the hull there is the ground: the robot is on a face of the hull, in balance
over the line between two contacts, or on one ball.  That is the largest t for which t g is a
mixture of points of the primitives, a linear programme with three of them in its basis; a better
point enters, one at a time (column generation), until none is better.  Nothing here has a tolerance
for what a facet is, and nothing is taken from lutgen.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from proofs.physics.body import Floats, Posture

Ints = NDArray[np.int64]
DOWN = np.array([0.0, 0.0, -1.0])
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
# Directions that are looked at on the way to one that misses the hull.
WAY = 64


@dataclass(frozen=True)
class Start:
    """A plane that the robot touches: outward normal, distance from the com, contact points (n, 3).

    `basis` (n,) are the points' primitives, and `width` is the least width of the triangle of
    three; without one the robot does not stand there.
    """

    normal: Floats
    height: float
    points: Floats
    basis: Ints
    width: float = math.inf

    def balanced(self, posture: Posture) -> bool:
        """Tell whether the robot is in balance over a line."""
        return self.width < LINE * posture.size

    def slope(self, gravity_dir: Floats) -> float:
        """Return the angle (rad) between gravity and the normal."""
        return math.acos(min(1.0, max(-1.0, float(self.normal @ gravity_dir))))


def reach(posture: Posture, normals: Floats) -> Floats:
    """Return the points (d, n, 3) of all primitives that lie furthest along normals (d, 3)."""
    centres, axes, radius, _ = posture.primitives
    out = normals[:, None] - (normals @ axes.T)[..., None] * axes
    size = np.linalg.norm(out, axis=2, keepdims=True)
    out = np.divide(out, size, out=np.zeros_like(out), where=size > 1e-12)
    return np.asarray(centres + radius[:, None] * out)


def heights(posture: Posture, normals: Floats) -> Floats:
    """Return how far (d, n) each primitive reaches along normals (d, 3)."""
    return np.asarray(np.einsum("dnk,dk->dn", reach(posture, normals), normals))


def on_plane(posture: Posture, normal: Floats) -> Start:
    """Return the start on level ground whose normal, out of the body, is given."""
    high = heights(posture, normal[None])[0]
    basis = np.argsort(high)[:-4:-1]
    return Start(normal, float(high.max()), reach(posture, normal[None])[0, basis], basis)


def pierced(posture: Posture, gravity_dir: Floats) -> list[Start | None]:
    """Return where the rays along unit directions (d, 3) leave the hull; None where they miss."""
    g = np.asarray(gravity_dir, np.float64)
    count, size = len(g), posture.size
    first = np.cross(g, np.eye(3)[np.argmin(np.abs(g), axis=1)])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    across = np.stack([first, np.cross(g, first)], axis=1)
    turn = 2.0 * np.pi / 3.0 * np.arange(3)
    round_ = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = size * (ASIDE * np.einsum("ca,dak->dck", round_, across) - BEHIND * g[:, None])
    basis = np.full((count, 3), -1, np.int64)
    share = np.full((count, 3), 1.0 / 3.0)
    normal, at = g.copy(), np.arange(count)
    for _ in range(STEPS):
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
        row, best = np.arange(len(at)), high.argmax(axis=1)
        enters = far[row, best]
        gain = high[row, best] - np.einsum("dk,dk->d", corner[:, 0], n)
        # The entering point, seen along gravity, as a mixture of the basis.
        system = np.concatenate(
            [np.einsum("dak,dck->dac", across[at], corner), np.ones((len(at), 1, 3))], axis=1
        )
        target = np.einsum("dak,dk->da", across[at], enters)
        singular = np.abs(np.linalg.det(system)) < 1e-300
        system[singular] = np.eye(3)
        mix = np.linalg.solve(
            system, np.pad(target, ((0, 0), (0, 1)), constant_values=1.0)[..., None]
        )
        mix = mix[..., 0]
        ratio = np.where(mix > 1e-12, share[at] / np.where(mix > 1e-12, mix, 1.0), np.inf)
        leaves = ratio.argmin(axis=1)
        step = ratio[row, leaves]
        goes = (gain > FOUND * size) & ~singular & np.isfinite(step)
        at, leaves, step = at[goes], leaves[goes], step[goes]
        share[at] = np.maximum(share[at] - step[:, None] * mix[goes], 0.0)
        share[at, leaves], points[at, leaves] = step, enters[goes]
        basis[at, leaves] = best[goes]
    high = heights(posture, normal).max(axis=1)
    sides = np.linalg.norm(points - np.roll(points, 1, axis=1), axis=2).max(axis=1)
    edges = points[:, 1:] - points[:, :1]
    wide = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / np.maximum(sides, 1e-300)
    return [
        None
        if (basis[d] < 0).any() or high[d] <= 1e-9 * size
        else Start(normal[d], float(high[d]), points[d], basis[d], float(wide[d]))
        for d in range(count)
    ]


def start(posture: Posture, gravity_dir: Floats) -> Start | None:
    """Return where the robot is under a direction; None where that is on one ball.

    Where the ray misses the hull, the robot is about to tip from the last plane that it touched as
    gravity turned there from the middle of the contacts.  On one ball it is in balance as a pencil
    is, which no engine can show.
    """
    middle = posture.primitives.centres.mean(axis=0)
    part = np.linspace(1.0, 0.0, WAY)[:, None]
    way = part * gravity_dir + (1.0 - part) * middle / np.linalg.norm(middle)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    found = next((one for one in pierced(posture, way) if one is not None), None)
    return None if found is None or len(set(found.basis.tolist())) < 2 else found
