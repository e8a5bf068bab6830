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

from lutgen.arrays import Vector
from lutgen.channels.axes import lowest_lever
from lutgen.jit import njit
from lutgen.support import Region
from lutgen.vector import add, read3, scale

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
def settled(region: Region, phi: Vector, mu: Vector, gravity_plane: Vector) -> Vector:
    """Return the body's gravity direction when the robot rests on the plane.

    It rests on the least inclined of the rests that carry it when they lie on the plane.  If none
    carries it, it tips, and the one that comes closest counts.  Without any rest the plane is the
    body's own.
    """
    best, best_up, nearest, nearest_inside = -1, -2.0, -1, -math.inf
    for k in range(region.counts.accepted):
        if not region.seat[k].is_rest:
            continue
        up = scale(read3(region.seat[k].normal), -1.0)
        g = turned(up, gravity_plane)
        inside = lowest_lever(region, k, add(g, phi), mu)
        if inside >= 0.0 and up[2] > best_up:
            best, best_up = k, up[2]
        if inside > nearest_inside:
            nearest, nearest_inside = k, inside
    chosen = best if best >= 0 else nearest
    if chosen < 0:
        return gravity_plane
    return turned(scale(read3(region.seat[chosen].normal), -1.0), gravity_plane)
