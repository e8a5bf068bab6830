"""What stands: one roll, one landing; slow, and plain NumPy.

Written from the definition by other methods than lutgen's: facets by trying all triples from many
starts, arcs of normals followed in many small steps, the energy of a roll by a fine sum, held parts
by dense sampling and bisection, sides of gaps as fine polylines.

Lengths in one unit, angles in rad, all relative to the com in the body frame.
"""

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tests.oracles.primitives import (
    least_turn,
    norm,
    planes_of_three,
    polygon,
    reach,
    size_of,
    touch,
    unit,
)

STANDS, ROCKS, TIPS = 0, 1, 2
# A share of the size: lengths that differ by less are one.
SAME = 1e-9
# A corner stands out of its neighbours' line by more than this part of the size.
ROW = 1e-8
# Rests that a shorter turn joins are one; a wheel whose axle is nearer to the normal lies on its
# face.
ONE_REST, FACE = 2e-4, math.radians(10.0)
# Sine by which a convex region may be concave.
NOISE = 1e-4
# Longest step (rad) along an arc; a side is a polyline of them, off by at most STEP^2 / 8 = 5e-7.
STEP = 0.002


class Limits(NamedTuple):
    """`upright` and `rock_angle` (None: no limit), and two lengths."""

    upright: float | None = None
    rock_angle: float | None = None
    rest_width: float = 0.0
    contact_tolerance: float = 0.0


@dataclass(eq=False)
class Arc:
    """A roll to the rest `to`, over its edge `back`; both contacts `p`, `q` (k, 3) on the way.

    Gravity g arrives as `turned` @ g, and the com has sunk by `sunk` . g.
    """

    to: "Facet"
    back: int
    p: np.ndarray
    q: np.ndarray
    turned: np.ndarray
    sunk: np.ndarray
    held: tuple[float, float] = (1.0, 0.0)


@dataclass(eq=False)
class Facet:
    """A plane with none below: who touches it, who and where its corners are, arcs by edge."""

    normal: np.ndarray
    height: float
    touching: np.ndarray
    corners: np.ndarray
    points: np.ndarray
    centroid: np.ndarray = field(default_factory=lambda: np.zeros(3))
    width: float = 0.0
    group: int = -1
    beyond: dict[int, Arc] = field(default_factory=dict)

    def edges(self):
        two = np.stack([self.corners, np.roll(self.corners, -1)], -1)
        return list(
            zip(range(len(two)), two, self.points, np.roll(self.points, -1, 0), strict=True)
        )


def facets_of(rows):
    """Return all support facets; those that share three contacts which are not in a row are one."""
    size, found = size_of(rows), []
    for n in planes_of_three(rows, size):
        h = reach(rows, n[None])[0]
        touching = np.flatnonzero(h >= h.max() - SAME * size)
        for f in list(found):
            common = np.intersect1d(f.touching, touching)
            near = norm(f.normal - n) < 1e-4 and len(common) > 2
            if near and len(polygon(touch(rows[common], n), n, ROW * size)):
                touching, n = np.union1d(touching, f.touching), f.normal
                found.remove(f)
        corners = touching[polygon(touch(rows[touching], n), n, ROW * size)]
        if len(corners):
            points = touch(rows[corners], n)
            found.append(Facet(n, float((points @ n).max()), touching, corners, points))
    return found


def rests_of(rows, limits):
    """Return the rests, with the centroids of their support polygons."""
    size, found = size_of(rows), []
    upright = math.pi if limits.upright is None else limits.upright
    steepest = -2.0 if upright >= math.pi else math.cos(upright) + 1e-9
    for f in facets_of(rows):
        discs = rows[f.corners][rows[f.corners, 7] == 2]
        sine = norm(np.cross(discs[:, 3:6], f.normal)).min(initial=1.0)
        upside_down = f.height <= SAME * size or -f.normal[2] <= steepest
        if upside_down or sine < min(math.sin(FACE), max(steepest, 0.0)):
            continue
        gap = f.height - reach(rows, f.normal[None])[0]
        near = gap <= max(limits.contact_tolerance, SAME * size)
        near[f.touching] = True
        p = touch(rows, f.normal)[near]
        p = p[polygon(p, f.normal, 0.0)]
        p += np.outer(f.height - p @ f.normal, f.normal)
        after = np.roll(p, -1, 0)
        area = np.cross(p - p[0], after - p[0]) @ f.normal
        f.centroid = area @ (p[0] + p + after) / (3.0 * area.sum())
        f.width = np.ptp(p @ unit(np.cross(f.normal, after - p)).T, axis=0).min()
        if f.width >= limits.rest_width or limits.rock_angle is None:
            found.append(f)
    return found


