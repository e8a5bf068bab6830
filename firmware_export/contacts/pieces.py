"""Positions of a robot that is given by code as Chebyshev series over pieces of its box.

Axes are cut where the function has a kink, else in the middle, until few terms hold it along the
axis.  Then every piece gets the tensor product of these, and `series` leaves out what is small.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from firmware_export.contacts.lines import find_break, find_jump
from firmware_export.truth import (
    Model,
    chebyshev_nodes,
    chebyshev_transform,
    combinations,
    widened,
)
from lutgen.errors import InputError
from lutgen.recipe import robot_size_of
from lutgen.vector import Floats

MOST_PARAMETERS = 3
# Nodes along a line, and the most terms along an axis by the number of parameters.
LINE_NODES, MOST_LENGTH = 49, (1, 40, 24, 16)
# Pieces of an axis, and nodes of all pieces: bounds of time and memory.
MOST_PIECES, MOST_NODES = 64, 100_000
LINES, SEED = 12, 11
# Parts of the size by which what jumps still differs over the shortest stretch that is looked at: a
# square root at the end of its range differs there by 1e-6.
JUMP = 1e-5
# Part of the error asked for at which a series along an axis has ended.
ENDED = 0.05


@dataclass(frozen=True, eq=False)
class Pieces:
    """Series over pieces.

    `knots`: of each axis (p + 1,), rad or length, exact in single precision; `series`:
    (p_1, ..., p_k, n_1, ..., n_k, groups, 3) float64, coefficients of T_a1(s_1) ... T_ak(s_k) with
    s from -1 to 1 over a piece, length.
    """

    knots: tuple[Floats, ...]
    series: Floats

    @property
    def shape(self) -> tuple[int, ...]:
        """Pieces of each axis."""
        return tuple(len(one) - 1 for one in self.knots)


def pieces_of(model: Model, order: tuple[int, ...], error: float, common: bool) -> Pieces:
    """Return series that are off by less than about `error` (length).

    Parameters
    ----------
    model : Model
        Its box is widened by what sensors may say beyond its ends.
    order : tuple of int
        Places of the contacts in the recipe, in the order of the series.
    error : float
        Length.
    common : bool
        Whether the groups are minus the com, and contacts in the robot's own frame; else contacts
        relative to the com.

    Raises
    ------
    InputError
        Where the positions jump, or too many pieces would be needed.
    """
    box = widened(model)
    place = _function(box, order, common)
    ends = zip(box.lower, box.upper, strict=True)
    knots, lengths = [], []
    for axis, (low, high) in enumerate(ends):
        single = np.array([low, high], np.float32).astype(np.float64)
        cuts, length = _cut(box, place, axis, single, error)
        knots.append(cuts)
        lengths.append(length)
        nodes = math.prod(len(one) - 1 for one in knots) * math.prod(lengths)
        if nodes > MOST_NODES:
            raise InputError(_too_many(error))
    return Pieces(tuple(knots), _series(place, knots, lengths))


def _too_many(error: float) -> str:
    return (
        f"its positions cannot be held to {error:.3g} by a moderate number of polynomials (they "
        "have kinks along no axis, or bend too fast); use --codec grid"
    )


def _function(box: Model, order: tuple[int, ...], common: bool) -> Callable[[Floats], Floats]:
    """Return params (m, k) -> groups (m, g, 3), length."""

    def place(params: Floats) -> Floats:
        found = box.postures(params)
        centres, com = found.centres[:, order], found.com[:, None]
        return np.concatenate([-com, centres + com], axis=1) if common else centres

    return place


@lru_cache(maxsize=8)
def com_moves(model: Model) -> bool:
    """Whether the com moves in the robot's own frame: then all contacts share that."""
    t = np.random.default_rng(SEED).random((500, model.k))
    com = model.postures(model.at(t)).com
    return bool(np.ptp(com, axis=0).max() > 1e-9 * robot_size_of(model.recipe))


def _bases(box: Model) -> Floats:
    """Return the postures (l, k) through which the lines go: some corners, the middle, others."""
    rng = np.random.default_rng(SEED)
    t = rng.random((LINES, box.k))
    t[:4] = rng.integers(0, 2, (4, box.k))
    t[4] = 0.5
    return box.at(t)


def _cut(
    box: Model, place: Callable[[Floats], Floats], axis: int, ends: Floats, error: float
) -> tuple[Floats, int]:
    """Return the knots of an axis, and how many terms each piece needs along it."""
    bases, size = _bases(box), robot_size_of(box.recipe)
    matrix = chebyshev_transform(LINE_NODES)

    def line(x: Floats) -> Floats:
        params = np.broadcast_to(bases, (len(x), *bases.shape)).copy()
        params[..., axis] = x
        return place(params.reshape(-1, box.k)).reshape(*params.shape[:2], -1)

    knots = ends
    while True:
        longest = 1
        for low, high in pairwise(knots):
            x = low + (chebyshev_nodes(LINE_NODES)[:, None] + 1.0) / 2.0 * (high - low)
            found = np.tensordot(matrix, line(x), (1, 0))
            above = np.flatnonzero(np.abs(found).max(axis=(1, 2)) > ENDED * error)
            length = int(above[-1]) + 1 if len(above) else 1
            if length > MOST_LENGTH[box.k]:
                break
            longest = max(longest, length)
        else:
            return knots, longest
        if len(knots) > MOST_PIECES:
            raise InputError(_too_many(error))
        jump, where = find_jump(low, high, line)
        if jump > JUMP * size:
            name = box.recipe.parameters[axis].name
            raise InputError(
                f"its positions jump (by {jump:.3g} where {name} is {where:.6g}), which no table "
                "may hold; let them be continuous, or use --codec grid"
            )
        cut = float(np.float32(find_break(low, high, line)))
        if not low < cut < high:
            raise InputError(_too_many(error))
        knots = np.sort(np.append(knots, cut))


def _series(
    place: Callable[[Floats], Floats], knots: Sequence[Floats], lengths: Sequence[int]
) -> Floats:
    """Return the series of all pieces, see `Pieces`; one node more than there are terms."""
    k, counts = len(knots), [n + 1 for n in lengths]
    axes = [
        (one[:-1, None] + (chebyshev_nodes(n) + 1.0) / 2.0 * np.diff(one)[:, None]).ravel()
        for one, n in zip(knots, counts, strict=True)
    ]
    value = place(combinations(axes))
    shape = [number for one, n in zip(knots, counts, strict=True) for number in (len(one) - 1, n)]
    value = value.reshape(*shape, *value.shape[1:])
    for axis, n in enumerate(counts):
        value = np.moveaxis(
            np.tensordot(chebyshev_transform(n)[: n - 1], value, (1, 2 * axis + 1)), 0, 2 * axis + 1
        )
    order = [*range(0, 2 * k, 2), *range(1, 2 * k, 2), 2 * k, 2 * k + 1]
    return np.ascontiguousarray(value.transpose(order))
