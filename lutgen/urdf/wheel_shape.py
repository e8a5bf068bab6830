"""A wheel recognised in a mesh: its two rims.

Owns when a body is round about the axis of its joint, and which discs then stand for it.
"""

import math

import numpy as np

from lutgen.rotation import angles
from lutgen.urdf.description import Collision
from lutgen.urdf.reach import across, plain, reaches, ring
from lutgen.vector import Floats

# Planes that lean so far (rad) from the wheel's upright touch it like its discs, or it is none.
LEAN = tuple(math.radians(angle) for angle in (0.0, -15.0, 15.0, -30.0, 30.0))
# Shares of the radius: by how much the reach of a wheel may change while it turns (a polygon of
# 10 sides: 4.9 %), and how far inside the largest radius a rim is still tread: what fits best.
EVEN, TREADS = 0.05, (0.0005, 0.002, 0.005, 0.01, 0.02)
# A share of the radius that is nothing.
SAME = 1e-6
# A shaft is no wheel: a robot's wheels are not this many times wider than high.
WIDEST = 3.0


def wheel_of(
    points: Floats, origin: Floats, axis: Floats, noun: str = "a wheel"
) -> Collision | None:
    """Return the cylinder whose rims stand for a wheel, None of a body that is none.

    Parameters
    ----------
    points : (n, 3) float64
        Corners of the body's convex hull, link frame, m.
    origin, axis : (3,) float64
        The joint's axis, a unit vector, and a point on it, link frame.
    noun : str
        What its note calls it.

    Returns
    -------
    Collision or None
        Its radius is the largest of any corner from the axis; its ends are where the tread ends,
        the outermost corners that lie within 0.05 to 2 % of that radius: whichever share makes
        the rims reach most nearly as far as the body.
    """
    away = points - origin
    along = away @ axis
    radius = np.linalg.norm(away - along[:, None] * axis, axis=1)
    largest = float(radius.max())
    if largest <= 0.0:
        return None
    outward = [ring(axis, 0.5 * math.pi - lean) for lean in LEAN]
    found = [reaches(away, ways)[0] for ways in outward]
    if any(np.ptp(one) > EVEN * largest for one in found):
        return None
    low = high = 0.0
    worst = math.inf
    for share in TREADS:
        tread = along[radius >= (1.0 - share) * largest]
        ends = float(tread.min()), float(tread.max())
        off = 0.0
        for lean, one in zip(LEAN, found, strict=True):
            stands = largest * math.cos(lean) + max(end * math.sin(lean) for end in ends)
            off = max(off, float(np.abs(one - stands).max()))
        if off < worst - SAME * largest:
            low, high, worst = *ends, off
    if high - low > 2.0 * WIDEST * largest:
        return None
    first, second = across(axis)
    centre = origin + 0.5 * (low + high) * axis
    note = (
        f"{noun} of radius {1000.0 * largest:.2f} mm and width {1000.0 * (high - low):.2f} mm, "
        f"off by at most {1000.0 * worst:.2f} mm up to 30 deg of lean"
    )
    size = plain(np.array([largest, high - low]))
    x, y, z = plain(centre)
    rpy = angles(np.stack([first, second, axis], axis=1))
    return Collision("", "cylinder", size, (x, y, z), rpy, note=note)
