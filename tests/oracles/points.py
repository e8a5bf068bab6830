"""Oracle for point contacts: triples, barycentrics and planes, one robot at a time.

Every quantity follows its definition as directly as possible; where a quantity has two
definitions that must agree (the verdict by barycentrics and by planes, the boundary of
the standing region by facet edges and by pairs of contacts) both are here.
Lengths are in the caller's unit, angles in rad, vectors in the body frame with the
centre of mass at the origin; `gravity` is a unit vector pointing down.
"""

from dataclasses import dataclass
from itertools import combinations, pairwise
from math import acos, asin, atan2, copysign, cos, hypot, inf, pi, sqrt

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Contacts closer to a plane (or to each other) than this share of the robot's size count as
# on it (as one).  Exactly coplanar sets miss by about 1e-16 after a rotation, the tests keep
# every other set beyond 1e-6.
ON = 1e-9

# A ray this close (rad) to an edge may count for either of the facets that share it.
TIE = 1e-8


def unit(vectors: Floats) -> Floats:
    """Return vectors scaled to length one along the last axis."""
    return np.asarray(vectors / np.sqrt((vectors**2).sum(axis=-1, keepdims=True)))


@dataclass(frozen=True)
class Facet:
    """Support facet: outward unit normal (3,), height, contacts on it, ccw polygon."""

    normal: Floats
    height: float
    touching: tuple[int, ...]
    polygon: tuple[int, ...]
    points: Floats  # (k, 3), the corners in the order of `polygon`


@dataclass(frozen=True)
class Axis:
    """Tip-over axis from one contact to another, with the inward unit normal of its plane."""

    start: Floats
    end: Floats
    inward: Floats


@dataclass(frozen=True)
class Verdict:
    """Everything the oracle says about one posture and one gravity direction.

    `pierced` holds (sdg, height) of every facet that the ray meets within `TIE`: two or more
    at a shared edge, where the tie rule may pick any of them.  `energy_margin` is the least rise
    over any tip-over axis: that of a robot on its only facet, or of one that tips; see `tipping`.
    """

    stands: bool
    tip_angle: float
    margin: float
    energy_margin: float
    pierced: tuple[tuple[float, float], ...]
    convex: bool


def cross(left: Floats, right: Floats) -> Floats:
    """Cross product along the last axis, by its three components."""
    return np.stack(
        (
            left[..., 1] * right[..., 2] - left[..., 2] * right[..., 1],
            left[..., 2] * right[..., 0] - left[..., 0] * right[..., 2],
            left[..., 0] * right[..., 1] - left[..., 1] * right[..., 0],
        ),
        axis=-1,
    )


def length(vectors: Floats) -> Floats:
    """Euclidean norm along the last axis."""
    return np.asarray(np.sqrt((vectors * vectors).sum(axis=-1)))


def size_of(contacts: Floats) -> float:
    """Largest distance of a contact from the centre of mass."""
    return float(length(contacts).max())


def distinct(contacts: Floats) -> Floats:
    """Contacts without repetitions, the first of each kept."""
    keep: list[int] = []
    limit = ON * size_of(contacts)
    for index, point in enumerate(contacts):
        if all(length(point - contacts[other]) > limit for other in keep):
            keep.append(index)
    return contacts[keep]


