"""One posture of a robot for Python: its support facets and its tip-over axes.

Every function of this room about one posture takes a `Posture`; those that take many at
once take a recipe and (m, k) rows of geometry parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen import support
from lutgen.analysis.forces import Axle
from lutgen.channels import acceptance_of, primitives_of, refuse_forces, region_of, wrenches
from lutgen.errors import InputError, reject
from lutgen.recipe import Postures, Recipe, body_parts, forward, robot_size_of
from lutgen.vector import Floats, read3

# Share of the robot's size: descriptions round their shapes, and a sole may be a little below the
# spheres that stand for it.
SLACK = 0.01


@dataclass(frozen=True, eq=False)
class Facet:
    """An accepted support facet: unit outward normal, height of the com, and its polygon.

    `contacts` are the polygon's corners, counter-clockwise seen from outside, and `points` (k, 3)
    their contact points relative to the com; `centroid` (3,) is s.  `touching` are all contacts
    in the facet's plane, the corners first and then, in the recipe's order, those on its sides and
    inside, and `touching_points` (t, 3) theirs.  `axle` is one that swings there, if any; the
    corners then have the names of the nearest contacts.  Body frame, recipe's unit.
    """

    normal: Floats
    height: float
    contacts: tuple[int, ...]
    points: Floats
    centroid: Floats
    touching: tuple[int, ...]
    touching_points: Floats
    axle: Axle | None = None

    @property
    def inradius(self) -> float:
        """Distance from the centroid to the nearest side of the support polygon."""
        sides = np.roll(self.points, -1, axis=0) - self.points
        arms = np.cross(self.points - self.centroid, sides)
        return float((np.linalg.norm(arms, axis=1) / np.linalg.norm(sides, axis=1)).min())

    def pierced(self, direction: Floats, moment: Floats | None = None) -> Floats:
        """Return D_g (3,), where the ray along a direction pierces the facet's plane.

        With the moment of forces about the com it is the zero-moment point.  NaN where the ray
        runs along or away from the plane.
        """
        rate = float(self.normal @ direction)
        if not rate > 0.0:
            return np.full(3, np.nan)
        pierced = np.asarray(direction * (self.height / rate))
        if moment is not None and moment.any():
            pierced = pierced + np.cross(self.normal, moment) / rate
        return pierced

    def along(self, direction: Floats) -> Floats:
        """Return the part (3,) of a direction in the facet's plane."""
        return np.asarray(direction - float(self.normal @ direction) * self.normal)

    def frame(self, ahead: Floats) -> Floats:
        """Return the unit axes x and y (2, 3) of the plane.

        x runs along the part of `ahead` in it, which must not vanish; x, y and the outward normal
        are right-handed, so that y points to the right of x seen from above the ground.
        """
        x = self.along(ahead)
        x = x / float(np.linalg.norm(x))
        return np.array([x, np.cross(self.normal, x)])


