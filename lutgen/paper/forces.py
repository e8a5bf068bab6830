"""How far the paper's Eq 12 is from the exact normal forces on three wheels.

Owns the table over pitch and the statistics over random loads.  Eq 12 is taken without its
leading minus; forces are shares of |N_g|.
"""

import math
from dataclasses import dataclass

import numpy as np

from lutgen.analysis import heuristic_forces
from lutgen.paper.nominal import Array, nominal_wheels
from lutgen.paper.printed import eq4_to_6, eq7, normal_of

# Pitch and heading (deg).  The slope rises towards the heading, seen from the com; wheel 1 is at
# heading 0.  39.7 and 58 deg are close to tipping, atan(10/12) = 39.81 and atan(20/12) = 59.04.
SLOPES = ((0, 0), (10, 0), (20, 0), (30, 0), (39.7, 0), (30, 180), (58, 180), (30, 90))


@dataclass(frozen=True)
class ForceRow:
    """One slope: the exact shares, those of Eq 12, and the largest difference.

    Angles in degrees, forces as shares of |N_g|.
    """

    pitch_deg: float
    heading_deg: float
    exact: tuple[float, ...]
    heuristic: tuple[float, ...]
    largest_error: float


@dataclass(frozen=True)
class ForceStatistics:
    """Largest error of the three shares by Eq 12, over random loads inside triangles.

    `triangles` is "equilateral", or "random": corners uniform in a square.  `mean`, `p95` (the
    95th percentile) and `worst` are over the loads; `negative` is the share of the loads for
    which Eq 12 lets a wheel pull at the ground.
    """

    triangles: str
    loads: int
    mean: float
    p95: float
    worst: float
    negative: float


def slope_gravity(pitch: float, heading: float) -> Array:
    """Return gravity in the body frame, (3,), on a slope that rises to `heading` (rad)."""
    level = -math.sin(pitch)
    return np.array([level * math.cos(heading), level * math.sin(heading), -math.cos(pitch)])


def exact_forces(wheels: Array, gravity: Array) -> Array:
    """Return the normal forces on three wheels, (3,), as shares of |N_g|.

    Contact points (3, 3) are relative to the com and not in a plane with it; gravity (3,) points
    down, with any length, and is not parallel to the contact plane.

    With b = inv([P1 P2 P3]) g, D_g = sum(b_i P_i) / sum(b), so b / sum(b) are the forces whose
    resultant goes through D_g: negative where the robot tips, zero on the tip-over axis.
    Friction acts in the plane and has no moment about its axes.
    """
    b = np.linalg.solve(wheels.T, gravity)
    return np.asarray(b / b.sum())


def pierced_point(wheels: Array, gravity: Array) -> Array:
    """Return D_g, (3,), by Eqs 4 to 7, which are right as printed."""
    return eq4_to_6(gravity, eq7(normal_of(wheels), wheels[0], gravity))


def force_table(wheels: Array | None = None) -> tuple[ForceRow, ...]:
    """Return exact and heuristic forces on `wheels` (3, 3), by default the nominal robot's."""
    points = nominal_wheels() if wheels is None else wheels
    rows = []
    for pitch, heading in SLOPES:
        gravity = slope_gravity(math.radians(pitch), math.radians(heading))
        exact = exact_forces(points, gravity)
        rough = heuristic_forces(points, pierced_point(points, gravity))
        error = float(np.abs(exact - rough).max())
        rows.append(ForceRow(pitch, heading, tuple(exact.tolist()), tuple(rough.tolist()), error))
    return tuple(rows)


def force_statistics(loads: int = 200_000, seed: int = 20) -> tuple[ForceStatistics, ...]:
    """Return the error of Eq 12 over `loads` uniform in equilateral and in random triangles.

    The latter depends on how triangles are drawn: with Gaussian corners Eq 12 is negative about
    as often, with corners on a circle a third more often.
    """
    rng = np.random.default_rng(seed)
    shares = rng.dirichlet(np.ones(3), loads)
    equilateral = np.broadcast_to(nominal_wheels()[:, :2], (loads, 3, 2))
    return (
        _statistics("equilateral", equilateral, shares),
        _statistics("random", rng.random((loads, 3, 2)), shares),
    )


def _statistics(name: str, corners: Array, shares: Array) -> ForceStatistics:
    """Return the errors for exact `shares` (m, 3) on triangles (m, 3, 2)."""
    pierced = np.einsum("mi,mij->mj", shares, corners)
    distance = np.linalg.norm(corners - pierced[:, None], axis=2)
    # Eq 12 for n_a = 3, over all loads at once.
    rough = 2.0 / 3.0 - distance / distance.sum(axis=1, keepdims=True)
    error = np.abs(rough - shares).max(axis=1)
    found = error.mean(), np.quantile(error, 0.95), error.max(), (rough < 0.0).any(axis=1).mean()
    return ForceStatistics(name, len(error), *map(float, found))
