"""The energy margin: the least height over which the com must be lifted until the robot tips over.

Owns the search for the way on which the com's highest point is least.  A way begins on the facet
on which the robot lies, rolls from facet to facet over the edges between them, with gravity turning
along, comes to no facet twice, and ends over an edge beyond which there is none that counts, or
beyond which the robot is not caught.
"""

import math

from lutgen.jit import njit
from lutgen.support import FIRST, OVER, Region, Ridges, roll_over
from lutgen.vector import Vector, length, subtract

# Ways that are held at once, and ways on which the robot goes on from the same facet.
LABELS, VISITS = 512, 4
PEAK, RAISED, SEEN_FROM = 0, 1, 2
FACET, BEFORE, GONE_ON = 0, 1, 2
# Two ways to a facet that differ by less than this, in gravity and in parts of a height, are one.
SAME_WAY = 1e-9


@njit(inline=True)
def _enter(ridges: Ridges, at: int, peak: float, raised: float, g: Vector, k: int, by: int) -> None:
    label, way = ridges.label, ridges.way
    label[at, PEAK], label[at, RAISED] = peak, raised
    label[at, SEEN_FROM], label[at, SEEN_FROM + 1], label[at, SEEN_FROM + 2] = g
    way[at, FACET], way[at, BEFORE], way[at, GONE_ON] = k, by, 0


@njit(inline=True)
def _seen(ridges: Ridges, at: int) -> Vector:
    label = ridges.label
    return label[at, SEEN_FROM], label[at, SEEN_FROM + 1], label[at, SEEN_FROM + 2]


@njit()
def _adds_nothing(ridges: Ridges, held: int, at: int) -> bool:
    """Tell whether the robot has gone on from a way's facet often enough, or just like that."""
    label, way = ridges.label, ridges.way
    visits = 0
    for other in range(held):
        if way[other, GONE_ON] == 1 and way[other, FACET] == way[at, FACET]:
            visits += 1
            # It got there over a barrier that was no higher.
            apart = length(subtract(_seen(ridges, other), _seen(ridges, at)))
            lower = label[at, RAISED] - label[other, RAISED]
            if apart < SAME_WAY and abs(lower) <= SAME_WAY * (1.0 + abs(label[at, RAISED])):
                return True
    return visits >= VISITS


@njit(inline=True)
def _has_been(ridges: Ridges, at: int, k: int) -> bool:
    """Tell whether a way has come to facet k."""
    while at >= 0:
        if ridges.way[at, FACET] == k:
            return True
        at = ridges.way[at, BEFORE]
    return False


@njit()
def barrier(region: Region, ridges: Ridges, k: int, g: Vector) -> float:
    """Return the least rise of the com (length) on any way of rolling that ends in tipping over.

    The robot lies on facet k under the unit direction g.  Ways are gone on in the order of their
    highest points, from each facet by the first `VISITS` of them: on level ground all ways to a
    facet see the same gravity, and more than one is only for slopes.  Infinity where no way ends.
    """
    label, way = ridges.label, ridges.way
    _enter(ridges, 0, 0.0, 0.0, g, k, -1)
    held, best = 1, math.inf
    while True:
        at, lowest = -1, best
        for other in range(held):
            if way[other, GONE_ON] == 0 and label[other, PEAK] < lowest:
                at, lowest = other, label[other, PEAK]
        if at < 0:
            return best
        repeats = _adds_nothing(ridges, held, at)
        way[at, GONE_ON] = 2 if repeats else 1
        if repeats:
            continue
        here, raised, down = way[at, FACET], label[at, RAISED], _seen(ridges, at)
        begin, end = region.span[here, FIRST], region.span[here + 1, FIRST]
        for e in range(begin, end):
            following = e + 1 if e + 1 < end else begin
            beyond, most, last, seen = roll_over(region, ridges, e, following, down)
            peak = max(lowest, raised + most)
            if beyond == OVER:
                best = min(best, peak)
            elif peak < best and not _has_been(ridges, at, beyond):
                if held == label.shape[0]:
                    # More ways than there is room for: none of them gets by below this.
                    return min(best, lowest)
                _enter(ridges, held, peak, raised + last, seen, beyond, at)
                held += 1
