"""One posture under one direction, explained: facet, tip-over axes, forces, sliding.

Owns what a map does not store.  `diagnose` is for people and plots; it is exact and not fast.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels import (
    CHANNELS,
    MU,
    PHI,
    RHO,
    acceptance_of,
    axis_angle,
    axis_energy,
    axis_margin,
    checked_directions,
    empty_axes,
    find_axes,
    loaded_margin,
    loaded_verdict,
    measure_moved,
    tip_angle,
    wrenches,
)
from lutgen.chart import STANDARD_GRAVITY
from lutgen.recipe import Recipe, forward, radii_and_kinds
from lutgen.support import (
    CENTROID,
    CONVEX,
    FACETS,
    FIRST,
    HEIGHT,
    KIND,
    RADIUS,
    SEGMENTS,
    SOURCE,
    START,
    STOP,
    TIP_PLANE,
    VERTEX,
    empty_region,
    facet_table,
    pack,
    stand,
    supporting_facet,
    vector_at,
)
from lutgen.vector import dot

Vector3 = NDArray[np.float64]
# Shares of the weight below this are zero but for rounding.
ROUNDING = 1e-12


@dataclass(frozen=True)
class FacetView:
    """The support facet: unit outward normal, height of the com above it, and its polygon.

    `contacts` are the polygon's corners, counter-clockwise seen from outside, and `points` (k, 3)
    their contact points relative to the com; `centroid` is s, `pierced` is D_g (NaN where the ray
    runs along or away from the plane); under forces it is the zero-moment point.
    """

    normal: Vector3
    height: float
    contacts: tuple[int, ...]
    points: NDArray[np.float64]
    centroid: Vector3
    pierced: Vector3


@dataclass(frozen=True)
class TipAxis:
    """A piece of the standing region's boundary: the line over which the robot would turn.

    The two contacts are the same for the side of a gap, where one round contact rolls.  Angles
    and lengths are signed as for the channels.
    """

    contacts: tuple[int, int]
    names: tuple[str, str]
    start: Vector3
    stop: Vector3
    tip_angle: float
    margin: float
    energy_margin: float


@dataclass(frozen=True)
class Diagnosis:
    """Everything about one posture under one direction; lengths in the recipe's unit.

    `facet` is the support facet, also where the robot tips, or None if it has none.
    `normal_forces` are shares of the weight's component along the facet's normal, by contact
    name: "exact" for three contacts, "minimum norm" (of all that balance and nowhere pull) for
    more; empty where the robot tips, and over a gap, where it rocks from one facet to another.
    `heuristic_forces` are those of the paper's Eq 12.  `slides` is None without a friction
    coefficient.  Under the recipe's forces the weight is the resultant of weight and forces,
    `resultant` over the weight, and `slope` its angle to the normal.  `com_uncertainty` is the
    radius of the com's ball; `force_points` (f, 3), relative to the com, and `forces` (f, 3), over
    the weight, are where and how the recipe's forces act.
    """

    gravity_dir: Vector3
    com: Vector3
    centres: NDArray[np.float64]
    axes: NDArray[np.float64]
    radius: NDArray[np.float64]
    kind: NDArray[np.int64]
    standing: bool
    channels: dict[str, float]
    facet: FacetView | None
    tip_over_axes: tuple[TipAxis, ...]
    least_stable: int | None
    normal_forces: dict[str, float]
    forces_kind: str
    heuristic_forces: dict[str, float]
    slope: float
    slides: bool | None
    resultant: Vector3
    com_uncertainty: float
    force_points: NDArray[np.float64]
    forces: NDArray[np.float64]


def normal_forces(points: NDArray[np.float64], pierced: Vector3) -> NDArray[np.float64]:
    """Return each contact's share of the normal force, (k,), adding up to 1.

    Friction has no moment about axes in the contact plane, so force and moment balance about
    D_g alone fix the shares of three contacts, whatever mu is.  Of more than three the balance
    leaves a choice; this is the solution of the smallest sum of squares in which no contact pulls
    at the ground.  Where D_g is outside the polygon there is none, and some share is negative.

    Parameters
    ----------
    points : (k, 3) float64
        Contact points in one plane.
    pierced : (3,) float64
        D_g, in the same plane.
    """
    arms = points - pierced
    _, spread, basis = np.linalg.svd(arms, full_matrices=False)
    plane = basis[:2] if spread[1] > 0.0 else basis[:1]
    balance = np.vstack([np.ones(len(points)), (arms @ plane.T).T / max(spread[0], 1e-300)])
    wanted = np.zeros(len(balance))
    wanted[0] = 1.0
    shares: NDArray[np.float64] = np.linalg.lstsq(balance, wanted, rcond=None)[0]
    # The optimum has the form max(0, balance.T @ multipliers): find which contacts carry.
    carries = np.ones(len(points), np.bool_)
    for _ in range(2 * len(points)):
        part = balance[:, carries]
        candidate = balance.T @ np.linalg.lstsq(part @ part.T, wanted, rcond=None)[0]
        settled = not (candidate[carries] < -ROUNDING).any()
        if settled and not (candidate[~carries] > ROUNDING).any():
            pushing = np.where(carries, np.maximum(candidate, 0.0), 0.0)
            balanced = np.abs(balance @ pushing - wanted).max() < 1e3 * ROUNDING
            return pushing if balanced else shares
        carries = candidate > 0.0
        if not carries.any():
            break
    return shares


def heuristic_forces(points: NDArray[np.float64], pierced: Vector3) -> NDArray[np.float64]:
    """Return the shares of the paper's Eq 12 without its leading minus, (k,), adding up to 1.

    They do not balance moments: at a tip-over axis they still give the lifting wheel a fifth of
    the weight.  For comparison with the paper only.
    """
    distance = np.linalg.norm(points - pierced, axis=1)
    total = float(distance.sum())
    if total == 0.0:
        return np.full(len(points), 1.0 / len(points))
    return np.asarray((total / (len(points) / 2.0) - distance) / total)


def diagnose(recipe: Recipe, params: ArrayLike, gravity_dir: ArrayLike) -> Diagnosis:
    """Explain one posture under one gravity direction.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (k,) array_like
        Geometry parameters, rad or length.
    gravity_dir : (3,) array_like
        Pointing down, body frame, any length > 0.
    """
    row = np.atleast_2d(np.asarray(params, np.float64))
    down = checked_directions(gravity_dir)
    posture = forward(recipe, row)
    radius, kind = radii_and_kinds(recipe)
    primitives = pack(posture.centres[0], posture.axes[0], radius, kind)
    values = measure_moved(recipe, posture, down, CHANNELS)
    channels = {name: float(values[name][0, 0]) for name in CHANNELS}
    acceptance = acceptance_of(recipe)
    table, region = facet_table(len(primitives)), empty_region(len(primitives))
    stand(table, region, primitives, acceptance)
    g = (float(down[0, 0]), float(down[0, 1]), float(down[0, 2]))
    k = supporting_facet(region.facet, region.tally[FACETS], g)
    names = recipe.contact_names
    standing = channels["tip_angle"] >= 0.0
    wrench = wrenches(recipe, posture)[0]
    axes = empty_axes(region)
    if recipe.loaded:
        find_axes(region, wrench, axes)
        k, _, _ = loaded_verdict(region, axes, wrench, acceptance.least_cosine, g)
    tip_axes = tuple(
        _loaded_axis(region, axes, wrench, b, names, g, standing)
        if recipe.loaded
        else _tip_axis(region, b, names, g, standing)
        for b in range(region.tally[SEGMENTS])
    )
    least = min(range(len(tip_axes)), key=lambda b: abs(tip_axes[b].tip_angle), default=None)
    if region.tally[CONVEX] == 1 and tip_axes:
        least = min(range(len(tip_axes)), key=lambda b: tip_axes[b].tip_angle)
    resultant = down[0] + wrench[PHI:MU]
    facet = None if k < 0 else _facet_view(region, table, k, resultant, wrench[MU:RHO])
    slope = math.nan
    if facet is not None:
        size = float(np.linalg.norm(resultant)) if recipe.has_wrench else 1.0
        slope = math.acos(max(-1.0, min(1.0, float(facet.normal @ resultant) / size)))
    exact: dict[str, float] = {}
    rough: dict[str, float] = {}
    forces_kind = ""
    if facet is not None and standing:
        corners = [names[i] for i in facet.contacts]
        shares = normal_forces(facet.points, facet.pierced)
        # Over a gap the robot rocks on two contacts, and nothing balances on this facet.
        if shares.min() >= -1e-9:
            exact = dict(zip(corners, shares.tolist(), strict=True))
            heuristic = heuristic_forces(facet.points, facet.pierced)
            rough = dict(zip(corners, heuristic.tolist(), strict=True))
            forces_kind = "exact" if len(corners) == 3 else "minimum norm"
    slides = None
    if recipe.friction is not None and facet is not None:
        slides = math.tan(slope) > recipe.friction if slope < math.pi / 2 else True
    return Diagnosis(
        down[0],
        posture.com[0],
        posture.centres[0],
        posture.axes[0],
        primitives[:, RADIUS],
        primitives[:, KIND].astype(np.int64),
        standing,
        channels,
        facet,
        tip_axes,
        least,
        exact,
        forces_kind,
        rough,
        slope,
        slides,
        resultant,
        recipe.com_uncertainty,
        posture.force_points[0],
        _over_weight(recipe),
    )


def _over_weight(recipe: Recipe) -> NDArray[np.float64]:
    """Return the recipe's forces (f, 3) over its weight."""
    weight = sum(link.mass for link in recipe.links) * STANDARD_GRAVITY
    forces = [[part / weight for part in force.force] for force in recipe.forces]
    return np.array(forces, dtype=np.float64).reshape(-1, 3)


