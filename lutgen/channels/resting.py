"""The gravity transform T_g: how gravity turns in the body while the robot changes its shape.

A robot that moves its legs on given ground turns its body, and with it the direction of gravity in
the body frame.  There are two readings of "the robot stands on this slope":

- ``"plane"`` (P): gravity is given relative to the **contact plane**.  Its z axis is the plane's
  normal, upward, and its x axis is the body's x axis, carried along.  T_g is the least rotation
  that takes the body's z axis to that normal, so on level ground the gravity direction in the
  body frame is the outward normal of the support facet, for any shape.
- ``"body"`` (F): gravity is given in the body frame and stays there; T_g is the identity.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.arrays import Floats, Vector
from lutgen.channels.axes import PHI, Axes, empty_axes, find_axes, lowest_lever, part
from lutgen.channels.evaluation import for_each_posture
from lutgen.channels.wrench import acceptance_of
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.jit import njit
from lutgen.recipe import Recipe, forward
from lutgen.support import ACCEPTED, Acceptance, Region, empty_region, stand
from lutgen.vector import add, read3, row, scale, write3

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


@njit(bare=True)
def _settled(region: Region, axes: Axes, wrench: Floats, gravity_plane: Vector) -> Vector:
    """Return the body's gravity direction when the robot rests on the plane.

    It rests on the least inclined of the rests that carry it when they lie on the plane.  If none
    carries it, it tips, and the one that comes closest counts.  Without any rest the plane is the
    body's own.
    """
    best, best_up, nearest, nearest_inside = -1, -2.0, -1, -math.inf
    for k in range(region.counts[ACCEPTED]):
        if not region.seat[k].is_rest:
            continue
        up = scale(read3(region.seat[k].normal), -1.0)
        g = turned(up, gravity_plane)
        inside = lowest_lever(region, axes, k, add(g, part(wrench, PHI)))
        if inside >= 0.0 and up[2] > best_up:
            best, best_up = k, up[2]
        if inside > nearest_inside:
            nearest, nearest_inside = k, inside
    chosen = best if best >= 0 else nearest
    if chosen < 0:
        return gravity_plane
    return turned(scale(read3(region.seat[chosen].normal), -1.0), gravity_plane)


@njit()
def _settle_some(
    begin: int,
    end: int,
    primitives: Floats,
    wrench: Floats,
    gravity_plane: Floats,
    accept: Acceptance,
    down: Floats,
) -> None:
    """Fill the body's gravity directions `down` (m, 3)."""
    region = empty_region(primitives.shape[1])
    axes = empty_axes(region)
    for posture in range(begin, end):
        stand(region, primitives[posture], accept)
        find_axes(region, wrench[posture], axes)
        direction = _settled(region, axes, wrench[posture], row(gravity_plane, posture))
        write3(down[posture], direction)


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
        it; without one, with the one that comes closest, and the robot tips.

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
    # Not the read-only view itself: the kernel would be compiled once more for it.
    directions = np.broadcast_to(given, (count, 3)).copy()
    if convention == "body":
        return directions
    down = np.empty((count, 3))
    for_each_posture(_settle_some, recipe, posture, directions, acceptance_of(recipe), down)
    return down
