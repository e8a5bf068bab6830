"""The gravity transform T_g: how gravity turns in the body while the robot changes its shape.

Owns the two readings of "the robot stands on this slope".  A robot that moves its legs on given
ground turns its body, and with it the direction of gravity in the body frame.

- ``"plane"`` (P): gravity is given relative to the **contact plane**.  Its z axis is the plane's
  normal, upward, and its x axis is the body's x axis, carried along.  T_g is the least rotation
  that takes the body's z axis to that normal, so on level ground the gravity direction in the
  body frame is the outward normal of the support facet, whatever the shape.
- ``"body"`` (F): gravity is given in the body frame and stays there; T_g is the identity.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.channels.axes import MOMENT, MU, PHI, RHO, add, enter_edge_planes, part
from lutgen.channels.batch import for_each_posture
from lutgen.channels.wrench import acceptance_of
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.recipe import Recipe, forward
from lutgen.support import (
    Acceptance,
    Region,
    edge_plane_at,
    edges_at,
    empty_region,
    facet_table,
    facets_in,
    height_at,
    is_rest_at,
    plane_at,
    stand,
)
from lutgen.vector import Floats, Vector, dot, row, scale

CONVENTIONS = ("body", "plane")


@njit(inline=True)
def turned(up: Vector, x: Vector) -> Vector:
    """Return x after the least rotation that takes the z axis to the unit vector `up`.

    With w = z x up = (-up_y, up_x, 0) it is x + w x x + w x (w x x) / (1 + up_z).  Upside down
    (within 1e-12) there are many least rotations; this is then the half turn about the x axis.
    """
    a, b = -up[1], up[0]
    square = a * a + b * b
    if up[2] < 0.0 and square < 1e-24:
        return x[0], -x[1], -x[2]
    first = (b * x[2], -a * x[2], a * x[1] - b * x[0])
    # Nearly upside down 1 + up_z would lose its digits.
    share = 1.0 / (1.0 + up[2]) if up[2] > -0.5 else (1.0 - up[2]) / square
    return (
        x[0] + first[0] + share * b * first[2],
        x[1] + first[1] - share * a * first[2],
        x[2] + first[2] + share * (a * first[1] - b * first[0]),
    )


@njit()
def _lowest_edge_plane(region: Region, edge_plane: Floats, k: int, force: Vector) -> float:
    """Return how far the resultant is inside the nearest side of facet k, negative outside.

    Without forces it is the sine of the angle from gravity to that side.
    """
    lowest = 1.0
    for e in range(*edges_at(region.span, k)):
        lowest = min(lowest, dot(edge_plane_at(region.edge, e), force) + edge_plane[e, MOMENT])
    return lowest


@njit()
def _settle(region: Region, edge_plane: Floats, wrench: Floats, gravity_plane: Vector) -> Vector:
    """Return the body's gravity direction when the robot rests on the plane.

    Of the facets that carry the robot when they lie on the plane, the least inclined to the
    body's xy plane counts; if none does, the one that comes closest to carrying it, and the robot
    tips; without any facet the plane is taken to be the body's own.
    """
    best, best_up = -1, -2.0
    nearest, nearest_inside = -1, -math.inf
    rests = 0
    for k in range(facets_in(region.tally)):
        rests += is_rest_at(region.span, k)
    for k in range(facets_in(region.tally)):
        # Nobody comes to rest on a stage, as long as there is anything else.
        if rests > 0 and not is_rest_at(region.span, k):
            continue
        up = scale(plane_at(region.facet, k), -height_at(region.facet, k))
        g = turned(up, gravity_plane)
        inside = _lowest_edge_plane(region, edge_plane, k, add(g, part(wrench, PHI)))
        if inside >= 0.0 and up[2] > best_up:
            best, best_up = k, up[2]
        if inside > nearest_inside:
            nearest, nearest_inside = k, inside
    chosen = best if best >= 0 else nearest
    if chosen < 0:
        return gravity_plane
    up = scale(plane_at(region.facet, chosen), -height_at(region.facet, chosen))
    return turned(up, gravity_plane)


@njit()
def _settle_some(
    begin: int,
    end: int,
    primitives: Floats,
    wrench: Floats,
    gravity_plane: Floats,
    acceptance: Acceptance,
    down: Floats,
) -> int:
    """Fill the body's gravity directions `down` (m, 3); return how many tables were too small."""
    n = primitives.shape[1]
    table, region = facet_table(n), empty_region(n)
    overflow = 0
    for posture in range(begin, end):
        overflow += stand(table, region, primitives[posture], acceptance)
        edge_plane = np.zeros((region.edge.shape[0], 16))
        if np.abs(wrench[posture, MU:RHO]).max() > 0.0:
            enter_edge_planes(region, wrench[posture], edge_plane)
        down[posture, 0], down[posture, 1], down[posture, 2] = _settle(
            region, edge_plane, wrench[posture], row(gravity_plane, posture)
        )
    return overflow


def body_gravity(
    recipe: Recipe, params: ArrayLike, gravity: ArrayLike, convention: str = "body"
) -> NDArray[np.float64]:
    """Return the gravity direction in the body frame of m postures: T_g.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (m, k) array_like
        Geometry parameters, rad or length.
    gravity : (3,) or (m, 3) array_like
        Pointing down, any length > 0; in the frame that the convention names.
    convention : {"body", "plane"}
        F and P of the module's head.

    Returns
    -------
    (m, 3) float64
        Unit vectors.  Under ``"plane"`` the robot rests on the plane with the facet that carries
        it; where none does, with the one that comes closest, and the robot tips.

    Examples
    --------
    >>> from lutgen.recipe.recipe import load_recipe
    >>> recipe = load_recipe("maps/paper_one.toml")
    >>> body_gravity(recipe, [[0.75]], [0, 0, -1], "plane").round(3)  # wheel 1 low: nose up
    array([[-0.143,  0.   , -0.99 ]])
    """
    if convention not in CONVENTIONS:
        raise InputError(f"unknown convention {convention!r}; choose from {', '.join(CONVENTIONS)}")
    posture = forward(recipe, params)
    count = len(posture.com)
    given = unit_directions(gravity)
    if given.shape not in ((3,), (count, 3)):
        raise InputError(
            f"gravity must have the shape (3,) or ({count}, 3) (got {given.shape}); give one "
            "direction, or one for each posture"
        )
    directions = np.ascontiguousarray(np.broadcast_to(given, (count, 3)))
    if convention == "body":
        return directions.copy()
    down = np.empty((count, 3))
    for_each_posture(_settle_some, recipe, posture, directions, acceptance_of(recipe), down)
    return down
