"""Codec `grid`: multilinear tables over the parameters and the chart, with fitted nodes.

Facade of the codec protocol for three contacts whose facet is accepted in every posture; the parts
are in `spec` (sizes), `fit` (stability factor and height), `margin` and `guard` (the verdict) and
`tables` (layout).  Where the standing region jumps, the room `verdict` makes the same tables.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import fit as fitting
from firmware_export.grid import guard, margin
from firmware_export.grid.lattice import Lattice, spread_knots
from firmware_export.grid.spec import Spec, grow, start
from firmware_export.grid.tables import Part, Tables, U, V, c_body, places_of
from firmware_export.protocol import CodecInfo, slack, widened
from firmware_export.truth import Cells, Model
from lutgen.errors import InputError

__all__ = [
    "INFO",
    "Spec",
    "Tables",
    "c_body",
    "encode",
    "grow",
    "lattice_of",
    "length_table",
    "part_of",
    "places_of",
    "refusal",
    "rounding",
    "start",
    "tip_part",
    "too_large",
]

# (model, coordinate, count) -> the knots of an axis, uint16.
Knots = Callable[[Model, int, int], NDArray[np.uint16]]

DTYPE: dict[int, Any] = {8: np.uint8, 16: np.uint16}
# Parameters that smap_read_i and the tables can address, and the largest u it can.
MOST_PARAMS = 8
STEEPEST = 15.9
# Nodes along each axis below which a table says little, and nodes of a table that can be fitted.
FEWEST, MOST_NODES = 4, 1 << 18
# By how many units of an axis (1/65534) float32 misplaces a query, and the integer path u and v;
# and parts of a cell to which the latter rounds.
FLOAT_PLACE, INTEGER_PLACE, INTEGER_PARTS = 0.02, 6.0, 16384.0
# Rounding of the float path: operations after the codes, in units of 2^-24.
OPERATIONS = 64.0


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


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
    problem = too_large(model, arithmetic)
    if problem is None and not guard.is_smooth(widened(model)):
        return "grid is fitted to three contacts whose facet is accepted in every posture"
    return problem


def lattice_of(model: Model, shape: tuple[int, ...], knots: Knots = spread_knots) -> Lattice:
    """Return a table's lattice: the nodes of each parameter, of v and of u."""
    names = [*range(model.k), V, U]
    held = [(c, n) for c, n in zip(names, shape, strict=True) if n > 1]
    return Lattice(model, tuple(c for c, _ in held), tuple(knots(model, c, n) for c, n in held))


def _misplaced(part: Part, units: float, parts: float) -> float:
    """Return by how many codes a value is off where the query is misplaced.

    u and v by `units`, and every coordinate by 1/`parts` of its cell if that is not 0.
    """
    total = 0.0
    for axis, (coordinate, knots) in enumerate(zip(part.coordinates, part.knots, strict=True), 1):
        change = np.abs(np.diff(part.codes.astype(np.float64), axis=axis))
        worst = change.max(axis=tuple(a for a in range(change.ndim) if a != axis))
        share = np.full(len(worst), 1.0 / parts if parts else 0.0)
        if coordinate >= U or not parts:
            share += units / np.diff(knots.astype(np.float64))
        total += float((worst * share).max())
    return total


# Tables do not depend on each other: sizes that share one do not fit it again.
@lru_cache(maxsize=16)
def _tip_table(model: Model, shape: tuple[int, ...], bits: int) -> tuple[Part, str]:
    """Return the verdict's table, and how it was kept below the truth."""
    lattice = lattice_of(model, shape)
    aims = guard.targets(model, lattice)
    codes = margin.fit(model, lattice, aims, bits)
    text = (
        "the table is below the tip margin everywhere: concave in (u, v), second derivatives "
        f"bounded in the parameters (at most {aims.remainder:.2g} taken off), codes rounded "
        "down; the guard covers the rounding of the arithmetic."
    )
    return tip_part(lattice, codes, bits), text


@lru_cache(maxsize=16)
def length_table(
    model: Model, name: str, shape: tuple[int, ...], bits: int, knots: Knots = spread_knots
) -> Part:
    """Return the table ``sdg`` or ``height``."""
    lattice = lattice_of(model, shape, knots)
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


def tip_part(lattice: Lattice, codes: margin.Codes, bits: int) -> Part:
    """Return the verdict's codes as a table."""
    return part_of("tip", lattice, codes.codes.astype(DTYPE[bits]), [codes.offset], codes.step)


def rounding(tip: Part) -> float:
    """Return by how much (rad) the arithmetic may read a tip angle too high."""
    largest = float(np.abs(tip.offset[0]) + tip.step * 2.0**tip.bits)
    return OPERATIONS * 2.0**-24 * max(largest, 1.0)


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Fit and quantise the tables of one size, and bound the guard."""
    problem = refusal(model, "float")
    if problem is not None:
        raise InputError(f"{model.recipe.source}: {problem}; choose another codec.")
    places, model = places_of(model), widened(model)
    (_, shape), *lengths = spec.nodes
    tip, text = _tip_table(model, shape, spec.bits)
    remainder = (1 << (16 - spec.bits)) * _misplaced(tip, INTEGER_PLACE, INTEGER_PARTS)
    parts = [replace(tip, remainder=math.ceil(remainder))]
    parts += [length_table(model, name, shape, spec.bits) for name, shape in lengths]
    off = float(tip.step) * _misplaced(tip, FLOAT_PLACE, 0.0) + rounding(tip)
    return Tables(spec, channels, tuple(parts), model.chart_limit, places, off, text)


def cells(model: Model, tables: Tables) -> Cells:
    """Return the knots of the tables: of |SD_g| where it is held, since that is what is bounded."""
    part = next((part for part in tables.parts if part.name == "sdg"), tables.parts[0])
    knots = {
        coordinate: places.astype(np.float64) / places[-1]
        for coordinate, places in zip(part.coordinates, part.knots, strict=True)
    }
    for at, parameter in enumerate(model.recipe.parameters):
        if at in knots:  # the tables reach beyond the axis by what sensors may say
            room = slack(parameter) / (parameter.maximum - parameter.minimum)
            knots[at] = np.unique(np.clip(knots[at] * (1.0 + 2.0 * room) - room, 0.0, 1.0))
    ends = np.array([0.0, 1.0])
    v, u = ((2.0 * knots.get(at, ends) - 1.0) * model.chart_limit for at in (V, U))
    return Cells(tuple(knots.get(at, ends) for at in range(model.k)), u, v)


INFO = CodecInfo(
    name="grid",
    switches={"float": "SMAP_GRID", "integer": "SMAP_GRID"},
    look=("#D55E00", "s"),
    refusal=refusal,
    sizes=start,
    grow=grow,
    encode=encode,
    c_body=c_body,
    read_label=Spec.of_label,
    bytes=lambda spec: int(spec.bytes),
    cells=cells,
    encodings=44,
)
