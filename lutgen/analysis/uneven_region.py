"""The centres of mass that contacts can hold: a convex region, seen along gravity.

Owns the region's refinement from outside questions, and the distance to its boundary.  Lengths are
over the scene's size.
"""

import numpy as np

from lutgen.analysis.balance import BOX, MISSING, Balance
from lutgen.vector import Floats

# The region is refined until no side can be moved out by more, of its diameter.
GAP = 1e-4
# Lengths below it, of the size or the diameter, are none: a farthest com is known to about the
# solver's accuracy of 1e-9, times as much as a com moves with a wrench in flat scenes.
SAME = 1e-6
# A round region takes some 200 corners to GAP; where rounding keeps finding more, there is an end.
MOST_CORNERS = 1000


def region_of(balance: Balance) -> Floats:
    """Return the corners (k, 2) of the com positions that hold, over the size.

    Between two corners the farthest com beyond their side is asked for, and is a new corner, until
    there is none (Bretl and Lall, Section IV).
    """
    missing, *start = balance.missing(None)
    if not missing <= MISSING:
        return np.empty((0, 2))

    def farthest(x: float, y: float) -> Floats:
        return balance.farthest(np.array([x, y]), (start[0], start[1]))

    ends = [farthest(x, y) for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))]
    apart = [
        (float(np.linalg.norm(a - b)), i, j)
        for i, a in enumerate(ends)
        for j, b in enumerate(ends[:i])
    ]
    diameter, i, j = max(apart)
    if diameter <= SAME:
        return ends[0][None]
    corners = [ends[i], ends[j]]
    at = 0
    while at < len(corners) < MOST_CORNERS:
        here, there = corners[at], corners[(at + 1) % len(corners)]
        x, y = (there - here) / np.linalg.norm(there - here)
        # To the right of a side, the corners being counter-clockwise.
        found = farthest(y, -x)
        if (found - here) @ (y, -x) > GAP * diameter:
            corners.insert(at + 1, found)
            diameter = max(diameter, *(float(np.linalg.norm(found - one)) for one in corners))
        else:
            at += 1
    return _without_straight(np.array(corners), SAME * diameter)


def _without_straight(corners: Floats, least: float) -> Floats:
    """Return the corners of a polygon without those that stand out by less than a length."""
    at = 0
    while len(corners) > 2 and at < len(corners):
        before, here, after = corners[[at - 1, at, (at + 1) % len(corners)]]
        side = after - before
        arm = here - before
        long = float(np.linalg.norm(side))
        if long <= least or abs(side[0] * arm[1] - side[1] * arm[0]) <= least * long:
            corners = np.delete(corners, at, axis=0)
            at = max(at - 1, 0)
        else:
            at += 1
    return corners


def reaches_the_box(region: Floats) -> bool:
    """Tell whether a region ends only where the search for it does."""
    return bool((np.abs(region) > BOX * (1.0 - SAME)).any())


def margin_in(region: Floats, com: Floats) -> float:
    """Return the signed distance of a com (2,) from a region's boundary, over the size.

    The ends of the search are no boundary for a com within.
    """
    if not len(region):
        return -np.inf
    ends = np.roll(region, -1, axis=0)
    sides, arms = ends - region, com - region
    squares = np.einsum("ki,ki->k", sides, sides)
    share = np.einsum("ki,ki->k", arms, sides) / np.where(squares > 0.0, squares, 1.0)
    distance = np.linalg.norm(arms - np.clip(share, 0.0, 1.0)[:, None] * sides, axis=1)
    left = sides[:, 0] * arms[:, 1] - sides[:, 1] * arms[:, 0]
    if len(region) < 3:
        away = float(distance.min())
        return 0.0 if away <= SAME else -away
    if (left < 0.0).any():
        return -float(distance.min())
    limit = BOX * (1.0 - SAME)
    true = ~((np.abs(region) > limit) & (np.abs(ends) > limit)).any(axis=1)
    return float(distance[true].min(initial=np.inf))
