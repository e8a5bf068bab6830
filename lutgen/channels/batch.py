"""The loop over postures and over the directions of each, on as many threads as that is worth.

Owns the one kernel through which measurements in float64 go.  A measurement can also continue the
stability factor to where the robot tips, because a table's nodes there must hold something smooth
and a search that starts there must find its way out.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from lutgen.channels.axes import MU, PHI, add, empty_axes, find_axes, part
from lutgen.channels.block import BLOCK, empty_block, measure_block, worth_blocks
from lutgen.channels.loaded import measure_loaded
from lutgen.channels.plain import (
    HEIGHT_BEYOND,
    Setting,
    find_wanted_ridges,
    go_beyond,
    measure,
    room_for_ridges,
)
from lutgen.channels.wrench import wrenches
from lutgen.errors import InputError
from lutgen.jit import in_threads, njit
from lutgen.quantities import CHANNELS
from lutgen.recipe import Postures, Recipe, radii_and_kinds
from lutgen.support import empty_region, facet_table, pack, stand
from lutgen.vector import Floats, length, row

# Pieces of work for a thread: this many directions of one posture.
STRETCH = 2048
# A thread is worth waking for this many postures, half a millisecond of work for a few contacts.
POSTURES_A_THREAD = 256
# Measuring this many directions takes as long as finding the facets of a posture: in blocks, which
# fit where nothing is limited and nothing pulls, and where that is not known beforehand.
IN_BLOCKS, OTHERWISE = 256, 64
ROWS = HEIGHT_BEYOND + 1
Rows = dict[int, NDArray[np.float64]]


@njit()
def measure_some(
    begin: int,
    end: int,
    primitives: Floats,
    wrench: Floats | None,
    gravity_dir: Floats,
    setting: Setting,
    out: Floats,
) -> int:
    """Measure stretches [begin, end), which count through the directions of posture after posture.

    Parameters as in `measure_postures`; `out` (rows, m, d) has a row for each wanted channel, and
    three more for what is beyond the standing region, if that is wanted as well.  Returns how many
    of the postures that begin there have more facets than a table holds.  Compiled apart for the
    weight alone, where `wrench` is None: whoever needs no forces does not wait for their machine
    code.
    """
    acceptance, wanted = setting
    n, count = primitives.shape[1], gravity_dir.shape[1]
    per_posture = (count + STRETCH - 1) // STRETCH
    table, region, ridges = facet_table(n), empty_region(n), room_for_ridges(n, wanted)
    if wrench is not None:
        axes = empty_axes(region)
    room, values, places = empty_block(), np.empty(ROWS), np.empty(ROWS, np.int64)
    held = 0
    for c in range(len(CHANNELS)):
        places[c] = held if wanted[c] else -1
        held += wanted[c]
    current, overflow = -1, 0
    for piece in range(begin, end):
        posture, first = piece // per_posture, piece % per_posture * STRETCH
        if posture != current:
            current = posture
            too_many = stand(table, region, primitives[posture], acceptance)
            overflow += too_many if first == 0 else 0
            if wrench is None:
                find_wanted_ridges(ridges, table, region, primitives[posture], wanted)
            else:
                find_axes(region, wrench[posture], axes)
        directions = gravity_dir[posture % gravity_dir.shape[0], first : first + STRETCH]
        if wrench is None and worth_blocks(region.tally, wanted, directions.shape[0]):
            for at in range(0, directions.shape[0], BLOCK):
                some = directions[at : at + BLOCK]
                measure_block(region, ridges, some, room, places, (posture, first + at), out)
        else:
            for d in range(directions.shape[0]):
                g = row(directions, d)
                if wrench is None:
                    measure(region, ridges, g, wanted, values)
                else:
                    measure_loaded(region, axes, wrench[posture], g, wanted, values)
                for c in range(len(CHANNELS)):
                    if wanted[c]:
                        out[places[c], posture, first + d] = values[c]
        if out.shape[0] > held:
            for d in range(directions.shape[0]):
                force, known = row(directions, d), True
                if wrench is not None:
                    force = add(force, part(wrench[posture], PHI))
                    known = length(part(wrench[posture], MU)) == 0.0
                go_beyond(region, force, known, values)
                for c in range(ROWS - len(CHANNELS)):
                    out[held + c, posture, first + d] = values[len(CHANNELS) + c]
    return overflow


def measure_postures(
    primitives: Floats,
    wrench: Floats | None,
    gravity_dir: Floats,
    setting: Setting,
    beyond: bool = False,
) -> tuple[Rows, int]:
    """Measure m postures under d directions; count those with too many facets.

    `primitives` (m, n, 8) are rows of `primitive.pack`, `wrench` (m, 7) those of `wrench.wrenches`,
    or None for the weight alone, which is faster; the unit directions (m, d, 3) or (1, d, 3) point
    down.  The answer holds (m, d) for the index of each wanted channel; with `beyond` also for
    ALONG, ASIDE and HEIGHT_BEYOND: the in-plane components of D_g - s on the facet whose plane
    gravity pierces first, and its height, NaN where no accepted facet's plane is pierced, and under
    a moment.
    """
    names = [c for c, asked in enumerate(setting.wanted.tolist()) if asked]
    names += range(len(CHANNELS), ROWS) if beyond else ()
    # No row that nobody wants: memory that is touched first takes longer than what fills it.
    out = np.empty((len(names), len(primitives), gravity_dir.shape[1]))
    stretches = -(-gravity_dir.shape[1] // STRETCH)
    # A limit that is none is below every cosine, and above every angle.
    free = setting.acceptance.steepest < -1.0 and setting.acceptance.rock_angle == math.inf
    a_posture = IN_BLOCKS if wrench is None and free else OTHERWISE
    least = max(POSTURES_A_THREAD // (1 + min(gravity_dir.shape[1], STRETCH) // a_posture), 1)
    arguments = (primitives, wrench, np.ascontiguousarray(gravity_dir), setting, out)
    overflow = in_threads(measure_some, len(primitives) * stretches, *arguments, least=least)
    return dict(zip(names, out, strict=True)), overflow


def refuse_overflow(source: str, overflow: int, postures: int, contacts: int) -> None:
    """Raise InputError where facet tables of `overflow` postures were too small."""
    if overflow:
        raise InputError(
            f"{source}: a posture has more support facets than its {contacts} contacts can have "
            f"(got it in {overflow} of {postures} postures); check the radii for overlapping "
            "spheres"
        )


def for_each_posture(
    kernel: Callable[..., int], recipe: Recipe, postures: Postures, *arguments: object
) -> None:
    """Call ``kernel(begin, end, primitives, wrench, *arguments)`` on parts of a recipe's postures.

    It returns how many of [begin, end) have more facets than a table holds, which none may have.
    """
    primitives = pack(postures.centres, postures.axes, *radii_and_kinds(recipe))
    everything = (primitives, wrenches(recipe, postures), *arguments)
    overflow = in_threads(kernel, len(primitives), *everything, least=POSTURES_A_THREAD)
    refuse_overflow(recipe.source, overflow, *primitives.shape[:2])
