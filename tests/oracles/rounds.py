"""Oracle for spheres and discs: support facets from the support function alone.

The support function of a primitive, h(n) = largest n.x over its points x, is
n.c + r for a sphere and n.c + r sqrt(1 - (n.a)^2) for a disc (r = 0: a point).  A support
facet is a normal n at which three or more primitives share the largest h.  The roots of
h_i = h_j = h_k are bracketed on an icosahedral grid of normals and polished by Newton
iterations with numerical derivatives: no contact point takes part in the search.
"""

from dataclasses import dataclass
from functools import cache
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

POINT, SPHERE, DISC = 0, 1, 2

# Primitives whose support value is this close to the largest, per unit of size, touch.
ON = 1e-9
# Step of the numerical derivatives (rad): error about STEP^2 and 1e-16 / STEP.
STEP = 1e-5
# How far outside a triangle of the grid (in barycentric weights) a root may seem to lie and
# be searched from there: the support functions are curved, so a root can move to the next one.
REACH = 0.6


@dataclass(frozen=True)
class Robot:
    """Primitives of one posture, relative to the centre of mass."""

    centres: Floats  # (n, 3)
    axes: Floats  # (n, 3) unit for discs, zero for the rest
    radius: Floats  # (n,)
    kind: NDArray[np.int64]  # (n,)

    @property
    def size(self) -> float:
        """Largest distance of a primitive's points from the centre of mass."""
        return float((np.sqrt((self.centres**2).sum(axis=1)) + self.radius).max())


@dataclass(frozen=True)
class Facet:
    """Support facet with the measures that say how well its place is determined."""

    normal: Floats  # (3,)
    height: float
    touching: tuple[int, ...]
    contacts: Floats  # (k, 3), one per touching primitive
    width: float  # smallest altitude of the best triangle of contacts, per unit of size
    clearance: float  # of the nearest primitive that does not touch, per unit of size
    tilt: float  # smallest sine between the normal and the axis of a touching disc

    @property
    def is_clear(self) -> bool:
        """Whether rounding cannot make or unmake this facet.

        A thin triangle of contacts is a double root, a small clearance or height is a facet
        about to appear or vanish, and a disc nearly flat on the plane has its contact point
        anywhere on its rim.
        """
        return (
            self.width > 1e-4 and self.clearance > 1e-6 and self.height > 0.0 and self.tilt > 1e-2
        )


def support(normals: Floats, robot: Robot) -> Floats:
    """Support values (n, ...) of all primitives along unit normals (..., 3)."""
    along = np.einsum("ic,...c->i...", robot.centres, normals)
    cosine = np.einsum("ic,...c->i...", robot.axes, normals)
    # A disc is as wide as the sine of the angle to its axis; axes of spheres are zero.
    widths = np.sqrt(np.maximum(0.0, 1.0 - cosine**2))
    radius = robot.radius.reshape((-1,) + (1,) * (normals.ndim - 1))
    return np.asarray(along + radius * widths)


def contact(normal: Floats, robot: Robot, index: int) -> Floats:
    """Point (3,) of a primitive that lies furthest along the normal."""
    across = normal - robot.axes[index] * (robot.axes[index] @ normal)
    reach = robot.radius[index] / np.sqrt(across @ across)
    return np.asarray(robot.centres[index] + reach * across)


@cache
def icosphere(levels: int) -> tuple[Floats, Indices]:
    """Split an icosahedron `levels` times: unit vectors (v, 3) and triangles (f, 3)."""
    golden = (1.0 + np.sqrt(5.0)) / 2.0
    corners = [
        np.roll([0.0, one, other * golden], turn)
        for turn in range(3)
        for one in (-1.0, 1.0)
        for other in (-1.0, 1.0)
    ]
    vertices = [corner / np.sqrt(corner @ corner) for corner in corners]
    faces = [
        (i, j, k)
        for i, j, k in combinations(range(12), 3)
        if min(vertices[i] @ vertices[j], vertices[j] @ vertices[k], vertices[k] @ vertices[i])
        > 0.4  # neighbours are 63.4 degrees apart, the next ones 116.6
    ]
    for _ in range(levels):
        middles: dict[tuple[int, int], int] = {}
        finer = []
        for face in faces:
            mid = []
            for first, second in combinations(face, 2):
                if (first, second) not in middles:
                    middle = vertices[first] + vertices[second]
                    middles[first, second] = middles[second, first] = len(vertices)
                    vertices.append(middle / np.sqrt(middle @ middle))
                mid.append(middles[first, second])
            i, j, k = face
            ij, ik, jk = mid
            finer += [(i, ij, ik), (j, ij, jk), (k, ik, jk), (ij, ik, jk)]
        faces = finer
    return np.array(vertices), np.array(faces, dtype=np.intp)


