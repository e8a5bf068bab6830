"""One posture under one direction, explained: facet, tip-over axes, forces, sliding.

It says what a map does not store, for people and plots; it is exact and not fast.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lutgen import channels as kernels
from lutgen.analysis.forces import heuristic_forces, loads_on
from lutgen.analysis.posture import Facet, Posture
from lutgen.quantities import CHANNELS
from lutgen.support import seat_under
from lutgen.vector import Floats, Vector, dot, read3

# Shares of the weight nearer than this are one, as far as the balance is kept.
BALANCED = 1e-9


@dataclass(frozen=True)
class TipAxis:
    """A piece of the standing region's boundary: the line over which the robot would turn.

    Its two contacts, by `names`, are the same for the side of a gap, where one round contact rolls.
    Angles and lengths are signed as for the channels.
    """

    names: tuple[str, str]
    start: Floats
    stop: Floats
    tip_angle: float
    margin: float
    energy_margin: float


@dataclass(frozen=True)
class Diagnosis:
    """Everything about one posture under one direction, `gravity_dir`; lengths as in the recipe.

    `facet` is the support facet, also where the robot tips, or None if it has none; `pierced` (3,)
    is D_g in its plane, under forces the zero-moment point, and NaN without a facet.
    `normal_forces` are shares of the weight's component along the facet's normal, by name of all
    contacts that touch it: "exact" where only one distribution balances, as for three contacts not
    in a line, "minimum norm" (of all that balance and do not pull) elsewhere; empty where the
    robot tips, and over a gap, where it rocks from one facet to another.  `normal_ranges` are the
    least and the largest share that each can carry, one distribution per bound.
    `heuristic_forces` are those of the paper's Eq 12.  `slides` is None without a friction
    coefficient.  Under the recipe's forces the weight is the resultant of weight and forces,
    `resultant` over the weight, and `slope` its angle to the normal.
    """

    posture: Posture
    gravity_dir: Floats
    standing: bool
    channels: dict[str, float]
    facet: Facet | None
    pierced: Floats
    tip_over_axes: tuple[TipAxis, ...]
    least_stable: int | None
    normal_forces: dict[str, float]
    forces_kind: str
    normal_ranges: dict[str, tuple[float, float]]
    heuristic_forces: dict[str, float]
    slope: float
    slides: bool | None
    resultant: Floats


def diagnose(posture: Posture, gravity_dir: ArrayLike) -> Diagnosis:
    """Explain one posture under one gravity direction (3,): down, body frame, any length > 0."""
    recipe, wrench = posture.recipe, posture.wrench
    down = kernels.checked_directions(gravity_dir)
    values = kernels.measure_recipe(recipe, posture.placed, down[None], CHANNELS)
    channels = {name: float(values[name][0, 0]) for name in CHANNELS}
    g = (float(down[0, 0]), float(down[0, 1]), float(down[0, 2]))
    standing = channels["tip_angle"] >= 0.0
    numbers_of = _loaded_numbers if recipe.loaded else _numbers
    k, numbers = numbers_of(posture, g, standing)
    tip_axes = tuple(_tip_axis(posture, b, *found) for b, found in enumerate(numbers))
    angles = [axis.tip_angle if posture.convex else abs(axis.tip_angle) for axis in tip_axes]
    least = angles.index(min(angles)) if angles else None
    resultant = down[0] + wrench["phi"]
    facet, pierced, slope = None, np.full(3, np.nan), math.nan
    if k >= 0:
        facet = posture.facets[k]
        pierced = facet.pierced(resultant, wrench["mu"])
        size = float(np.linalg.norm(resultant)) if recipe.has_wrench else 1.0
        slope = math.acos(max(-1.0, min(1.0, float(facet.normal @ resultant) / size)))
    exact: dict[str, float] = {}
    ranges: dict[str, tuple[float, float]] = {}
    rough: dict[str, float] = {}
    forces_kind = ""
    if facet is not None and standing:
        points = facet.touching_points
        loads, smallest = loads_on(points, pierced, facet.axle)
        # Over a gap the robot rocks on two contacts, and nothing balances on this facet.
        if len(loads):
            names = [recipe.contact_names[i] for i in facet.touching]
            low, high = loads.min(axis=0), loads.max(axis=0)
            exact = dict(zip(names, smallest.tolist(), strict=True))
            bounds = zip(low.tolist(), high.tolist(), strict=True)
            ranges = dict(zip(names, bounds, strict=True))
            rough = dict(zip(names, heuristic_forces(points, pierced).tolist(), strict=True))
            unique = float((high - low).max()) < BALANCED
            forces_kind = "exact" if unique else "minimum norm"
    slides = None
    if recipe.friction is not None and facet is not None:
        slides = math.tan(slope) > recipe.friction if slope < math.pi / 2 else True
    return Diagnosis(
        posture,
        gravity_dir=down[0],
        standing=standing,
        channels=channels,
        facet=facet,
        pierced=pierced,
        tip_over_axes=tip_axes,
        least_stable=least,
        normal_forces=exact,
        forces_kind=forces_kind,
        normal_ranges=ranges,
        heuristic_forces=rough,
        slope=slope,
        slides=slides,
        resultant=resultant,
    )


def _numbers(posture: Posture, g: Vector, standing: bool) -> tuple[int, list[Vector]]:
    """Return the facet on the ground; angle, margin and energy of the arcs of the boundary."""
    region, convex = posture.region, posture.convex
    sign = 1.0 if standing else -1.0
    found = []
    for b in range(region.counts.arcs):
        start, stop, wall = (read3(region.arc[b][name]) for name in ("start", "stop", "wall"))
        margin = kernels.axis_margin(start, stop, wall, convex, g)
        if convex:
            angle = math.asin(min(max(dot(wall, g), -1.0), 1.0))
            energy = kernels.axis_energy(start, stop, wall, g)
        else:
            angle = sign * kernels.arc_angle(region, b, g)
            margin, energy = sign * abs(margin), sign * kernels.segment_energy(start, stop, g)
        found.append((angle, margin, energy))
    return seat_under(region, g), found


def _loaded_numbers(posture: Posture, g: Vector, standing: bool) -> tuple[int, list[Vector]]:
    """Return the same under a load, for which the energy margin is not defined."""
    region, wrench = posture.region, posture.wrench
    axes, found = kernels.empty_axes(), []
    kernels.find_axes(region, wrench, axes)
    for b in range(region.counts.arcs):
        angle = kernels.axis_angle(region, axes, b, wrench, standing, g)
        margin = kernels.loaded_margin(region, axes, b, wrench, standing, g)
        found.append((angle, margin, math.nan))
    return kernels.loaded_verdict(region, axes, wrench, g)[0], found


def _tip_axis(posture: Posture, b: int, angle: float, margin: float, energy: float) -> TipAxis:
    """Return arc b of the boundary with its numbers."""
    axis, names = posture.axes[b], posture.recipe.contact_names
    i, j = (int(posture.region.source[c]) for c in axis["contacts"])
    ends = axis["start"].copy(), axis["stop"].copy()
    return TipAxis((names[i], names[j]), *ends, angle, margin, energy)
