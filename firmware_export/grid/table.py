"""Codec `grid` for more than three contacts: trained tables over the parameters, face, v and u.

The layout is that of runtime/smap_grid.c, which reads without floats.  `ground`, `train` and `fit`
make the numbers.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import fit
from firmware_export.grid.ground import Fold, Ground
from firmware_export.grid.lookup import INFO as LOOKUP
from firmware_export.grid.train import Lattice
from firmware_export.model import Model, Sample
from firmware_export.protocol import CArray, CBody, Channels, Codec
from firmware_export.protocol import Tables as AnyTables
from lutgen.vector import Floats

# Its number in runtime/smap_map.h; parameters that the runtime takes, and the largest u.
GRID, MOST_PARAMS, STEEPEST = 4, 6, 15.9
LENGTHS = ("sdg", "height")
# Rounds in which a table is lowered after a failed test, and by how much further each time: the
# windows that are left are ever more and smaller.
AGAIN, LOWER = 2, 0.5
# Bytes beside codes and knots: those of the head, and of each parameter.
HEAD, PARAMETER = 60, 24
TESTED = "the table was lowered where fresh points were called safe that tip: tested, not proved"


@dataclass(frozen=True)
class Spec:
    """A size: the nodes of each parameter, of v and of u."""

    nodes: tuple[int, ...]
    bits: int = 8

    @property
    def label(self) -> str:
        """Short text, such as ``grid u8 18x18x15x13``."""
        return f"grid u{self.bits} " + "x".join(map(str, self.nodes))


@dataclass(frozen=True, eq=False)
class Tables(AnyTables):
    """Codes of the tip angle and of lengths on one lattice.

    `block` (6,) is of each face the block of its codes, -1: none; `codes` (tables, blocks x nodes);
    `steps` are the lengths of a code of each table after the first.
    """

    spec: Spec
    channels: Channels
    ground: Ground
    lattice: Lattice
    block: NDArray[np.int8]
    codes: NDArray[np.uint8]
    steps: tuple[float, ...]
    guard: float = 0.0
    guard_text: str = TESTED
    tested = True

    @property
    def knots(self) -> list[NDArray[np.uint16]]:
        """The knots of each axis."""
        rows = zip(self.lattice.knots, self.lattice.cells, strict=True)
        return [row[: cells + 1].astype(np.uint16) for row, cells in rows]

    def body(self, integer: bool) -> CBody:
        """Return the tables for the emitter."""
        ground, knots = self.ground, self.knots
        params = len(ground.places)
        fold = ground.fold or Fold(tuple(range(params)), (False,) * params)
        first = 24 + 6 * params + sum(2 + one.nbytes for one in knots)
        limit = [math.ceil(ground.model.chart_limit * 8193.0), self.codes.shape[1]]
        blocks = int(self.block.max()) + 1
        head = [len(self.codes), blocks, int(ground.fold is not None), 0]
        counts = [*head, *self.block.view(np.uint8), 0, 0]
        arrays = [
            CArray("limit", "uint32_t", limit, "chart, codes", False),
            CArray("counts", "uint8_t", counts, "tables, faces", False),
            CArray("first", "uint32_t", [first], "where the codes are", False),
        ]
        for i, place in enumerate(ground.places):
            mirror = [fold.partner[i], fold.over[i] * (1 + int(ground.rounds[i]))]
            arrays.append(CArray("place", "uint16_t", [place.first, place.rate], "steps", False))
            arrays.append(CArray("mirror", "uint8_t", mirror, "of which it is the image", False))
        axes = [[n, len(one)] for n, one in zip(self.spec.nodes, knots, strict=True)]
        arrays.append(CArray("axes", "uint8_t", axes, "nodes and knots of each axis"))
        arrays += [CArray("knots", "uint16_t", one, "places of an axis") for one in knots]
        names = ("tip_angle", *_lengths(self.channels))
        for name, codes in zip(names, self.codes, strict=True):
            arrays.append(CArray(f"{name} codes", "uint8_t", codes, "one for each node"))
        words = 1 + (max(params, 1) + 1) // 2
        steps = zip(names[1:], (step / 128.0 for step in self.steps), strict=True)
        return CBody(GRID, tuple(arrays), 0, (), (words, words), lengths=tuple(steps))

    def lowered(self, params: Floats, gravity: Floats, seed: int) -> "Tables":
        """Return tables that call none of some points safe, lowered near them and anew.

        The `seed` counts the tests that have found any.
        """
        values, lesson = self.codes[0].astype(np.float32), fit.learn(self.ground.narrow)
        wrong = [Sample(params, gravity[:, None])]
        least = fit.FURTHER * (1.0 + LOWER * seed)
        fit.settle(lesson, self.lattice, values, 9 + seed, AGAIN, least, wrong)
        return replace(self, codes=np.stack([values.astype(np.uint8), *self.codes[1:]]))


class Trained(Codec):
    """The codec: one size, as large as may be; it trains for minutes."""

    name = "grid"

    def refusal(self, model: Model, arithmetic: str) -> str | None:
        """Return why the codec cannot be used, or None."""
        if LOOKUP.refusal(model, arithmetic) is None:
            return "three contacts are looked up by themselves"
        if model.recipe.com_uncertainty > 0.0:
            return "grid holds no com_uncertainty; choose the codec contacts"
        if model.k > MOST_PARAMS:
            return (
                f"grid holds a node for every combination of at most {MOST_PARAMS} parameters (got "
                f"{model.k}); choose the codec contacts"
            )
        if model.chart_limit > STEEPEST:
            return f"grid reaches |u| = {STEEPEST} (got {model.chart_limit:.4g})"
        if arithmetic != "integer":
            return (
                "grid of more than three contacts is read without floats; choose integer arithmetic"
            )
        return None

    def sizes(self, model: Model, channels: Channels, most: int | None = None) -> list[Spec]:
        """Return the size that at most so many bytes of tables hold."""
        if most is None:
            return [Spec((6,) * (model.k + 2))]
        tables = 1 + len(_lengths(channels))
        whole = (most - HEAD - PARAMETER * model.k) // tables
        return [Spec(fit.learn(model).shape(min(whole, fit.MOST_BYTES)))]

    def encode(self, model: Model, channels: Channels, spec: Spec) -> Tables:
        """Train the tables of one size."""
        lengths = _lengths(channels)
        lattice, values, found = fit.fit(model, spec.nodes, lengths)
        codes = np.stack([values, *(found[name][0] for name in lengths)]).astype(np.uint8)
        steps = tuple(found[name][1] for name in lengths)
        lesson = fit.learn(model)
        return Tables(spec, channels, lesson.ground, lattice, lesson.block, codes, steps)


def _lengths(channels: Channels) -> tuple[str, ...]:
    return tuple(name for name in LENGTHS if name in channels)


INFO = Trained()
