"""Sizes of the codec `grid`: bytes of its trees, bits of a code and nodes per axis of each table.

Owns which axes a table has (found by probing), and how nodes are shared out over them.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from firmware_export.truth import Model

# Tables of lengths; what else is held is the trees.
GROUPS = ("sdg", "height")
LARGEST = 65
# Nodes of an axis, and bytes of a tree, at least; bytes of a tree at most.
FEWEST, LEAST, MOST_TREE = 3, 32, 65535
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
    tree : int
        Bytes of the trees of all faces, at most.
    nodes : tuple of (str, tuple of int)
        Per table its name and the nodes of each parameter, of v and of u; 1 for an axis on
        which nothing depends.
    """

    bits: int
    tree: int
    nodes: tuple[tuple[str, tuple[int, ...]], ...] = ()

    @property
    def label(self) -> str:
        """Short text, such as ``grid u8 tree 9000 sdg 5x5x9x9``."""
        parts = [f"{name} {'x'.join(map(str, nodes))}" for name, nodes in self.nodes]
        return " ".join([f"grid u{self.bits} tree {self.tree}", *parts])

    @classmethod
    def of_label(cls, label: str) -> "Spec":
        """Return the size with a label.

        Examples
        --------
        >>> Spec.of_label("grid u8 tree 9000 sdg 9x9")
        Spec(bits=8, tree=9000, nodes=(('sdg', (9, 9)),))
        """
        _, bits, _, tree, *words = label.split()
        tables = zip(words[::2], words[1::2], strict=True)
        nodes = tuple((name, tuple(map(int, shape.split("x")))) for name, shape in tables)
        return cls(int(bits[1:]), int(tree), nodes)


@lru_cache(maxsize=8)
def active_axes(model: Model, name: str) -> tuple[bool, ...]:
    """Tell for each parameter, for v and for u whether a table's value depends on it.

    Compares the exact value at places that differ along one axis only.
    """
    rng = np.random.default_rng(SEED)
    axes = model.k + 2
    result = []
    for axis in range(axes):
        base = rng.random((12, axes))
        place = np.repeat(base[:, None], PROBES, axis=1)
        place[:, :, axis] = np.linspace(0.0, 1.0, PROBES)
        params = model.at(place[..., : model.k].reshape(12 * PROBES, model.k))
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


def even(model: Model, name: str, nodes: int) -> tuple[int, ...]:
    """Return the nodes of each axis of a table of at most so many in all, alike as far as can be.

    FEWEST at least on each axis on which the table depends.
    """
    active = active_axes(model, name)
    faces = model.faces if any(active[-2:]) else 1
    shape = [FEWEST if on else 1 for on in active]
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


def of_nodes(model: Model, channels: tuple[str, ...], nodes: dict[str, int], bits: int) -> Spec:
    """Return the size whose tables have at most so many nodes each, spread over the axes.

    `nodes` counts those of ``sdg`` and ``height``, and the bytes of ``tip``; each has a few at
    least.
    """
    shapes = [(name, even(model, name, nodes.get(name, 0))) for name in GROUPS if name in channels]
    tree = min(max(nodes.get("tip", 0), LEAST), model.faces * MOST_TREE)
    return Spec(bits, tree, tuple(shapes))
