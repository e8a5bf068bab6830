"""What a robot's contacts depend on, found by probing: sums of products of functions.

Owns the separation P(q) = sum over terms of weight x product of modes, where a mode is a function
of a single parameter (cos and sin of a revolute joint, the travel of a prismatic one).  A tree of
joints has this form exactly; a function given in Python is tested for it.  Storing the modes takes
tables of one dimension only, whatever the number of parameters.
"""

import math
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from firmware_export.truth import Model
from lutgen.errors import InputError
from lutgen.support import DISC
from lutgen.vector import Floats

DENSE = 1025
"""Places per parameter at which modes are known."""
PROBES = 8
RELATIVE = 1e-9
"""Functions that differ by less than this part of the robot's size are equal."""
MOST_MODES = 6
MOST_POSTURES = 20_000


@dataclass(frozen=True, eq=False)
class Separation:
    """Coordinates as sums of products.

    Attributes
    ----------
    modes : tuple of (r_p, DENSE) float64
        Per parameter its modes at evenly spaced places, each between -1 and 1.
    weights : (r_1 + 1, ..., r_k + 1, c) float64
        Index 0 along a parameter stands for 1, index i for its mode i - 1.  Coordinates: x, y, z of
        every contact relative to the com, then x, y, z of every distinct disc axis.
    hinge_of : (n,) int64
        Which axis each contact has; -1 for points and spheres.
    """

    modes: tuple[Floats, ...]
    weights: Floats
    hinge_of: NDArray[np.int64]


class Coordinates:
    """The coordinates of a model as one vector-valued function of its parameters."""

    def __init__(self, model: Model) -> None:
        self.model = model
        random = np.random.default_rng(11)
        some = model.postures(model.at(random.random((4, model.k)))).axes
        self.hinge_of = np.full(len(model.kind), -1, np.int64)
        self.leaders: list[int] = []
        for i in np.flatnonzero(model.kind == DISC):
            for h, leader in enumerate(self.leaders):
                # An axis and its opposite are one hinge.
                apart = np.abs(some[:, i] - some[:, leader]).max()
                if min(apart, np.abs(some[:, i] + some[:, leader]).max()) < RELATIVE:
                    self.hinge_of[i] = h
                    break
            else:
                self.hinge_of[i] = len(self.leaders)
                self.leaders.append(int(i))

    def __call__(self, t: Floats) -> Floats:
        """Return (m, c) coordinates at places (m, k)."""
        where = self.model.postures(self.model.at(t))
        parts = (where.centres, where.axes[:, self.leaders])
        return np.concatenate([part.reshape(len(t), -1) for part in parts], axis=1)


def separate(model: Model) -> Separation:
    """Find the modes and weights of a model.

    Raises
    ------
    InputError
        If the contacts are no such sum (a function given in Python can be anything), or one of too
        many terms.
    """
    source = model.recipe.source
    coordinates = Coordinates(model)
    size = float(np.abs(coordinates(np.full((1, model.k), 0.5))).max())
    modes = tuple(_modes(coordinates, p, RELATIVE * size) for p in range(model.k))
    if any(len(found) > MOST_MODES for found in modes):
        worst = max(range(model.k), key=lambda p: len(modes[p]))
        raise InputError(
            f"{source}: the contacts follow parameter {model.recipe.parameters[worst].name} in "
            f"more than {MOST_MODES} independent ways (got {len(modes[worst])}); use --codec grid"
        )
    count = math.prod(len(found) + 1 for found in modes)
    if count > MOST_POSTURES:
        raise InputError(
            f"{source}: the contacts may be a sum of up to {count} products, more than "
            f"{MOST_POSTURES}; use --codec grid"
        )
    weights = _weights(coordinates, modes)
    weights[np.abs(weights) < RELATIVE * size] = 0.0
    result = Separation(modes, weights, coordinates.hinge_of)
    random = np.random.default_rng(12)
    places = random.integers(0, DENSE, (200, model.k))
    error = np.abs(evaluate(result, places) - coordinates(places / (DENSE - 1))).max()
    if error > 1e3 * RELATIVE * size:
        raise InputError(
            f"{source}: the contacts are no sum of products of functions of one parameter each "
            f"(they differ by {error:.3g}); use --codec grid"
        )
    return result


