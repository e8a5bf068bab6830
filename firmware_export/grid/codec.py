"""Codec `grid`: multilinear tables over the parameters and the chart, with fitted nodes.

Facade of the codec protocol; the parts are in `grid_spec` (sizes), `grid_fit` (stability factor and
height), `grid_tip` and `grid_guard` (the verdict of three points), `grid_rough`, `grid_outline` and
`grid_verdict` (that of any robot), `grid_tables` (layout), `grid_read` and `grid_read_i` (twins of
the C functions).
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import fit as grid_fit
from firmware_export.grid import guard as grid_guard
from firmware_export.grid import margin as grid_tip
from firmware_export.grid.lattice import Lattice, spread_knots
from firmware_export.grid.read import read
from firmware_export.grid.read_integer import read_i
from firmware_export.grid.spec import CHANNEL, GROUPS, Spec, even, grow, start
from firmware_export.grid.tables import Part, Tables, U, V, c_body
from firmware_export.truth import Model
from firmware_export.verdict import balanced, chosen_knots
from firmware_export.verdict import train as grid_rough
from lutgen.errors import InputError

__all__ = [
    "Spec",
    "Tables",
    "blank",
    "c_body",
    "dear",
    "encode",
    "grow",
    "least_bytes",
    "of_nodes",
    "read",
    "read_i",
    "refusal",
    "start",
]

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

SIGN_ONLY = (
    "Of this table's tip angle only the sign is bounded: it is negative wherever the robot tips, "
    "but where it stands the angle may be read too large; take it as a verdict, not a distance."
)


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
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


def least_bytes(spec: Spec) -> int:
    """Return the bytes of a size's codes, known before anything is encoded."""
    values = sum((2 if name == "sdg" else 1) * math.prod(shape) for name, shape in spec.nodes)
    return values * spec.bits // 8


def _lattice(model: Model, shape: tuple[int, ...], chosen: bool) -> Lattice:
    """Return a table's lattice: knots spread evenly, or `chosen` for what they give up."""
    names = [*range(model.k), V, U]
    held = [(at, c, n) for at, (c, n) in enumerate(zip(names, shape, strict=True)) if n > 1]
    knots = [
        chosen_knots(model, at, n) if chosen else spread_knots(model, c, n) for at, c, n in held
    ]
    return Lattice(model, tuple(c for _, c, _ in held), tuple(knots))


def _tip(model: Model, shape: tuple[int, ...], bits: int) -> tuple[Lattice, grid_tip.Codes, str]:
    """Return the verdict's table, and how it was kept below the truth."""
    if grid_guard.is_smooth(model):
        lattice = _lattice(model, shape, False)
        aims = grid_guard.targets(model, lattice)
        text = (
            "the table is below the tip margin everywhere: concave in (u, v), second derivatives "
            f"bounded in the parameters (at most {aims.remainder:.2g} taken off), codes rounded "
            "down; the guard covers the rounding of the arithmetic."
        )
        return lattice, grid_tip.fit(model, lattice, aims, bits), text
    lattice = _lattice(model, shape, True)
    codes, found = grid_rough.fit(model, lattice, bits)
    text = (
        f"the table is below zero on every outline of the standing region in the "
        f"{len(found.tips)} sub-cells of the parameters, moved inwards by what the contacts move "
        f"within a sub-cell, with `upright` and `rock_angle` tightened by "
        f"{math.degrees(found.tighter):.2g} deg; the guard covers the rounding of the arithmetic."
    )
    return lattice, codes, text


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


@lru_cache(maxsize=16)
def _table(model: Model, name: str, shape: tuple[int, ...], bits: int) -> tuple[Part, str]:
    """Return one table, and for the verdict how it was kept below the truth.

    Tables do not depend on each other: sizes that share one do not fit it again.
    """
    text = ""
    if name == "tip":
        lattice, tip, text = _tip(model, shape, bits)
        codes, offset, step = tip.codes.astype(DTYPE[bits]), [tip.offset], tip.step
    else:
        lattice = _lattice(model, shape, not model.single_facet)
        node = grid_fit.fit(model, lattice, name)
        if name == "height":
            # Nodes where nothing stands may come out negative; the integer path has no such height.
            node = np.maximum(node, 0.0)
        flat, offset, step = grid_fit.quantise(node, bits)
        codes = flat.reshape(lattice.faces, *lattice.shape, -1)
    return _part(name, lattice, codes, offset, step), text


def _part(
    name: str, lattice: Lattice, codes: NDArray[Any], offset: Sequence[float], step: float
) -> Part:
    return Part(
        name,
        lattice.coordinates,
        lattice.knots,
        codes,
        np.array([*offset, 0.0][:2], np.float32),
        np.float32(step),
    )


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Fit and quantise the tables of one size, and bound the guard."""
    problem = refusal(model, "float")
    if problem is not None:
        raise InputError(f"{model.recipe.source}: {problem}; choose another codec.")
    fitted = [_table(model, name, shape, spec.bits) for name, shape in spec.nodes]
    parts, text = [part for part, _ in fitted], fitted[0][1]
    tip_part = parts[0]
    guard = 0.0
    if grid_guard.is_smooth(model):
        # Elsewhere the outlines leave room for it.
        remainder = (1 << (16 - spec.bits)) * _misplaced(tip_part, INTEGER_PLACE, INTEGER_PARTS)
        parts[0] = replace(tip_part, remainder=math.ceil(remainder))
        guard = float(tip_part.step) * _misplaced(tip_part, FLOAT_PLACE, 0.0)
    largest = float(np.abs(tip_part.offset[0]) + tip_part.step * 2.0**spec.bits)
    guard += OPERATIONS * 2.0**-24 * max(largest, 1.0)
    notes = () if grid_guard.is_smooth(model) else (SIGN_ONLY,)
    return Tables(spec, channels, tuple(parts), model.chart_limit, guard, text, notes)


def blank(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Return tables of a size before anything is fitted: as many bytes, all codes 0."""
    parts = []
    for name, shape in spec.nodes:
        lattice = _lattice(model, shape, not model.single_facet)
        codes = np.zeros(
            (lattice.faces, *lattice.shape, 2 if name == "sdg" else 1), DTYPE[spec.bits]
        )
        parts.append(_part(name, lattice, codes, [0.0], 1.0))
    return Tables(spec, channels, tuple(parts), model.chart_limit, 0.0, "")


def dear(model: Model) -> bool:
    """Tell whether an encoding takes so long that few can be tried: where the region jumps."""
    return not model.single_facet


def of_nodes(model: Model, channels: tuple[str, ...], nodes: dict[str, int], bits: int) -> Spec:
    """Return the size whose tables have at most so many nodes each, spread over the axes.

    `nodes` counts those of ``tip``, ``sdg`` and ``height``; a table has a few at least.
    """
    shapes = []
    for name in GROUPS:
        if name == "tip":
            shapes.append((name, balanced(model, nodes.get(name, 0))))
        elif CHANNEL[name] in channels:
            shapes.append((name, even(model, name, nodes.get(name, 0))))
    return Spec(bits, tuple(shapes))
