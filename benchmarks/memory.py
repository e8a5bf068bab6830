"""Speed of what is computed: sweeps into memory, facets of one posture, and many directions."""

from collections.abc import Callable, Iterator
from functools import partial
from math import radians
from pathlib import Path

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.cases import DISC, KIND_NAMES, POINT, SPHERE, Case, point_shapes, wheel_shapes
from benchmarks.references import Loop, by_numpy, fill, planes, tip_over_axes
from benchmarks.rows import Row, interleave
from lutgen.channels.evaluation import stability
from lutgen.channels.exact import Setting
from lutgen.channels.rows import nodes_of
from lutgen.channels.scan import scan
from lutgen.chart import Chart, unit_directions
from lutgen.jit import njit
from lutgen.quantities import CHANNELS, wanted
from lutgen.support import Acceptance, Region, acceptance, empty_region, stand
from lutgen.vector import Floats

# 64 MiB of float32 for each channel, more than the caches hold.
NODES, C_NODES, NUMPY_NODES = 1 << 24, 1 << 21, 1 << 18
SWEPT = (Case("ground", 3), Case("ground", 4), Case("inside", 8), Case("ground", 8))
# How much longer than a fill of memory a sweep of |SD_g| may take, by the number of contacts.
FILLS = {3: 2.0, 8: 4.0}
LIMITS = (radians(90.0), radians(30.0))
DIRECTIONS = 100_000
# The largest difference from a reference, relative.
AGREE = 1e-5


def sweep_run(
    primitives: Floats, chart: Chart, channels: tuple[str, ...], angles: tuple[float, float] | None
) -> tuple[Callable[[], None], NDArray[np.float32]]:
    """Return a sweep over postures (m, n, 8) into one array, and that array."""
    accept = acceptance(*(angles or (None, None)))
    setting, rows = Setting(accept, np.array(wanted(channels))), chart.faces * chart.nodes
    out = np.full((len(CHANNELS), len(primitives) * rows * chart.nodes), np.nan, np.float32)
    return partial(scan, primitives, setting, nodes_of(chart), out), out


def sweeps(folder: Path, nodes: int = NODES) -> Iterator[Row]:
    """Hold sweeps into memory against the fill, C and NumPy, with one thread; then two."""
    loop, chart = Loop(folder), Chart("sphere", 129)
    upright = chart.directions().reshape(-1, 3)
    count = len(upright)
    for case, angles in [(case, None) for case in SWEPT] + [(SWEPT[-1], LIMITS)]:
        name = f"{case.contacts} {case.stance}{', limits 90/30' if angles else ''}"
        primitives = point_shapes(case, -(-nodes // count))
        sdg, values = sweep_run(primitives, chart, ("sdg",), angles)
        both, _ = sweep_run(primitives, chart, ("sdg", "tip_angle"), angles)
        accept = acceptance(*(angles or (None, None)))
        for_c = planes(primitives[: C_NODES // count], accept)
        for_numpy = planes(primitives[: max(NUMPY_NODES // count, 1)], accept)
        by_c = np.zeros((len(for_c.counts), count), np.float32)
        numpy_out = np.zeros((len(for_numpy.counts), count), np.float32)
        buffer = np.zeros(nodes, np.float32)
        numba.set_num_threads(1)
        times = interleave(
            sdg,
            both,
            partial(fill, buffer, np.float32(1.5)),
            partial(loop.sdg, for_c, upright, by_c),
            partial(by_numpy, for_numpy, np.ascontiguousarray(upright.T), numpy_out),
        )
        sizes = (len(primitives) * count,) * 2 + (nodes, by_c.size, numpy_out.size)
        a, b, filled, c, vectorised = (t / size for t, size in zip(times, sizes, strict=True))
        ours = values[CHANNELS.index("sdg")]
        for theirs in (by_c, numpy_out):
            agree(ours[: theirs.size], theirs.ravel())
        yield Row(
            f"{name}: sdg", 1, a, "fill", filled, None if angles else FILLS.get(case.contacts)
        )
        yield Row(f"{name}: sdg", 1, a, "C loop", c, 1.0)
        yield Row(f"{name}: sdg", 1, a, "NumPy", vectorised, 0.01 if case.contacts > 3 else None)
        yield Row(f"{name}: sdg + tip_angle", 1, b, "sdg", a, 4.0 if angles else 2.5)
        if numba.config.NUMBA_NUM_THREADS > 1:
            numba.set_num_threads(2)
            (two,) = interleave(both)
            yield Row(f"{name}: sdg + tip_angle", 2, two / sizes[0], "one thread", b, 1.0 / 1.7)


def agree(ours: NDArray[np.floating], theirs: NDArray[np.floating]) -> None:
    """End the run where numbers differ from those of a reference."""
    with np.errstate(invalid="ignore"):
        off = np.abs(ours - theirs) / np.maximum(np.abs(theirs), 1.0)
    if (np.isnan(ours) != np.isnan(theirs)).any() or np.nanmax(off, initial=0.0) > AGREE:
        raise SystemExit(f"ours and the reference differ by {np.nanmax(off, initial=0.0):.3g}")


@njit()
def find_all(region: Region, primitives: Floats, accept: Acceptance) -> int:
    """Find facets and region of every posture; return how many facets."""
    found = 0
    for m in range(primitives.shape[0]):
        stand(region, primitives[m], accept)
        found += region.counts.facets
    return found


def facets() -> Iterator[Row]:
    """Hold the search for facets and region against the whole sweep of 1,014 directions."""
    numba.set_num_threads(1)
    for kind, counts in ((POINT, (3, 8, 32)), (SPHERE, (4, 8)), (DISC, (4, 8, 12))):
        for n in counts:
            if kind == POINT:
                m, angles = 512, None
                primitives = point_shapes(Case("inside" if n > 3 else "ground", n), m)
            else:
                m, angles = 32, LIMITS
                primitives = wheel_shapes(kind, n, m)
            accept = acceptance(*(angles or (None, None)))
            sweep, _ = sweep_run(primitives, Chart("sphere", 13), ("sdg",), angles)
            search, whole = interleave(partial(find_all, empty_region(), primitives, accept), sweep)
            yield Row(f"{n} {KIND_NAMES[kind]}: facets", 1, search / m, "whole sweep", whole / m)


def directions(folder: Path) -> Iterator[Row]:
    """Hold `lutgen.stability` of one posture in many directions against the loop in C."""
    numba.set_num_threads(1)
    primitives, loop = point_shapes(Case("ground", 4), 1), Loop(folder)
    contacts = primitives[0, :, :3]
    gravity = np.random.default_rng(1).normal(size=(DIRECTIONS, 3))
    units, axes = unit_directions(gravity), tip_over_axes(primitives[0], acceptance(None, None))
    by_c = np.empty((3, DIRECTIONS))
    three = ("tip_angle", "margin", "energy_margin")
    asked = (("sdg", "tip_angle"), three, ("sdg", *three))
    runs = [partial(stability, contacts, gravity, channels) for channels in asked]
    *ours, theirs = interleave(*runs, partial(loop.three_metrics, axes, units, by_c))
    values = stability(contacts, gravity, three)
    # The energy margin of the loop is that of one axis; ours is the least of all ways over.
    for name, reference in zip(three[:2], by_c, strict=False):
        agree(values[name][0], reference)
    for channels, taken in zip(asked, ours, strict=True):
        name = f"4 ground, one posture: {' + '.join(channels)}"
        yield Row(name, 1, taken / DIRECTIONS, "C loop, three metrics", theirs / DIRECTIONS)
