"""Sizes of the codec `grid`: bits of a code and nodes per axis of each table.

Owns which axes a table has (found by probing), the smallest sensible sizes, and how a size grows.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from firmware_export.truth import Model

GROUPS = ("tip", "sdg", "height")
CHANNEL = {"tip": "tip_angle", "sdg": "sdg", "height": "height"}
LARGEST = 65
# Nodes of each axis to begin with where the region jumps.
ROUGH = 9
# Places looked at per axis when asking whether a value depends on it.
PROBES = 9
SEED = 20


@dataclass(frozen=True)
class Spec:
    """A size.

    Parameters
    ----------
    bits : int
        8 or 16.
    nodes : tuple of (str, tuple of int)
        Per table its name and the nodes of each parameter, of v and of u; 1 for an axis on
        which nothing depends.
    """

    bits: int
    nodes: tuple[tuple[str, tuple[int, ...]], ...]

    @property
    def label(self) -> str:
        """Short text, such as ``grid u8 tip 7x7x13x13 sdg 5x5x9x9``."""
        parts = [f"{name} {'x'.join(map(str, nodes))}" for name, nodes in self.nodes]
        return f"grid u{self.bits} {' '.join(parts)}"

    def shape(self, name: str) -> tuple[int, ...]:
        """Nodes of a table, parameters first, then v and u."""
        return dict(self.nodes)[name]


@lru_cache(maxsize=8)
def active_axes(model: Model, name: str) -> tuple[bool, ...]:
    """Tell for each parameter, for v and for u whether a table's value depends on it.

    Compares the exact value at places that differ along one axis only.
    """
    rng = np.random.default_rng(SEED)
    axes = model.k + 2
    if name == "tip":
        return (True,) * axes
    result = []
    for axis in range(axes):
        base = rng.random((12, axes))
        place = np.repeat(base[:, None], PROBES, axis=1)
        place[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
        params = (
            (model.lower + (model.upper - model.lower) * place[..., : model.k]).reshape(-1, model.k)
            if model.k
            else np.zeros((12 * PROBES, 0))
        )
        face = rng.integers(model.faces, size=12)[:, None]
        u, v = ((2.0 * place[..., at] - 1.0) * model.chart_limit for at in (-1, -2))
        gravity = model.uv_to_gravity(face, u, v).reshape(-1, 1, 3)
        exact = model.exact(params, gravity)
        value = exact.height_beyond if name == "height" else exact.along
        known = value.reshape(12, PROBES)
        with np.errstate(invalid="ignore"):
            spread = np.abs(known - known[:, :1])
        size = np.nanmax(np.abs(known), initial=1e-300)
        result.append(bool(np.nanmax(spread, initial=0.0) > 1e-9 * size))
    return tuple(result)


def start(model: Model, channels: tuple[str, ...], arithmetic: str) -> list[Spec]:
    """Return the smallest sensible size for each bit width."""
    nodes = []
    for name in GROUPS:
        if CHANNEL[name] in channels or name == "tip":
            active = active_axes(model, name)
            # A region that jumps needs knots where it does.
            few = 3 if model.single_facet else ROUGH if name == "tip" else 5
            count = [few] * model.k + [5 if model.single_facet else few] * 2
            shape = tuple(n if on else 1 for n, on in zip(count, active, strict=True))
            nodes.append((name, shape))
    return [Spec(bits, tuple(nodes)) for bits in (8, 16)]


def even(model: Model, name: str, nodes: int) -> tuple[int, ...]:
    """Return the nodes of each axis of a table of at most so many in all, alike as far as can be.

    Three at least on each axis on which the table depends.
    """
    active = active_axes(model, name)
    faces = model.faces if any(active[-2:]) else 1
    shape = [3 if on else 1 for on in active]
    while True:
        total = faces * math.prod(shape)
        able = [
            axis
            for axis, on in enumerate(active)
            if on and shape[axis] < LARGEST and total // shape[axis] * (shape[axis] + 1) <= nodes
        ]
        if not able:
            return tuple(shape)
        shape[min(able, key=lambda axis: shape[axis])] += 1


def grow(model: Model, spec: Spec) -> list[Spec]:
    """Return the next larger sizes: one axis of one table each, v and u together.

    Tables of robots whose region jumps take long to fit and are grown in larger steps.
    """
    result = []
    for at, (name, shape) in enumerate(spec.nodes):
        for axis in range(model.k + 1):
            if shape[axis] == 1 or shape[axis] >= LARGEST:
                continue
            # v and u are alike: an odd number keeps a knot in the middle.
            more = shape[axis] + (2 if axis == model.k or shape[axis] >= 9 else 1)
            if not model.single_facet:
                more = shape[axis] + max(2, shape[axis] // 4)
            larger = list(shape)
            larger[axis] = more
            if axis == model.k:
                larger[axis + 1] = more if shape[axis + 1] > 1 else 1
            nodes = list(spec.nodes)
            nodes[at] = (name, tuple(larger))
            result.append(replace(spec, nodes=tuple(nodes)))
    return result
