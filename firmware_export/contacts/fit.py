"""Codes of the `contacts` codec: modes as tables of one dimension, weights as integers.

Owns the fit (best piecewise linear function on evenly spaced nodes, in the minimax sense), the
rounding, and the bound of the contacts' position error that follows from both.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from firmware_export.contacts.modes import DENSE, Separation
from lutgen.vector import Floats

LAWSON_STEPS = 30
MOST_ENTRIES = 64
FULL = {8: 127, 16: 32767}
WEIGHT_FULL = 32767
ROUNDING = 2e-6
"""Bound of float32 rounding in a position, relative to its size: some 20 operations of 6e-8."""


@dataclass(frozen=True, eq=False)
class Codes:
    """The tables as they are in C, and how far the positions read from them can be off.

    Attributes
    ----------
    shape : (k, 2) uint8
        Modes and nodes of every parameter.
    modes : (sum of modes x nodes,) int8 or int16
        Mode after mode, in parameter order.
    products : (count, 2) uint8
        Pairs of entries; entry 0 is 1, then come the modes, then the products.
    entries, weights : (terms,) uint8, (terms,) int16
        Per term two bits of how many coordinates to go on and six of the entry; its weight.
    radii, hinges : (n,) int16, (n,) uint8, or empty
    length, unit : float
        Length of one step of a weight, value of one step of a mode.
    position_error : (n,) float
        Bound of the distance between a contact's centre and its stored one (plus, for discs, what
        the axis' error moves the rim).
    speed : (k, n) float
        Bound of |d centre / d t| along each parameter, t from 0 to 1.
    drift : float
        Bound of the sum over parameters of |d error / d t| of any centre.
    stored : Separation
        The same robot as the tables have it.
    """

    shape: NDArray[np.uint8]
    modes: NDArray[np.int8] | NDArray[np.int16]
    products: NDArray[np.uint8]
    entries: NDArray[np.uint8]
    weights: NDArray[np.int16]
    radii: NDArray[np.int16]
    hinges: NDArray[np.uint8]
    length: float
    unit: float
    axes: int
    position_error: Floats
    speed: Floats
    drift: float
    stored: Separation

    @property
    def bytes(self) -> int:
        """Bytes of all tables."""
        parts = (self.shape, self.modes, self.products, self.entries, self.weights)
        return int(sum(part.nbytes for part in (*parts, self.radii, self.hinges)))


def fit_line(function: Floats, nodes: int) -> Floats:
    """Return the nodes (nodes,) of the piecewise linear function nearest to dense values (DENSE,).

    Weighted least squares, weights raised where the error is large (Lawson), so that the largest
    error is nearly as small as it can be.  There are 2 nodes at least.
    """
    x = np.linspace(0.0, nodes - 1.0, len(function))
    cell = np.minimum(x.astype(np.intp), nodes - 2)
    right = x - cell
    left = 1.0 - right

    def at_nodes(low: Floats, high: Floats) -> Floats:
        """Return what dense places give to the nodes on either side of them, summed."""
        return np.asarray(np.bincount(cell, low, nodes) + np.bincount(cell + 1, high, nodes))

    weight = np.full(len(function), 1.0 / len(function))
    best: Floats = function[:: max(1, (len(function) - 1) // (nodes - 1))][:nodes]
    least = math.inf
    for _ in range(LAWSON_STEPS):
        # A place knows two nodes only, so the normal equations have three diagonals.
        diagonal = at_nodes(weight * left * left, weight * right * right) + 1e-12
        beside = at_nodes(weight * left * right, 0.0 * right)[:-1]
        known = at_nodes(weight * left * function, weight * right * function)
        value = _three_diagonals(diagonal, beside, known)
        error = np.abs(left * value[cell] + right * value[cell + 1] - function)
        if error.max() < least:
            best, least = value, float(error.max())
        if error.max() <= 1e-12:
            break
        weight = weight * (0.05 * error.max() + error)
        weight /= weight.sum()
    return np.asarray(best)


def _three_diagonals(diagonal: Floats, beside: Floats, known: Floats) -> Floats:
    """Solve symmetric positive definite equations of three diagonals by elimination.

    By hand, because a library that wakes threads for a few hundred numbers waits for them a
    thousand times as long as this takes wherever the machine has other work.
    """
    pivot, reduced, off = [float(diagonal[0])], [float(known[0])], beside.tolist()
    for i, (size, value) in enumerate(zip(diagonal[1:].tolist(), known[1:].tolist(), strict=True)):
        share = off[i] / pivot[i]
        pivot.append(size - share * off[i])
        reduced.append(value - share * reduced[i])
    result = [reduced[-1] / pivot[-1]]
    for i in range(len(off) - 1, -1, -1):
        result.append((reduced[i] - off[i] * result[-1]) / pivot[i])
    return np.array(result[::-1])


def encode_codes(
    separation: Separation,
    nodes: tuple[int, ...],
    bits: int,
    radius: Floats,
    kind: NDArray[np.int64],
    many: bool,
) -> Codes:
    """Return the tables for given nodes per parameter and width of the modes' codes.

    `radius` and `kind` (n,) are the contacts' shapes; `many` says whether the runtime's general
    path reads them, which has common terms and hinges.
    """
    full = FULL[bits]
    weights = separation.weights.copy()
    tables, dense = [], []
    for p, modes in enumerate(separation.modes):
        read = np.empty_like(modes)
        for r, mode in enumerate(modes):
            value = fit_line(mode, nodes[p])
            scale = float(np.abs(value).max())
            rounded = np.rint(value / scale * full)
            tables.append(rounded.astype(np.int16 if bits == 16 else np.int8))
            take: list[slice | int] = [slice(None)] * weights.ndim
            take[p] = r + 1
            weights[tuple(take)] *= scale
            x = np.linspace(0.0, nodes[p] - 1.0, DENSE)
            read[r] = np.interp(x, np.arange(nodes[p]), rounded / full) * scale
        dense.append(read)
    count = sum(len(modes) for modes in separation.modes)
    n = len(kind)
    grouped = _with_common(weights, n) if many else weights
    step = float(np.abs(grouped[..., : 3 * n + (3 if many else 0)]).max()) / WEIGHT_FULL
    step = max(step, float(radius.max()) / WEIGHT_FULL)
    radii = np.rint(radius / step).astype(np.int16)
    unit = np.full(grouped.shape[-1], step)
    unit[3 * n + (3 if many else 0) :] = 1.0 / WEIGHT_FULL  # axes have no length
    codes = np.rint(grouped / unit).astype(np.int64)
    products, entries, values = _terms(codes, [len(m) for m in separation.modes], count)
    round_error = 0.5 * float(np.abs(radius - radii * step).max()) if radius.any() else 0.0
    stored = Separation(tuple(dense), _without_common(codes * unit, n, many), separation.hinge_of)
    error, speed, drift = _bounds(separation, stored, n)
    hinge = np.where(separation.hinge_of < 0, 255, separation.hinge_of).astype(np.uint8)
    round_contacts = bool(radius.any())
    empty = np.empty(0, np.int16 if bits == 16 else np.int8)
    return Codes(
        shape=np.array([*zip(map(len, separation.modes), nodes, strict=True)], "u1").reshape(-1, 2),
        modes=np.concatenate([empty, *tables]),
        products=products,
        entries=entries,
        weights=values,
        radii=radii if round_contacts else np.empty(0, np.int16),
        hinges=hinge if round_contacts else np.empty(0, np.uint8),
        length=step,
        unit=1.0 / full,
        axes=int(separation.hinge_of.max(initial=-1)) + 1,
        position_error=error + 2.0 * round_error,
        speed=speed,
        drift=drift,
        stored=stored,
    )


def _with_common(weights: Floats, n: int) -> Floats:
    """Put three coordinates in front that are added to every contact: what most of them share.

    The com's motion moves all contacts alike; storing it once saves its terms on each.
    """
    head = np.zeros((*weights.shape[:-1], 3))
    body = weights.copy()
    flat_head, flat = head.reshape(-1, 3), body.reshape(-1, weights.shape[-1])
    # Not the constants, and of the rest the few that are there.
    for term in np.flatnonzero(flat.any(axis=1))[1 if flat[0].any() else 0 :]:
        for axis in range(3):
            values = flat[term, axis : 3 * n : 3]
            rounded = np.round(values, 12)
            found, times = np.unique(rounded[rounded != 0.0], return_counts=True)
            if len(times) and times.max() >= 3:
                shared = values[rounded == found[times.argmax()]][0]
                if np.count_nonzero(np.abs(values - shared) > 1e-12) < np.count_nonzero(values):
                    flat_head[term, axis] = shared
                    values = values - shared
                    flat[term, axis : 3 * n : 3] = np.where(np.abs(values) < 1e-12, 0.0, values)
    return np.concatenate([flat_head.reshape(head.shape), flat.reshape(body.shape)], axis=-1)


def _terms(
    codes: NDArray[np.int64], modes: list[int], count: int
) -> tuple[NDArray[np.uint8], NDArray[np.uint8], NDArray[np.int16]]:
    """Return products, entries and weights, coordinate after coordinate."""
    first = np.concatenate([[1], 1 + np.cumsum(modes)]).astype(int)
    pairs: dict[tuple[int, int], int] = {}
    number: dict[tuple[int, ...], int] = {}

    def entry(index: tuple[int, ...]) -> int:
        parts = [int(first[p]) + i - 1 for p, i in enumerate(index) if i > 0]
        at = parts[0] if parts else 0
        for part in parts[1:]:
            at = pairs.setdefault((at, part), 1 + count + len(pairs))
        return at

    entries, weights = [], []
    behind = 0
    for c in range(codes.shape[-1]):
        for index in np.argwhere(codes[..., c]):
            key = tuple(int(i) for i in index)
            at = number.setdefault(key, entry(key))
            while behind > 3:
                entries.append(3 << 6)
                weights.append(0)
                behind -= 3
            entries.append(behind << 6 | at)
            weights.append(int(codes[(*key, c)]))
            behind = 0
        behind += 1
    if 1 + count + len(pairs) > MOST_ENTRIES:
        raise OverflowError(1 + count + len(pairs))
    return (
        np.array(sorted(pairs, key=lambda pair: pairs[pair]), np.uint8).reshape(-1, 2),
        np.array(entries, np.uint8),
        np.array(weights, np.int16),
    )


def _without_common(weights: Floats, n: int, many: bool) -> Floats:
    """Return the stored weights with the common coordinates added to every contact's."""
    if not many:
        return weights
    result = np.array(weights[..., 3:])
    result[..., : 3 * n] += np.tile(weights[..., :3], n)
    return result


