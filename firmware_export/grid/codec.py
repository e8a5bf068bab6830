"""Tables of lengths over the parameters and the chart, beside the trees of the room `verdict`.

The parts are in `spec` (sizes), `fit` (stability factor and height) and `tables` (layout).
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import fit as fitting
from firmware_export.grid.lattice import Lattice, spread_knots
from firmware_export.grid.spec import Spec
from firmware_export.grid.tables import Fold, Part, Tables, Trees, U, V, places_of
from firmware_export.truth import Model, widened

DTYPE: dict[int, Any] = {8: np.uint8, 16: np.uint16}
# Parameters that smap_read_i and the tables can address, and the largest u it can.
MOST_PARAMS = 8
STEEPEST = 15.9
# Nodes along each axis below which a table says little, and nodes of a table that can be fitted.
FEWEST, MOST_NODES = 4, 1 << 18


def too_large(model: Model, arithmetic: str) -> str | None:
    """Return why no table of this kind can hold a robot, or None."""
    if model.recipe.com_uncertainty > 0.0:
        return "grid holds no com_uncertainty; choose the codec contacts"
    if model.k > MOST_PARAMS:
        return f"grid holds at most {MOST_PARAMS} parameters (got {model.k})"
    least = model.faces * FEWEST ** (model.k + 2)
    if least > MOST_NODES:
        return (
            f"grid holds a node for every combination: {FEWEST} along each of {model.k} parameters "
            f"and of v and u are {least:,} nodes, more than the {MOST_NODES:,} that it fits; "
            "choose the codec contacts"
        )
    if arithmetic == "integer" and model.chart_limit > STEEPEST:
        return f"grid without floats reaches |u| = {STEEPEST} (got {model.chart_limit:.4g})"
    return None


def lattice_of(model: Model, shape: tuple[int, ...]) -> Lattice:
    """Return a table's lattice: the nodes of each parameter, of v and of u."""
    names = [*range(model.k), V, U]
    held = [(c, n) for c, n in zip(names, shape, strict=True) if n > 1]
    return Lattice(
        model, tuple(c for c, _ in held), tuple(spread_knots(model, c, n) for c, n in held)
    )


# Tables do not depend on each other: sizes that share one do not fit it again.
@lru_cache(maxsize=16)
def length_table(model: Model, name: str, shape: tuple[int, ...], bits: int) -> Part:
    """Return the table ``sdg`` or ``height``."""
    lattice = lattice_of(model, shape)
    node = fitting.fit(model, lattice, name)
    if name == "height":
        # Nodes where nothing stands may come out negative; the integer path has no such height.
        node = np.maximum(node, 0.0)
    flat, offset, step = fitting.quantise(node, bits)
    codes = flat.reshape(lattice.faces, *lattice.shape, -1)
    return part_of(name, lattice, codes, offset, step)


def part_of(
    name: str, lattice: Lattice, codes: NDArray[Any], offset: Sequence[float], step: float
) -> Part:
    """Return codes (faces, n..., width) on a lattice as a table."""
    return Part(
        name,
        lattice.coordinates,
        lattice.knots,
        codes,
        np.array([*offset, 0.0][:2], np.float32),
        np.float32(step),
    )


def blank(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Return tables of a size before anything is fitted: as many bytes, all of them 0."""
    parts = []
    places, model = places_of(model), widened(model)
    for name, shape in spec.nodes:
        lattice = lattice_of(model, shape)
        width = 2 if name == "sdg" else 1
        codes = np.zeros((lattice.faces, *lattice.shape, width), DTYPE[spec.bits])
        parts.append(part_of(name, lattice, codes, [0.0], 1.0))
    ends = [spec.tree * face // model.faces for face in range(model.faces + 1)]
    trees = Trees(Fold(0, 0, 0), 0, 0, tuple(map(bytes, np.diff(ends).tolist())))
    return Tables(spec, channels, trees, tuple(parts), model.chart_limit, places, "")
