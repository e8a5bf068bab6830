"""Footing of one posture: its support facets with their polygons, and its tip-over axes.

Owns the step from the kernels' flat arrays to what questions about many directions of one posture
need: which facet lies on the ground is then one matrix product.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import acceptance_of, refuse_forces
from lutgen.recipe import Recipe, forward, radii_and_kinds
from lutgen.support import (
    CENTROID,
    CONVEX,
    FACETS,
    FIRST,
    HEIGHT,
    SEGMENTS,
    SOURCE,
    START,
    STOP,
    VERTEX,
    empty_region,
    facet_table,
    pack,
    stand,
)

__all__ = ["Footing", "GroundFacet", "find_footing"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class GroundFacet:
    """An accepted facet: unit outward normal, height of the com, and its support polygon.

    `contacts` are the polygon's corners, counter-clockwise seen from outside, and `points` (k, 3)
    their contact points relative to the com; `centroid` (3,) is s.
    """

    normal: Floats
    height: float
    contacts: tuple[int, ...]
    points: Floats
    centroid: Floats

    @property
    def inradius(self) -> float:
        """Distance from the centroid to the nearest side of the support polygon."""
        sides = np.roll(self.points, -1, axis=0) - self.points
        arms = np.cross(self.points - self.centroid, sides)
        return float((np.linalg.norm(arms, axis=1) / np.linalg.norm(sides, axis=1)).min())

    def pierced(self, gravity_dir: Floats) -> Floats:
        """Return D_g (3,), where the ray along a direction pierces the facet's plane."""
        return np.asarray(gravity_dir * (self.height / float(self.normal @ gravity_dir)))


@dataclass(frozen=True)
class Footing:
    """Facets in canonical order, and the boundary of the standing region.

    `axes` (n, 3) are the discs' unit axes, zero for other contacts.  `start` and `stop` (b, 3)
    are the tip-over axes' ends relative to the com, start x stop pointing inward; `convex` tells
    whether the standing region is.
    """

    facets: tuple[GroundFacet, ...]
    axes: Floats
    start: Floats
    stop: Floats
    convex: bool

    def under(self, gravity_dir: Floats) -> NDArray[np.intp]:
        """Return the index (g,) of the facet on the ground for (g, 3) directions; -1 for none."""
        if not self.facets:
            return np.full(len(gravity_dir), -1)
        planes = np.array([facet.normal / facet.height for facet in self.facets])
        rates = gravity_dir @ planes.T
        highest = rates.max(axis=1)
        # Ties go to the lower index, as in `region.supporting_facet`.
        nearest = np.argmax(rates * (1.0 + 1e-12) >= highest[:, None], axis=1)
        return np.where(highest > 0.0, nearest, -1)


def find_footing(recipe: Recipe, params: ArrayLike) -> Footing:
    """Find the facets on which one posture can stand, and its tip-over axes.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (k,) array_like
        Geometry parameters, rad or length.

    Raises
    ------
    InputError
        For a recipe with forces, under which a ray of gravity does not find the facet.
    """
    refuse_forces(recipe, "a footing (metrics, rolling)")
    posture = forward(recipe, np.atleast_2d(np.asarray(params, np.float64)))
    primitives = pack(posture.centres[0], posture.axes[0], *radii_and_kinds(recipe))
    table, region = facet_table(len(primitives)), empty_region(len(primitives))
    stand(table, region, primitives, acceptance_of(recipe))
    facets = []
    for k in range(region.tally[FACETS]):
        f = region.span[k, SOURCE]
        corners = slice(table.span[f, FIRST], table.span[f + 1, FIRST])
        facets.append(
            GroundFacet(
                table.facet[f, :3].copy(),
                float(region.facet[k, HEIGHT]),
                tuple(int(i) for i in table.link[corners, VERTEX]),
                table.corner[corners].copy(),
                region.facet[k, CENTROID : CENTROID + 3].copy(),
            )
        )
    sides = region.segment[: region.tally[SEGMENTS]]
    return Footing(
        tuple(facets),
        posture.axes[0],
        sides[:, START : START + 3].copy(),
        sides[:, STOP : STOP + 3].copy(),
        bool(region.tally[CONVEX] == 1),
    )