def follow(rows, pair, begin, end, slack):
    """Return the normals from one rest outwards to another on two primitives.

    None if the arc does not lead there, or another primitive comes below the plane before.
    """
    way, n = [begin], begin
    if norm(touch(pair, begin) - touch(pair, end)).max() <= slack:
        return np.stack([begin, end])
    while len(way) < 4.0 / STEP and reach(rows, n[None]).max() <= touch(pair[0], n) @ n + slack:
        p, q = touch(pair, n)
        ahead = unit(np.cross(q - p, n))
        sine = norm(np.cross(pair[:, 3:6], n))[pair[:, 7] == 2].min(initial=1.0)
        step = STEP * sine * min(1.0, 2.0 * norm(q - p) / max(pair[:, 6].max(), 1e-300))
        if 0.0 <= (end - n) @ ahead <= step and norm(end - n) < 2.0 * step:
            return np.stack([*way, end])
        n = unit(n + step * ahead)
        for _ in range(3):  # Onto the arc again.
            p, q = touch(pair, n)
            n = unit(n - (q - p) * ((q - p) @ n) / ((q - p) @ (q - p)))
        way.append(n)
    return None


class Standing:
    """The standing region of a posture: rests, gaps, and the arcs of its boundary."""

    def __init__(self, rows, limits):
        self.rows, self.size = rows, size_of(rows)
        self.rests = rests_of(rows, limits)
        self.gaps = []
        self._link(-1.0 if limits.rock_angle is None else math.cos(limits.rock_angle + 1e-12))
        sides = []
        for k, here in enumerate(self.rests):
            for e, _, a, b in here.edges():
                low, high, arc = 1.0, 0.0, here.beyond.get(e)
                if arc is not None:
                    free = arc.to.group == here.group or limits.rock_angle is None
                    low, high = arc.held = (0.0, 1.0) if free else self._held(here, arc)
                    if low < high and len(arc.p) > 2 and k < self.rests.index(arc.to):
                        self.gaps.append((here, arc))
                low, high = (low, high) if low < high else (0.0, 0.0)
                parts = [(v, w) for v, w in ((0.0, low), (high, 1.0)) if v < w]
                sides += [(a + v * (b - a), a + w * (b - a)) for v, w in parts]
        for _, arc in self.gaps:
            for w in arc.held:
                sides += pairwise(arc.p + w * (arc.q - arc.p))
        self.sides = np.array(sides).reshape(-1, 2, 3)
        # A region is convex if no corner is outside a plane by more than noise may make it.
        self.walls = unit(np.cross(*self.sides.swapaxes(0, 1)))
        corners = unit(np.concatenate([np.zeros((0, 3)), *(f.points for f in self.rests)]))
        apart = any(here.group != arc.to.group for here, arc in self.gaps)
        inside = (corners @ self.walls.T >= -NOISE).all()
        self.convex = bool(len(self.rests) and len(self.sides) and inside and not apart)

    def _link(self, least):
        """Find the arcs between rests with at least this cosine, and number the groups."""
        for here in self.rests:
            for e, ids, _, _ in here.edges():
                for there in self.rests:
                    sought = touch(self.rows[ids[::-1]], there.normal)
                    for back, _, *ends in there.edges():
                        off = norm(np.stack(ends) - sought).max()
                        cosine = here.normal @ there.normal
                        if there is here or off > 1e-7 * self.size:
                            continue
                        if cosine >= least or norm(here.normal - there.normal) <= ONE_REST:
                            self._roll(here, e, there, back, self.rows[ids])
        for k, first in enumerate(self.rests):
            queue = [first] if first.group < 0 else []
            for f in queue:
                f.group = k
                near = [a.to for a in f.beyond.values() if norm(f.normal - a.to.normal) <= ONE_REST]
                queue += [g for g in near if g.group < 0 and g not in queue]

    def _roll(self, here, e, there, back, pair):
        """Roll over edge e of a rest to another one, and back."""
        way = follow(self.rows, pair, here.normal, there.normal, 10.0 * SAME * self.size)
        if way is None or back in there.beyond:
            return
        p, q = touch(pair[0], way), touch(pair[1], way)
        turned, sunk = np.eye(3), np.zeros(3)
        for k in range(len(way) - 1):
            further = least_turn(way[k], way[k + 1]) @ turned
            sunk -= (further - turned).T @ (p[k] + p[k + 1]) / 2.0
            turned = further
        here.beyond[e] = Arc(there, back, p, q, turned, sunk)
        there.beyond[back] = Arc(here, e, q[::-1], p[::-1], turned.T, -turned @ sunk)

    def _stays(self, arc, g):
        """Tell whether a robot that is let go under directions (m, 3) stays where it lands."""
        good = np.ones(len(g), bool)
        for f in self.rests:
            if f.group != arc.to.group:
                continue
            last, sunk = g @ arc.turned.T, g @ arc.sunk
            on = last @ least_turn(arc.to.normal, f.normal).T
            last, sunk = on, sunk - (on - last) @ f.points[0]
            for e, _, a, b in f.edges():
                inner = e in f.beyond and f.beyond[e].to.group == f.group
                if not inner and not (f is arc.to and e == arc.back):
                    u = unit(b - a)
                    inside, above = last @ np.cross(a, u), last @ (a - (a @ u) * u)
                    good &= (inside >= 0.0) & (np.hypot(inside, above) >= above + sunk)
        return good

    def _held(self, here, on):
        """Return the longest part of an edge over which the robot stays wherever it rolls."""
        off = on.to.beyond[on.back]

        def good(w):
            begin, end = (on.p[k] + w[:, None] * (on.q[k] - on.p[k]) for k in (0, -1))
            return self._stays(on, begin) & self._stays(off, end)

        w = np.linspace(0.0, 1.0, 2001)
        inside = np.diff(np.concatenate([[0], good(w), [0]]))
        begins, ends = np.flatnonzero(inside == 1), np.flatnonzero(inside == -1) - 1
        if not len(begins):
            return 1.0, 0.0
        k, found = int(np.argmax(ends - begins)), []
        for yes, no in ((w[begins[k]], w[begins[k] - 1]), (w[ends[k]], w[(ends[k] + 1) % len(w)])):
            while 1e-12 < abs(yes - no) < 0.5:  # From 0 to 1: there is none beyond.
                half = 0.5 * (yes + no)
                yes, no = (half, no) if good(np.array([half]))[0] else (yes, half)
            found.append(float(yes))
        return found[0], found[1]

    def in_gap(self, arc, g):
        """Tell which directions (m, 3) point at the held part of a strip."""
        found, side = np.zeros(len(g), bool), np.cross(arc.p, arc.q) @ g.T
        k, m = np.nonzero(side[1:] * side[:-1] <= 0.0)
        step = side[k, m] - side[k + 1, m]
        t = (side[k, m] / np.where(step == 0.0, 1.0, step))[:, None]
        p, q = (x[k] + t * (x[k + 1] - x[k]) for x in (arc.p, arc.q))
        u, v = (x - (x * g[m]).sum(-1)[:, None] * g[m] for x in (p, q))
        w = (u * (u - v)).sum(-1) / ((u - v) ** 2).sum(-1)
        ahead = ((p + w[:, None] * (q - p)) * g[m]).sum(-1) > 0.0
        found[m[(arc.held[0] <= w) & (w <= arc.held[1]) & ahead]] = True
        return found

    def distance(self, g):
        """Return the angle from directions (m, 3) to the boundary; pi if there is none."""
        a, b = unit(self.sides[:, 0]), unit(self.sides[:, 1])
        m = unit(np.cross(a, b))
        beside = (g @ np.cross(m, a).T >= 0.0) & (g @ np.cross(b, m).T >= 0.0)
        ends = np.minimum(norm(g[:, None] - a), norm(g[:, None] - b))
        ends = 2.0 * np.arcsin(np.minimum(ends / 2.0, 1.0))
        flat = abs(np.arcsin(np.clip(g @ m.T, -1.0, 1.0)))
        return np.asarray(np.where(beside, flat, ends).min(1, initial=math.pi))

    def read(self, g):
        """Return status, tip_angle, sdg, height and lever of unit directions (m, 3).

        Planes that differ by d at the corners of a rest differ by d * lever where g pierces them,
        along g, and at the com's foot, which is less than 1 outside the rest.
        """
        status, seat = np.full(len(g), TIPS), np.full(len(g), -1)
        for here, arc in self.gaps:
            inside, two = self.in_gap(arc, g), [here, arc.to]
            first = np.argmax([g @ f.normal / f.height for f in two], 0)
            status[inside] = STANDS if here.group == arc.to.group else ROCKS
            seat[inside] = np.array([self.rests.index(f) for f in two])[first][inside]
        for k, f in enumerate(self.rests):
            walls = unit(np.cross(f.points, np.roll(f.points, -1, 0)))
            inside = (g @ walls.T >= -1e-12).all(1)
            status[inside], seat[inside] = STANDS, k
        stands = status != TIPS
        tip = self.distance(g) * np.where(stands, 1.0, -1.0)
        if self.convex:
            tip = np.arcsin(np.clip((g @ self.walls.T).min(1), -1.0, 1.0))
        tip = np.where(stands, np.maximum(tip, 0.0), np.minimum(tip, 0.0))
        sdg, height, lever = np.full((3, len(g)), math.nan)
        for k, f in enumerate(self.rests):
            mine = seat == k
            height[mine] = f.height
            cosine = g[mine] @ f.normal
            sdg[mine] = norm(g[mine] * f.height / cosine[:, None] - f.centroid)
            lever[mine] = np.maximum(1.0 / cosine, 1.0 + 2.0 * self.size / f.width)
        return status, tip, sdg, height, lever
