"""Codec `grid` where the standing region jumps: round contacts, gaps, facets that are refused.

Facade of the codec protocol; the layout, and the tables of lengths, are those of the room `grid`.
A tree over the parameters, u and v tells where the robot stands: it is grown on points, pruned to
its bytes, and its leaves are moved until a proof finds nothing that tips in what they call safe.
That takes most of a minute, so a size says beforehand what it will cost.
"""

import math
from functools import lru_cache
from typing import NamedTuple

from firmware_export.grid import INFO as LOOKUP
from firmware_export.grid import (
    LEAST,
    Fold,
    Spec,
    Tables,
    Trees,
    blank,
    length_table,
    of_nodes,
    places_of,
    too_large,
)
from firmware_export.protocol import CodecInfo, Foresight
from firmware_export.truth import Model, widened
from firmware_export.verdict.directory import bits_of
from firmware_export.verdict.fold import fold_of
from firmware_export.verdict.grow import Forest, grow, joined
from firmware_export.verdict.middles import Middles
from firmware_export.verdict.outline import View, view_of
from firmware_export.verdict.planes import refine
from firmware_export.verdict.points import points_of
from firmware_export.verdict.prove import prove
from firmware_export.verdict.prune import prune
from firmware_export.verdict.tree import fitting, whole
from lutgen.errors import InputError

# By which share more bytes are asked for at first: leaves of which the proof leaves least are given
# up.
SPARE = 0.15


class _Grown(NamedTuple):
    """The grown trees of all faces, and what they were grown on."""

    forest: Forest
    fold: Fold
    middles: Middles
    view: View


def refusal(model: Model, arithmetic: str) -> str | None:
    """Return why the codec cannot be used, or None."""
    problem = too_large(model, arithmetic)
    if problem is None and LOOKUP.refusal(model, arithmetic) is None:
        return "the region of this robot does not jump"
    return problem


@lru_cache(maxsize=1)
def _grown(model: Model) -> _Grown:
    """Return the trees before anything is pruned."""
    middles, fold = Middles(model), fold_of(model)
    view = view_of(model.recipe.chart.basis(), model.chart_limit)
    trees = []
    for points in points_of(middles, view, fold):
        tree = grow(points, middles.shortest, bits_of(model.k, math.inf))
        refine(points, tree)
        trees.append((points, tree))
    return _Grown(joined(trees), fold, middles, view)


@lru_cache(maxsize=16)
def _trees(model: Model, most: int) -> tuple[Trees, str]:
    """Return trees of at most so many bytes, and how they were kept from calling safe what tips."""
    forest, fold, middles, view = _grown(model)
    bits = bits_of(model.k, most / model.faces)
    nodes, kind = prune(forest.nodes, bits, model.faces, most * (1.0 + SPARE))
    found = prove(nodes, kind, middles, view, fold)
    limit = whole(found.limit, model.k + 2)
    held, levels = fitting(forest._replace(nodes=nodes), kind, limit, bits, model.faces, most)
    text = (
        f"what the trees call safe in a posture meets none of the outlines of {found.postures} "
        "postures, each moved inwards by what contacts move to the postures next to it and drawn "
        f"as far as these, with `upright` and `rock_angle` tightened by "
        f"{math.degrees(found.tighter):.2g} deg, and stands there; the rounding of the arithmetic "
        "is in what they are moved by."
    )
    return Trees(fold, bits, levels, held), text


def encode(model: Model, channels: tuple[str, ...], spec: Spec) -> Tables:
    """Grow the trees of one size, and fit its tables."""
    problem = refusal(model, "float")
    if problem is not None:
        raise InputError(f"{model.recipe.source}: {problem}; choose another codec.")
    places, model = places_of(model), widened(model)
    trees, text = _trees(model, spec.tree)
    parts = tuple(length_table(model, name, shape, spec.bits) for name, shape in spec.nodes)
    return Tables(spec, channels, trees, parts, model.chart_limit, places, text)


def sizes(model: Model, channels: tuple[str, ...], arithmetic: str) -> list[Spec]:
    """Return the smallest sensible size for each bit width."""
    return [of_nodes(model, channels, {"tip": 16 * LEAST}, bits) for bits in (8, 16)]


INFO = CodecInfo(
    name="grid",
    switches={"float": "SMAP_GRID", "integer": "SMAP_GRID"},
    look=("#D55E00", "s"),
    refusal=refusal,
    sizes=sizes,
    grow=lambda model, spec: [],
    encode=encode,
    c_body=lambda tables, integer: tables.body(integer),
    read_label=Spec.of_label,
    cells=lambda model, tables: tables.cells(model),
    costly=lambda model: Foresight(of_nodes, blank),
)
