"""The room of a pose of many contacts: the most rests, corners, gaps and arcs that it can hold.

Postures are counted, and a margin is added.  A posture that needs more loses gaps or rests, and
without room for an arc of the boundary the pose fails: all of that is safe.
"""

import math
from typing import NamedTuple

import numpy as np

from firmware_export.host import Host
from firmware_export.truth import Model

MARGIN = 1.1
# The ends of gaps are numbered with 8 bits, and corners come before them.
MOST_PLACES = 100


class Room(NamedTuple):
    """The most of each, in the order of the enum in runtime/smap_region.h."""

    rests: int
    corners: int
    gaps: int
    arcs: int
    facets: int


# What the host has room for, and the least that an array of C can have.
LIMITS, LEAST = Room(60, 154, 50, 254, 250), Room(1, 3, 1, 3, 1)


def room_of(model: Model, host: Host) -> Room:
    """Return the room that a pose needs; `host` reads with LIMITS."""
    rng = np.random.default_rng(5)
    any_posture = rng.random((3500, model.k))
    even = rng.integers(0, 5, (1000, model.k)) / 4.0
    equal = np.repeat(rng.random((500, 1)), model.k, axis=1)
    params = model.at(np.concatenate([any_posture, even, equal])).astype(np.float32)
    most = np.maximum(host.room(params), LEAST)
    return Room(*(min(math.ceil(MARGIN * n), most) for n, most in zip(most, LIMITS, strict=True)))


def pose_words(room: Room, contacts: int, discs: int) -> tuple[int, int, int]:
    """Return the words of 32 bits of poses beside an address; NAME.c asserts that they suffice.

    With both forms, with integers alone, and of the region that on-board control keeps beside
    (runtime/smap_pose.h, smap_region.h, smap_reading_i.h).  Addresses have up to 8 bytes.
    """
    vectors = 2 * room.corners + 2 * room.gaps + min(4 * room.gaps, MOST_PLACES)
    layout = 6 + 4 * room.rests + 4 * room.gaps + 5 * room.arcs
    region = 4 * (1 + 7 * room.rests + 3 * vectors)
    floats = 4 * contacts + 3 * max(discs, 1) + 3 * room.rests
    work = 24 + 4 * floats + (contacts if discs else 1) + 6 * room.corners + room.rests + 8
    whole = 6 + 14 * room.rests + 6 * vectors
    both = 4 + layout + 3 + region + 4 + max(work, whole + 2)
    return -(-both // 4), -(-(4 + layout + whole + 4) // 4), -(-(layout + 3 + region + 4) // 4)