def evaluate(separation: Separation, places: NDArray[np.int64]) -> Floats:
    """Return the coordinates (m, c) at (m, k) indices of dense places.

    Sums the products that are there: of eight revolute joints some 30 of 6,561.
    """
    weights = separation.weights
    result = np.zeros((len(places), weights.shape[-1]))
    for index in np.argwhere(weights.any(axis=-1)):
        factor = np.ones(len(places))
        for p in np.flatnonzero(index):
            factor *= separation.modes[p][index[p] - 1, places[:, p]]
        result += factor[:, None] * weights[tuple(index)]
    return result


def _modes(coordinates: Coordinates, p: int, tolerance: float) -> Floats:
    """Return (r, DENSE) functions of parameter p that, with 1, span every coordinate's."""
    k = coordinates.model.k
    random = np.random.default_rng(20 + p)
    coarse = np.linspace(0, DENSE - 1, 65).astype(np.int64)
    anchors = random.random((PROBES, k))
    rows = []
    for anchor in anchors:
        places = np.repeat(anchor[None], len(coarse), axis=0)
        places[:, p] = coarse / (DENSE - 1)
        rows.append(coordinates(places).T)
    count = rows[0].shape[0]
    left = np.concatenate(rows)
    left = left - left.mean(axis=1, keepdims=True)
    basis = np.empty((0, len(coarse)))
    chosen: list[int] = []
    while len(chosen) <= MOST_MODES:
        size = np.abs(left).max(axis=1)
        pick = int(size.argmax())
        if size[pick] <= tolerance:
            break
        chosen.append(pick)
        basis = np.vstack([basis, left[pick] / np.linalg.norm(left[pick])])
        left = left - (left @ basis[-1])[:, None] * basis[-1]
        left = left - (left @ basis.T) @ basis  # again: rounding
    modes = np.empty((len(chosen), DENSE))
    for r, pick in enumerate(chosen):
        places = np.repeat(anchors[pick // count][None], DENSE, axis=0)
        places[:, p] = np.arange(DENSE) / (DENSE - 1)
        value = coordinates(places)[:, pick % count]
        middle, half = (value.max() + value.min()) / 2.0, (value.max() - value.min()) / 2.0
        modes[r] = (value - middle) / half
    return modes


def _weights(coordinates: Coordinates, modes: tuple[Floats, ...]) -> Floats:
    """Return the weights by interpolation at as many places per parameter as it has functions."""
    bases = [np.vstack([np.ones(DENSE), found]) for found in modes]
    picks = [_independent(basis) for basis in bases]
    combined = list(product(*picks))
    grid = np.array(combined, dtype=np.float64).reshape(len(combined), len(modes))
    value = coordinates(grid / (DENSE - 1)).reshape(*(len(pick) for pick in picks), -1)
    for p, (basis, pick) in enumerate(zip(bases, picks, strict=True)):
        solve = np.linalg.inv(basis[:, pick].T)
        value = np.moveaxis(np.tensordot(solve, value, axes=(1, p)), 0, p)
    return np.asarray(value)


def _independent(basis: Floats) -> list[int]:
    """Return places at which the rows of a basis are well told apart (pivoted elimination)."""
    left = basis.copy()
    picks: list[int] = []
    for _ in range(len(basis)):
        pick = int(np.linalg.norm(left, axis=0).argmax())
        picks.append(pick)
        direction = left[:, pick] / np.linalg.norm(left[:, pick])
        left = left - np.outer(direction, direction @ left)
    return picks
