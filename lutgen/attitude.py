"""The gravity transform T_g: how gravity turns in the body while the robot changes its shape.

Owns the two readings of "the robot stands on this slope" and what an accelerometer says about
body and ground.  A robot that moves its legs on given ground turns its body, and with it the
direction of gravity in the body frame.

- ``"plane"`` (P): gravity is given relative to the **contact plane**.  Its z axis is the plane's
  normal, upward, and its x axis is the body's x axis, carried along.  T_g is the least rotation
  that takes the body's z axis to that normal, so on level ground the gravity direction in the
  body frame is the outward normal of the support facet, whatever the shape.
- ``"body"`` (F): gravity is given in the body frame and stays there; T_g is the identity.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lutgen.boundary import find_region
from lutgen.channels import POSTURES_A_THREAD, refuse_overflow
from lutgen.errors import InputError
from lutgen.jit import few_threads, njit, prange
from lutgen.load import limits_of, loads
from lutgen.loaded_axes import MOMENT, MU, PHI, RHO, add, enter_walls, part
from lutgen.primitive import pack
from lutgen.recipe import Recipe
from lutgen.region import (
    FACETS,
    HEIGHT,
    PLANE,
    WALL,
    Limit,
    Region,
    empty_region,
    supporting_facet,
    vector_at,
)
from lutgen.robot import forward, shapes
from lutgen.rounds import find_facets
from lutgen.sphere import gravity_from_up, unit_directions
from lutgen.statics import diagnose
from lutgen.support import FIRST, facet_table, robot_size
from lutgen.vector import Floats, Ints, Vector, dot, row, scale

CONVENTIONS = ("body", "plane")


@njit(inline=True)
def _turned(up: Vector, x: Vector) -> Vector:
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
def _lowest_wall(region: Region, wall: Floats, k: int, force: Vector) -> float:
    """Return how far the resultant is inside the nearest side of facet k, negative outside.

    Without a load it is the sine of the angle from gravity to that side.
    """
    lowest = 1.0
    for e in range(region.span[k, FIRST], region.span[k + 1, FIRST]):
        lowest = min(lowest, dot(vector_at(region.edge, e, WALL), force) + wall[e, MOMENT])
    return lowest


@njit()
def _settle(region: Region, wall: Floats, load: Floats, gravity_plane: Vector) -> Vector:
    """Return the body's gravity direction when the robot rests on the plane.

    Of the facets that carry the robot when they lie on the plane, the least inclined to the
    body's xy plane counts; if none does, the one that comes closest to carrying it, and the robot
    tips; without any facet the plane is taken to be the body's own.
    """
    best, best_up = -1, -2.0
    nearest, nearest_wall = -1, -math.inf
    loaded = np.abs(load[:RHO]).max() > 0.0
    for k in range(region.tally[FACETS]):
        up = scale(vector_at(region.plate, k, PLANE), -region.plate[k, HEIGHT])
        g = _turned(up, gravity_plane)
        inside = _lowest_wall(region, wall, k, add(g, part(load, PHI)))
        # Under a load the zero-moment point is in this facet and not where a ray comes first.
        first = loaded or supporting_facet(region.plate, region.tally[FACETS], g) == k
        carries = first and inside >= 0.0
        if carries and up[2] > best_up:
            best, best_up = k, up[2]
        if inside > nearest_wall:
            nearest, nearest_wall = k, inside
    chosen = best if best >= 0 else nearest
    if chosen < 0:
        return gravity_plane
    up = scale(vector_at(region.plate, chosen, PLANE), -region.plate[chosen, HEIGHT])
    return _turned(up, gravity_plane)


@njit(parallel=True)
def _settle_all(
    shapes: Floats, load: Floats, gravity_plane: Floats, limit: Limit
) -> tuple[Floats, Ints]:
    """Return the body's gravity directions (m, 3), and 1 where a facet table was too small."""
    m, n = shapes.shape[0], shapes.shape[1]
    down, overflow = np.empty((m, 3)), np.zeros(m, np.int64)
    for posture in prange(m):
        table, region = facet_table(n), empty_region(n)
        find_facets(table, shapes[posture], limit[2])
        find_region(region, table, limit, robot_size(shapes[posture]))
        wall = np.zeros((region.edge.shape[0], 16))
        if np.abs(load[posture, MU:RHO]).max() > 0.0:
            enter_walls(region, load[posture], wall)
        down[posture, 0], down[posture, 1], down[posture, 2] = _settle(
            region, wall, load[posture], row(gravity_plane, posture)
        )
        overflow[posture] = table.tally[1]
    return down, overflow


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
    >>> from lutgen.recipe import load_recipe
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
    radius, kind = shapes(recipe)
    with few_threads(count, POSTURES_A_THREAD):
        down, overflow = _settle_all(
            pack(posture.centres, posture.axes, radius, kind),
            loads(recipe, posture),
            directions,
            limits_of(recipe),
        )
    refuse_overflow(recipe.source, overflow, len(kind))
    return down


