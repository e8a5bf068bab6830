"""Time to find support facets and the standing region of one posture, and its share of a sweep."""

from dataclasses import dataclass
from functools import partial
from math import radians

import numba
import numpy as np

from benchmarks.cases import DISC, KIND_NAMES, POINT, SPHERE, Case, point_shapes, wheel_shapes
from benchmarks.memory_sweep import MemorySweep
from benchmarks.timing import interleave
from lutgen.channels.plain import CHANNELS
from lutgen.chart import Chart
from lutgen.jit import njit
from lutgen.support.boundary import find_region
from lutgen.support.region import Acceptance, acceptance, empty_region
from lutgen.support.search import find_facets
from lutgen.support.table import facet_table, robot_size
from lutgen.support.unite import unite
from lutgen.vector import Floats

POINT_COUNTS = (3, 4, 6, 8, 16, 32)
WHEEL_COUNTS = (3, 4, 6, 8, 12, 32)
DEFAULT_LIMITS = (radians(90.0), radians(30.0))
# Postures per pass: about 10 ms whatever they cost.
PASS_SECONDS = 0.01
FEWEST, MOST = 4, 2048


@dataclass(frozen=True)
class Enumeration:
    """Microseconds per posture, one thread, and shares of a sweep of 1,014 directions (sdg)."""

    kind: str
    contacts: int
    limits_on: bool
    facets_found: float
    facets_us: float
    region_us: float
    sweep_us: float

    @property
    def share(self) -> float:
        """Share of facets and region in the sweep."""
        return (self.facets_us + self.region_us) / self.sweep_us


@njit()
def find_all(primitives: Floats, accept: Acceptance, regions: bool) -> int:
    """Find the facets, and if asked the regions, of all postures; return how many facets."""
    n = primitives.shape[1]
    table, region = facet_table(n), empty_region(n)
    found = 0
    for m in range(primitives.shape[0]):
        size = robot_size(primitives[m])
        find_facets(table.work, primitives[m], accept.lowest_up, size)
        unite(table, primitives[m], size)
        found += table.hull.tally[0]
        if regions:
            find_region(region, table, primitives[m], accept, size)
    return found


def measure_enumeration() -> list[Enumeration]:
    """Measure points inside and wheels on the ground, one thread."""
    numba.set_num_threads(1)
    chart = Chart("sphere", 13)
    store = np.full(len(CHANNELS) * MOST * 6 * 13 * 13, np.nan, np.float32)
    rows = []
    for kind, counts in ((POINT, POINT_COUNTS), (SPHERE, WHEEL_COUNTS), (DISC, WHEEL_COUNTS)):
        for n in counts:
            if kind == POINT:
                every = point_shapes(Case("inside" if n > 3 else "ground", n), MOST)
            else:
                every = wheel_shapes(kind, n, MOST)
            angles = (None, None) if kind == POINT else DEFAULT_LIMITS
            accept = acceptance(*angles)
            find_all(every[:FEWEST], accept, True)
            trial = interleave({"trial": partial(find_all, every[:FEWEST], accept, True)}, 3)
            per_posture = trial["trial"].best / FEWEST
            m = int(min(max(PASS_SECONDS / per_posture, FEWEST), MOST))
            primitives = every[:m]
            times = interleave(
                {
                    "facets": partial(find_all, primitives, accept, False),
                    "region": partial(find_all, primitives, accept, True),
                    "sweep": MemorySweep(primitives, chart, ("sdg",), store, angles).large,
                }
            )
            facets, region, sweep = (times[name].median for name in ("facets", "region", "sweep"))
            rows.append(
                Enumeration(
                    *(KIND_NAMES[kind], n, angles != (None, None)),
                    facets_found=find_all(primitives, accept, False) / m,
                    facets_us=1e6 * facets / m,
                    region_us=1e6 * max(region - facets, 0.0) / m,
                    sweep_us=1e6 * sweep / m,
                )
            )
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    return rows
