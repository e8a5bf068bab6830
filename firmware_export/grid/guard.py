"""Tip margins of a robot on three points, and how far a table of them may rise above the truth.

Owns the targets under which `margin` keeps the table.  On three points the standing region is the
cone m_e . g >= 0 of three tip-over planes, if their facet is accepted, and mu = min over e of
m_e . (u, v, 1) with the middle and axes of the face for 1, u and v.

- In (u, v) nothing is needed: within a cell, at fixed parameters, table minus m_e . (u, v, 1)
  is bilinear and so is largest at a corner.  The table is below mu everywhere if it is at the knots
  of (u, v).
- In the parameters a lattice of postures subdivides every cell.  Within a sub-cell with the sides
  s_a the table is multilinear and m_e differs from its own multilinear interpolant by at most the
  sum over a of s_a^2 / 8 |d2 m_e / dq_a^2|.  That is taken off the target: the second derivative is
  the largest second difference over the neighbouring postures, doubled because it is sampled.
"""

import math
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.lattice import Lattice
from firmware_export.grid.tables import U
from firmware_export.truth import Model, combinations
from lutgen.vector import Floats

# Postures of the lattice, about, and sub-cells of a cell at least and at most.
POSTURES = 4_000
FEWEST, MOST = 2, 8
SAFETY = 2.0
# Least accepted distance from the limit of `upright` (rad) and least height in robot sizes.
CLEAR = 0.02


class Targets(NamedTuple):
    """A lattice of postures and what the table must stay below there.

    `place` (P, k), 0 to 1; `target` (P, J) for J = faces x v knots x u knots; `remainder`, the
    largest that was taken off.
    """

    place: Floats
    target: Floats
    remainder: float


def subdivided(ends: Floats, parts: int) -> Floats:
    """Return the ends of cells with `parts` - 1 further places in every cell."""
    inner = ends[:-1, None] + np.diff(ends)[:, None] * np.arange(parts) / parts
    return np.append(inner.ravel(), ends[-1])


def planes(model: Model, params: Floats) -> tuple[Floats, Floats]:
    """Return inward unit normals (m, 3, 3) of the tip-over planes, and the facet's clearance.

    The clearance (m,) is positive where the facet is accepted: the lesser of its height over the
    robot's size, and of the angle (rad) by which it is within `upright`.
    """
    points = model.postures(params).centres
    normal = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normal /= np.sqrt((normal * normal).sum(axis=1, keepdims=True))
    height = (normal * points[:, 0]).sum(axis=1)
    away = np.where(height < 0.0, -1.0, 1.0)
    normal, height = normal * away[:, None], np.abs(height)
    edge = np.cross(points, np.roll(points, -1, axis=1)) * away[:, None, None]
    edge /= np.sqrt((edge * edge).sum(axis=2, keepdims=True))
    size = np.sqrt((points * points).sum(axis=2)).max(axis=1)
    tilt = np.arccos(np.clip(-normal[:, 2], -1.0, 1.0))
    limit = model.recipe.upright
    within = np.full(len(params), math.pi) if limit >= math.pi else limit - tilt
    return edge, np.minimum(height / size, within)


def is_smooth(model: Model) -> bool:
    """Tell whether `targets` applies: three points whose facet is accepted all over the box."""
    if not model.is_tripod:
        return False
    count = max(3, round(POSTURES ** (1.0 / max(model.k, 1))))
    place = combinations([np.linspace(0.0, 1.0, count)] * model.k)
    clearance = planes(model, model.at(place))[1]
    return bool(clearance.min() > CLEAR)


def targets(model: Model, lattice: Lattice) -> Targets:
    """Return what the table of mu on `lattice` must stay below."""
    cells = [len(k) - 1 for k, c in zip(lattice.knots, lattice.coordinates, strict=True) if c < U]
    total = math.prod(cells) if cells else 1
    wanted = (POSTURES / total) ** (1.0 / max(len(cells), 1))
    parts = min(max(round(wanted), FEWEST), MOST)
    axes = [np.array([0.0, 0.5, 1.0])] * model.k
    for coordinate, ends in zip(lattice.coordinates, lattice.ends, strict=True):
        if coordinate < U:
            axes[coordinate] = subdivided(ends, parts)
    shape = tuple(len(axis) for axis in axes)
    place = combinations(axes)
    normal = planes(model, model.at(place))[0]
    direction = lattice.directions()
    margin = np.einsum("pec,jc->pej", normal, direction)

    allowance = np.zeros_like(margin)
    for a, axis in enumerate(axes):
        if len(axis) < 3:
            continue
        grid = margin.reshape(*shape, *margin.shape[1:])
        allowance += _curvature(grid, axis, a).reshape(margin.shape)
    # The largest of all postures around: those of the sub-cells that meet here and one beyond.
    grid = allowance.reshape(*shape, *margin.shape[1:])
    for a in range(model.k):
        grid = _largest_around(_largest_around(grid, a), a)
    allowance = SAFETY * grid.reshape(margin.shape)
    return Targets(place, (margin - allowance).min(axis=1), float(allowance.max(initial=0.0)))


def _curvature(value: Floats, axis: Floats, a: int) -> Floats:
    """Return s^2 / 8 |second derivative| along one axis, s the larger neighbouring sub-cell."""
    grid = np.moveaxis(value, a, 0)
    step = np.diff(axis).reshape(-1, *[1] * (grid.ndim - 1))
    slope = np.diff(grid, axis=0) / step
    second = np.abs(np.diff(slope, axis=0)) / (0.5 * (step[1:] + step[:-1]))
    bound = np.maximum(step[1:], step[:-1]) ** 2 / 8.0 * second
    bound = np.concatenate([bound[:1], bound, bound[-1:]])
    return np.moveaxis(bound, 0, a)


def _largest_around(value: Floats, a: int) -> Floats:
    grid = np.moveaxis(value, a, 0)
    padded = np.concatenate([grid[:1], grid, grid[-1:]])
    return np.moveaxis(np.maximum.reduce([padded[:-2], padded[1:-1], padded[2:]]), 0, a)


def neighbours(shape: tuple[int, ...], flag: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return `flag` (shape) spread to all nodes that share a cell with a flagged one."""
    result = flag.reshape(shape)
    padded = np.pad(result, 1)
    found = np.zeros(shape, np.bool_)
    for way in product((0, 1, 2), repeat=len(shape)):
        found |= padded[tuple(slice(w, w + n) for w, n in zip(way, shape, strict=True))]
    return found
