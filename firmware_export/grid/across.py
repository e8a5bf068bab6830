"""How far the errors of three tables turn the tip-over planes, at postures between all nodes.

The true contacts P_i span a cone; M is the stored normal of edge i.  Where
gravity is inside the cone and edge i the nearest, the foot of gravity on it lies on the arc from
P_i to P_(i+1), so the tip angle is too large by at most the largest angle of that arc above the
stored plane.  Errors along the legs lie in that plane and turn nothing.
"""

import numpy as np
from scipy.interpolate import interpn

from firmware_export.grid.points import Point
from firmware_export.truth import Model, combinations
from lutgen.vector import Floats

# Places between two nodes at which errors are looked at, by the number of parameters; what may lie
# between.
BETWEEN = {0: 1, 1: 16, 2: 8, 3: 4, 4: 3}
MORE = 1.05
# Postures that are looked at, of more some at random; and at once.
MOST, AT_ONCE = 200_000, 20_000


def turned(model: Model, order: tuple[int, int, int], points: tuple[Point, ...]) -> float:
    """Return how far (rad) an arc is above its stored plane at most; pi where there is no plane.

    The model's box is what sensors may say (`widened`); `order` has the recipe's contacts in the
    order of the tables.
    """
    nodes = np.ones(model.k, np.intp)
    for one in points:
        for axis, count in zip(one.axes, one.codes.shape, strict=False):
            nodes[axis] = max(nodes[axis], count)
    between = BETWEEN.get(model.k, 2)
    fine = [np.linspace(0.0, 1.0, (n - 1) * between + 1) for n in nodes]
    count = int(np.prod([float(len(one)) for one in fine]))
    few = count <= MOST
    t = combinations(fine) if few else np.random.default_rng(8).random((MOST, model.k))
    most = 0.0
    for first in range(0, len(t), AT_ONCE):
        here = t[first : first + AT_ONCE]
        true = model.postures(model.at(here)).centres[:, list(order)]
        held = np.stack([_read(one, here) for one in points], axis=1)
        most = max(most, _above(true, held))
    return MORE * most


def _read(point: Point, t: Floats) -> Floats:
    """Return what is looked up (m, 3), in units of its codes, at places t (m, k) of the box."""
    codes = point.codes.astype(np.float64)
    if not point.axes:
        return np.broadcast_to(codes, (len(t), 3))
    knots = [np.linspace(0.0, 1.0, n) for n in codes.shape[:-1]]
    return np.asarray(interpn(knots, codes, t[:, list(point.axes)]))


def _above(true: Floats, held: Floats) -> float:
    """Return the largest angle (rad) of an arc (m, 3, 3) above the plane of stored points."""
    most = 0.0
    for i in range(3):
        normal = np.cross(held[:, i - 1], held[:, i])
        ends = [true[:, j] / np.linalg.norm(true[:, j], axis=1, keepdims=True) for j in (i - 1, i)]
        size = np.linalg.norm(normal, axis=1)
        a, b = ((normal * end).sum(axis=1) / size for end in ends)
        # Between the ends the greatest is where the arc's plane is steepest, if that is on the arc.
        c = (ends[0] * ends[1]).sum(axis=1)
        inner = np.sqrt((a * a + b * b - 2.0 * a * b * c) / np.maximum(1.0 - c * c, 1e-300))
        on_arc = (b > a * c) & (a > b * c)
        above = np.where(on_arc, inner, np.maximum(a, b))
        if not np.isfinite(above).all():
            return np.pi
        most = max(most, float(np.arcsin(np.clip(above, 0.0, 1.0)).max()))
    return most
