"""Forces at contacts that balance a weight, and the centres of mass that they can hold.

Pyramids stand for friction cones, so that linear programmes find the forces.  Forces are shares of
the weight, lengths are over the scene's size, in a frame of two horizontal axes and up.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lutgen.vector import Floats

# A wrench that is missing by less (of weight, and of weight x size) counts as none: 100 times what
# of the solver, below.
MISSING = 1e-7
# Steps of one programme, a hundred times what real scenes take: rounding may make it go in circles.
OPTIONS = {
    "primal_feasibility_tolerance": 1e-9,
    "dual_feasibility_tolerance": 1e-9,
    "maxiter": 20_000,
}
# Tried in turn: each gives up on some programmes that the others solve.
METHODS = ("highs", "highs-ds", "highs-ipm")
# Half a side of the square in which the com is searched, in sizes.
BOX = 100.0
# The region is refined until no side can be moved out by more, of its diameter.
GAP = 1e-4
# Lengths below it, of the size or the diameter, count as 0: a farthest com is known to about the
# solver's accuracy of 1e-9, times as much as a com moves with a wrench in flat scenes.
SAME = 1e-6
# A round region takes some 200 corners to GAP; where rounding keeps finding more, there is an end.
MOST_CORNERS = 1000
# The weight's moment about the origin, com x (0, 0, -1) = (-y, x, 0), as columns of the com's x
# and y; and what the forces have to add up to.
COM = np.zeros((6, 2))
COM[3, 1], COM[4, 0] = -1.0, 1.0
WEIGHT = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])


@dataclass(frozen=True)
class Balance:
    """Equations for the strengths (r,) along the edges of pyramids that carry the weight.

    `edges` (6, r) are the unit edges' forces and their moments about the origin.  An entry of
    `along` (n, r) is the edge's part along the normal of its contact, so that the matrix turns
    strengths into normal forces.
    """

    edges: Floats
    along: Floats

    @classmethod
    def of(
        cls, points: Floats, normals: Floats, friction: Floats, sides: int, outside: bool = False
    ) -> "Balance":
        """Return the equations of contacts (n, 3) for pyramids of so many sides.

        The pyramids lie in the cones and touch them with their edges, or go round them and touch
        them with their faces.  One edge lies straight uphill, so that a scene in one vertical plane
        has its own cones.
        """
        rays, owner = [], []
        around = np.arange(sides) * (2.0 * math.pi / sides)
        for i, (normal, mu) in enumerate(zip(normals, friction, strict=True)):
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
            rays.append((normal + mu * fan) / math.hypot(1.0, mu))
            owner += [i] * len(turns)
        ray = np.concatenate(rays)
        along = np.zeros((len(points), len(ray)))
        along[owner, range(len(ray))] = np.einsum("rk,rk->r", ray, normals[owner])
        return cls(np.vstack([ray.T, np.cross(points[owner], ray).T]), along)

    def missing(self, com: Floats | None) -> tuple[float, Floats, Floats]:
        """Return the least wrench that is missing, and the strengths (r,) and com (2,) with it.

        The sum of its six absolute components.  Without a com the best one is found, too.
        """
        count = self.edges.shape[1]
        residue = np.hstack([np.eye(6), -np.eye(6)])
        box = [(-BOX, BOX)] * 2 if com is None else [(x, x) for x in com.tolist()]
        found = _solved(
            np.concatenate([np.zeros(count + 2), np.ones(12)]),
            np.hstack([self.edges, COM, residue]),
            WEIGHT,
            [*[(0.0, None)] * count, *box, *[(0.0, None)] * 12],
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
        rows = np.hstack([self.edges, COM])
        found = _solved(
            np.concatenate([np.zeros(len(strengths)), -direction]),
            rows,
            rows @ np.concatenate([strengths, com]),
            [*[(0.0, None)] * len(strengths), *[(-BOX, BOX)] * 2],
        )
        return com if found is None else found[len(strengths) :]

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
        return np.asarray((self.along != 0.0) @ (best[:, None] * self.edges[:3].T))

    def region(self) -> Floats:
        """Return the corners (k, 2) of the com positions that hold, counter-clockwise.

        Between two corners the farthest com beyond their side is a new corner, as long as there is
        one (Bretl and Lall, Section IV).
        """
        missing, *start = self.missing(None)
        if not missing <= MISSING:
            return np.empty((0, 2))

        def farthest(x: float, y: float) -> Floats:
            return self.farthest(np.array([x, y]), (start[0], start[1]))

        ends = [farthest(x, y) for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))]
        apart = [
            (float(np.linalg.norm(a - b)), i, j)
            for i, a in enumerate(ends)
            for j, b in enumerate(ends[:i])
        ]
        diameter, i, j = max(apart)
        if diameter <= SAME:
            return ends[0][None]
        corners = [ends[i], ends[j]]
        at = 0
        while at < len(corners) < MOST_CORNERS:
            here, there = corners[at], corners[(at + 1) % len(corners)]
            x, y = (there - here) / np.linalg.norm(there - here)
            # To the right of a side, the corners being counter-clockwise.
            found = farthest(y, -x)
            if (found - here) @ (y, -x) > GAP * diameter:
                corners.insert(at + 1, found)
                diameter = max(diameter, *(float(np.linalg.norm(found - one)) for one in corners))
            else:
                at += 1
        return _without_straight(np.array(corners), SAME * diameter)


def _solved(
    cost: Floats, rows: Floats, right: Floats, bounds: list[Any], **more: Floats
) -> Floats | None:
    """Return the least costly x with rows x = right, or None where no method finds one."""
    # Other commands need not wait for it, a quarter of a second.
    from scipy.optimize import linprog

    for method in METHODS:
        given = {"A_eq": rows, "b_eq": right, "bounds": bounds, "options": OPTIONS, **more}
        found = linprog(cost, method=method, **given)
        if found.status == 0:
            return np.asarray(found.x)
    return None


def _without_straight(corners: Floats, least: float) -> Floats:
    """Return the corners of a polygon without those that stand out by less than a length."""
    at = 0
    while len(corners) > 2 and at < len(corners):
        before, here, after = corners[[at - 1, at, (at + 1) % len(corners)]]
        side, arm = after - before, here - before
        long = float(np.linalg.norm(side))
        if long <= least or abs(side[0] * arm[1] - side[1] * arm[0]) <= least * long:
            corners = np.delete(corners, at, axis=0)
            at = max(at - 1, 0)
        else:
            at += 1
    return corners


def margin_in(region: Floats, com: Floats) -> float:
    """Return the signed distance of a com (2,) from the boundary of a region (k, 2).

    The ends of the search are no boundary for a com within.
    """
    if not len(region):
        return -np.inf
    ends = np.roll(region, -1, axis=0)
    sides, arms = ends - region, com - region
    squares = np.einsum("ki,ki->k", sides, sides)
    share = np.einsum("ki,ki->k", arms, sides) / np.where(squares > 0.0, squares, 1.0)
    distance = np.linalg.norm(arms - np.clip(share, 0.0, 1.0)[:, None] * sides, axis=1)
    left = sides[:, 0] * arms[:, 1] - sides[:, 1] * arms[:, 0]
    if len(region) < 3:
        away = float(distance.min())
        return 0.0 if away <= SAME else -away
    if (left < 0.0).any():
        return -float(distance.min())
    limit = BOX * (1.0 - SAME)
    true = ~((np.abs(region) > limit) & (np.abs(ends) > limit)).any(axis=1)
    return float(distance[true].min(initial=np.inf))
