"""Tables of three contact points over the parameters.

Nodes are evenly spaced and shifted by half of the distance between chord and arc, so that errors
lie on both sides alike.  A table has the axes on which its point depends.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from firmware_export.truth import Model, combinations, widened
from lutgen.vector import Floats

# Units from the com to the furthest contact: products of two of them stay in 31 bits.
UNITS = 16000
MOST_AXES = 4
PROBES = 9
NEGLIGIBLE = 1e-9


@dataclass(frozen=True, eq=False)
class Point:
    """The table of one contact over the parameters on which it depends.

    `codes` (nodes..., 3) are x, y, z in units, or of 8 bits in 128 units.
    """

    axes: tuple[int, ...]
    codes: NDArray[np.int16] | NDArray[np.int8]


@lru_cache(maxsize=4)
def depends_on(model: Model, contact: int) -> tuple[int, ...]:
    """Return the parameters on which a contact's position relative to the com depends."""
    rng = np.random.default_rng(6)
    found = []
    for axis in range(model.k):
        t = np.repeat(rng.random((12, 1, model.k)), PROBES, axis=1)
        t[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
        p = _contact(model, contact, t.reshape(-1, model.k)).reshape(12, PROBES, 3)
        if np.abs(p - p[:, :1]).max() > NEGLIGIBLE * np.abs(p).max():
            found.append(axis)
    return tuple(found)


@lru_cache(maxsize=16)
def curvature(model: Model, axis: int) -> float:
    """Return how far (length) any contact's arc along an axis is from its chord at most."""
    t = np.repeat(np.random.default_rng(6).random((12, 1, model.k)), PROBES, axis=1)
    t[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
    p = model.postures(model.at(t.reshape(-1, model.k))).centres.reshape(12, PROBES, -1)
    second = p[:, 2:] - 2.0 * p[:, 1:-1] + p[:, :-2]
    return float(np.abs(second).max()) * (PROBES - 1) ** 2 / 8.0


def _contact(model: Model, contact: int, t: Floats) -> Floats:
    """Return the positions (m, 3) of a contact at places t (m, k) of the box."""
    return model.postures(model.at(t)).centres[:, contact]


def reach_of(model: Model) -> float:
    """Return how far (length) a contact is from the com at most, in many postures."""
    t = np.random.default_rng(7).random((4000, model.k))
    t[:1000] = np.rint(t[:1000])
    return 1.02 * float(np.sqrt((model.postures(model.at(t)).centres ** 2).sum(axis=2)).max())


def fit_point(model: Model, contact: int, nodes: tuple[int, ...], bits: int, unit: float) -> Point:
    """Return the table of one contact, in units, of so many nodes along each of its axes.

    The model's box is what sensors may say (`widened`).
    """
    axes = depends_on(model, contact)

    def exact(places: list[Floats]) -> Floats:
        grid = combinations(places)
        t = np.full((len(grid), model.k), 0.5)
        t[:, list(axes)] = grid
        shape = (*(len(one) for one in places), 3)
        return _contact(model, contact, t).reshape(shape)

    knots = [np.linspace(0.0, 1.0, n) for n in nodes]
    values = exact(knots)
    shift = np.zeros_like(values)
    for axis, knot in enumerate(knots):
        middles = [*knots]
        middles[axis] = (knot[1:] + knot[:-1]) / 2.0
        before = np.moveaxis(values, axis, 0)
        sag = np.moveaxis(exact(middles), axis, 0) - (before[1:] + before[:-1]) / 2.0
        both = np.concatenate([sag[:1], (sag[1:] + sag[:-1]) / 2.0, sag[-1:]])
        shift += np.moveaxis(both, 0, axis) / 2.0
    step = unit * (128 if bits == 8 else 1)
    most = 127 if bits == 8 else 16383
    codes = np.clip(np.rint((values + shift) / step), -most, most)
    return Point(axes, codes.astype(np.int8) if bits == 8 else codes.astype(np.int16))


def bounds(model: Model) -> tuple[Model, float]:
    """Return the model over what sensors may say, and the length of a unit."""
    wide = widened(model)
    return wide, reach_of(wide) / UNITS
