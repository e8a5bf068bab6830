"""One cell of the main table: a case, a number of directions and threads, and all contenders.

Every time is that of one whole pass; rates are in evaluations per second, an evaluation being one
posture and one direction, whatever the number of channels.
"""

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
from benchmarks.fill import fill
from benchmarks.memory_sweep import MemorySweep
from benchmarks.planes import Planes, planes
from benchmarks.timing import interleave
from lutgen.channels.evaluation import stability
from lutgen.channels.plain import CHANNELS
from lutgen.chart import Chart
from lutgen.support.region import acceptance

# 64 MiB of float32, more than the caches hold: for the fill, and per channel for our sweep.  Few
# directions take so long per node that their output's size does not matter.
NODES = 1 << 24
FEW, NODES_OF_FEW = 4096, 1 << 22
C_NODES = 1 << 21
NUMPY_NODES = 1 << 18
LimitAngles = tuple[float | None, float | None]


@dataclass(frozen=True)
class Agreement:
    """How our numbers differ from a reference: largest difference, and nodes NaN in one only.

    Relative differences for |SD_g|, absolute ones (rad) for tip angles.
    """

    difference: float
    nan_mismatches: int
    nodes: int


@dataclass(frozen=True)
class Cell:
    """Results: `rates` and `best` in evaluations/s per contender, `agreement` per reference."""

    stance: str
    contacts: int
    directions: int
    threads: int
    limits_on: bool
    rates: dict[str, float]
    best: dict[str, float]
    agreement: dict[str, Agreement]

    def ratio(self, faster: str, slower: str) -> float:
        """Return how many times longer `slower` takes than `faster`; NaN if one was not run."""
        return self.rates.get(faster, np.nan) / self.rates.get(slower, np.nan)


class Bench:
    """Runs cells with buffers that it keeps; `folder` receives the compiled C."""

    def __init__(self, folder: Path, nodes: int = NODES) -> None:
        self.nodes = nodes
        self._c = CReference(folder)
        # Room for a posture beyond the last whole one.
        self._store = np.full(len(CHANNELS) * (nodes + 150_000), np.nan, np.float32)

    def cells(
        self,
        case: Case,
        face_nodes: int,
        threads: tuple[int, ...] = (1, 2),
        limit_angles: LimitAngles = (None, None),
        nodes: int | None = None,
    ) -> list[Cell]:
        """Measure one case with a sphere chart of `face_nodes` nodes per side of a face."""
        chart = Chart("sphere", face_nodes)
        directions = chart.directions().reshape(-1, 3)
        count = len(directions)
        wanted = nodes or min(self.nodes, NODES_OF_FEW if count < FEW else NODES)
        primitives = point_shapes(case, -(-wanted // count))
        sdg = MemorySweep(primitives, chart, ("sdg",), self._store, limit_angles)
        both = MemorySweep(primitives, chart, ("sdg", "tip_angle"), self._store, limit_angles)
        accept = acceptance(*limit_angles)
        for_c = planes(primitives[: max(C_NODES // count, 1)], accept)
        for_numpy = planes(primitives[: max(NUMPY_NODES // count, 1)], accept)
        c_out = np.zeros((len(for_c.counts), count), np.float32)
        numpy_out = np.zeros((len(for_numpy.counts), count), np.float32)
        upright = np.ascontiguousarray(directions.T)
        agreement = self._compare(
            both, primitives, limit_angles, directions, for_c, for_numpy, c_out
        )
        buffer = self._store[: self.nodes]
        result = []
        for number in threads:
            numba.set_num_threads(number)
            all_nodes = len(primitives) * count
            contenders: dict[str, tuple[Callable[[], None], int]] = {
                "fill": (partial(fill, buffer, np.float32(1.5)), buffer.size),
                "sdg large": (sdg.large, all_nodes),
                "both large": (both.large, all_nodes),
                "c": (partial(self._c.run, for_c, directions, c_out, number), c_out.size),
                "sdg reused": (sdg.reused, all_nodes),
                "both reused": (both.reused, all_nodes),
            }
            if number == 1:
                run = partial(numpy_reference.stability_factor, for_numpy, upright, numpy_out)
                contenders["numpy"] = (run, numpy_out.size)
            times = interleave({name: run for name, (run, _) in contenders.items()})
            work = {name: size for name, (_, size) in contenders.items()}
            result.append(
                Cell(
                    *(case.stance, case.contacts, count, number, limit_angles != (None, None)),
                    rates={name: work[name] / times[name].median for name in work},
                    best={name: work[name] / times[name].best for name in work},
                    agreement=agreement,
                )
            )
        numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
        return result

    def _compare(
        self,
        ours: MemorySweep,
        primitives: NDArray[np.float64],
        limit_angles: LimitAngles,
        directions: NDArray[np.float64],
        for_c: Planes,
        for_numpy: Planes,
        c_out: NDArray[np.float32],
    ) -> dict[str, Agreement]:
        """Compare |SD_g| with C and NumPy, and tip angles with `lutgen.stability` in float64."""
        few = len(for_numpy.counts)
        self._c.run(for_c, directions, c_out, 1)
        by_numpy = np.empty((few, len(directions)), np.float32)
        numpy_reference.stability_factor(for_numpy, np.ascontiguousarray(directions.T), by_numpy)
        exact = stability(
            primitives[:few, :, :3], directions, ("tip_angle",), limit_angles[0], limit_angles[1]
        )["tip_angle"]
        sdg = ours.values("sdg", len(c_out))
        return {
            "c": _agreement(sdg, c_out, True),
            "numpy": _agreement(sdg[:few], by_numpy, True),
            "tip_angle": _agreement(ours.values("tip_angle", few), exact, False),
        }


def _agreement(
    ours: NDArray[np.float32], theirs: NDArray[np.floating], relative: bool
) -> Agreement:
    mine, other = ours.astype(np.float64), theirs.astype(np.float64)
    difference = np.abs(mine - other)
    if relative:
        difference /= np.maximum(np.abs(other), 1e-30)
    both = ~np.isnan(difference)
    largest = float(difference[both].max()) if both.any() else 0.0
    return Agreement(largest, int((np.isnan(mine) != np.isnan(other)).sum()), mine.size)
