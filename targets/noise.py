"""Maps of the codec `grid` that mean nothing: what matters of them is how they are read."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from firmware_export.grid.spec import Spec
from firmware_export.grid.tables import RATE, SPAN, Fold, Part, Tables, Trees, U, V, places_of
from firmware_export.protocol import Export
from firmware_export.truth import Model
from firmware_export.verdict.grow import Nodes
from firmware_export.verdict.prune import HALF, INNER, SAFE, UNSAFE, leaf_bytes
from firmware_export.verdict.tree import packed, whole
from lutgen.quantities import EXPORTABLE

__all__ = ["noise", "noise_trees"]

# What a leaf is, and how often.
LEAVES, SHARES = (HALF, SAFE, UNSAFE), (0.7, 0.2, 0.1)
SPARSE = Fold(0, 2 * RATE - 1, 1 - 2 * RATE)


def noise_trees(dims: int, faces: int, size: int, seed: int = 8) -> Trees:
    """Return trees of so many bytes each, nearly, whose boxes are halved anywhere."""
    rng = np.random.default_rng(seed)
    halved = faces * max(1, size // (2 + leaf_bytes(dims)))
    count = faces + 2 * halved
    kind = rng.choice(LEAVES, count, p=SHARES).astype(np.int8)
    axis, child = rng.integers(dims, size=count).astype(np.int8), np.zeros(count, np.int64)
    # In the order in which nodes come: trees as flat as can be.
    kind[:halved] = INNER
    child[:halved] = faces + 2 * np.arange(halved)
    plane = rng.uniform(-1.0, 1.0, (count, dims + 1))
    plane[:, dims] = 0.5 * plane[:, :dims].sum(axis=1)
    empty = np.zeros((count, dims))
    none = np.zeros(count)
    nodes = Nodes(axis, child, child, empty, empty, plane, none, none, none, child, child)
    held, levels = packed(nodes, kind, whole(plane[:, dims], dims), 0, faces)
    return Trees(SPARSE if faces == 1 else Fold(1 << 15, RATE, RATE), 0, levels, held)


def _table(name: str, faces: int, shape: tuple[int, ...], dtype: Any, params: int) -> Part:
    """Return a table over the first axes of a robot; all its heights are above zero.

    Knots are even along parameters, and where there are none; else those of u and v are not.
    """
    bent = [1.0 if axis < params or not params else 1.25 for axis in range(len(shape))]
    knots = tuple(
        (SPAN * np.linspace(0.0, 1.0, n) ** power).round().astype(np.uint16)
        for n, power in zip(shape, bent, strict=True)
    )
    rng = np.random.default_rng(len(shape) + faces)
    most = np.iinfo(dtype).max
    codes = rng.integers(0, most, (faces, *shape, 2 if name == "sdg" else 1)).astype(dtype)
    offset = np.full(2, 0.1 if name == "height" else -0.4, np.float32)
    axes = (*range(params), V, U)[: len(shape)]
    return Part(name, axes, knots, codes, offset, np.float32(1.0 / most))


def noise(
    name: str,
    model: Model,
    arithmetic: str,
    size: int,
    shapes: Mapping[str, tuple[int, ...]] | None = None,
    bits: int = 8,
) -> Export:
    """Return a map with trees of so many bytes, and a table of each shape that is asked for.

    `shapes`: nodes of ``sdg`` and ``height`` along the parameters, v and u, or the first of these.
    """
    shapes = shapes or {}
    dtype = np.uint8 if bits == 8 else np.uint16
    parts = tuple(
        _table(one, model.faces if len(shape) > model.k else 1, shape, dtype, model.k)
        for one, shape in shapes.items()
    )
    channels = tuple(one for one in EXPORTABLE if one in (*shapes, "tip_angle"))
    trees = noise_trees(model.k + 2, model.faces, size)
    tables = Tables(
        Spec(bits, size), channels, trees, parts, model.chart_limit, places_of(model), "noise"
    )
    return Export(name, model.recipe, model, "grid", arithmetic, channels, tables)
