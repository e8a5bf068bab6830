"""Maps of the trained tables that mean nothing: what matters of them is how they are read."""

import numpy as np

from firmware_export.grid.ground import ground_of
from firmware_export.grid.table import Spec, Tables
from firmware_export.grid.train import Lattice
from firmware_export.protocol import Export
from firmware_export.truth import Model
from lutgen.quantities import EXPORTABLE

__all__ = ["noise"]


def noise(
    name: str, model: Model, shape: tuple[int, ...], lengths: tuple[str, ...] = (), seed: int = 8
) -> Export:
    """Return tables of so many nodes (parameters, v and u) with random knots and codes.

    Of a chart of six faces one is held by no block.
    """
    rng, ground = np.random.default_rng(seed), ground_of(model)
    count = [n + int(r) for n, r in zip(shape, (*ground.rounds, False, False), strict=True)]
    knots = np.zeros((len(shape), max(count)), np.float32)
    for axis, n in enumerate(count):
        inner = 3000 + np.sort(rng.choice(59_000, n, replace=False))
        knots[axis, :n] = inner if axis >= model.k else [0, *inner[1:-1], 65535]
    block = np.full(6, -1, np.int8)
    held = max(1, model.faces - 1)
    block[:held] = rng.permutation(held)
    codes = rng.integers(0, 256, (1 + len(lengths), held * int(np.prod(shape)))).astype(np.uint8)
    channels = tuple(one for one in EXPORTABLE if one in (*lengths, "tip_angle"))
    lattice = Lattice(np.array(shape), np.array(count) - 1, knots)
    tables = Tables(Spec(shape), channels, ground, lattice, block, codes, (0.01,) * len(lengths))
    return Export(name, model.recipe, model, "grid", "integer", channels, tables)
