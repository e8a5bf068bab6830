"""Forces at contacts that balance a weight, found by linear programmes.

Owns the pyramids that stand for friction cones, the wrench that is missing, and the farthest com.
All forces are shares of the weight; lengths are divided by the scene's size beforehand.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lutgen.vector import Floats

# A wrench that is missing by less (of weight, and of weight x size) counts as none: 100 times what
# the solver is asked for, below.
MISSING = 1e-7
ACCURACY = {"primal_feasibility_tolerance": 1e-9, "dual_feasibility_tolerance": 1e-9}
# Steps of one programme, a hundred times what real scenes take: rounding may make it go in circles.
STEPS = 20_000
# Half a side of the square in which the com is sought, in sizes.
BOX = 100.0
# Tried in turn: each gives up on some programmes that the others solve.
METHODS = ("highs", "highs-ds", "highs-ipm")


@dataclass(frozen=True)
class Scene:
    """Contacts in a frame of two horizontal axes and up, lengths over the size.

    `points` and unit `normals` (n, 3) out of the ground, `friction` (n,).
    """

    points: Floats
    normals: Floats
    friction: Floats

    def rays(self, sides: int, outside: bool = False) -> tuple[Floats, Floats]:
        """Return unit edges (r, 3) of the feet's pyramids, and a matrix (n, r) of which is whose.

        An entry of the matrix is the edge's part along the normal, so that the matrix turns
        strengths along edges into normal forces.  The pyramids lie in the cones and touch them
        with their edges, or go round them and touch them with their faces.  One edge lies straight
        uphill, so that a scene in one vertical plane has its own cones.
        """
        edges, owner = [], []
        around = np.arange(sides) * (2.0 * math.pi / sides)
        for i, (normal, mu) in enumerate(zip(self.normals, self.friction, strict=True)):
            if outside:
                mu = mu / math.cos(math.pi / sides)
            uphill = np.array([0.0, 0.0, 1.0]) - normal[2] * normal
            if not np.linalg.norm(uphill) > 1e-12:
                # On level ground every direction is as good.
                uphill = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
            uphill /= np.linalg.norm(uphill)
            turns = around if mu > 0.0 else around[:1]
            fan = np.outer(np.cos(turns), uphill)
            fan += np.outer(np.sin(turns), np.cross(normal, uphill))
            edges.append((normal + mu * fan) / math.hypot(1.0, mu))
            owner += [i] * len(turns)
        rays = np.concatenate(edges)
        along = np.zeros((len(self.points), len(rays)))
        along[owner, range(len(rays))] = np.einsum("rk,rk->r", rays, self.normals[owner])
        return rays, along


@dataclass(frozen=True)
class Balance:
    """Equations for the strengths (r,) along the pyramids' edges that carry the weight.

    `edges` (6, r) are the edges' forces and their moments about the origin; `rays` (r, 3) and
    `along` (n, r) are those of `Scene.rays`.
    """

    edges: Floats
    rays: Floats
    along: Floats

    @classmethod
    def of(cls, scene: Scene, sides: int, outside: bool = False) -> "Balance":
        """Return the equations for pyramids of so many sides."""
        rays, along = scene.rays(sides, outside)
        points = scene.points[np.argmax(along != 0.0, axis=0)]
        return cls(np.vstack([rays.T, np.cross(points, rays).T]), rays, along)

    def missing(self, com: Floats | None) -> tuple[float, Floats, Floats]:
        """Return the least wrench that is missing, and the strengths (r,) and com (2,) with it.

        The sum of its six absolute components.  Without a com the best one is found, too.
        """
        count = self.edges.shape[1]
        slack = np.hstack([np.eye(6), -np.eye(6)])
        found = _solved(
            np.concatenate([np.zeros(count + 2), np.ones(12)]),
            np.hstack([self.edges, COM, slack]),
            WEIGHT,
            [*[(0.0, None)] * count, *_bounds(com), *[(0.0, None)] * 12],
        )
        if found is None:
            return math.nan, np.zeros(count), np.zeros(2)
        return float(found[count + 2 :].sum()), found[:count], found[count : count + 2]

    def farthest(self, direction: Floats, start: tuple[Floats, Floats]) -> Floats:
        """Return the com (2,) that holds and lies farthest along a horizontal direction (2,).

        `start` are strengths and a com that hold, to within `MISSING`: what is missing there may be
        missing everywhere.
        """
        strengths, com = start
        count = len(strengths)
        rows = np.hstack([self.edges, COM])
        found = _solved(
            np.concatenate([np.zeros(count), -direction]),
            rows,
            rows @ np.concatenate([strengths, com]),
            [*[(0.0, None)] * count, *_bounds(None)],
        )
        return com if found is None else found[count:]

    def gentlest(self, strengths: Floats) -> Floats:
        """Return forces (n, 3) with the same wrench and the least largest normal force."""
        count, feet = len(strengths), len(self.along)
        found = _solved(
            np.append(np.zeros(count), 1.0),
            np.hstack([self.edges, np.zeros((6, 1))]),
            self.edges @ strengths,
            [(0.0, None)] * (count + 1),
            A_ub=np.hstack([self.along, -np.ones((feet, 1))]),
            b_ub=np.zeros(feet),
        )
        best = strengths if found is None else found[:count]
        return np.asarray((self.along != 0.0) @ (best[:, None] * self.rays))


# The weight's moment about the origin, com x (0, 0, -1) = (-y, x, 0), as columns of the com's x
# and y; and what the forces have to add up to.
COM = np.zeros((6, 2))
COM[3, 1], COM[4, 0] = -1.0, 1.0
WEIGHT = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


def _bounds(com: Floats | None) -> list[tuple[float, float]]:
    """Return the bounds of the com's x and y: itself, or the box."""
    return [(-BOX, BOX)] * 2 if com is None else [(x, x) for x in com.tolist()]


def _solved(
    cost: Floats, rows: Floats, right: Floats, bounds: list[Any], **more: Floats
) -> Floats | None:
    """Return the least costly x with rows x = right, or None where no method finds one."""
    from scipy.optimize import linprog

    for method in METHODS:
        options: dict[str, Any] = {**ACCURACY, "maxiter": STEPS}
        found = linprog(
            cost, A_eq=rows, b_eq=right, bounds=bounds, method=method, options=options, **more
        )
        if found.status == 0:
            return np.asarray(found.x)
    return None