def _bounds(separation: Separation, stored: Separation, n: int) -> tuple[Floats, Floats, float]:
    """Return bounds of the position errors (n,), of the speeds (k, n) and of the errors' drift.

    Terms of one parameter are compared with the exact ones as vectors, place by place; those of
    several are bounded by the triangle inequality.  Between two dense places the error of a smooth
    mode changes by less than between neighbouring places: half of that is added.
    """
    k = len(separation.modes)
    speed, error = np.zeros((k, n)), np.zeros(n)
    drift = np.zeros(n)
    per_place = float(DENSE - 1)

    def fastest(mode: Floats) -> float:
        return float(np.abs(np.diff(mode)).max()) * per_place

    zero = (0,) * k
    error += _norms(separation.weights[zero][: 3 * n] - stored.weights[zero][: 3 * n], n)
    # Next to none of the products are there: of eight revolute joints 30 of 6,561.
    for place in np.argwhere(separation.weights[..., : 3 * n].any(axis=-1)):
        index = tuple(int(i) for i in place)
        used = [p for p in range(k) if index[p] > 0]
        here, there = separation.weights[index][: 3 * n], stored.weights[index][: 3 * n]
        size, rounded = _norms(here, n), _norms(here - there, n)
        for p in used:
            speed[p] += size * fastest(separation.modes[p][index[p] - 1])
        if len(used) < 2:
            continue
        apart = [separation.modes[p][index[p] - 1] - stored.modes[p][index[p] - 1] for p in used]
        # Modes are at most 1 in size, stored ones a hair more: hence the tenth.
        error += 1.1 * (size * sum(float(np.abs(one).max()) for one in apart) + rounded)
        for p, one in zip(used, apart, strict=True):
            others = sum(float(np.abs(x).max()) for x in apart)
            mode = fastest(separation.modes[p][index[p] - 1])
            drift += 1.1 * (size * (fastest(one) + others * mode) + rounded * mode)
    for p in range(k):
        apart_at = np.zeros((3 * n, DENSE))
        for r in range(len(separation.modes[p])):
            take: tuple[int, ...] = tuple(r + 1 if other == p else 0 for other in range(k))
            apart_at += np.outer(separation.weights[take][: 3 * n], separation.modes[p][r])
            apart_at -= np.outer(stored.weights[take][: 3 * n], stored.modes[p][r])
        vectors = apart_at.reshape(n, 3, DENSE)
        change = np.sqrt((np.diff(vectors, axis=2) ** 2).sum(axis=1)).max(axis=1)
        error += np.sqrt((vectors**2).sum(axis=1)).max(axis=1) + 0.5 * change
        drift += change * per_place
    reach = np.abs(separation.weights).sum(axis=tuple(range(k)))[: 3 * n]
    return error + ROUNDING * _norms(reach, n), speed, float(drift.max(initial=0.0))


def _norms(vector: Floats, n: int) -> Floats:
    return np.asarray(np.sqrt((vector.reshape(n, 3) ** 2).sum(axis=1)))
