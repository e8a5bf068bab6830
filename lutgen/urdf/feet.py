"""Wheels and feet recognised in meshes: rims, a ball, the corners of a sole, the lowest points.

Two bodies that reach equally far in the directions from which the ground can come touch it alike:
how far they differ is the error of a guess.  Points are corners of the body itself, so that what
stands on them stands on less than the body has.
"""

import math

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from lutgen.arrays import Floats, Ints
from lutgen.parts import three
from lutgen.urdf.description import Collision
from lutgen.urdf.meshes import DIGITS
from lutgen.vector import angles

# Directions of a fan, and of a turn in a plane; even, so that opposite ones are among them.
RINGS, ROUND = 9, 1440
# Vertices that are tested at once, which bounds the memory.
CHUNK = 4_000

# Planes that lean so far (rad) from the wheel's upright touch a wheel like its discs.
WHEEL_LEAN = tuple(math.radians(angle) for angle in (0.0, -15.0, 15.0, -30.0, 30.0))
# Shares of the radius: by how much the reach of a wheel may change while it turns (a polygon of
# 10 sides: 4.9 %), and how far inside the largest radius a rim is still tread: what fits best.
EVEN, TREADS = 0.05, (0.0005, 0.002, 0.005, 0.01, 0.02)
# A share of the radius that is nothing.
SAME = 1e-6
# A shaft is no wheel: a robot's wheels are not this many times wider than high.
WIDEST = 3.0

# The lower end is what planes touch that lean up to this angle (rad) from level: slopes, and
# joints that turn the link.
LEAN = math.radians(45.0)
# Shares of half the lower end's width by which a ball may differ from it: a ball of 12 segments
# does by 2.4 %, the best ball for a cube by 20 %.  A body neither round nor flat may be less of a
# ball: one contact instead of eight.
BALL, NEARLY = 0.04, 0.10
# A sole's plane is this near (rad) to level and its facets this near to its plane.
LEVEL, SAME_PLANE = math.radians(20.0), math.radians(1.0)
# Shares of the lower end's width: within which a sole's corners lie of its plane, the flattest that
# there is, and how wide it is at least.
FLAT, SOLE = (0.002, 0.005, 0.01, 0.02), 0.3
# Share of the width by which the hull of the chosen points may fall short, and their number.
LOSS, MOST = 0.01, 8


def wheel_of(
    points: Floats, origin: Floats, axis: Floats, noun: str = "a wheel"
) -> Collision | None:
    """Return the cylinder whose rims stand for a wheel about an axis, None of other bodies.

    The radius is the largest of any corner (n, 3); the tread ends at the outermost corners that
    lie within one of `TREADS` of it, whichever makes the rims reach most nearly as the body does.
    """
    away = points - origin
    along = away @ axis
    radius = np.linalg.norm(away - along[:, None] * axis, axis=1)
    largest = float(radius.max())
    if largest <= 0.0:
        return None
    found = [_reaches(away, _ring(axis, 0.5 * math.pi - lean))[0] for lean in WHEEL_LEAN]
    if any(np.ptp(one) > EVEN * largest for one in found):
        return None
    low = high = 0.0
    worst = math.inf
    for share in TREADS:
        tread = along[radius >= (1.0 - share) * largest]
        ends = float(tread.min()), float(tread.max())
        off = 0.0
        for lean, one in zip(WHEEL_LEAN, found, strict=True):
            stands = largest * math.cos(lean) + max(end * math.sin(lean) for end in ends)
            off = max(off, float(np.abs(one - stands).max()))
        if off < worst - SAME * largest:
            low, high, worst = *ends, off
    if high - low > 2.0 * WIDEST * largest:
        return None
    note = (
        f"{noun} of radius {1000.0 * largest:.2f} mm and width {1000.0 * (high - low):.2f} mm, "
        f"off by at most {1000.0 * worst:.2f} mm up to 30 deg of lean"
    )
    centre = three(_plain(origin + 0.5 * (low + high) * axis))
    rpy = angles(np.stack([*_across(axis), axis], axis=1))
    size = _plain(np.array([largest, high - low]))
    return Collision("cylinder", size, centre, rpy, note=note)


