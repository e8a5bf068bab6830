"""Node values of the codec `grid` for the tip margin: as high as they can be below the truth.

Owns the quantised ascent for smooth robots (`grid_guard`).  The table starts from the targets at
its nodes, is lowered where it is above a target, floored to codes, and then raised node by node
until every node touches a target.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid.guard import Targets, neighbours
from firmware_export.grid.lattice import Lattice, at_points, to_places
from firmware_export.truth import Model, uniform
from lutgen.jit import njit, prange
from lutgen.vector import Floats

Ints = NDArray[np.int32]

PASSES = 3
# Shares of the largest margin at which it may be clipped, and the sample on which they compete.
CAPS = (1.0, 0.8, 0.65, 0.5, 0.4, 0.3)
POINTS, SEED = 100_000, 53


class Codes(NamedTuple):
    """A quantised table: value = offset + step * code."""

    codes: NDArray[np.int64]
    offset: float
    step: float


@njit(parallel=True)
def _lower(index: Ints, weight: Floats, target: Floats, node: Floats) -> None:
    """Lower nodes (Q, J) until the interpolant is nowhere above `target` (P, J)."""
    for j in prange(node.shape[1]):
        drop = np.zeros(len(node))
        for p in range(len(index)):
            value = 0.0
            for c in range(index.shape[1]):
                value += weight[p, c] * node[index[p, c], j]
            over = value - target[p, j]
            if over > 0.0:
                for c in range(index.shape[1]):
                    if weight[p, c] > 0.0:
                        drop[index[p, c]] = max(drop[index[p, c]], over)
        for q in range(len(node)):
            node[q, j] -= drop[q]


@njit(parallel=True)
def _raise(
    index: Ints,
    weight: Floats,
    target: Floats,
    first: NDArray[np.int64],
    entry: NDArray[np.int64],
    code: NDArray[np.int64],
    most: NDArray[np.int64],
) -> None:
    """Raise codes (Q, J) one after the other as far as `target` (P, J), in codes, allows.

    `entry` lists the (posture, corner) pairs of each node, from `first` on.
    """
    corners = index.shape[1]
    for j in prange(code.shape[1]):
        value = np.zeros(len(index))
        for p in range(len(index)):
            for c in range(corners):
                value[p] += weight[p, c] * code[index[p, c], j]
        for q in range(len(code)):
            slack = float(most[q, j] - code[q, j])
            for e in range(first[q], first[q + 1]):
                p, c = entry[e] // corners, entry[e] % corners
                slack = min(slack, (target[p, j] - value[p]) / weight[p, c])
            up = np.int64(np.floor(slack - 1e-9))
            if up > 0:
                code[q, j] += up
                for e in range(first[q], first[q + 1]):
                    value[entry[e] // corners] += (
                        weight[entry[e] // corners, entry[e] % corners] * up
                    )


def fit(model: Model, lattice: Lattice, aims: Targets, bits: int) -> Codes:
    """Return the codes (faces, parameters..., v, u, 1) of mu; v and u are the last axes."""
    nodes = lattice.shape[:-2]
    index, weight = lattice.posture_corners(aims.place)
    count = math.prod(nodes)
    whole = np.argmax(weight, axis=1)
    at_node = weight[np.arange(len(weight)), whole] >= 1.0 - 1e-8
    node = np.empty((count, aims.target.shape[1]))
    node[index[at_node, whole[at_node]]] = aims.target[at_node]
    shape = (count, lattice.faces, *lattice.shape[-2:])
    near = np.stack(
        [
            neighbours((*nodes, *lattice.shape[-2:]), node.reshape(shape)[:, face] > 0.0)
            for face in range(lattice.faces)
        ],
        axis=len(nodes),
    ).reshape(node.shape)
    _lower(index, weight, aims.target, node)

    pair = np.flatnonzero(weight.ravel() > 0.0)
    order = pair[np.argsort(index.ravel()[pair], kind="stable")].astype(np.int64)
    first = np.searchsorted(index.ravel()[order], np.arange(count + 1)).astype(np.int64)
    lowest = float(np.float32(node[near].min(initial=-1e-3)))
    best, fewest = None, np.inf
    for cap in CAPS:
        highest = cap * float(max(node.max(), 1e-3))
        step = float(np.float32((highest - lowest) / (2**bits - 1) * (1.0 + 1e-6)))
        aim = (aims.target - lowest) / step - 1e-6
        code = np.floor((node - lowest) / step - 1e-6).astype(np.int64)
        # A node all of whose cells tip throughout may hold anything below zero.
        code = np.clip(code, 0, 2**bits - 1)
        most = np.where(near, 2**bits - 1, code)
        for _ in range(PASSES):
            _raise(index, weight, aim, first, order, code, most)
        by_face = np.moveaxis(code.reshape(shape), 1, 0)
        result = Codes(by_face.reshape(lattice.faces, *lattice.shape, 1), lowest, step)
        lost = false_tip(model, lattice, result)
        # A lower cap hides how stable the robot is: it must be worth it.
        if lost < 0.97 * fewest:
            best, fewest = result, lost
    assert best is not None
    return best


def false_tip(model: Model, lattice: Lattice, codes: Codes) -> float:
    """Return the share of the standing configurations that the table calls tipping."""
    place, face = standing_places(model)
    node = codes.offset + codes.step * codes.codes.reshape(-1, 1).astype(np.float64)
    index, weight, start = lattice.find(place, face)
    value = at_points(index, weight, node, start)
    return float((value < 0.0).mean()) if len(value) else 0.0


@lru_cache(maxsize=4)
def standing_places(model: Model) -> tuple[Floats, NDArray[np.int64]]:
    """Return places and faces of standing configurations, uniform."""
    sample = uniform(model, POINTS, SEED)
    stands = model.exact(sample.params, sample.gravity).tip_angle.ravel() >= 0.0
    place, face = to_places(model, sample)
    return place[stands], face[stands]
