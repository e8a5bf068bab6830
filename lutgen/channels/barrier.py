"""The energy margin: the least height over which the com must be lifted until the robot tips over.

Owns the search for the way on which the com's highest point is least.  A way begins on the facet
on which the robot lies, rolls from facet to facet over the edges between them, with gravity turning
along, comes to no facet twice, and ends over an edge beyond which there is none that counts, or
beyond which the robot is not caught.
"""

import math

from lutgen.jit import njit
from lutgen.support import OVER, Region, Ridges, edges_at, put, roll_over, vector_at
from lutgen.vector import Floats, Ints, Vector, length, subtract

# Ways that are held at once, and ways on which the robot goes on from the same facet.
LABELS, VISITS = 512, 4
# Columns of Ridges.label and of Ridges.way, and what STATE holds.
PEAK, RAISED, SEEN = 0, 1, 2
FACET, BEFORE, STATE = 0, 1, 2
WAITS, GONE_ON, DROPPED = 0, 1, 2
# Two ways to a facet that differ by less than this, in gravity and in parts of a height, are one.
SAME_WAY = 1e-9


@njit(inline=True, bare=True)
def _enter(
    label: Floats,
    way: Ints,
    at: int,
    heights: tuple[float, float],
    g: Vector,
    steps: tuple[int, int],
) -> None:
    label[at, PEAK], label[at, RAISED] = heights
    put(label, at, SEEN, g)
    way[at, FACET], way[at, BEFORE] = steps
    way[at, STATE] = WAITS


@njit(bare=True)
def _adds_nothing(label: Floats, way: Ints, held: int, at: int) -> bool:
    """Tell whether the robot has gone on from a way's facet often enough, or just like that."""
    visits = 0
    for other in range(held):
        if way[other, STATE] == GONE_ON and way[other, FACET] == way[at, FACET]:
            visits += 1
            # It got there over a barrier that was no higher.
            apart = length(subtract(vector_at(label, other, SEEN), vector_at(label, at, SEEN)))
            lower = label[at, RAISED] - label[other, RAISED]
            if apart < SAME_WAY and abs(lower) <= SAME_WAY * (1.0 + abs(label[at, RAISED])):
                return True
    return visits >= VISITS


@njit(inline=True, bare=True)
def _has_been(way: Ints, at: int, k: int) -> bool:
    """Tell whether a way has come to facet k."""
    while at >= 0:
        if way[at, FACET] == k:
            return True
        at = way[at, BEFORE]
    return False


@njit(bare=True)
def barrier(region: Region, ridges: Ridges, k: int, g: Vector) -> float:
    """Return the least rise of the com (length) on any way of rolling that ends in tipping over.

    The robot lies on facet k under the unit direction g.  Ways are gone on in the order of their
    highest points, from each facet by the first `VISITS` of them: on level ground all ways to a
    facet see the same gravity, and more than one is only for slopes.  Infinity where no way ends.
    """
    span, label, way = region.span, ridges.label, ridges.way
    _enter(label, way, 0, (0.0, 0.0), g, (k, -1))
    held, best = 1, math.inf
    while True:
        at, lowest = -1, best
        for other in range(held):
            if way[other, STATE] == WAITS and label[other, PEAK] < lowest:
                at, lowest = other, label[other, PEAK]
        if at < 0:
            return best
        if _adds_nothing(label, way, held, at):
            way[at, STATE] = DROPPED
            continue
        way[at, STATE] = GONE_ON
        here, raised, down = way[at, FACET], label[at, RAISED], vector_at(label, at, SEEN)
        for e in range(*edges_at(span, here)):
            beyond, most, last, seen = roll_over(ridges.ridge, ridges.beyond, ridges.arc, e, down)
            peak = max(lowest, raised + most)
            if beyond == OVER:
                best = min(best, peak)
            elif peak < best and not _has_been(way, at, beyond):
                if held == label.shape[0]:
                    # More ways than there is room for: none of them gets by below this.
                    return min(best, lowest)
                _enter(label, way, held, (peak, raised + last), seen, (beyond, at))
                held += 1
