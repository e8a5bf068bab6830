"""Second ways to the quantities of the paper, to check its equations against.

Owns no equation of the paper: linear solves, least squares, contour integrals and the library's
own exact functions.  Contacts are relative to the com, body frame, any one unit of length.
"""

import numpy as np

from lutgen.channels import stability
from lutgen.paper import printed
from lutgen.paper.nominal import Array
from lutgen.support import measure_polygon, outline, plane_axes

# Weights of a fourth contact on the three wheels: behind the edge from wheel 2 to wheel 3, in
# their plane.  The contacts in the order 1, 2, 3, 4 then make a polygon that crosses itself.
FOURTH = np.array([-0.8, 1.1, 0.7])


def four_contacts(wheels: Array) -> Array:
    """Return the wheels and a fourth contact in their plane, (4, 3)."""
    return np.vstack([wheels, FOURTH @ wheels])


def polygon_centre(contacts: Array) -> Array:
    """Return S, (3,): Eqs 22 to 27 corrected, in 3-D and for coplanar contacts in any order."""
    x, y, z = printed.normal_of(contacts).tolist()
    flat = contacts @ np.array(plane_axes((x, y, z))).T
    ids = np.zeros(3 * len(contacts) + 2, np.int64)
    ids[: len(contacts)] = range(len(contacts))
    corners = outline(flat, ids, len(contacts), 1e-9 * float(np.abs(contacts).max()))
    return np.array(measure_polygon(contacts[ids[:corners]], (x, y, z))[0])


def contour_centroid(contacts: Array) -> Array:
    """Return the centre of coplanar contacts, (3,), by Green's theorem on the XY contour.

    The contacts are put in order of their angle about their mean; z comes from the plane by
    least squares.  The plane must not be vertical.
    """
    flat = contacts[:, :2] - contacts[:, :2].mean(axis=0)
    corners = flat[np.argsort(np.arctan2(flat[:, 1], flat[:, 0]))]
    ahead = np.roll(corners, -1, axis=0)
    doubled = corners[:, 0] * ahead[:, 1] - ahead[:, 0] * corners[:, 1]
    centre = ((corners + ahead) * doubled[:, None]).sum(axis=0) / (3.0 * doubled.sum())
    slope = np.linalg.lstsq(flat, contacts[:, 2] - contacts[:, 2].mean(), rcond=None)[0]
    return np.asarray(np.append(centre, slope @ centre) + contacts.mean(axis=0))


def pierced_by_solving(wheels: Array, gravity: Array) -> Array:
    """Return D_g, (3,), from the line t g and the plane P1 + u (P2 - P1) + v (P3 - P1)."""
    matrix = np.column_stack([gravity, wheels[0] - wheels[1], wheels[0] - wheels[2]])
    return np.asarray(gravity * np.linalg.solve(matrix, wheels[0])[0])


def foot_by_least_squares(wheels: Array) -> Array:
    """Return D_c, (3,), the point of the wheels' plane nearest to the com."""
    edges = np.column_stack([wheels[1] - wheels[0], wheels[2] - wheels[0]])
    return np.asarray(wheels[0] - edges @ np.linalg.lstsq(edges, wheels[0], rcond=None)[0])


def stability_factor(contacts: Array, gravity: Array) -> float:
    """Return |SD_g| by the library; NaN where the robot tips."""
    return float(stability(contacts[None], gravity[None], ("sdg",))["sdg"][0, 0])


def factor_at_tipping(wheels: Array, heading: float) -> float:
    """Return |SD_g| where gravity, tilted more and more to `heading` (rad), tips the robot."""
    stands, tips = 0.0, np.pi / 2
    last = np.nan
    for _ in range(60):
        tilt = (stands + tips) / 2.0
        level = np.sin(tilt) * np.array([np.cos(heading), np.sin(heading)])
        factor = stability_factor(wheels, np.append(level, -np.cos(tilt)))
        if np.isnan(factor):
            tips = tilt
        else:
            stands, last = tilt, factor
    return float(last)


def edge_distance(triangle: Array, point: Array) -> float:
    """Return the distance of a point inside a triangle, in its plane, from the nearest edge."""
    along = np.roll(triangle, -1, axis=0) - triangle
    across = np.cross(along, point - triangle)
    return float((np.linalg.norm(across, axis=1) / np.linalg.norm(along, axis=1)).min())


def incentre(triangle: Array) -> Array:
    """Return the point of a triangle, (3,), that is furthest from its nearest edge."""
    opposite = np.linalg.norm(np.roll(triangle, -1, axis=0) - np.roll(triangle, 1, axis=0), axis=1)
    return np.asarray(opposite @ triangle / opposite.sum())


def largest_inscribed_radius(triangle: Array) -> float:
    """Return the largest distance from all edges: twice the area over the perimeter."""
    edges = np.roll(triangle, -1, axis=0) - triangle
    return float(np.linalg.norm(np.cross(*edges[:2])) / np.linalg.norm(edges, axis=1).sum())