def gravity_transform(normal: ArrayLike) -> NDArray[np.float64]:
    """Return T_g of convention P as a matrix: from the contact plane's frame to the body frame.

    Parameters
    ----------
    normal : (3,) array_like
        Upward normal of the contact plane in the body frame, any length > 0.

    Returns
    -------
    (3, 3) float64
        The rotation that takes (0, 0, 1) to the normal and turns by the least angle.

    Examples
    --------
    >>> gravity_transform([1, 0, 1]).round(3).tolist()
    [[0.707, 0.0, 0.707], [0.0, 1.0, 0.0], [-0.707, 0.0, 0.707]]
    """
    up = tuple(unit_directions(normal).tolist())
    columns = [_turned(up, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    return np.array(columns).T + 0.0


@dataclass(frozen=True)
class TangentPlane:
    """The ground under a robot, from an accelerometer reading.

    `roll` and `pitch` are the body's attitude (rad): body = Ry(pitch) Rx(roll) after any heading,
    so a lowered nose has positive pitch and a lowered right side positive roll.  `normal` (3,) is
    the ground's upward normal in the body frame and `height` the com's distance from the ground.
    `slope` (rad) is the ground's inclination, `downhill` (rad) the heading in which it falls (0
    ahead, pi/2 to the left), and `gravity` (3,) the gravity direction relative to the contact
    plane, convention P.  `standing` is the verdict in this attitude; where the robot tips, the
    ground is taken to be the plane of the facet that gravity pierces first.
    """

    roll: float
    pitch: float
    normal: NDArray[np.float64]
    height: float
    slope: float
    downhill: float
    gravity: NDArray[np.float64]
    standing: bool


def tangent_plane(recipe: Recipe, params: ArrayLike, up_dir: ArrayLike) -> TangentPlane:
    """Return the ground's orientation under a posture from an accelerometer reading.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    params : (k,) array_like
        Geometry parameters, rad or length.
    up_dir : (3,) array_like
        What the accelerometer reads (specific force, body frame), any length > 0.

    Raises
    ------
    InputError
        Where gravity pierces no support facet: then nothing is known of the ground.

    Examples
    --------
    Wheel 1 is low on level ground, so the body leans back, and the ground does not slope:

    >>> from lutgen.recipe import load_recipe
    >>> recipe = load_recipe("maps/paper_one.toml")
    >>> ground = tangent_plane(recipe, [0.75], [0.143, 0.0, 0.99])
    >>> round(math.degrees(ground.pitch), 1), round(math.degrees(ground.slope), 1)
    (-8.2, 0.0)
    """
    roll, pitch = roll_pitch(up_dir)
    down = gravity_from_up(up_dir)
    found = diagnose(recipe, params, down)
    if found.facet is None:
        raise InputError(
            f"{recipe.source}: the robot lies on no support facet (got up_dir = "
            f"{np.asarray(up_dir, dtype=float).tolist()}); nothing is known of the ground then"
        )
    up = -found.facet.normal
    gravity = gravity_transform(up).T @ down
    slope = math.atan2(math.hypot(gravity[0], gravity[1]), -gravity[2])
    downhill = math.atan2(gravity[1], gravity[0])
    return TangentPlane(
        roll, pitch, up, found.facet.height, slope, downhill, gravity, found.standing
    )


def roll_pitch(up_dir: ArrayLike) -> tuple[float, float]:
    """Return the body's roll and pitch in rad from what an accelerometer at rest reads.

    Parameters
    ----------
    up_dir : (3,) array_like
        Specific force in the body frame, any length > 0.

    Examples
    --------
    The nose of a robot that looks down a slope of 30 deg:

    >>> roll, pitch = roll_pitch([-0.5, 0.0, 0.866025404])
    >>> round(math.degrees(roll), 6), round(math.degrees(pitch), 6)
    (0.0, 30.0)
    """
    x, y, z = unit_directions(up_dir)
    return math.atan2(y, z), math.atan2(-x, math.hypot(y, z))