def starts(robot: Robot) -> tuple[Indices, Floats]:
    """Triples (s, 3) of primitives and normals (s, 3) near which all three may touch.

    A triangle of the grid is taken when the linear interpolant of (h_i - h_j, h_i - h_k) has
    its root in or near it, or when it holds the axis of a disc (where h has a kink), and no
    other primitive is further out than the curvature over a triangle allows.
    """
    vertices, faces = icosphere(3)
    centres = vertices[faces].mean(axis=1)
    centres /= np.sqrt((centres**2).sum(axis=1))[:, None]
    reach = 2.0 * float(np.sqrt(((centres - vertices[faces[:, 0]]) ** 2).sum(axis=1)).max())
    values = support(vertices, robot)[:, faces]  # (n, f, 3)
    largest = values.max(axis=0).min(axis=1)  # (f,)
    slope = np.sqrt((robot.centres**2).sum(axis=1)) + robot.radius
    close = values.max(axis=2) >= largest - 2.0 * reach * slope.max()  # (n, f)
    kinks = np.abs(np.einsum("ic,fc->if", robot.axes, centres)) > np.cos(reach)
    triples, normals = [], []
    for triple in combinations(range(len(robot.radius)), 3):
        i, j, k = triple
        first, second = values[i] - values[j], values[i] - values[k]
        weights = np.stack(
            [
                first[:, 1] * second[:, 2] - first[:, 2] * second[:, 1],
                first[:, 2] * second[:, 0] - first[:, 0] * second[:, 2],
                first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0],
            ],
            axis=1,
        )
        total = weights.sum(axis=1)
        near = (weights * np.sign(total)[:, None] >= -REACH * np.abs(total)[:, None]).all(axis=1)
        here = np.flatnonzero((near | kinks[list(triple)].any(axis=0)) & close[list(triple)].all(0))
        normals.append(centres[here])
        triples.append(np.tile(np.array(triple, dtype=np.intp), (len(here), 1)))
    return np.concatenate(triples), np.concatenate(normals)


def polished(robot: Robot, triples: Indices, normals: Floats) -> tuple[Indices, Floats]:
    """Triples (s, 3) and normals (s, 3) where the three support values agree to rounding."""
    pick = np.arange(len(triples))
    for _ in range(25):
        # Two unit vectors across the normal, from the coordinate axis least along it.
        helper = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
        u = np.cross(normals, helper)
        u /= np.sqrt((u**2).sum(axis=1))[:, None]
        v = np.cross(normals, u)
        probes = np.stack(
            (
                normals,
                normals + STEP * u,
                normals - STEP * u,
                normals + STEP * v,
                normals - STEP * v,
            )
        )
        probes /= np.sqrt((probes**2).sum(axis=2))[..., None]
        values = support(probes, robot)[triples.T, :, pick]  # (3, s, 5)
        first, second = values[0] - values[1], values[0] - values[2]
        a, b = (first[:, 1] - first[:, 2]) / (2 * STEP), (first[:, 3] - first[:, 4]) / (2 * STEP)
        c, d = (
            (second[:, 1] - second[:, 2]) / (2 * STEP),
            (second[:, 3] - second[:, 4]) / (2 * STEP),
        )
        determinant = a * d - b * c
        determinant = np.where(np.abs(determinant) < 1e-12 * robot.size**2, np.inf, determinant)
        right = (b * second[:, 0] - d * first[:, 0]) / determinant
        up = (c * first[:, 0] - a * second[:, 0]) / determinant
        # A step of at most a triangle of the grid: far from the root the slope misleads.
        scale = np.minimum(1.0, 0.3 / np.maximum(1e-300, np.hypot(right, up)))
        normals = normals + (scale * right)[:, None] * u + (scale * up)[:, None] * v
        normals /= np.sqrt((normals**2).sum(axis=1))[:, None]
    values = support(normals, robot)[triples.T, pick]
    agree = np.ptp(values, axis=0) <= 1e-12 * robot.size
    return triples[agree], normals[agree]


def altitude(corners: Floats) -> float:
    """Smallest altitude of the triangle (3, 3)."""
    sides = corners - np.roll(corners, 1, axis=0)
    across = np.cross(sides[1], sides[2])
    longest = np.sqrt((sides**2).sum(axis=1).max())
    return float(np.sqrt(across @ across) / longest) if longest > 0.0 else 0.0


def support_facets(robot: Robot) -> list[Facet]:
    """All support facets with the centre of mass above them, in no particular order."""
    _, normals = polished(robot, *starts(robot))
    found: list[Facet] = []
    values = support(normals, robot)
    for normal, heights in zip(normals, values.T, strict=True):
        height = float(heights.max())
        touching = [int(i) for i in np.flatnonzero(heights >= height - ON * robot.size)]
        if height <= 0.0 or len(touching) < 3:
            continue
        if any(normal @ facet.normal > 1.0 - 1e-14 for facet in found):
            continue
        sines = [
            float(np.sqrt(max(0.0, 1.0 - (robot.axes[i] @ normal) ** 2)))
            for i in touching
            if robot.kind[i] == DISC and robot.radius[i] > 0.0
        ]
        if min(sines, default=1.0) < 1e-6:
            continue
        contacts = np.array([contact(normal, robot, i) for i in touching])
        rest = np.delete(heights, touching)
        found.append(
            Facet(
                normal=normal,
                height=height,
                touching=tuple(touching),
                contacts=contacts,
                width=max(
                    altitude(contacts[list(t)]) for t in combinations(range(len(contacts)), 3)
                )
                / robot.size,
                clearance=float(height - rest.max()) / robot.size if len(rest) else np.inf,
                tilt=min(sines, default=1.0),
            )
        )
    return [facet for facet in found if facet.width > ON]
