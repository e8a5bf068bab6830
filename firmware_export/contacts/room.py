"""The room of a pose of many contacts: how many facets, rests, arcs and so on it has.

As much as many postures take, and a margin.  Where a posture needs more, gaps are given up and
without anything else the pose fails: both are safe.
"""

import math
from collections.abc import Callable

import numpy as np

from firmware_export.host import Host
from firmware_export.truth import Model

# The most of each, in the order of the runtime's smap_room_t: facets, edges, rests, corners, gaps,
# arcs; the least, as an array of C has an element; and the margin on what was seen.
LIMITS, LEAST, MARGIN = (80, 250, 60, 154, 50, 254), (1, 3, 1, 3, 0, 3), 1.1
CORNERS, GAPS, ARCS = 3, 4, 5

Room = tuple[int, ...]


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
        In the order of `LIMITS`.  Without a gap in any of these postures none is ever looked for.
    """
    rng = np.random.default_rng(5)
    any_posture = rng.random((6000, model.k))
    even = rng.integers(0, 5, (3000, model.k)) / 4.0
    equal = np.repeat(rng.random((1000, 1)), model.k, axis=1)
    params = model.at(np.concatenate([any_posture, even, equal])).astype(np.float32)
    most = np.maximum(host(LIMITS).room(params).max(axis=0), LEAST)
    most[ARCS] = max(most[ARCS], most[CORNERS])  # where gaps are given up
    return tuple(min(math.ceil(MARGIN * n), limit) for n, limit in zip(most, LIMITS, strict=True))
