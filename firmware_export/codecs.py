"""The codecs by name: which of them can hold a robot, and how their answers are asked for.

The only place that knows their names; each is a module of the same protocol (docs/format.md).
"""

from collections.abc import Sequence
from functools import partial
from importlib import import_module
from typing import Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from firmware_export.certify import Device
from firmware_export.emit import CBody, Export
from firmware_export.truth import Cells, Model
from firmware_export.twin import read
from lutgen.errors import ExportError, InputError

__all__ = ["ARITHMETIC", "NAMES", "Codec", "cells", "codec", "device", "usable"]

# In the order in which they are tried: the first are smallest for what they can hold.
NAMES = ("contacts", "poly", "grid")
ARITHMETIC = ("float", "integer")


class Tables(Protocol):
    """What a codec has encoded; everything else about it is the codec's own."""

    @property
    def guard(self) -> float:
        """Angle (rad) that is subtracted from tip_angle."""

    @property
    def bytes(self) -> int:
        """Bytes of all tables."""

    @property
    def spec(self) -> Any:
        """The size that was asked for."""


class Codec(Protocol):
    """A codec's module."""

    def refusal(self, model: Model, arithmetic: str) -> str | None:
        """Return why the codec cannot hold this robot, in one sentence, or None."""

    def start(self, model: Model, channels: tuple[str, ...], arithmetic: str) -> list[Any]:
        """Return the smallest sensible sizes, one for each bit width."""

    def grow(self, model: Model, spec: Any) -> list[Any]:
        """Return the next larger sizes, such as one for each axis."""

    def encode(self, model: Model, channels: tuple[str, ...], spec: Any) -> Tables:
        """Fit and quantise the tables of one size."""

    def c_body(self, tables: Any) -> CBody:
        """Return the struct and arrays for C."""


def codec(name: str) -> Codec:
    """Return a codec's module."""
    if name not in NAMES:
        raise InputError(
            f"codec: {name!r} is unknown (got {name!r}); use auto or one of: {', '.join(NAMES)}."
        )
    return cast(Codec, import_module(f"firmware_export.{name}.codec"))


def usable(model: Model, arithmetic: str, name: str = "auto") -> list[str]:
    """Return the names of the codecs that can hold a robot, in the order to try them.

    Raises
    ------
    InputError
        For names that are not known.
    ExportError
        If none can, with the reason of each.
    """
    if arithmetic not in ARITHMETIC:
        raise InputError(
            f"arithmetic: {arithmetic!r} is unknown (got {arithmetic!r}); use one of: "
            f"{', '.join(ARITHMETIC)}."
        )
    asked: Sequence[str] = NAMES if name == "auto" else (name,)
    reasons = {one: codec(one).refusal(model, arithmetic) for one in asked}
    found = [one for one in asked if reasons[one] is None]
    if not found:
        why = "; ".join(str(reasons[one]).rstrip(".") for one in asked)
        raise ExportError(
            f"{model.recipe.source}: no codec can hold this robot (got codec {name!r}, arithmetic "
            f"{arithmetic!r}: {why}); ask for another codec or arithmetic."
        )
    return found


def device(export: Export) -> Device:
    """Return what answers as the export's C code does."""
    if not export.integer:
        return Device(export.model, partial(read, export))
    module = cast(Any, codec(export.codec))

    def read_i(params: NDArray[Any], gravity: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        status, reading = module.read_i(export.tables, params, gravity, export.model.faces)
        return status, reading

    return Device(export.model, read_i, dict(module.c_body(export.tables).steps))


def cells(export: Export) -> Cells | None:
    """Return the knots of an export's table, or None for a codec that has none."""
    limit, tables = export.model.chart_limit, export.tables
    rim = np.array([-limit, limit])
    if export.codec == "contacts":
        nodes = tuple(np.linspace(0.0, 1.0, max(int(n), 2)) for n in tables.spec.nodes)
        return Cells(nodes, rim, rim)
    if export.codec != "grid":
        return None
    # Of |SD_g| where it is held: that is what is bounded.
    part = next((part for part in tables.parts if part.name == "sdg"), tables.parts[0])
    knots: dict[int, NDArray[np.float64]] = {}
    for coordinate, places in zip(part.coordinates, part.knots, strict=True):
        knots[coordinate] = places.astype(np.float64) / places[-1]
    ends = np.array([0.0, 1.0])
    # Coordinates above the parameters' are v, then u: see `grid_tables`.
    v, u = ((2.0 * knots.get(at, ends) - 1.0) * limit for at in (254, 255))
    return Cells(tuple(knots.get(at, ends) for at in range(export.model.k)), u, v)
