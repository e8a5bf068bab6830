"""The equations of the paper literally as printed, right or wrong, one small function each.

Owns no corrections: those are beside each erratum.  Source: "Variable Robot Geometry Optimization
Method to Avoid Tip Over Situations During Slow Motion on Unknown Terrains".  Vectors are in the
body frame with the com at the origin; lengths have any one unit.
"""

import numpy as np

from lutgen.paper.nominal import Array


def normal_of(points: Array) -> Array:
    """Return (a, b, c) of Eq 1, (3,): the unit normal of three points' plane, with c >= 0.

    The paper fixes neither its length nor its sign.
    """
    across = np.cross(points[1] - points[0], points[2] - points[0])
    across *= -1.0 if across[2] < 0.0 else 1.0
    return np.asarray(across / np.linalg.norm(across))


def eq2(n: int) -> float:
    """Return k_max, the number of combinations of three of n contact points."""
    return n * (n - 1) * (n - 2) / 6


def eq7(normal: Array, contact: Array, gravity: Array) -> float:
    """Return t_1, where gravity's line meets the plane through `contact`."""
    return float(-(normal @ (contact - gravity)) / (normal @ gravity))


def eq4_to_6(gravity: Array, t1: float) -> Array:
    """Return D_g, (3,), where gravity's line meets the plane."""
    return np.asarray(gravity * (1.0 - t1))


def eq8_to_11(normal: Array, contact: Array) -> Array:
    """Return D_c, (3,), where the normal through the com meets the plane."""
    t2 = -(normal @ (contact - normal)) / (normal @ normal)
    return np.asarray(normal * (1.0 - t2))


def eq12(distances: Array) -> Array:
    """Return the normal forces |F_ni| / |N_g|, (n_a,), from the ratio numbers L, (n_a,)."""
    total = distances.sum()
    return np.asarray(-(1.0 / total) * (total / (len(distances) / 2) - distances))


def eq16(static_moment: Array, mass: float, r: Array) -> Array:
    """Return S_MS = S_MO - m r, (3,)."""
    return np.asarray(static_moment - mass * r)


def eq22_23(triangle: Array) -> Array:
    """Return the centre of a triangle, (2,), projected to the XY plane, from its (3, 3) corners."""
    return np.asarray(triangle[:, :2].sum(axis=0) / 3)


def eq24(triangle: Array) -> float:
    """Return the area of a triangle projected to the XY plane, from its (3, 3) corners."""
    (x1, y1), (x2, y2), (x3, y3) = triangle[:, :2]
    return float(abs(x1 * (y2 - y3) + x2 * (y3 - y1) + x3 * (y1 - y2)) / 2)


def eq25_26(contacts: Array) -> Array:
    """Return s_x and s_y, (2,), of contacts (n, 3) in the order in which they come.

    The printed sum runs to n without saying which n triangles; here they are the fan from the
    first contact.  NaN for a projected area of zero.
    """
    triangles = [contacts[[0, i, i + 1]] for i in range(1, len(contacts) - 1)]
    areas = np.array([eq24(triangle) for triangle in triangles])
    centres = np.array([eq22_23(triangle) for triangle in triangles])
    with np.errstate(invalid="ignore"):
        return np.asarray((areas @ centres) / areas.sum())


def eq27(normal: Array, contact: Array, sx: float, sy: float) -> float:
    """Return s_z of the polygon's centre; NaN or infinite for a vertical plane."""
    a, b, c = normal
    with np.errstate(invalid="ignore", divide="ignore"):
        return float(normal @ contact - (a * sx + b * sy) / c)


def eq28(foot: Array) -> float:
    """Return |OC|, the height, from D_c."""
    return float(np.sqrt((foot * foot).sum()))


def eq29(pierced: Array, centre: Array) -> float:
    """Return |SD_g|, the stability factor, from D_g and S."""
    return float(np.sqrt(((pierced - centre) ** 2).sum()))


def eq32(x: float) -> float:
    """Return y of the path; NaN at 0."""
    with np.errstate(invalid="ignore"):
        return float(0.8 * np.sin(np.float64(x)) / np.float64(x))


def eq33(x: float) -> float:
    """Return z of the path; NaN at 0."""
    with np.errstate(invalid="ignore"):
        return float(15.0 * np.sin(np.float64(x)) ** 2 / np.float64(x))
