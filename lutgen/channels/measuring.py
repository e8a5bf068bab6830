"""Postures under directions of gravity: the kernel that finds where each stands, and measures."""

import threading
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Floats, Ints
from lutgen.channels.axes import Axes, Wrench, empty_axes, find_axes
from lutgen.channels.exact import NO_GROUPS, SHARE, Setting, measure
from lutgen.channels.loads import measure_loaded
from lutgen.channels.resting import CONVENTIONS, settled
from lutgen.channels.shares import least_share
from lutgen.errors import InputError
from lutgen.jit import in_threads, njit
from lutgen.parts import ZERO
from lutgen.quantities import CHANNELS, wanted
from lutgen.support import Acceptance, Region, empty_region, stand
from lutgen.vector import add, read3, row, write3

# Directions of one posture are measured in stretches of this many: a thread takes some of them.
STRETCH = 1024
# A thread is worth its waking for this many postures, half a millisecond of work for a few
# contacts; finding the facets of one takes as long as measuring this many directions.
POSTURES_A_THREAD, DIRECTIONS_A_POSTURE = 256, 64
NOTHING = np.zeros(len(CHANNELS), np.bool_)
_OWN = threading.local()


class Memory(NamedTuple):
    """What the kernels of one thread write: the region of a posture, its axes, and channels."""

    region: Region
    axes: Axes
    values: Floats


def own_memory() -> Memory:
    """Return the memory of this thread; one that is new takes longer than a posture."""
    if not hasattr(_OWN, "memory"):
        _OWN.memory = Memory(empty_region(), empty_axes(), np.empty(len(CHANNELS)))
    memory: Memory = _OWN.memory
    return memory


@njit(bare=True)
def measure_some(
    span: tuple[int, int],
    memory: Memory,
    primitives: Floats,
    wrench: NDArray[Wrench] | None,
    gravity_dir: Floats,
    setting: Setting,
    out: Floats,
) -> None:
    """Measure a span of stretches, which count through the directions of posture after posture.

    Parameters as in `measure_postures`; `out` (channels, m, d) has a row for each wanted channel.
    Compiled apart for the weight alone, where `wrench` is None.
    """
    (region, axes, values), (accept, wanted, groups, plane) = memory, setting
    count = gravity_dir.shape[1]
    per_posture = (count + STRETCH - 1) // STRETCH
    current, phi, mu = -1, ZERO, ZERO
    for piece in range(span[0], span[1]):
        posture, first = piece // per_posture, piece % per_posture * STRETCH
        if posture != current:
            current = posture
            stand(region, primitives[posture], accept)
            if wrench is not None:
                find_axes(region, wrench[posture], axes)
                phi, mu = read3(wrench[posture].phi), read3(wrench[posture].mu)
        directions = gravity_dir[posture % gravity_dir.shape[0]]
        for d in range(first, min(first + STRETCH, count)):
            g = row(directions, d)
            if plane:
                g = settled(region, phi, mu, g)
                write3(directions[d], g)
            if wrench is None:
                measure(region, g, wanted, values)
            else:
                measure_loaded(region, axes, wrench[posture], g, wanted, values)
            if wanted[SHARE]:
                values[SHARE] = least_share(region, values, add(g, phi), mu, groups)
            place = 0
            for c in range(len(CHANNELS)):
                if wanted[c]:
                    out[place, posture, d] = values[c]
                    place += 1


def measure_postures(
    primitives: Floats,
    gravity_dir: Floats,
    channels: Sequence[str],
    limits: Acceptance,
    wrench: NDArray[Wrench] | None = None,
    groups: Ints = NO_GROUPS,
    convention: str = "body",
) -> dict[str, NDArray[np.float64]]:
    """Return the channels (m, d) of m postures under d directions.

    `primitives` (m, n, 8) are rows of `primitive.pack`, relative to the com, `wrench` (m,) those
    of `evaluation.wrenches`, or None for the weight alone, which is faster; the unit directions
    (m, d, 3) or (1, d, 3) point down; `limits` are of `support.acceptance`, and `groups` (n,) those
    of `shares.least_share`.  Directions (m, d, 3) of the `convention` "plane" are turned into the
    body in place, if they are a writeable C-contiguous array.
    """
    if convention not in CONVENTIONS:
        raise InputError(f"unknown convention {convention!r}; choose from {', '.join(CONVENTIONS)}")
    setting = Setting(limits, np.array(wanted(channels)), groups, convention == "plane")
    # No row that is not wanted: memory that is touched first takes longer than what fills it.
    out = np.empty((setting.wanted.sum(), len(primitives), gravity_dir.shape[1]))
    stretches = -(-gravity_dir.shape[1] // STRETCH)
    work = 1 + min(gravity_dir.shape[1], STRETCH) // DIRECTIONS_A_POSTURE
    arguments = (primitives, wrench, np.require(gravity_dir, None, ["C", "W"]), setting, out)
    least = max(POSTURES_A_THREAD // work, 1)
    in_threads(measure_some, len(primitives) * stretches, own_memory, *arguments, least=least)
    found = dict(zip(np.array(CHANNELS)[setting.wanted].tolist(), out, strict=True))
    return {name: found[name] for name in channels}


def region_of(primitives: Floats, limits: Acceptance) -> Region:
    """Return the region of one posture (n, 8)."""
    memory, setting = own_memory()._replace(region=empty_region()), Setting(limits, NOTHING)
    down, out = np.zeros((1, 1, 3)), np.empty((0, 1, 1))
    measure_some((0, 1), memory, primitives[None], None, down, setting, out)
    return memory.region
