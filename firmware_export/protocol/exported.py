"""One finished export: data only, made by the exporter and read by those who write and ask."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from firmware_export.protocol.array import CBody
from firmware_export.protocol.policy import Policy
from lutgen.recipe import Recipe


@dataclass(frozen=True, eq=False)
class Export:
    """A map's tables, chosen and certified, before it becomes C.

    Parameters
    ----------
    name : str
        C identifier of the descriptor, and the stem of the files.
    recipe : Recipe
        The robot, its parameters and chart.
    model : Model
        The exact function that the tables stand for.
    codec, arithmetic : str
        ``"contacts"`` or ``"grid"``; ``"float"`` or ``"integer"``.
    channels : tuple of str
        Subset of `quantities.EXPORTABLE`, in that order.
    tables : Tables
        The codec's tables.
    certificate : dict, optional
        What was measured, see `certify.Certificate`; each key may be absent.
    pareto : list of dict, optional
        Candidates that the choice was made from, see `choose.front`.
    policy : Policy, optional
        What on-board control follows; None for an export that is only read.
    """

    name: str
    recipe: Recipe
    model: Any
    codec: str
    arithmetic: str
    channels: tuple[str, ...]
    tables: Any
    certificate: dict[str, Any] | None = None
    pareto: list[dict[str, Any]] | None = None
    policy: Policy | None = None

    @property
    def integer(self) -> bool:
        """Whether the export answers smap_read_i."""
        return self.arithmetic == "integer"

    @cached_property
    def body(self) -> CBody:
        """The codec's part of the blob, as this export is read."""
        found: CBody = self.tables.body(self.integer)
        return found
