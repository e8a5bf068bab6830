"""The simulations of the paper in closed form: its search, and its path with and without control.

Owns a second way: recipes, maps and the search of the library have no part in it.  Angles in rad
unless a name ends in `_deg`; the search of all points of a path runs at once.
"""

import math
from collections.abc import Callable

import numpy as np

from lutgen.paper.nominal import DOWN, NOMINAL, TO_THE_LEFT, Array, tripods
from lutgen.paper.printed import eq33
from lutgen.paper.published import ROUNDING_DEG

# The range of the search (deg), the nodes per parameter, its levels, and how far to look at most.
RANGE_DEG = (0.0, 50.0)
NODES = 5
LEVELS = 6
MOST_LEVELS = 12
# Added to the cost of a shape that tips: more than any |SD_g|.
TIPS = 1e6


def stability_factors(wheels: Array, gravity: Array) -> tuple[Array, Array]:
    """Return |SD_g| and the tip-over angle, (...) each.

    Of contacts relative to the com, (..., 3, 3), and gravity, (..., 3) unit vectors.
    """
    ahead = np.roll(wheels, -1, axis=-2)
    normal = np.cross(ahead[..., 0, :] - wheels[..., 0, :], ahead[..., 1, :] - wheels[..., 0, :])
    along = (normal * wheels[..., 0, :]).sum(axis=-1) / (normal * gravity).sum(axis=-1)
    apart = gravity * along[..., None] - wheels.mean(axis=-2)
    # Inward normals of the planes through the com and one edge.
    planes = np.cross(wheels, ahead)
    planes *= np.sign((planes * wheels.mean(axis=-2)[..., None, :]).sum(axis=-1))[..., None]
    planes /= np.linalg.norm(planes, axis=-1, keepdims=True)
    inside = (planes * gravity[..., None, :]).sum(axis=-1)
    return np.linalg.norm(apart, axis=-1), np.arcsin(inside.min(axis=-1))


def factor_at(alpha_deg: float, gamma_deg: float) -> float:
    """Return |SD_g| of simulation 2 with gravity along the body's -z."""
    shape = tripods(np.radians(alpha_deg), np.radians(gamma_deg))
    return float(stability_factors(shape, DOWN)[0])


def second_optimum_deg() -> float:
    """Return alpha = gamma < 0 of the other shape whose wheels make an equilateral triangle."""

    def uneven(angle: float) -> float:
        one, two, three = tripods(np.array(angle), np.array(angle))
        return float(np.linalg.norm(two - one) - np.linalg.norm(three - two))

    from scipy.optimize import brentq

    return math.degrees(brentq(uneven, -0.5, 0.0))


def search(cost: Callable[[Array], Array], runs: int, levels: int = LEVELS) -> Array:
    """Return the best node (deg) of each level of the paper's search, (levels, runs, 2).

    The five nodes are the left ends of five cells of the interval; the next interval is one cell
    to either side of the best node.  `cost` takes alpha and gamma, (runs, 25, 2) rad, and returns
    (runs, 25).
    """
    low, width = np.full((runs, 2), RANGE_DEG[0]), RANGE_DEG[1] - RANGE_DEG[0]
    cells = np.stack(np.meshgrid(*[np.arange(NODES)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
    trace = []
    for _ in range(levels):
        step = width / NODES
        nodes = np.clip(low[:, None] + step * cells, *RANGE_DEG)
        best = cost(np.radians(nodes)).argmin(axis=1)
        trace.append(nodes[np.arange(runs), best])
        low, width = trace[-1] - step, 2.0 * step
    return np.array(trace)


def search_trace(levels: int) -> list[float]:
    """Return alpha (deg) of each level with gravity along the body's -z; gamma is the same."""

    def cost(angles: Array) -> Array:
        return stability_factors(tripods(angles[..., 0], angles[..., 1]), DOWN)[0]

    return [float(angle) for angle in search(cost, 1, levels)[:, 0, 0]]


def levels_until(angle_deg: float) -> int:
    """Return how many levels the search needs to print `angle_deg`; 0 if it never does."""
    trace = search_trace(MOST_LEVELS)
    hits = [i + 1 for i, angle in enumerate(trace) if abs(angle - angle_deg) < ROUNDING_DEG]
    return hits[0] if hits else 0


def path_slope(x: float) -> float:
    """Return dz/dx of Eq 33, whose singularity at 0 is removable: 15 there."""
    sinc = float(np.sinc(x / np.pi))
    # d/dx of x sinc(x)^2.
    return 15.0 * (2.0 * math.cos(x) * sinc - sinc * sinc)


def path_height(x: float) -> float:
    """Return z of Eq 33 with its limit, 0, at 0."""
    return 0.0 if x == 0.0 else eq33(x)


def path_gravity(places: Array) -> Array:
    """Return gravity on the path, (m, 3): the robot heads along x and pitches with dz/ds."""
    pitch = np.arctan([path_slope(float(s)) for s in places])
    return np.column_stack([-np.sin(pitch), np.zeros(len(pitch)), -np.cos(pitch)])


def leaning(wheels: Array, gravity: Array) -> Array:
    """Return gravity, (..., 3), in the body that leans as its wheels' plane makes it: T_g.

    The turn is the smallest that takes z to the normal of the wheels' plane.
    """
    normal = np.cross(wheels[..., 1, :] - wheels[..., 0, :], wheels[..., 2, :] - wheels[..., 0, :])
    normal *= np.sign(normal[..., 2:])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    # Rodrigues' formula: v + w x v + w x (w x v)/(1 + z.n) with w = z x n.
    turn = np.cross(-DOWN, normal)
    first = np.cross(turn, np.broadcast_to(gravity, turn.shape))
    return np.asarray(gravity + first + np.cross(turn, first) / (1.0 + normal[..., 2:]))


def tipping_points(places: Array, control: bool = False) -> int:
    """Return at how many places of the path, (m,) values of s in order, the robot tips.

    Under control it takes the shape that the search finds for the place before; else, and at the
    first place, it has the nominal one.
    """
    gravity = path_gravity(places)
    angles = np.full((len(places), 2), NOMINAL)
    if control:

        def cost(nodes: Array) -> Array:
            shape = tripods(nodes[..., 0], nodes[..., 1], TO_THE_LEFT)
            factor, tip = stability_factors(shape, leaning(shape, gravity[:-1, None]))
            return np.where(tip < 0.0, TIPS - tip, factor)

        angles[1:] = np.radians(search(cost, len(places) - 1)[-1])
    shape = tripods(angles[:, 0], angles[:, 1], TO_THE_LEFT)
    return int((stability_factors(shape, leaning(shape, gravity))[1] < 0.0).sum())
