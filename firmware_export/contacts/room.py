"""The room of a pose of many contacts: how many facets, walls and so on it has, and its time.

Facets get what many postures need, with a margin, as a pose without room for one fails.  Gaps that
find no room or no time are given up, which is safe: so they get the least with which next to no
direction is answered otherwise, as a few odd postures would make every pose larger and slower.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from firmware_export.host import STANDS, Host
from firmware_export.truth import Model

# The most of each, in the order of the runtime's smap_room_t: facets, edges, facets that are shown,
# walls, links, sides, work on gaps (SMAP_COST_...) and all work; and the margin on what was seen.
LIMITS, MARGIN = (80, 250, 60, 254, 254, 250, 0xFFFF, 0x7FFFFFFF), 1.1
WALLS, LINKS, SIDES, SOUGHT, WORK = 3, 4, 5, 6, 7
# Of the directions in which the robot stands so many may be answered otherwise for want of room (99
# of 100 still are not), and of these which share is spent when, in this order, each is made less.
GIVEN_UP = 0.003
ORDER = {SOUGHT: 0.5, LINKS: 0.8, WALLS: 0.9, SIDES: 1.0}
# Otherwise is: it tips, or the tip angle (rad) is less by more than this.
NOTICED = math.radians(0.02)
DIRECTIONS = 40

Room = tuple[int, ...]


class _Sample:
    """Postures, the directions that each is asked in, and the answers with all room there is.

    Made of what `room_of` is given.
    """

    def __init__(self, model: Model, host: Callable[[Room], Host]) -> None:
        rng = np.random.default_rng(5)
        any_posture = rng.random((3000, model.k))
        even = rng.integers(0, 5, (1500, model.k)) / 4.0
        equal = np.repeat(rng.random((500, 1)), model.k, axis=1)
        kinds = any_posture, even, equal
        self._host = host
        self._params = model.at(np.concatenate(kinds)).astype(np.float32)
        self._starts = np.cumsum([0, *(len(kind) * DIRECTIONS for kind in kinds[:-1])])
        count = len(self._params) * DIRECTIONS
        u, v = rng.uniform(-1.0, 1.0, (2, count)) * model.chart_limit
        gravity = model.uv_to_gravity(rng.integers(0, model.faces, count), u, v)
        self._asked = np.repeat(self._params, DIRECTIONS, axis=0), gravity.astype(np.float32)
        self._stands, self._tip = self._read(LIMITS)

    def _read(self, room: Room) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
        """Return in which directions the robot stands, and the tip angles (rad)."""
        status, reading = self._host(room).read(*self._asked)
        return np.isin(status, STANDS), reading[:, 1].astype(np.float64)

    def taken(self, room: Room) -> NDArray[np.int64]:
        """Return what each posture takes (m, 8) of a room."""
        return self._host(room).room(self._params).astype(np.int64)

    def changed(self, room: Room) -> float:
        """Return in which share of the directions in which it stands a room changes the answer.

        Of any postures, of those at even parts of the axes, or of those whose axes are at the same
        part: the largest of the three.
        """
        stands, tip = self._read(room)
        otherwise = self._stands & (~stands | (self._tip - tip > NOTICED))
        changed, all_of = (np.add.reduceat(one, self._starts) for one in (otherwise, self._stands))
        return float((changed / np.maximum(all_of, 1)).max())


def _with(room: Room, one: int, value: int) -> Room:
    return (*room[:one], value, *room[one + 1 :])


def _least(sample: _Sample, room: Room, one: int, values: NDArray[np.int64], share: float) -> Room:
    """Return a room with the least of ascending values, of which the last will do, for a share."""
    low, high = 0, len(values) - 1
    while low < high:
        middle = (low + high) // 2
        if sample.changed(_with(room, one, int(values[middle]))) <= share:
            high = middle
        else:
            low = middle + 1
    return _with(room, one, int(values[high]))


def room_of(model: Model, host: Callable[[Room], Host]) -> Room:
    """Return the room that a pose needs.

    Parameters
    ----------
    model : Model
        Of a robot on many contacts.
    host : callable
        The C that reads with a room.

    Returns
    -------
    tuple of int
        In the order of `LIMITS`.  The work on gaps is 0 where these hardly change an answer: then
        none is looked for.
    """
    sample = _Sample(model, host)
    found, facets = sample.taken(LIMITS), sample.taken((*LIMITS[:SIDES], 1, 0, LIMITS[WORK]))
    # Of one triangle at least, also for a robot that stands nowhere; an array of C has an element.
    most = np.maximum(facets[:, :SIDES].max(axis=0), (1, 3, 1, 3, 3))
    bare = tuple(min(math.ceil(MARGIN * n), limit) for n, limit in zip(most, LIMITS, strict=False))
    bare = (*bare, 1, 0, LIMITS[WORK])
    room = bare
    if sample.changed(bare) > GIVEN_UP:
        # All that is left of time is never taken.
        found[:, SOUGHT] += 1
        values = {one: np.unique(np.clip(found[:, one], bare[one], LIMITS[one])) for one in ORDER}
        for one in ORDER:
            room = _with(room, one, int(values[one][-1]))
        for one, share in ORDER.items():
            room = _least(sample, room, one, values[one], share * GIVEN_UP)
    work = math.ceil(MARGIN * sample.taken(room)[:, WORK].max()) + 1
    return _with(room, WORK, min(work, LIMITS[WORK]))
