"""Lattices of the codec `grid`: knots, the cells that hold a place, and sums over their corners.

Owns interpolation in float64 for encoders; places are (m, k + 2): the parameters, v and u, each
from 0 to 1 over its axis.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.tables import SPAN, U, V, is_even
from firmware_export.truth import Model, Sample, combinations
from lutgen.jit import njit, prange
from lutgen.vector import Floats

Ints = NDArray[np.int32]

# Pieces of the work, each with its own result: the same for any number of threads.
PARTS = 4
NOTHING = np.empty(0)


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


@njit(inline=True)
def _shares(frac: NDArray[np.float32], share: Floats) -> None:
    """Fill the weights of a cell's corners; bit a of a corner's number is its side on axis a."""
    share[0] = 1.0
    for a in range(len(frac)):
        f = float(frac[a])
        for c in range(1 << a):
            share[c + (1 << a)] = share[c] * f
            share[c] *= 1.0 - f


@njit(inline=True)
def _sum(share: Floats, node: Floats, first: int, offset: NDArray[np.int64]) -> float:
    """Return the sum over a cell's corners of their shares of the nodes."""
    value = 0.0
    for c in range(len(offset)):
        value += share[c] * node[first + offset[c]]
    return value


@njit(parallel=True)
def _spread(
    first: Ints,
    frac: NDArray[np.float32],
    offset: NDArray[np.int64],
    value: Floats,
    node: Floats,
    power: int,
    out: Floats,
) -> None:
    """Add up values at the nodes, each times what `node` (empty: 1) comes to at its place."""
    parts, m = len(out), len(first)
    for part in prange(parts):
        share = np.empty(len(offset))
        for p in range(m * part // parts, m * (part + 1) // parts):
            _shares(frac[p], share)
            amount = value[p]
            if len(node):
                amount *= _sum(share, node, first[p], offset)
            for c in range(len(offset)):
                weight = share[c] * share[c] if power == 2 else share[c]
                out[part, first[p] + offset[c]] += weight * amount


@njit(parallel=True)
def _interpolate(
    first: Ints, frac: NDArray[np.float32], offset: NDArray[np.int64], node: Floats, out: Floats
) -> None:
    m = len(first)
    for part in prange(PARTS):
        share = np.empty(len(offset))
        for p in range(m * part // PARTS, m * (part + 1) // PARTS):
            _shares(frac[p], share)
            out[p] = _sum(share, node, first[p], offset)


class Spots:
    """Where points lie in a lattice, in a sixth of the memory that all their corners take.

    `first` (m,) is the lowest node of a point's cell, `frac` (m, d) where in the cell it lies, 0 to
    1 along each axis, `offset` (2^d,) leads to the other corners; `nodes` are those of all faces.
    """

    def __init__(
        self, first: Ints, frac: NDArray[np.float32], offset: NDArray[np.int64], nodes: int
    ) -> None:
        self.first, self.frac, self.offset, self.nodes = first, frac, offset, nodes

    def __len__(self) -> int:
        return len(self.first)

    def part(self, which: NDArray[Any]) -> "Spots":
        """Return some of the points: indices, or a mask."""
        return Spots(self.first[which], self.frac[which], self.offset, self.nodes)

    def joined(self, other: "Spots") -> "Spots":
        """Return these points and then others of the same lattice."""
        return Spots(
            np.concatenate([self.first, other.first]),
            np.concatenate([self.frac, other.frac]),
            self.offset,
            self.nodes,
        )

    def at(self, node: Floats) -> Floats:
        """Interpolate nodes (n,) at the points."""
        out = np.empty(len(self.first))
        _interpolate(self.first, self.frac, self.offset, node, out)
        return out

    def spread(self, value: Floats, node: Floats = NOTHING, power: int = 1) -> Floats:
        """Add up values (m,) at the nodes, by the weights or (`power` 2) by their squares.

        With `node` (n,) each value counts times `at(node)`, in one pass.
        """
        out = np.zeros((PARTS, self.nodes))
        _spread(self.first, self.frac, self.offset, value, node, power, out)
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

    def posture_corners(self, place: Floats) -> tuple[Ints, Floats]:
        """Return index and weight (m, 2^axes) among the parameters' nodes of places (m, k...).

        Rounding must not make a posture at a knot lean on the next one.
        """
        held = [(c, ends) for c, ends in zip(self.coordinates, self.ends, strict=True) if c < U]
        index, weight = _cells(place[:, [c for c, _ in held]], [ends for _, ends in held])
        return index, np.where(weight < 1e-9, 0.0, weight)

    def spots(self, place: Floats, face: NDArray[np.int64]) -> Spots:
        """Return where places (m, k + 2) lie; see `find`."""
        first = (face if self.faces > 1 else np.zeros_like(face)) * self.face_nodes
        frac = np.empty((len(place), len(self.ends)), np.float32)
        offset = np.zeros(1 << len(self.ends), np.int64)
        stride = self.face_nodes
        for axis, (column, ends) in enumerate(zip(self.columns, self.ends, strict=True)):
            x = place[:, column]
            cell = np.clip(np.searchsorted(ends, x, side="right") - 1, 0, len(ends) - 2)
            frac[:, axis] = (x - ends[cell]) / (ends[cell + 1] - ends[cell])
            stride //= len(ends)
            first = first + cell * stride
            offset += (np.arange(len(offset)) >> axis & 1) * stride
        return Spots(first.astype(np.int32), frac, offset, self.faces * self.face_nodes)

    def places(self) -> tuple[Floats, NDArray[np.int64]]:
        """Return the places (nodes, k + 2) and faces of all nodes; pruned axes in the middle."""
        place = np.full((self.faces * self.face_nodes, self.model.k + 2), 0.5)
        place[:, self.columns] = np.tile(combinations(self.ends), (self.faces, 1))
        return place, np.repeat(np.arange(self.faces), self.face_nodes)

    def directions(self) -> Floats:
        """Return the directions (faces v u, 3) of the knots of v and u on every face."""
        v, u = (2.0 * self.ends[self.coordinates.index(c)] - 1.0 for c in (V, U))
        limit = self.model.chart_limit
        face, vs, us = np.meshgrid(np.arange(self.model.faces), v * limit, u * limit, indexing="ij")
        return self.model.uv_to_gravity(face, us, vs).reshape(-1, 3)


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