def foot_of(points: Floats, down: Floats) -> Collision:
    """Return what stands for the lower end of a body, with a note on how far (mm) it is off.

    It is a sphere of a ball, a cylinder of a disc about an axis of the link, else ``"points"``: the
    corners of a flat sole, or the lowest corners of the hull's (n, 3).
    """
    fan = [_ring(down, LEAN * k / RINGS, 8 * k) for k in range(1, RINGS + 1)]
    directions = np.concatenate([down[None], *fan])
    reach, which = _reaches(points, directions)
    end = points[np.unique(which)]
    flat = end @ np.stack(_across(down), axis=1)
    width = float(np.linalg.norm(np.ptp(flat, axis=0)))
    ball, off = _ball(directions, reach)
    if off <= 0.5 * BALL * width:
        return ball
    # A disc turns about an axis of its link that points neither up nor down.
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    for axis in np.eye(3):
        disc = wheel_of(points, centre, axis, "a disc") if abs(axis @ down) <= 0.5 else None
        if disc is not None:
            return disc
    sole = _sole(points, down, width)
    if sole is None and off <= 0.5 * NEARLY * width:
        return ball
    if sole is not None:
        corners, normal, uneven = sole
        kept, loss = _few(corners, _ring(normal, 0.5 * math.pi))
        note = (
            f"the corners of a flat sole, at most {1000.0 * loss:.2f} mm inside of its rim and "
            f"{1000.0 * uneven:.2f} mm above its plane"
        )
    else:
        kept, loss = _few(end, directions)
        note = f"the lowest corners, at most {1000.0 * loss:.2f} mm inside of its shape"
    return Collision("points", _plain(kept.ravel()), note=note)


def _ball(directions: Floats, reach: Floats) -> tuple[Collision, float]:
    """Return the ball that reaches as far as the body, and by how much it is off at most, m."""
    terms = np.column_stack([directions, np.ones(len(directions))])
    found = np.asarray(np.linalg.lstsq(terms, reach, rcond=None)[0], np.float64)
    off = float(np.abs(terms @ found - reach).max())
    x, y, z, radius = _plain(found)
    note = (
        f"a ball of radius {1000.0 * radius:.2f} mm, off by at most {1000.0 * off:.2f} mm up to "
        f"{math.degrees(LEAN):.0f} deg of lean"
    )
    ball = Collision("sphere", (radius,), (x, y, z), note=note)
    return ball, off if radius > 0.0 else math.inf


def _sole(points: Floats, down: Floats, width: float) -> tuple[Floats, Floats, float] | None:
    """Return the corners (k, 3) of the largest flat sole, its normal, and how uneven (m) it is."""
    try:
        hull = ConvexHull(points)
    except QhullError:
        return None
    normals = hull.equations[:, :3]
    corner = points[hull.simplices]
    sides = corner[:, 1:] - corner[:, :1]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    level = np.flatnonzero(normals @ down >= math.cos(LEVEL))
    if not len(level):
        return None
    alike = normals[level] @ normals[level].T >= math.cos(SAME_PLANE)
    normal = normals[level[int((alike @ area[level]).argmax())]]
    above = (points @ normal).max() - points @ normal
    around = _ring(normal, 0.5 * math.pi)
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
    wanted, which = _reaches(points, directions)
    enough = LOSS * float((wanted + _reaches(points, -directions)[0]).max())

    def short(chosen: list[int]) -> Floats:
        return wanted - _reaches(points[chosen], directions)[0]

    kept = [int(which[0])]
    while short(kept).max() > enough and len(kept) < MOST:
        kept.append(int(which[int(short(kept).argmax())]))
    allowed = max(enough, float(short(kept).max()))
    for one in list(kept):
        others = [other for other in kept if other != one]
        if others and short(others).max() <= allowed:
            kept = others
    return points[sorted(kept)], float(short(kept).max())


def _reaches(points: Floats, directions: Floats) -> tuple[Floats, Ints]:
    """Return how far points (n, 3) reach in directions (d, 3), and which of them does (d,)."""
    best = np.full(len(directions), -math.inf)
    which = np.zeros(len(directions), np.int64)
    for first in range(0, len(points), CHUNK):
        high = points[first : first + CHUNK] @ directions.T
        at = high.argmax(axis=0)
        found = high[at, np.arange(len(directions))]
        better = found > best
        best[better], which[better] = found[better], first + at[better]
    return best, which


def _across(direction: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors (3,) at right angles to a unit vector (3,), right-handed with it."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    first = np.cross(direction, helper)
    first /= np.linalg.norm(first)
    return first, np.cross(direction, first)


def _ring(direction: Floats, angle: float, count: int = ROUND) -> Floats:
    """Return unit vectors (count, 3) evenly around a unit vector, at an angle (rad) to it."""
    first, second = _across(direction)
    turn = 2.0 * math.pi / count * np.arange(count)[:, None]
    around = np.cos(turn) * first + np.sin(turn) * second
    return np.asarray(math.cos(angle) * direction + math.sin(angle) * around)


def _plain(values: Floats) -> tuple[float, ...]:
    return tuple((np.round(values, DIGITS) + 0.0).tolist())