def _facet_view(  # type: ignore[no-untyped-def]
    region, table, k: int, resultant: Vector3, moment: Vector3
) -> FacetView:
    f = region.span[k, SOURCE]
    corners = slice(table.span[f, FIRST], table.span[f + 1, FIRST])
    normal = table.facet[f, :3].copy()
    height = float(region.facet[k, HEIGHT])
    rate = float(normal @ resultant)
    pierced = np.full(3, np.nan)
    if rate > 0.0:
        pierced = resultant * (height / rate)
        if moment.any():
            pierced = pierced + np.cross(normal, moment) / rate
    return FacetView(
        normal,
        height,
        tuple(int(i) for i in table.link[corners, VERTEX]),
        table.corner[corners].copy(),
        region.facet[k, CENTROID : CENTROID + 3].copy(),
        pierced,
    )


def _tip_axis(region, b, names, g, standing) -> TipAxis:  # type: ignore[no-untyped-def]
    """Return boundary segment b with its own angle, margin and energy."""
    i, j = (int(c) for c in region.contacts[b])
    start, stop, plane = (vector_at(region.segment, b, c) for c in (START, STOP, TIP_PLANE))
    convex = region.tally[CONVEX] == 1
    alone = region.tally.copy()
    alone[SEGMENTS] = 1
    piece = region.segment[b : b + 1]
    if convex:
        sine = dot(plane, g)
        angle = math.asin(min(max(sine, -1.0), 1.0))
    else:
        angle = tip_angle(alone, piece, standing, g)
    margin = axis_margin(start, stop, plane, convex, g)
    energy = axis_energy(start, stop, plane, g)
    if not convex:
        sign = 1.0 if standing else -1.0
        margin, energy = sign * abs(margin), sign * abs(energy)
    return TipAxis(
        (i, j),
        (names[i], names[j]),
        np.array(start),
        np.array(stop),
        angle,
        margin,
        energy,
    )


def _loaded_axis(region, axes, wrench, b, names, g, standing) -> TipAxis:  # type: ignore[no-untyped-def]
    """Return boundary segment b of a loaded robot, whose energy margin is not defined."""
    i, j = (int(c) for c in region.contacts[b])
    start, stop = (vector_at(region.segment, b, c) for c in (START, STOP))
    convex = bool(region.tally[CONVEX] == 1)
    row = axes.axis[b]
    return TipAxis(
        (i, j),
        (names[i], names[j]),
        np.array(start),
        np.array(stop),
        axis_angle(convex, row, axes.ends[b], start, stop, wrench, standing, g),
        loaded_margin(convex, row, start, stop, wrench, standing, g),
        math.nan,
    )
