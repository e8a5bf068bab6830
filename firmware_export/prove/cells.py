"""What one cell of postures proves: the guard that it needs, and that what is answered stands.

The three contacts P_i, seen from the com, span a cone; E_i = P_i x P_(i+1) are its inward edge
normals, m_i = E_i / |E_i|.  The C has the points P_i + d_i, from them normals M_i, and answers the
least asin(M_i . g), less the guard.

*One edge.*  M_i is normal to both stored points but for the rounding c of the vector product, so
M_i . P_i = (c . P_i - E* . d_i) / |E*| with E* the stored product, and the same with P_(i+1).  What
of M_i lies in the plane of P_i and P_(i+1) is known from these two products: its length is the sine
of the angle V between both planes.  asin(M . g) is g's distance from a great circle: it changes by
no more than its pole turns.

*Only the arc counts.*  Let w be a direction on the arc from P_i to P_(i+1), a combination of both
with weights >= 0: then only products M_i . P above 0 count.  Where g is inside the true cone and
edge i the nearest, the foot of g on it lies on that arc, so asin(M_i . g) <= asin(m_i . g) +
asin(M_i . w).  And the directions with all M_i . g > sin V are a convex set that holds no direction
of the true boundary: it lies inside the true cone if one of its directions, the *witness*, does.
So V may be taken of the arcs where a witness is found, of whole planes elsewhere.

*Where the facet is low.*  |E_i| is at least the side's length times the height of the com over the
facet, and the C answers only where that is above `lowest`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.prove.intervals import (
    Interval,
    cross,
    dot,
    norm,
    root_down,
    root_up,
    up,
)
from firmware_export.prove.motion import Sum, Waves
from firmware_export.prove.rounding import ARCSINE, HALF_UNIT, LAST, READ
from firmware_export.prove.stored import Stored
from lutgen.vector import Floats

# Lengths whose fourth powers are numbers of single precision, far from its ends.
SMALLEST, LARGEST = 1e-7, 1e8
# Why a cell proves nothing, in the order in which it is asked.
REASONS = (
    "",
    "the facet's height is not known to be above 0",
    "the facet may be steeper than the recipe's `upright`",
    "the facet may be narrower than the recipe's rest_width",
    "a tip-over axis comes too near to the centre of mass",
)


class Rules(NamedTuple):
    """What stands, by the recipe and by the C.

    `steepest`: least -n_z of the truth (-2: any); `width`: least width; `ball`: radius of the ball
    in which the com may be.  `thresholds`: the same of the C (lowest, steepest, least width);
    `either`: whether its points run either way round; `refuses`: whether it looks at height,
    steepness and width at all.
    """

    steepest: float
    width: float
    ball: float
    thresholds: tuple[float, float, float]
    either: bool
    refuses: bool


class Found(NamedTuple):
    """What cells (n,) prove; infinite where that is nothing.

    `guard` (rad) is what floats need, `turn` (rad) how far the planes turn: what whole numbers need
    but for their own rounding.  `reason`: index of `REASONS`.
    """

    guard: Floats
    turn: Floats
    reason: NDArray[np.int64]


def examine(box: Interval, truth: list[Sum], held: Stored, rules: Rules) -> Found:
    """Return what cells (k, n) of postures prove."""
    with np.errstate(all="ignore"):
        return _examine(box, truth, held, rules)


def _examine(box: Interval, truth: list[Sum], held: Stored, rules: Rules) -> Found:
    here = _Cells(box, truth, held)
    points, offs, seen = here.points, here.offs, here.seen
    edges = [cross(seen[i], seen[i - 2]) for i in range(3)]
    true = [cross(points[i], points[i - 2]) for i in range(3)]
    rounded = [_product_error(seen[i], seen[i - 2]) for i in range(3)]
    lengths = [norm(p) for p in points]
    sides = [norm(points[i - 2] - points[i]) for i in range(3)]

    stands, height, reason = _stands(true, edges, rounded, points, offs, sides, rules)
    reach = np.max([one.high for one in lengths], axis=0)
    whole, arc, away = np.zeros(len(reach)), np.zeros(len(reach)), np.full(len(reach), np.inf)
    for i in range(3):
        j = (i + 1) % 3
        moved = _moved(i, seen, offs, rounded)
        plane = np.maximum(norm(true[i]).low, sides[i].low * height * (1.0 - 1e-9))
        least = np.maximum(norm(edges[i]).low - rounded[i], plane - moved)
        # Normals that are not nearly opposite, and whose squares are numbers of single precision.
        small = (least <= SMALLEST**2) | (moved >= plane)
        reason = np.where((reason == 0) & small, 4, reason)
        bounds = []
        for at in (i, j):
            both = here.product(i, at).widened(rounded[i] * lengths[at].high)
            bounds.append((both.high / least, both.most / least))
        (a, a_most), (b, b_most) = bounds
        between = dot(points[i], points[j])
        turns = [
            _in_plane(x, y, lengths[i].high, lengths[j].high, along) / plane
            for x, y, along in (
                (np.maximum(a, 0.0), np.maximum(b, 0.0), -between.low),
                (a_most, b_most, between.most),
            )
        ]
        arc = np.maximum(arc, np.where(small, np.inf, turns[0]))
        whole = np.maximum(whole, np.where(small, np.inf, turns[1]))
        away = np.minimum(away, plane / sides[i].high)
    shown = _witness(points, true, edges, rounded, arc)
    sine = np.where(shown, np.minimum(arc, whole), whole) * (1.0 + 1e-12)
    ball = _ball(rules.ball, away)
    guard = _guard(sine, _steepness(true, height, reach) + 2.0 * ball) + ball
    turn = np.arcsin(np.minimum(sine, 1.0)) * (1.0 + 1e-12) + ball
    extent = (np.min([one.low for one in sides], axis=0) < SMALLEST) | (reach > LARGEST)
    failed = (reason > 0) | extent | ~(sine < 1.0) | ~np.isfinite(guard)
    reason = np.where(failed & (reason == 0), 4, reason)
    refused = ~stands & rules.refuses
    guard = np.where(refused, 0.0, np.where(failed, np.inf, guard))
    turn = np.where(refused, 0.0, np.where(failed, np.inf, turn))
    return Found(guard, turn, np.where(refused, 0, reason))


class _Cells:
    """Points over cells: the true ones, the stored ones, and how those differ (mean value form).

    A function over a cell is its value in the middle and what its derivatives, taken over the cell,
    can change on the way to the rim; where intervals as they come are shorter, those.
    """

    def __init__(self, box: Interval, truth: list[Sum], held: Stored) -> None:
        middle = Interval.of(0.5 * box.low + 0.5 * box.high)
        here, there = Waves.over(box), Waves.over(middle)
        self.way = box - middle
        k = range(len(box.low))
        self._off = held.off(there)
        slopes = [held.slope(here, axis) for axis in k]
        off = self._off
        for axis in k:
            off = off + slopes[axis] * self.way[axis]
        self._rounding = held.errors
        self._slopes = [[one[3 * i : 3 * i + 3] for one in slopes] for i in range(3)]
        self._middle = [there.value(one) for one in truth]
        self._real = [off[3 * i : 3 * i + 3] for i in range(3)]
        self._true_slopes = [[here.slope(one, axis) for axis in k] for one in truth]
        self.points = []
        for i, one in enumerate(truth):
            point = self._middle[i]
            for axis in k:
                point = point + self._true_slopes[i][axis] * self.way[axis]
            self.points.append(point.meet(here.value(one)))
        off = off.widened(held.errors[:, None])
        self.offs = [off[3 * i : 3 * i + 3] for i in range(3)]
        self.seen = [p + d for p, d in zip(self.points, self.offs, strict=True)]

    def product(self, i: int, at: int) -> Interval:
        """Return - E* . d (n,) of edge i and the point `at` of its two ends."""
        j = (i + 1) % 3
        middle = [self._middle[n] + self._off[3 * n : 3 * n + 3] for n in (i, j)]
        value = dot(cross(*middle), self._off[3 * at : 3 * at + 3])
        p, q = (self.points[n] + self._real[n] for n in (i, j))
        normal = cross(p, q)
        for axis, slopes in enumerate(zip(*self._slopes, strict=True)):
            p_along, q_along = (self._true_slopes[n][axis] + slopes[n] for n in (i, j))
            turning = cross(p_along, q) + cross(p, q_along)
            change = dot(turning, self._real[at]) + dot(normal, slopes[at])
            value = value + change * self.way[axis]
        value = value.meet(dot(normal, self._real[at]))
        # What rounding adds: to the points of the normal, and to d.
        r = [float(np.sqrt((self._rounding[3 * n : 3 * n + 3] ** 2).sum())) for n in range(3)]
        far, near = norm(p).high, norm(q).high
        more = (far * r[j] + near * r[i] + r[i] * r[j]) * (norm(self._real[at]).high + r[at])
        own = self._rounding[3 * at : 3 * at + 3, None]
        return -value.widened((more + (normal.most * own).sum(axis=0)) * (1.0 + 1e-12))


def _product_error(a: Interval, b: Interval) -> Floats:
    """Return how far (n,) rounding puts a vector product off."""
    turns = ((1, 2), (2, 0), (0, 1))
    parts = [a[i].most * b[j].most + a[j].most * b[i].most for i, j in turns]
    square = sum((part**2 for part in parts), np.zeros_like(parts[0]))
    return root_up(square) * (2.01 * HALF_UNIT) * (1.0 + 1e-12)


def _moved(i: int, seen: list[Interval], offs: list[Interval], rounded: list[Floats]) -> Floats:
    """Return how far (n,) the normal of edge i is from the true one."""
    j = (i + 1) % 3
    true = seen[i] - offs[i]
    return np.asarray(norm(cross(true, offs[j]) + cross(offs[i], seen[j])).high + rounded[i])


def _in_plane(a: Floats, b: Floats, p: Floats, q: Floats, along: Floats) -> Floats:
    """Return the most of |x Q - y P| for 0 <= x <= a, 0 <= y <= b; `along` at least -P . Q."""
    both = up((a * q) ** 2 + (b * p) ** 2 + 2.0 * a * b * along)
    corner = np.maximum(a * q, b * p)
    return np.maximum(corner, root_up(np.maximum(both, 0.0))) * (1.0 + 1e-12)


def _stands(
    true: list[Interval],
    edges: list[Interval],
    rounded: list[Floats],
    points: list[Interval],
    offs: list[Interval],
    sides: list[Interval],
    rules: Rules,
) -> tuple[NDArray[np.bool_], Floats, NDArray[np.int64]]:
    """Tell of cells whether the C may say that it stands, and whether it then does.

    Returns whether (n,) it may be said at all, the least height (n,) of those postures of which it
    is, and the reason why it may be wrong, 0 where it is right.
    """
    lowest, steepest, width = rules.thresholds
    normal = true[0] + true[1] + true[2]
    volume = dot(true[0], points[2])
    wrong = sum(
        (
            _moved(i, [p + d for p, d in zip(points, offs, strict=True)], offs, rounded)
            for i in range(3)
        ),
        np.zeros(len(rounded[0])),
    )
    size = norm(normal)
    reach = np.max([norm(p).high for p in points], axis=0)
    wrong = wrong + 16.0 * HALF_UNIT * np.max([norm(e).high for e in edges], axis=0)
    low_size = size.low
    longest = Interval(
        np.max([s.low for s in sides], axis=0), np.max([s.high for s in sides], axis=0)
    )
    moved = np.max([norm(d).high for d in offs], axis=0)
    if width > 0.0:
        # What the C takes for wide is: |normal| >= width x longest side, but for what is off.
        held_size = width * (1.0 - 16.0 * HALF_UNIT) * (longest.low - 2.0 * moved) - wrong
        low_size = np.maximum(low_size, held_size)
    # |det - V|: of the edge, of the point, of three products.
    off_volume = (
        _moved(0, [p + d for p, d in zip(points, offs, strict=True)], offs, rounded) * reach
        + (norm(true[0]).high + wrong) * (moved + 4.0 * HALF_UNIT * reach)
    ) * (1.0 + 1e-9)
    # V where the C finds it high enough.
    said = lowest * (1.0 - 8.0 * HALF_UNIT) * (low_size - wrong) - off_volume
    at_least = np.maximum(said, volume.least)
    known = (said > 0.0) | (volume.low > off_volume) | (volume.high < -off_volume)
    height = np.where(known, at_least / size.high * (1.0 - 1e-12), 0.0)
    if lowest > 0.0:
        tilt = np.where(low_size > 0.0, wrong / low_size, np.inf)
        there = lowest * (1.0 - 8.0 * HALF_UNIT) * (1.0 - tilt) - off_volume / low_size
        known |= there > 0.0
        height = np.fmax(height, there)
    ok_height = known & (height > rules.ball * (1.0 + 1e-9))
    upward = volume.high < 0.0
    if rules.either:
        sign = np.where(
            volume.low > off_volume, 1.0, np.where(volume.high < -off_volume, -1.0, 0.0)
        )
    else:
        sign = np.ones(len(reach))
        ok_height &= ~upward | (said > 0.0)
    down = -normal[2]
    down = Interval(
        np.where(sign < 0.0, -down.high, down.low), np.where(sign < 0.0, -down.low, down.high)
    )
    down = Interval(
        np.where(sign == 0.0, -down.most, down.low), np.where(sign == 0.0, down.most, down.high)
    )
    # A normal that is off by a small part of its length turns by hardly more than that part.
    share = wrong / low_size
    tilt = np.where(share < 0.1, 1.02 * share + 8.0 * HALF_UNIT, np.inf)
    ok_steep = np.ones(len(reach), bool)
    if rules.steepest > -1.0:
        limit = rules.steepest * np.where(rules.steepest >= 0.0, size.high, size.low)
        ok_steep = down.low > limit * (1.0 + 1e-12)
        if steepest > -1.0:
            ok_steep |= steepest - tilt > rules.steepest
    ok_wide = np.ones(len(reach), bool)
    if rules.width > 0.0:
        ok_wide = size.low >= rules.width * longest.high * (1.0 + 1e-12)
        if width > 0.0:
            least = width * (1.0 - 16.0 * HALF_UNIT) * (1.0 - 2.0 * moved / longest.low)
            ok_wide |= least - wrong / longest.low >= rules.width
    # What the C refuses anyhow.
    refused = np.zeros(len(reach), bool)
    highest = volume.most if rules.either else np.maximum(volume.high, 0.0)
    refused |= (highest + off_volume) < lowest * (1.0 - 8.0 * HALF_UNIT) * (size.low - wrong)
    if not rules.either:
        refused |= volume.high + off_volume < 0.0
    if steepest > -1.0:
        bound = steepest - tilt
        edge = bound * np.where(bound >= 0.0, size.low, size.high)
        refused |= down.high < edge
    if width > 0.0:
        refused |= size.high + wrong < width * (1.0 - 16.0 * HALF_UNIT) * (
            longest.low - 2.0 * moved
        )
    reason = np.where(~ok_height, 1, np.where(~ok_steep, 2, np.where(~ok_wide, 3, 0)))
    return ~refused, np.maximum(height, 0.0), reason


def _witness(
    points: list[Interval],
    true: list[Interval],
    edges: list[Interval],
    rounded: list[Floats],
    arc: Floats,
) -> NDArray[np.bool_]:
    """Tell whether a direction is shown that is inside the true cone and clears the stored one."""
    middles = [0.5 * (p.low + p.high) for p in points]
    witness = sum((m / np.sqrt((m**2).sum(axis=0)) for m in middles), np.zeros_like(middles[0]))
    down = Interval.of(witness)
    length = norm(down).high
    shown = np.ones(len(arc), bool)
    for i in range(3):
        clear = (dot(edges[i], down).low - rounded[i] * length) / (
            (norm(edges[i]).high + rounded[i]) * length
        )
        shown &= (dot(true[i], down).low > 0.0) & (clear * (1.0 - 1e-12) > arc)
    return shown


def _steepness(true: list[Interval], height: Floats, reach: Floats) -> Floats:
    """Return an upper bound (n,) of the sine of the greatest clearance there is.

    The least of three scalar products is at most their mean, so at most |m_1 + m_2 + m_3| / 3; and
    a cap within the cone is within the directions in which the facet is no further than `reach`.
    """
    lengths = [norm(one) for one in true]
    total = np.full(len(reach), 3.0)
    for i in range(3):
        j = (i + 1) % 3
        most = dot(true[i], true[j]).high
        size = np.where(
            most > 0.0, lengths[i].low * lengths[j].low, lengths[i].high * lengths[j].high
        )
        total = total + 2.0 * np.where(size > 0.0, np.minimum(most / size, 1.0), 1.0)
    mean = root_up(np.maximum(total, 0.0)) / 3.0
    share = np.minimum(height / reach, 1.0)
    cap = root_up(np.maximum(1.0 - share**2, 0.0))
    return np.minimum(np.minimum(mean, cap) * (1.0 + 1e-12), 1.0)


def _guard(sine: Floats, top: Floats) -> Floats:
    """Return the guard (n,) that a turn of the planes by asin(sine) and the rest of a read need.

    `top` is the sine of the greatest true clearance: asin turns an error of its argument into one
    that is larger by one over the cosine.
    """
    turn = np.arcsin(np.minimum(sine, 1.0))
    highest = np.minimum(top + sine + READ, 1.0)
    slope = root_down(1.0 - highest**2)
    # asin never changes by more than sqrt(2 x) over x, times 1 + x.
    rest = np.minimum(READ / slope, math.sqrt(2.0 * READ) * 1.001)
    rest = np.maximum(rest, np.arcsin(np.minimum(sine + READ, 1.0)) - turn)
    return np.asarray((turn + rest) * (1.0 + 1e-12) + ARCSINE + LAST)


def _ball(radius: float, away: Floats) -> Floats:
    """Return by how much (rad) a com in its ball turns the plane of an axis at a distance (n,)."""
    if radius == 0.0:
        return np.zeros_like(away)
    return np.where(
        away > radius, np.arcsin(np.minimum(radius / away, 1.0)) * (1.0 + 1e-12), np.inf
    )
