"""Normal forces: what each contact on the ground may carry, and how much it does.

Statics leaves the distribution open on more than three contacts, and on contacts that lie in a line
or inside the support polygon.  All loads that balance are the mixtures of a few, the corners of
that set, each of which rests on three contacts at most.
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.channels import axle_foot, smallest_shares
from lutgen.vector import Floats, Vector, read3

# Part of the contacts' spread: D_g nearer than this to a contact, or to the line of two, is on
# it.  A tenth of what the balance may miss.
ON = 1e-10


class Axle(NamedTuple):
    """An axle on a facet: a point and the direction of its line, its com, its share of the mass.

    `ends` are the places of its contacts among those that touch.
    """

    line: tuple[Vector, Vector]
    com: Vector
    mass: float
    ends: tuple[int, int]


def load_corners(points: Floats, pierced: Floats) -> Floats:
    """Return the corners (c, k) of the set of all loads that balance and do not pull.

    A load is each contact's share of the normal force; it balances if it adds up to 1 and its
    centre is D_g.  The set is bounded and convex, so a share's least and largest value, and the
    least of every concave function of the shares, are found at its corners.  A corner rests on
    contacts of which none can be left out: one under D_g, two with D_g between them, or three
    round it.

    `points` (k, 3) are in one plane, in any order; any may lie in a line or inside the others.
    D_g, `pierced` (3,), is in the same plane.  There is no row where it is outside the polygon by
    more than 1e-10 of the contacts' spread, and one where the balance leaves no choice.
    """
    arm = _flat(points, pierced)
    k, near = len(arm), np.hypot(*arm.T) <= ON
    corners = [np.eye(k)[near]]
    pairs = np.array(list(combinations(range(k), 2)), np.intp).reshape(-1, 2)
    a, b = arm[pairs[:, 0]], arm[pairs[:, 1]]
    side = b - a
    length = np.maximum(np.hypot(*side.T), 1e-300)
    between = (a * b).sum(axis=1) < 0.0
    between &= ~near[pairs].any(axis=1) & (np.abs(_cross(a, b)) <= ON * length)
    along = -(a * side).sum(axis=1) / np.maximum((side * side).sum(axis=1), 1e-300)
    corners.append(_rows(pairs[between], np.column_stack([1.0 - along, along])[between], k))
    triples = np.array(list(combinations(range(k), 3)), np.intp).reshape(-1, 3)
    turns, depths = [], []
    for t in range(3):
        p, q = arm[triples[:, (t + 1) % 3]], arm[triples[:, (t + 2) % 3]]
        turns.append(_cross(p, q))
        depths.append(turns[-1] / np.maximum(np.hypot(*(q - p).T), 1e-300))
    turn, depth = np.column_stack(turns), np.column_stack(depths)
    round_it = (depth > ON).all(axis=1) | (depth < -ON).all(axis=1)
    inside = turn[round_it]
    corners.append(_rows(triples[round_it], inside / inside.sum(axis=1, keepdims=True), k))
    return np.vstack(corners)


def normal_forces(points: Floats, pierced: Floats) -> Floats:
    """Return each contact's share of the normal force, (k,), adding up to 1.

    Friction has no moment about axes in the contact plane, so force and moment balance about
    D_g alone fix the shares of three contacts for any mu.  For more than three, or three in a
    line, the balance may leave a choice; this is the solution of the smallest sum of squares in
    which no contact pulls at the ground.  If D_g is outside the polygon, some
    share is negative, or, of contacts in a line, the moments do not balance.  Parameters are those
    of `load_corners`.
    """
    return smallest_load(points, pierced, load_corners(points, pierced))


def smallest_load(points: Floats, pierced: Floats, corners: Floats) -> Floats:
    """Return the same as `normal_forces`, with the corners (c, k) of `load_corners` known."""
    balance = np.vstack([np.ones(len(points)), _flat(points, pierced).T])
    if not len(corners):
        # The smallest that balances, pulling allowed.
        wanted = np.array([1.0, *np.zeros(len(balance) - 1)])
        return np.asarray(np.linalg.lstsq(balance, wanted, rcond=None)[0])
    # No load rests on the others: without them D_g is between those that can carry.
    able, shares = corners.any(axis=0), np.zeros(len(points))
    carried = np.empty(int(able.sum()))
    smallest_shares(np.ascontiguousarray(balance[1:, able].T), carried)
    shares[able] = carried
    return shares


def loads_on(points: Floats, pierced: Floats, axle: Axle | None) -> tuple[Floats, Floats]:
    """Return `load_corners` and `normal_forces` of contacts, of which an axle may carry two.

    All forces are along the ray to D_g.  The axle carries at one place, and its two contacts share
    what it does so that it does not turn, see `channels.shares.axle_foot`.
    """
    if axle is None:
        corners = load_corners(points, pierced)
        return corners, smallest_load(points, pierced, corners)
    i, j = axle.ends
    ends = read3(points[i]), read3(points[j])
    found = axle_foot(axle.line, axle.com, axle.mass, ends, read3(pierced))
    foot, shift, (one, two, own) = found
    others = [k for k in range(len(points)) if k not in axle.ends]
    fewer, there = np.vstack([points[others], foot]), pierced + np.array(shift)
    corners = load_corners(fewer, there)
    loads = np.vstack([corners, smallest_load(fewer, there, corners)])
    spread = np.zeros((len(loads), len(points)))
    spread[:, others] = loads[:, :-1]
    spread[:, i], spread[:, j] = loads[:, -1] * one + own, loads[:, -1] * two - own
    return spread[:-1], spread[-1]


def heuristic_forces(points: Floats, pierced: Floats) -> Floats:
    """Return the shares of the paper's Eq 12 without its leading minus, (k,), adding up to 1.

    They do not balance moments: at a tip-over axis they still give the lifting wheel a fifth of
    the weight.  For comparison with the paper only.
    """
    distance = np.linalg.norm(points - pierced, axis=1)
    total = float(distance.sum())
    if total == 0.0:
        return np.full(len(points), 1.0 / len(points))
    return np.asarray((total / (len(points) / 2.0) - distance) / total)


def _flat(points: Floats, pierced: Floats) -> Floats:
    """Return the contacts relative to D_g in their plane (k, 2), in units of their spread."""
    arms = points - pierced
    middle = points - points.mean(axis=0)
    # The plane is that of the contacts and D_g together: contacts in a line have none.
    _, spread, basis = np.linalg.svd(np.vstack([middle, arms]), full_matrices=False)
    if spread[0] == 0.0:
        return np.zeros((len(points), 2))
    plane = basis[:2] if len(basis) > 1 else np.vstack([basis, np.zeros(3)])
    flat = arms @ plane.T
    return np.asarray(flat / np.abs(np.vstack([flat, middle @ plane.T])).max())


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products (n,) of vectors (n, 2) in the plane."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _rows(places: NDArray[np.intp], shares: Floats, k: int) -> Floats:
    """Return loads (n, k) with the shares (n, j) at their places (n, j) and 0 elsewhere."""
    loads = np.zeros((len(places), k))
    np.put_along_axis(loads, places, shares, axis=1)
    return loads
