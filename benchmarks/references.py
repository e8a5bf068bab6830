"""What our speed is held against: a fill of memory, vectorised NumPy, and a plain loop in C.

NumPy and C are given the facet planes, which our sweep has to find within its time.
"""

import ctypes
import subprocess
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Floats, Ints, Singles
from lutgen.channels import region_of
from lutgen.jit import njit
from lutgen.support import Acceptance, Region, empty_region, rests_at, stand

COMMAND = ("cc", "-O3", "-march=native", "-shared", "-fPIC")
PARTS = 16


class Planes(NamedTuple):
    """Planes of m postures, padded.

    `facets` (m, F, 9): n/h, and the two axes w with |SD_g| = hypot(w1.g, w2.g) / ((n/h).g).
    `walls` (m, W, 3): inward normals of the edges beyond which the robot tips, facet by facet;
    those of facet k are `first[k]` to `first[k + 1]` of `first` (m, F + 1).
    `counts` (m,): F used.
    """

    facets: Floats
    walls: Floats
    first: Ints
    counts: Ints


@njit()
def _copy(region: Region, primitives: Floats, accept: Acceptance, planes: Planes) -> None:
    facets, walls, first, counts = planes
    for m in range(primitives.shape[0]):
        stand(region, primitives[m], accept)
        counts[m] = region.counts.accepted
        wall = 0
        for k in range(counts[m]):
            seat = region.seat[k]
            facets[m, k, :3] = seat.plane
            facets[m, k, 3:6] = seat.axes[0]
            facets[m, k, 6:] = seat.axes[1]
            first[m, k] = wall
            facet = region.facet[seat.facet]
            for e in range(facet.first, facet.first + facet.count):
                if rests_at(region, e)[1] < 0:
                    walls[m, wall] = region.edge[e].wall
                    wall += 1
        first[m, counts[m]] = wall


def planes(primitives: NDArray[np.float64], accept: Acceptance) -> Planes:
    """Return the planes of postures (m, n, 8) of points."""
    m, n = primitives.shape[:2]
    result = Planes(
        np.zeros((m, 2 * n, 9)),
        np.zeros((m, 6 * n, 3)),
        np.zeros((m, 2 * n + 1), np.int64),
        np.zeros(m, np.int64),
    )
    _copy(empty_region(), primitives, accept, result)
    return result


def tip_over_axes(contacts: NDArray[np.float64], accept: Acceptance) -> NDArray[np.float64]:
    """Return start, stop and inward normal (b, 9) of the tip-over axes of packed contacts."""
    region = region_of(contacts, accept)
    arcs = region.arc[: region.counts.arcs]
    return np.hstack([arcs["start"], arcs["stop"], arcs["wall"]])


@numba.njit(parallel=True)
def fill(out: Singles, value: np.float32) -> None:
    """Store a float32 `value` everywhere in `out` (k,), one contiguous part after the other.

    As a constant the value would make the loop memset, whose stores bypass the cache.
    """
    for part in numba.prange(PARTS):
        piece = out[part * out.shape[0] // PARTS : (part + 1) * out.shape[0] // PARTS]
        for i in range(piece.shape[0]):
            piece[i] = value


def by_numpy(held: Planes, directions: NDArray[np.float64], out: NDArray[np.float32]) -> None:
    """Fill `out` (m, g) with |SD_g| for directions (3, g), all of a posture at once."""
    every = np.arange(directions.shape[1])
    for m, facets in enumerate(held.counts):
        plane, w1, w2 = (held.facets[m, :facets, 3 * i : 3 * i + 3] for i in range(3))
        rates = plane @ directions
        best = rates.argmax(axis=0)
        rate = rates[best, every]
        along = np.einsum("gi,ig->g", w1[best], directions)
        aside = np.einsum("gi,ig->g", w2[best], directions)
        stands = rate > 0.0
        for k in range(facets):
            for e in range(held.first[m, k], held.first[m, k + 1]):
                stands &= (best != k) | (held.walls[m, e] @ directions >= 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            out[m] = np.where(stands, np.sqrt(along * along + aside * aside) / rate, np.nan)


class Loop:
    """The loop of reference.c, compiled into a folder; one thread."""

    def __init__(self, folder: Path) -> None:
        source = Path(__file__).with_name("reference.c")
        library = folder / "reference.so"
        subprocess.run([*COMMAND, str(source), "-o", str(library), "-lm"], check=True)
        self._library = ctypes.CDLL(str(library))

    def _call(self, name: str, *given: NDArray[np.generic] | int) -> None:
        function = getattr(self._library, name)
        function.restype = None
        function(
            *(
                ctypes.c_size_t(one) if isinstance(one, int) else ctypes.c_void_p(one.ctypes.data)
                for one in given
            )
        )

    def sdg(self, held: Planes, directions: Floats, out: Singles) -> None:
        """Fill `out` (m * g,) with |SD_g| for directions (g, 3)."""
        sizes = held.facets.shape[1], held.walls.shape[1]
        given = held.facets, sizes[0], held.walls, sizes[1], held.first, held.counts
        self._call("stability_factor", *given, len(held.counts), directions, len(directions), out)

    def three_metrics(self, axes: Floats, directions: Floats, out: Floats) -> None:
        """Fill `out` (3, g) with tip angle, static margin and energy margin."""
        self._call("three_metrics", axes, len(axes), directions, len(directions), out)
