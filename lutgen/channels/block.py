"""A convex standing region under a block of directions, pass by pass.

Owns the fast way to the channels where there are many directions for a posture: the coordinates of
a block lie side by side, each pass goes over all of them with one plane, and the compiler makes
vector instructions of it.  The numbers are those of `plain.measure` to the last bit.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.angles import JUST_OUTSIDE, signed_angle
from lutgen.channels.plain import axis_energy, axis_margin, least_barrier
from lutgen.jit import njit
from lutgen.support import (
    ON_AXIS,
    STANDS,
    TIPS,
    Region,
    Ridges,
    facets_in,
    first_axis_at,
    gaps_in,
    has_ridges,
    height_at,
    is_convex,
    plane_at,
    second_axis_at,
    segments_in,
    start_at,
    stop_at,
    tip_plane_at,
)
from lutgen.vector import Bools, Floats, Ints, Vector, dot

# Directions of a block: its arrays stay in the nearest cache, 2 KB each.
BLOCK = 256
# For fewer directions `plain.measure` is faster.
FEWEST = 3
# Channels that `measure_block` fills; whoever wants a later one gets all node by node.
KNOWN = 7


class Block(NamedTuple):
    """Room for a block: its directions' coordinates, and what is known of each.

    `numbers` (6, BLOCK): x; y; z; the largest (n/h) . g; the least m . g over the tip-over planes;
    the least margin or rise.  `first` (BLOCK,): the facet whose plane is pierced first, or -1.
    """

    numbers: NDArray[np.float64]
    first: NDArray[np.int64]


class Directions(NamedTuple):
    """Unit directions of gravity side by side, body frame; each (d,)."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    z: NDArray[np.float64]


@njit()
def empty_block() -> Block:
    """Return room for a block of directions."""
    return Block(np.empty((6, BLOCK)), np.empty(BLOCK, np.int64))


@njit(inline=True)
def worth_blocks(tally: Ints, wanted: Bools, directions: int) -> bool:
    """Tell whether a region's wanted channels can be measured in blocks, and faster so."""
    fits = is_convex(tally) and gaps_in(tally) == 0 and directions >= FEWEST
    # A method of the array would load numba's linear algebra with the machine code.
    for c in range(KNOWN, wanted.shape[0]):
        fits = fits and not wanted[c]
    return fits


@njit(bare=True)
def _take(given: Floats, directions: Directions) -> None:
    x, y, z = directions
    for i in range(np.uint64(given.shape[0])):
        x[i], y[i], z[i] = given[i, 0], given[i, 1], given[i, 2]


@njit(bare=True)
def _pierce(plane: Vector, k: int, directions: Directions, rate: Floats, first: Ints) -> None:
    """Let facet k take the directions whose ray pierces its plane before those of lower facets.

    The rule for ties is that of `support.supporting_facet`.
    """
    x, y, z = directions
    for i in range(np.uint64(x.shape[0])):
        here = dot(plane, (x[i], y[i], z[i]))
        sooner = here > rate[i] * (1.0 + 1e-12)
        rate[i] = here if sooner else rate[i]
        first[i] = k if sooner else first[i]


@njit(bare=True)
def _lower(plane: Vector, directions: Directions, lowest: Floats) -> None:
    x, y, z = directions
    for i in range(np.uint64(x.shape[0])):
        lowest[i] = min(lowest[i], dot(plane, (x[i], y[i], z[i])))


@njit(inline=True)
def _stands(first: int, lowest: float) -> bool:
    standing: bool = (first >= 0) & (lowest >= -ON_AXIS)
    return standing


@njit(bare=True)
def _factors(
    facet: Floats, directions: Directions, rate: Floats, first: Ints, lowest: Floats, out: Floats
) -> None:
    """Fill `out` with |SD_g|, NaN where the robot does not stand."""
    x, y, z = directions
    for i in range(np.uint64(out.shape[0])):
        k, g = max(first[i], 0), (x[i], y[i], z[i])
        along = dot(first_axis_at(facet, k), g)
        aside = dot(second_axis_at(facet, k), g)
        factor = math.sqrt(along * along + aside * aside) / rate[i]
        out[i] = factor if _stands(first[i], lowest[i]) else math.nan


@njit(bare=True)
def _heights(facet: Floats, first: Ints, lowest: Floats, out: Floats) -> None:
    for i in range(out.shape[0]):
        out[i] = height_at(facet, first[i]) if _stands(first[i], lowest[i]) else math.nan


