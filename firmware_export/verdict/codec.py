"""Codec `grid` where the standing region jumps: round contacts, gaps, facets that are refused.

Facade of the codec protocol; the tables, and the C that reads them, are those of the room `grid`.
The parts are in `outline` and `lower` (a verdict that is never too high), `knots` (which knots
give up least) and `train` (the table).  Where a robot has more than three contacts an encoding
takes a minute, so a size says beforehand what it will cost.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from firmware_export.grid import (
    CHANNEL,
    DTYPE,
    GROUPS,
    LARGEST,
    Part,
    Spec,
    Tables,
    U,
    active_axes,
    grow,
    lattice_of,
    length_table,
    part_of,
    places_of,
    rounding,
    spread_knots,
    start,
    tip_part,
    too_large,
)
from firmware_export.grid import (
    INFO as LOOKUP,
)
from firmware_export.protocol import CodecInfo, Foresight
from firmware_export.truth import Model, widened
from firmware_export.verdict import train
from firmware_export.verdict.knots import balanced, chosen_knots
from lutgen.errors import InputError

SIGN_ONLY = (
    "Of this table's tip angle only the sign is bounded: it is negative wherever the robot tips, "
    "but where it stands the angle may be read too large; take it as a verdict, not a distance."
)


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
    problem = too_large(model, arithmetic)
    if problem is None and LOOKUP.refusal(model, arithmetic) is None:
        return "the region of this robot does not jump"
    return problem


def _chosen(model: Model, coordinate: int, count: int) -> NDArray[np.uint16]:
    """Return the knots of an axis, `chosen` for what they give up."""
    axis = coordinate if coordinate < model.k else model.k + int(coordinate == U)
    return chosen_knots(model, axis, count)


def _knots(model: Model) -> Any:
    """Return how the knots of |SD_g| and of the height are found."""
    return spread_knots if model.is_tripod else _chosen


@lru_cache(maxsize=16)
def _tip_table(model: Model, shape: tuple[int, ...], bits: int) -> tuple[Part, str]:
    """Return the verdict's table, and how it was kept below the truth."""
    lattice = lattice_of(model, shape, _chosen)
    codes, found = train.fit(model, lattice, bits)
    text = (
        f"at each of {len(found.tips)} postures the table is below zero on every outline of the "
        f"standing region there and at those next to it, moved inwards by what the contacts move "
        f"within half a step to the next, with `upright` and `rock_angle` tightened by "
        f"{math.degrees(found.tighter):.2g} deg; the guard covers the rounding of the arithmetic."
    )
    return tip_part(lattice, codes, bits), text


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Fit and quantise the tables of one size; the outlines leave room for misplaced queries."""
    problem = refusal(model, "float")
    if problem is not None:
        raise InputError(f"{model.recipe.source}: {problem}; choose another codec.")
    places, model = places_of(model), widened(model)
    (_, shape), *lengths = spec.nodes
    tip, text = _tip_table(model, shape, spec.bits)
    parts = [length_table(model, name, n, spec.bits, _knots(model)) for name, n in lengths]
    guard = rounding(tip)
    return Tables(
        spec, channels, (tip, *parts), model.chart_limit, places, guard, text, (SIGN_ONLY,)
    )


def blank(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Return tables of a size before anything is fitted: as many bytes, all codes 0."""
    parts = []
    places, model = places_of(model), widened(model)
    for name, shape in spec.nodes:
        lattice = lattice_of(model, shape, _knots(model))
        width = 2 if name == "sdg" else 1
        codes = np.zeros((lattice.faces, *lattice.shape, width), DTYPE[spec.bits])
        parts.append(part_of(name, lattice, codes, [0.0], 1.0))
    return Tables(spec, channels, tuple(parts), model.chart_limit, places, 0.0, "")


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


def of_nodes(model: Model, channels: tuple[str, ...], nodes: dict[str, int], bits: int) -> Spec:
    """Return the size whose tables have at most so many nodes each, spread over the axes.

    `nodes` counts those of ``tip``, ``sdg`` and ``height``; a table has a few at least.
    """
    shapes = []
    for name in GROUPS:
        if name == "tip":
            shapes.append((name, balanced(widened(model), nodes.get(name, 0))))
        elif CHANNEL[name] in channels:
            shapes.append((name, even(model, name, nodes.get(name, 0))))
    return Spec(bits, tuple(shapes))


def costly(model: Model) -> Foresight | None:
    """Return what is known of a size beforehand where an encoding takes a minute, else None."""
    return None if model.is_tripod else Foresight(of_nodes, blank)


INFO = CodecInfo(
    name="grid",
    switches={"float": "SMAP_GRID", "integer": "SMAP_GRID"},
    look=("#D55E00", "s"),
    refusal=refusal,
    sizes=start,
    grow=grow,
    encode=encode,
    c_body=lambda tables, integer: tables.body(integer),
    read_label=Spec.of_label,
    bytes=lambda spec: int(spec.bytes),
    cells=lambda model, tables: tables.cells(model),
    costly=costly,
    encodings=44,
)
