"""Lattices of the codec `grid`: knots, the cells that hold a place, and sums over their corners.

Owns interpolation in float64 for encoders; places are (m, k + 2): the parameters, v and u, each
from 0 to 1 over its axis.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.tables import SPAN, U, V, is_even
from firmware_export.truth import Model, Sample, combinations
from lutgen.jit import njit, prange
from lutgen.vector import Floats

Ints = NDArray[np.int32]

# Pieces of the work, each with its own result: the same for any number of threads.
PARTS = 4


@njit(parallel=True)
def corners(x: Floats, knots: Floats, nodes: NDArray[np.int64]) -> tuple[Ints, Floats]:
    """Return the nodes (m, 2^d) of the cells that hold places x (m, d), and their weights.

    `knots` (d, most nodes), axes outermost first, `nodes` (d,) of them each.
    """
    m, d = x.shape
    index = np.empty((m, 1 << d), np.int32)
    weight = np.empty((m, 1 << d))
    for p in prange(m):
        lower = np.empty(d, np.int64)
        frac = np.empty(d)
        for a in range(d):
            i = 0
            while i < nodes[a] - 2 and x[p, a] >= knots[a, i + 1]:
                i += 1
            lower[a] = i
            frac[a] = (x[p, a] - knots[a, i]) / (knots[a, i + 1] - knots[a, i])
        for c in range(1 << d):
            share, at = 1.0, 0
            for a in range(d):
                upper = (c >> a) & 1
                share *= frac[a] if upper else 1.0 - frac[a]
                at = at * nodes[a] + lower[a] + upper
            index[p, c] = at
            weight[p, c] = share
    return index, weight


@njit(parallel=True)
def at_points(index: Ints, weight: Floats, node: Floats, start: NDArray[np.int64]) -> Floats:
    """Interpolate nodes (n, w) at places; `start` (m,) is the first node of the place's face."""
    out = np.zeros((len(index), node.shape[1]))
    for p in prange(len(index)):
        for c in range(index.shape[1]):
            for w in range(node.shape[1]):
                out[p, w] += weight[p, c] * node[start[p] + index[p, c], w]
    return out


@njit(parallel=True)
def _at_nodes(
    index: Ints, weight: Floats, value: Floats, start: NDArray[np.int64], out: Floats
) -> None:
    for part in prange(len(out)):
        for p in range(part, len(index), len(out)):
            for c in range(index.shape[1]):
                for w in range(value.shape[1]):
                    out[part, start[p] + index[p, c], w] += weight[p, c] * value[p, w]


def at_nodes(
    index: Ints, weight: Floats, value: Floats, start: NDArray[np.int64], count: int
) -> Floats:
    """Add up values (m, w) of places at the nodes: the transpose of `at_points`."""
    # A fixed number of parts: the same sums for any number of threads.
    out = np.zeros((PARTS, count, value.shape[1]))
    _at_nodes(index, weight, value, start, out)
    return np.asarray(out.sum(axis=0))


class Lattice:
    """Knots of a table, its nodes and what the exact kernels say there.

    `coordinates` and `knots` (n,) are those of its axes, the outermost first; see `Part`.
    """

    def __init__(
        self, model: Model, coordinates: tuple[int, ...], knots: tuple[NDArray[np.uint16], ...]
    ) -> None:
        self.model, self.coordinates, self.knots = model, coordinates, knots
        self.shape = tuple(len(k) for k in knots)
        self.face_nodes = int(np.prod(self.shape, dtype=np.int64)) if knots else 1
        # A table without v and u is the same on every face.
        self.faces = model.faces if {U, V} & set(coordinates) else 1
        # The ends of the cells, 0 to 1, and the columns of a place that they are for.
        self.ends = tuple(
            np.linspace(0.0, 1.0, len(k)) if is_even(k) else k.astype(np.float64) / SPAN
            for k in knots
        )
        self.columns = [{U: -1, V: -2}.get(c, c) for c in coordinates]

    def find(
        self, place: Floats, face: NDArray[np.int64]
    ) -> tuple[Ints, Floats, NDArray[np.int64]]:
        """Return index, weight and start of places (m, k + 2): parameters, v, u, each 0 to 1."""
        start = face * self.face_nodes if self.faces > 1 else np.zeros(len(face), np.int64)
        return *_cells(place[:, self.columns], self.ends), start

    def places(self) -> tuple[Floats, NDArray[np.int64]]:
        """Return the places (nodes, k + 2) and faces of all nodes; pruned axes in the middle."""
        place = np.full((self.faces * self.face_nodes, self.model.k + 2), 0.5)
        place[:, self.columns] = np.tile(combinations(self.ends), (self.faces, 1))
        return place, np.repeat(np.arange(self.faces), self.face_nodes)


def _cells(x: Floats, axes: Sequence[Floats]) -> tuple[Ints, Floats]:
    """Return `corners` of places x (m, d) among the knots of d axes."""
    table = np.zeros((len(axes), max(map(len, axes), default=1)))
    for row, knots in zip(table, axes, strict=True):
        row[: len(knots)] = knots
    return corners(np.ascontiguousarray(x), table, np.array([len(k) for k in axes], np.int64))


def spread_knots(model: Model, coordinate: int, count: int) -> NDArray[np.uint16]:
    """Return regular knots of a parameter; of u and v knots at equal angles."""
    even = np.linspace(-1.0, 1.0, count)
    if coordinate in (U, V):
        even = np.tan(even * np.arctan(model.chart_limit)) / model.chart_limit
    knots = np.rint((even + 1.0) * (SPAN / 2))
    knots[0], knots[-1] = 0, SPAN
    return knots.astype(np.uint16)


def to_places(model: Model, sample: Sample) -> tuple[Floats, NDArray[np.int64]]:
    """Return the places (m d, k + 2), each 0 to 1, and the faces of a sample's points."""
    m, d = sample.gravity.shape[:2]
    face, u, v, _ = model.recipe.chart.locate(sample.gravity.reshape(-1, 3))
    span = model.upper - model.lower
    t = (sample.params - model.lower) / np.where(span > 0.0, span, 1.0)
    place = np.empty((m * d, model.k + 2))
    place[:, : model.k] = np.repeat(np.clip(t, 0.0, 1.0), d, axis=0)
    place[:, -2] = np.clip((v / model.chart_limit + 1.0) / 2.0, 0.0, 1.0)
    place[:, -1] = np.clip((u / model.chart_limit + 1.0) / 2.0, 0.0, 1.0)
    return place, face.astype(np.int64)


def from_places(model: Model, place: Floats, face: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Return parameters (m, k) and directions (m, 1, 3) of places."""
    v, u = ((2.0 * place[:, at] - 1.0) * model.chart_limit for at in (-2, -1))
    return model.at(place[:, : model.k]), model.uv_to_gravity(face, u, v)[:, None]
