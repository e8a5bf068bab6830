"""One posture and 100,000 directions in float64: `lutgen.stability` from call to answer."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks import numpy_reference
from benchmarks.c_reference import CReference
from benchmarks.cases import Case, point_shapes
from benchmarks.timing import interleave
from lutgen.channels.evaluation import stability
from lutgen.chart import unit_directions
from lutgen.support import segments_in
from lutgen.support.region import acceptance, empty_region
from lutgen.support.search import stand
from lutgen.support.table import facet_table

DIRECTIONS = 100_000
CASE = Case("ground", 4)
TWO = ("sdg", "tip_angle")
THREE = ("tip_angle", "margin", "energy_margin")
ASKED = {"two": TWO, "three": THREE, "four": ("sdg", *THREE)}


@dataclass(frozen=True)
class Directions:
    """Nanoseconds per direction of each contender, the best run, and how far references are off.

    `differences`: largest difference of one of the three metrics from C and from NumPy, relative
    where it is above 1, where both are finite.
    """

    threads: int
    times: dict[str, float]
    differences: dict[str, float]


def tip_over_axes(contacts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return start, stop and inward normal (b, 9) of the tip-over axes of packed contacts."""
    table, region = facet_table(len(contacts)), empty_region(len(contacts))
    stand(table, region, contacts, acceptance(None, None))
    return region.segment[: segments_in(region.tally)].copy()


def measure_directions(folder: Path, threads: int) -> Directions:
    """Time `stability` against C and NumPy, which get axes and unit vectors for nothing."""
    primitives = point_shapes(CASE, 1)
    contacts = primitives[0, :, :3]
    gravity = np.random.default_rng(1).normal(size=(DIRECTIONS, 3))
    units, axes = unit_directions(gravity), tip_over_axes(primitives[0])
    upright = np.ascontiguousarray(units.T)
    reference = CReference(folder)
    by_c = np.empty((3, DIRECTIONS))
    contenders: dict[str, Callable[[], object]] = {
        name: partial(stability, contacts, gravity, channels) for name, channels in ASKED.items()
    }
    contenders["c"] = partial(reference.three_metrics, axes, units, by_c)
    contenders["numpy"] = partial(numpy_reference.three_metrics, axes, upright)
    numba.set_num_threads(threads)
    times = interleave(contenders, repeats=15)
    ours = stability(contacts, gravity, THREE)
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    mine = np.stack([ours[name][0] for name in THREE])
    by_numpy = numpy_reference.three_metrics(axes, upright)
    differences = {}
    for name, theirs in (("c", by_c), ("numpy", by_numpy)):
        off = np.abs(mine - theirs) / np.maximum(np.abs(theirs), 1.0)
        differences[name] = float(off[np.isfinite(off)].max())
    return Directions(
        threads,
        {name: 1e9 * time.best / DIRECTIONS for name, time in times.items()},
        differences,
    )
