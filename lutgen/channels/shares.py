"""How contacts share the weight, and the least share of a contact or of a group of them.

Statics leaves the shares open on more than three contacts.  Those of the least sum of squares
are taken among all that balance and do not pull: what equal springs under a rigid body carry, by
Castigliano's theorem of least work.
"""

import math

import numpy as np

from lutgen.arrays import Floats, Ints, Vector
from lutgen.channels.axes import zero_moment_point
from lutgen.channels.exact import FACET, STATUS
from lutgen.jit import njit
from lutgen.support import STANDS, TIPS, Region, plane_axes, support_contact
from lutgen.vector import add, cross, dot, read3, row, scale, subtract

# Newton's steps: a handful are taken.
STEPS = 200
# The weight (1) is balanced up to this.
BALANCED = 1e-15
# Added to the second derivatives (of 1): contacts in a line would leave them singular.
RIDGE, MOST_RIDGE = 1e-15, 1e6


@njit(bare=True)
def _residual(arm: Floats, spring: Vector, shares: Floats) -> tuple[float, Vector]:
    """Fill the shares (n,) of springs that cannot pull; return what is to be least, and its slope.

    `spring` are the coefficients of an affine function of the place, the lengths of springs.
    """
    total, x, y, half = 0.0, 0.0, 0.0, 0.0
    for i in range(arm.shape[0]):
        share = max(spring[0] + spring[1] * arm[i, 0] + spring[2] * arm[i, 1], 0.0)
        shares[i] = share
        total, x, y = total + share, x + share * arm[i, 0], y + share * arm[i, 1]
        half += 0.5 * share * share
    return half - spring[0], (total - 1.0, x, y)


@njit()
def _step(arm: Floats, shares: Floats, slope: Vector, ridge: float) -> Vector:
    """Return Newton's step: the slope over the second derivatives of the springs that push."""
    moments = ridge * np.eye(3)
    for i in range(arm.shape[0]):
        if shares[i] > 0.0:
            here = (1.0, arm[i, 0], arm[i, 1])
            for j in range(3):
                for k in range(3):
                    moments[j, k] += here[j] * here[k]
    a, b, c = row(moments, 0), row(moments, 1), row(moments, 2)
    first, second, third = cross(b, c), cross(c, a), cross(a, b)
    size = 1.0 / dot(a, first)
    return scale((dot(first, slope), dot(second, slope), dot(third, slope)), size)


@njit()
def smallest_shares(arm: Floats, shares: Floats) -> None:
    """Fill the shares (n,) of a weight on contacts at places (n, 2) from where it acts.

    They add up to 1, balance, and none is negative; of all such they have the least sum of squares.
    By duality they are the positive part of an affine function of the place, whose coefficients
    are the least of a convex function: Newton's method, damped after Levenberg, ends there.
    """
    size = 0.0
    for i in range(arm.shape[0]):
        size = max(size, math.hypot(arm[i, 0], arm[i, 1]))
    arm = arm / max(size, 1e-300)
    spring, ridge = (1.0 / arm.shape[0], 0.0, 0.0), RIDGE
    value, slope = _residual(arm, spring, shares)
    for _ in range(STEPS):
        missed = math.sqrt(dot(slope, slope))
        if missed < BALANCED or ridge > MOST_RIDGE:
            break
        there = subtract(spring, _step(arm, shares, slope, ridge))
        found, beyond = _residual(arm, there, shares)
        if found < value or (found < value + BALANCED and dot(beyond, beyond) < missed * missed):
            spring, value, slope, ridge = there, found, beyond, max(0.01 * ridge, RIDGE)
        else:
            ridge *= 10.0
            _residual(arm, spring, shares)
    total = 0.0
    for share in shares:
        total += share
    shares /= total


@njit(bare=True)
def axle_foot(
    line: tuple[Vector, Vector],
    com: Vector,
    mass: float,
    ends: tuple[Vector, Vector],
    pierced: Vector,
) -> tuple[Vector, Vector, Vector]:
    """Return where an axle carries on the ground, how D_g shifts, and how its contacts share.

    All forces are along the ray to D_g.  Those on the axle balance about its `line`, a point and a
    direction: they act at the foot, and of a load F there the contacts at its ends carry one F +
    own and two F - own, the numbers (one, two, own).  Its own weight moves D_g.
    """
    pivot, way = line
    first = dot(pierced, cross(way, subtract(ends[0], pivot)))
    second = dot(pierced, cross(way, subtract(ends[1], pivot)))
    weight = dot(pierced, cross(way, subtract(com, pivot)))
    one, own = second / (second - first), mass * weight / (first - second)
    two = 1.0 - one
    foot = add(scale(ends[0], one), scale(ends[1], two))
    return foot, scale(subtract(ends[1], ends[0]), own), (one, two, own)


@njit()
def least_share(region: Region, values: Floats, force: Vector, mu: Vector, groups: Ints) -> float:
    """Return the least share of the weight that a group carries under a force and a moment.

    The facet and the status of the direction are in `values`.  `groups` (n,) are bits of rows of
    the recipe's contacts; of none each contact that touches the facet counts by itself.  NaN where
    the robot tips, and 0 where it rocks, over two contacts.
    """
    k, status = int(values[FACET]), int(values[STATUS])
    if k < 0 or status != STANDS:
        return math.nan if k < 0 or status == TIPS else 0.0
    pierced = zero_moment_point(read3(region.seat[k].plane), force, mu)
    seat, shown = region.seat[k], region.shown
    normal = read3(seat.normal)
    one, two = plane_axes(normal)
    arm, bits = np.empty((region.counts.shown, 2)), np.empty(region.counts.shown, np.int64)
    count, mask, swings = 0, seat.mask, region.facet[seat.facet].swings == 1
    split = (0.0, 0.0, 0.0)
    axle = region.axle[seat.facet]
    if swings:
        mask &= ~(1 << axle.first | 1 << axle.second)
        ends = (
            support_contact(shown, axle.first, normal),
            support_contact(shown, axle.second, normal),
        )
        line = read3(axle.pivot), read3(axle.way)
        foot, shift, split = axle_foot(line, read3(axle.com), axle.mass, ends, pierced)
        pierced = add(pierced, shift)
        away = subtract(foot, pierced)
        arm[0, 0], arm[0, 1] = dot(one, away), dot(two, away)
        count = 1
    for i in range(region.counts.shown):
        if mask >> i & 1:
            away = subtract(support_contact(shown, i, normal), pierced)
            arm[count, 0], arm[count, 1] = dot(one, away), dot(two, away)
            bits[count] = 1 << region.source[i]
            count += 1
    shares = np.empty(count + 1)
    smallest_shares(arm[:count], shares[:count])
    if swings:
        load, count = shares[0], count + 1
        shares[0], bits[0] = load * split[0] + split[2], 1 << region.source[axle.first]
        shares[count - 1], bits[count - 1] = load - shares[0], 1 << region.source[axle.second]
    shares = shares[:count]
    least = 1.0
    if groups.shape[0] == 0:
        # Loops: numba would import scipy for arrays' own sum and least.
        for share in shares:
            least = min(least, share)
        return least
    for group in groups:
        carried = 0.0
        for i in range(count):
            carried += shares[i] if group & bits[i] else 0.0
        least = min(least, carried)
    return least