class Posture:
    """One geometry of a robot: its parameters (k,), rad or the recipe's length unit.

    `row` (1, k) are these parameters as functions of many postures take them.
    """

    def __init__(self, recipe: Recipe, params: ArrayLike) -> None:
        self.recipe = recipe
        self.params = np.asarray(params, dtype=np.float64)
        if self.params.ndim != 1:
            what = f"one posture needs params of the shape ({len(recipe.parameters)},)"
            way_out = "pass one number per geometry parameter"
            reject(recipe.source, what, f"the shape {self.params.shape}", way_out, InputError)
        self.row = self.params[None]

    @cached_property
    def placed(self) -> Postures:
        """Where everything is, of one posture: centres (1, n, 3), axes (1, n, 3), com (1, 3)."""
        return forward(self.recipe, self.row)

    @cached_property
    def primitives(self) -> Floats:
        """The contacts as the kernels take them (n, 8), relative to the com; then the axles."""
        return np.asarray(primitives_of(self.recipe, self.placed)[0])

    @cached_property
    def wrench(self) -> Any:
        """Forces `phi` and moment `mu` over the weight, and the com's uncertainty `rho`."""
        return wrenches(self.recipe, self.placed)[0]

    @cached_property
    def region(self) -> support.Region:
        """What stands and what tips, as the kernels have it."""
        return region_of(self.primitives, acceptance_of(self.recipe))

    @property
    def seats(self) -> NDArray[np.void]:
        """The kernels' rows of the accepted facets, in canonical order."""
        return np.asarray(self.region.seat[: self.region.counts.accepted])

    @cached_property
    def facets(self) -> tuple[Facet, ...]:
        """The accepted facets, in canonical order."""
        return tuple(_facet(self.region, k) for k in range(len(self.seats)))

    @property
    def axes(self) -> NDArray[np.void]:
        """The tip-over axes: `start` and `stop` (3,), relative to the com, start x stop inward."""
        return np.asarray(self.region.arc[: self.region.counts.arcs])

    @property
    def convex(self) -> bool:
        """True if the standing region is."""
        return bool(self.region.counts.convex)

    def under(self, direction: Floats) -> Facet | None:
        """Return the facet that gravity along a direction (3,) pierces, or None."""
        k = support.seat_under(self.region, read3(direction))
        return self.facets[k] if k >= 0 else None

    def refuse_forces(self) -> None:
        """Refuse forces, under which a ray of gravity finds no facet."""
        refuse_forces(self.recipe, "an answer on metrics or rolling")


def _facet(region: support.Region, k: int) -> Facet:
    """Return accepted facet k of a region; contacts by their rows in the recipe."""
    seat, source, shown = region.seat[k], region.source, region.shown
    facet = region.facet[seat["facet"]]
    edges = range(facet["first"], facet["first"] + facet["count"])
    corners = [int(region.edge[e]["primitive"]) for e in edges]
    mask = int(seat["mask"])
    first = [] if facet["swings"] else corners
    others = [i for i in range(len(source)) if mask >> i & 1 and i not in first]
    x, y, z = seat["normal"].tolist()
    inner = [support.support_contact(shown, i, (x, y, z)) for i in others]
    points = np.array([region.edge[e]["point"] for e in edges])
    return Facet(
        seat["normal"].copy(),
        float(seat["height"]),
        tuple(int(source[i]) for i in corners),
        points,
        seat["centroid"].copy(),
        tuple(int(source[i]) for i in (*first, *others)),
        np.vstack([points[: len(first)], np.array(inner).reshape(-1, 3)]),
        _axle(region.axle[seat["facet"]], others) if facet["swings"] else None,
    )


def _axle(row: np.void, touching: Sequence[int]) -> Axle:
    """Return an axle of the region; `touching` are the primitives on its facet."""
    pivot, way, com = (read3(row[name].copy()) for name in ("pivot", "way", "com"))
    ends = touching.index(int(row["first"])), touching.index(int(row["second"]))
    return Axle((pivot, way), com, float(row["mass"]), ends)


def below_ground(posture: Posture, facet: Facet) -> dict[str, float]:
    """Return how far links without contacts would reach below the ground, by their name.

    It is the depth below the plane of the facet that is on the ground, of those whose depth is more
    than 1 % of the robot's size; empty where nothing is known of the body.
    """
    recipe = posture.recipe
    parts = body_parts(recipe)
    if not parts:
        return {}
    # Sizes are the robot's, not those of a robot on all its parts.
    least = SLACK * robot_size_of(recipe)
    body = Posture(replace(recipe, contacts=parts, axles=()), posture.params).primitives
    x, y, z = facet.normal.tolist()
    result: dict[str, float] = {}
    for i, part in enumerate(parts):
        depth = support.support_height(body, i, (x, y, z)) - facet.height
        if depth > least:
            result[part.link] = max(depth, result.get(part.link, 0.0))
    return result