def convex_polygon(flat: Floats, limit: float) -> list[int]:
    """Return the indices of the strict convex hull of (k, 2) points, counter-clockwise.

    Monotone chain; a point within `limit` of the line between its neighbours is dropped.
    """

    def bulge(before: int, index: int, after: int) -> float:
        """Distance of a corner outside the line between two others, positive outside."""
        (ax, ay), (bx, by), (cx, cy) = flat[before], flat[index], flat[after]
        return float(((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / hypot(cx - ax, cy - ay))

    def chain(indices: list[int]) -> list[int]:
        hull: list[int] = []
        for index in indices:
            while len(hull) >= 2 and bulge(hull[-2], hull[-1], index) <= limit:
                hull.pop()
            hull.append(index)
        return hull

    # Points that share the smallest or largest x up to rounding are put in order of y, or else
    # the middle of an edge could become an end of the chain and oust a corner.
    order = sorted(range(len(flat)), key=lambda i: flat[i, 0])
    column = [0]
    for left, right in pairwise(order):
        column.append(column[-1] + int(flat[right, 0] - flat[left, 0] > limit))
    order = [i for _, _, i in sorted((column[k], flat[i, 1], i) for k, i in enumerate(order))]
    return chain(order)[:-1] + chain(order[::-1])[:-1]


def support_facets(contacts: Floats) -> list[Facet]:
    """Support facets of distinct points (n, 3) that have the centre of mass above them.

    A triple spans a plane; it supports when no contact lies beyond it along its outward
    normal and the centre of mass is strictly on the inner side.  The best conditioned triple
    speaks for all the triples of its plane.
    """
    size = size_of(contacts)
    limit = ON * size
    triples = np.array(list(combinations(range(len(contacts)), 3)), dtype=np.intp).reshape(-1, 3)
    corner = contacts[triples]
    across = cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = length(across)
    facets: list[Facet] = []
    seen: list[set[int]] = []
    for row in np.argsort(-area, kind="stable"):
        triple = {int(i) for i in triples[row]}
        if area[row] <= limit * size or any(triple <= plane for plane in seen):
            continue
        normal = across[row] / area[row]
        level = float(normal @ corner[row, 0])
        if level < 0.0:
            normal, level = -normal, -level
        beyond = contacts @ normal - level
        if level <= limit or beyond.max() > limit:
            continue
        touching = [int(i) for i in np.flatnonzero(np.abs(beyond) <= limit)]
        seen.append(set(touching))
        along = corner[row, 1] - corner[row, 0]
        along = along / length(along)
        flat = contacts[touching] @ np.stack((along, cross(normal, along)), axis=1)
        polygon = tuple(touching[i] for i in convex_polygon(flat, limit))
        facets.append(Facet(normal, level, tuple(touching), polygon, contacts[list(polygon)]))
    return sorted(facets, key=lambda facet: sum(1 << i for i in facet.touching))


def accepted(facets: list[Facet], upright: float | None) -> list[Facet]:
    """Facets whose normal is strictly within `upright` of the body's -z; None takes all."""
    if upright is None or upright >= pi:
        return facets
    return [facet for facet in facets if -facet.normal[2] > cos(upright) + ON]


def centroid(polygon: Floats) -> Floats:
    """Area centroid (3,) of a convex planar polygon (k, 3), by a fan of triangles."""
    fan = cross(polygon[1:-1] - polygon[0], polygon[2:] - polygon[0])
    area = length(fan)
    middle = (polygon[0] + polygon[1:-1] + polygon[2:]) / 3.0
    return np.asarray((area[:, None] * middle).sum(axis=0) / area.sum())


def is_pierced(facet: Facet, gravity: Floats) -> bool:
    """Whether the ray meets some triangle of contacts on the facet, by barycentrics.

    The weights b solve [P1 P2 P3] b = gravity; the ray is in the triangle's cone when none of
    them is negative and one is positive.
    """
    for triple in combinations(facet.polygon, 3):
        rows = [facet.polygon.index(i) for i in triple]
        first, second, third = facet.points[rows]
        volume = float(first @ cross(second, third))
        weights = (
            float(gravity @ cross(second, third)) / volume,
            float(gravity @ cross(third, first)) / volume,
            float(gravity @ cross(first, second)) / volume,
        )
        if min(weights) >= 0.0 < max(weights):
            return True
    return False


def is_nearly_pierced(facet: Facet, gravity: Floats) -> bool:
    """Whether the ray is inside, or at most `TIE` outside, the planes through the edges."""
    planes = cross(facet.points, np.roll(facet.points, -1, axis=0))
    return bool((planes @ gravity >= -TIE * length(planes)).all())


def tip_over_axes(facets: list[Facet], rock_angle: float | None) -> list[Axis]:
    """Edges of accepted facets over which the robot falls.

    An edge shared by two facets whose normals differ by at most `rock_angle` is none.
    """
    edges: dict[tuple[int, int], list[Facet]] = {}
    for facet in facets:
        for first, second in zip(facet.polygon, facet.polygon[1:] + facet.polygon[:1], strict=True):
            edges.setdefault((min(first, second), max(first, second)), []).append(facet)
    axes = []
    for (first, second), owners in edges.items():
        if len(owners) == 2:
            between = acos(max(-1.0, min(1.0, float(owners[0].normal @ owners[1].normal))))
            if rock_angle is None or between <= rock_angle:
                continue
        for facet in owners:
            corner = dict(zip(facet.polygon, facet.points, strict=True))
            start, end = corner[first], corner[second]
            inward = cross(start, end)
            inward = inward / length(inward)
            if float(inward @ centroid(facet.points)) < 0.0:
                inward = -inward
            axes.append(Axis(start, end, inward))
    return axes


def angle_between(left: Floats, right: Floats) -> float:
    """Angle between two vectors, accurate near 0 and pi, in [0, pi]."""
    return atan2(float(length(cross(left, right))), float(left @ right))


def angle_to_arc(axis: Axis, gravity: Floats) -> float:
    """Angular distance from a direction to the great-circle arc between two contacts."""
    offset = float(axis.inward @ gravity)
    foot = gravity - offset * axis.inward
    normal = cross(axis.start, axis.end)
    within = (
        float(cross(axis.start, foot) @ normal) >= 0.0
        and float(cross(foot, axis.end) @ normal) >= 0.0
    )
    if within:
        return abs(asin(max(-1.0, min(1.0, offset))))
    return min(angle_between(axis.start, gravity), angle_between(axis.end, gravity))


def is_convex(facets: list[Facet], axes: list[Axis]) -> bool:
    """Whether every contact of every accepted facet is inside every tip-over plane."""
    size = max(size_of(facet.points) for facet in facets)
    return all(
        float((facet.points @ axis.inward).min()) >= -ON * size for axis in axes for facet in facets
    )


def cone_tip_angle(contacts: Floats, gravity: Floats) -> float:
    """Tip angle with both limits off: the region is the convex cone of the contacts.

    Needs no facet edges: the planes through the centre of mass and two contacts that have
    all contacts on one side bound the cone.
    """
    points = distinct(contacts)
    if not support_facets(points):
        return -pi
    first, second = np.triu_indices(len(points), 1)
    normal = cross(points[first], points[second])
    norm = length(normal)
    # Contacts in line with the centre of mass span no plane.
    usable = norm > ON * length(points[first]) * length(points[second])
    normal = normal[usable] / norm[usable, None]
    distance = normal @ points.T
    limit = ON * size_of(points)
    planes = np.concatenate(
        (
            normal[distance.min(axis=1) >= -limit],
            -normal[distance.max(axis=1) <= limit],
        )
    )
    if not len(planes):
        return pi
    return asin(max(-1.0, min(1.0, float((planes @ gravity).min()))))


def axis_margin(axis: Axis, gravity: Floats) -> float:
    """Signed distance, seen along gravity, from the centre of mass to the axis's line."""
    along = axis.end - axis.start
    seen = length(cross(along, gravity))
    leverage = length(cross(axis.start, axis.end)) * float(axis.inward @ gravity)
    return float(leverage / seen) if seen > 0.0 else copysign(inf, leverage)


def segment_distance(axis: Axis, gravity: Floats) -> float:
    """Distance, seen along gravity, from the centre of mass to the edge between the contacts."""
    start = axis.start - float(axis.start @ gravity) * gravity
    along = axis.end - axis.start
    along = along - float(along @ gravity) * gravity
    seen = float(along @ along)
    # An edge along gravity is seen as a point.
    share = -float(start @ along) / seen if seen > 0.0 else 0.0
    nearest = start + min(1.0, max(0.0, share)) * along
    return float(length(nearest))


def axis_energy(axis: Axis, gravity: Floats) -> float:
    """Rise of the centre of mass needed to turn over the axis, negative once beyond it.

    The centre of mass moves on a circle about the axis, of radius |arm|; its highest point
    is |arm| |up minus its part along the axis| above the axis.
    """
    along = axis.end - axis.start
    along = along / length(along)
    arm = -(axis.start - float(axis.start @ along) * along)
    up = -gravity
    steepest = up - float(up @ along) * along
    rise = sqrt(float(arm @ arm)) * sqrt(float(steepest @ steepest)) - float(arm @ up)
    return copysign(rise, float(axis.inward @ gravity))


def judge(
    contacts: Floats,
    gravity: Floats,
    upright: float | None = None,
    rock_angle: float | None = None,
) -> Verdict:
    """All channels of one posture (n, 3) under one gravity direction (3,)."""
    facets = accepted(support_facets(distinct(contacts)), upright)
    if not facets:
        return Verdict(False, -pi, -inf, -inf, (), True)
    axes = tip_over_axes(facets, rock_angle)
    stands = any(is_pierced(facet, gravity) for facet in facets)
    convex = is_convex(facets, axes)
    if not axes:
        tip_angle, margin, energy_margin = pi, inf, inf
    elif convex:
        tip_angle = asin(max(-1.0, min(1.0, min(float(a.inward @ gravity) for a in axes))))
        margin = min(axis_margin(axis, gravity) for axis in axes)
        energy_margin = min(axis_energy(axis, gravity) for axis in axes)
    else:
        # No plane separates the region from the rest: nearest piece of its boundary, and the sign
        # of the verdict.
        sign = 1.0 if stands else -1.0
        tip_angle = sign * min(angle_to_arc(axis, gravity) for axis in axes)
        margin = sign * min(segment_distance(axis, gravity) for axis in axes)
        energy_margin = sign * min(abs(axis_energy(axis, gravity)) for axis in axes)
    pierced = []
    for facet in facets:
        if is_nearly_pierced(facet, gravity):
            landing = gravity * (facet.height / float(gravity @ facet.normal))
            pierced.append((float(length(landing - centroid(facet.points))), facet.height))
    return Verdict(
        stands=stands,
        tip_angle=tip_angle,
        margin=margin,
        energy_margin=energy_margin,
        pierced=tuple(pierced),
        convex=convex,
    )