@njit(bare=True)
def _angles(first: Ints, lowest: Floats, out: Floats) -> None:
    for i in range(np.uint64(out.shape[0])):
        out[i] = signed_angle(lowest[i], _stands(first[i], lowest[i]))


@njit(bare=True)
def _nearer(
    start: Vector, stop: Vector, plane: Vector, directions: Directions, least: Floats
) -> None:
    """Lower `least` to the margin of one axis."""
    x, y, z = directions
    for i in range(np.uint64(x.shape[0])):
        least[i] = min(least[i], axis_margin(start, stop, plane, True, (x[i], y[i], z[i])))


@njit(bare=True)
def _easier(
    start: Vector, stop: Vector, plane: Vector, directions: Directions, least: Floats
) -> None:
    """Lower `least` to the rise of the com over one axis."""
    x, y, z = directions
    for i in range(np.uint64(x.shape[0])):
        least[i] = min(least[i], axis_energy(start, stop, plane, (x[i], y[i], z[i])))


@njit(bare=True)
def _barriers(
    region: Region,
    ridges: Ridges,
    directions: Directions,
    first: Ints,
    lowest: Floats,
    least: Floats,
) -> None:
    """Put the least barrier for the least rise where the robot stands and may roll."""
    x, y, z = directions
    for i in range(x.shape[0]):
        if _stands(first[i], lowest[i]):
            least[i] = least_barrier(region, ridges, first[i], (x[i], y[i], z[i]), least[i])


@njit(bare=True)
def _margins(least: Floats, first: Ints, lowest: Floats, out: Floats) -> None:
    """Give a margin the sign of the verdict."""
    for i in range(np.uint64(out.shape[0])):
        standing = _stands(first[i], lowest[i])
        out[i] = max(least[i], 0.0) if standing else min(least[i], JUST_OUTSIDE)


@njit()
def measure_block(
    region: Region,
    ridges: Ridges,
    given: Floats,
    room: Block,
    places: Ints,
    at: tuple[int, int],
    out: Floats,
) -> None:
    """Fill out[:, m, d:], (m, d) = `at`, with the channels of at most BLOCK directions (d, 3).

    `places`: the row of each channel in `out`, or -1 where it is not wanted.
    """
    facet, segment, tally = region.facet, region.segment, region.tally
    facets, segments, count = facets_in(tally), segments_in(tally), given.shape[0]
    posture, begin = at
    here = slice(begin, begin + count)
    numbers, first = room.numbers, room.first[:count]
    directions = Directions(numbers[0, :count], numbers[1, :count], numbers[2, :count])
    rate, lowest, least = numbers[3, :count], numbers[4, :count], numbers[5, :count]
    _take(given, directions)
    rate[:], first[:], lowest[:] = 0.0, -1, 2.0
    for k in range(facets):
        _pierce(plane_at(facet, k), k, directions, rate, first)
    for b in range(segments):
        _lower(tip_plane_at(segment, b), directions, lowest)
    if places[0] >= 0:
        _factors(facet, directions, rate, first, lowest, out[places[0], posture, here])
    if places[1] >= 0:
        _heights(facet, first, lowest, out[places[1], posture, here])
    if places[2] >= 0:
        target = out[places[2], posture, here]
        if facets == 0:
            target[:] = -math.pi
        elif segments == 0:
            target[:] = math.pi
        else:
            _angles(first, lowest, target)
    for c in range(3, 5):
        if places[c] >= 0:
            least[:] = math.inf if facets > 0 else -math.inf
            for b in range(segments):
                start, stop = start_at(segment, b), stop_at(segment, b)
                plane = tip_plane_at(segment, b)
                if c == 3:
                    _nearer(start, stop, plane, directions, least)
                else:
                    _easier(start, stop, plane, directions, least)
            if c == 4 and has_ridges(tally):
                _barriers(region, ridges, directions, first, lowest, least)
            _margins(least, first, lowest, out[places[c], posture, here])
    if places[5] >= 0:
        for i in range(count):
            out[places[5], posture, begin + i] = first[i] if _stands(first[i], lowest[i]) else -1.0
    if places[6] >= 0:
        for i in range(count):
            out[places[6], posture, begin + i] = STANDS if _stands(first[i], lowest[i]) else TIPS
