"""A foot recognised in a mesh: a ball, a disc, the corners of a sole, or the lowest points.

Owns which of these stands for the lower end of a body.  Points are corners of the body itself, so
that what stands on them stands on less than the body has.
"""

import math

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from lutgen.urdf.description import Collision
from lutgen.urdf.reach import across, fan, plain, reaches, ring
from lutgen.urdf.wheel_shape import wheel_of
from lutgen.vector import Floats

# The lower end is what planes touch that lean up to this angle (rad) from level: slopes, and
# joints that turn the link.
LEAN = math.radians(45.0)
# Shares of half the lower end's width by which a ball may differ from it: a ball of 12 segments
# does by 2.4 %, the best ball for a cube by 20 %.  What is neither round nor flat may be less of a
# ball: one contact instead of eight.
BALL, NEARLY = 0.04, 0.10
# A sole's plane is this near (rad) to level and its facets this near to its plane.
LEVEL, SAME_PLANE = math.radians(20.0), math.radians(1.0)
# Shares of the lower end's width: within which a sole's corners lie of its plane, the flattest that
# there is, and how wide it is at least.
FLAT, SOLE = (0.002, 0.005, 0.01, 0.02), 0.3
# Share of the width by which the hull of the chosen points may fall short, and their number.
LOSS, MOST = 0.01, 8


def foot_of(points: Floats, down: Floats) -> Collision:
    """Return what stands for the lower end of a body.

    Parameters
    ----------
    points : (n, 3) float64
        Corners of the body's convex hull, link frame, m.
    down : (3,) float64
        Unit vector downwards in the standing posture, link frame.

    Returns
    -------
    Collision
        A sphere where the lower end is a ball, a cylinder where it is a disc about an axis of the
        link, else ``"points"``: the corners of a flat sole, or the lowest corners.  Its note says
        which, and by how much (mm) it is off.
    """
    directions = fan(down, LEAN)
    reach, which = reaches(points, directions)
    end = points[np.unique(which)]
    width = _width(end, down)
    ball, off = _ball(directions, reach)
    if off <= 0.5 * BALL * width:
        return ball
    disc = _disc(points, down)
    if disc is not None:
        return disc
    sole = _sole(points, down, width)
    if sole is None and off <= 0.5 * NEARLY * width:
        return ball
    if sole is not None:
        corners, normal, uneven = sole
        kept, loss = _few(corners, ring(normal, 0.5 * math.pi))
        note = (
            f"the corners of a flat sole, at most {1000.0 * loss:.2f} mm inside of its rim and "
            f"{1000.0 * uneven:.2f} mm above its plane"
        )
    else:
        kept, loss = _few(end, directions)
        note = f"the lowest corners, at most {1000.0 * loss:.2f} mm inside of its shape"
    return Collision("", "points", plain(kept.ravel()), note=note)


def _width(end: Floats, down: Floats) -> float:
    """Return the largest extent of points across a direction, m."""
    flat = end @ np.stack(across(down), axis=1)
    return float(np.linalg.norm(flat.max(axis=0) - flat.min(axis=0)))


def _ball(directions: Floats, reach: Floats) -> tuple[Collision, float]:
    """Return the ball that reaches as far as the body, and by how much it is off at most, m.

    Least squares in centre and radius; of what would have no radius it is off without limit.
    """
    terms = np.column_stack([directions, np.ones(len(directions))])
    found = np.asarray(np.linalg.lstsq(terms, reach, rcond=None)[0], np.float64)
    off = float(np.abs(terms @ found - reach).max())
    x, y, z, radius = plain(found)
    note = (
        f"a ball of radius {1000.0 * radius:.2f} mm, off by at most {1000.0 * off:.2f} mm up to "
        f"{math.degrees(LEAN):.0f} deg of lean"
    )
    ball = Collision("", "sphere", (radius,), (x, y, z), note=note)
    return ball, off if radius > 0.0 else math.inf


def _disc(points: Floats, down: Floats) -> Collision | None:
    """Return the disc that a body is about an axis of its link, None of one that is none.

    Like a wheel, which turns about its joint; an axis that points up or down is none.
    """
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    for axis in np.eye(3):
        found = wheel_of(points, centre, axis, "a disc") if abs(axis @ down) <= 0.5 else None
        if found is not None:
            return found
    return None


def _sole(points: Floats, down: Floats, width: float) -> tuple[Floats, Floats, float] | None:
    """Return a flat sole, of the hull's faces near to level the largest; None if there is none.

    Its corners (k, 3), its normal (3,), and how far the corners lie above its plane, m.
    """
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    normals = hull.equations[:, :3]
    corner = points[hull.simplices]
    area = np.linalg.norm(
        np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1
    )
    level = np.flatnonzero(normals @ down >= math.cos(LEVEL))
    if not len(level):
        return None
    alike = normals[level] @ normals[level].T >= math.cos(SAME_PLANE)
    normal = normals[level[int((alike @ area[level]).argmax())]]
    above = (points @ normal).max() - points @ normal
    around = ring(normal, 0.5 * math.pi)
    for share in FLAT:
        near = above <= share * width
        if np.ptp(points[near] @ around.T, axis=0).min() >= SOLE * width:
            return points[near], normal, float(above[near].max())
    return None


def _few(points: Floats, directions: Floats) -> tuple[Floats, float]:
    """Return few of the points, and by how much (m) these reach less far than all.

    One after the other that reaches furthest beyond those there are, until the rest is 1 % of the
    width, or there are eight; then without those that the others do for.
    """
    wanted, which = reaches(points, directions)
    enough = LOSS * float((wanted + reaches(points, -directions)[0]).max())

    def short(chosen: list[int]) -> Floats:
        return wanted - reaches(points[chosen], directions)[0]

    kept = [int(which[0])]
    while short(kept).max() > enough and len(kept) < MOST:
        kept.append(int(which[int(short(kept).argmax())]))
    allowed = max(enough, float(short(kept).max()))
    for one in list(kept):
        others = [other for other in kept if other != one]
        if others and short(others).max() <= allowed:
            kept = others
    return points[sorted(kept)], float(short(kept).max())
