"""One finished export: everything that the emitter, the host and the report need to know of it.

Data only; it is made by the exporter and read by `source`, `package`, `report` and the host.
"""

from dataclasses import dataclass
from typing import Any

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
    codec : str
        ``"contacts"`` or ``"grid"``.
    arithmetic : str
        ``"float"`` or ``"integer"``.
    channels : tuple of str
        Subset of `quantities.EXPORTABLE`, in that order.
    tables : Tables
        The codec's tables, with `guard` (rad), `guard_text`, `bytes`, `spec`.
    certificate : dict, optional
        What was measured.  Keys that the header and report print, each of which may be absent:
        ``points`` (int, measured points), ``channels`` (name -> ``max``, ``p99``, ``rms`` in the
        channel's unit, rad for angles, and for `sdg` also ``max_percent``, ``p99_percent``,
        ``rms_percent`` of ``range``; ``largest_seen`` instead of ``max`` where it has no bound),
        ``false_safe`` (int), ``false_tip`` (share of the standing
        configurations that the export calls tipping, 0..1), ``jumps`` (bool: |SD_g| jumps, so
        that its maximum error has no bound), ``beyond`` (share of points beyond the bound asked
        for, 0..1), ``text`` (sentences for people).  Anything else goes into the JSON only.
    pareto : list of dict, optional
        Candidates that the choice was made from: ``label`` (str), ``codec``, ``bytes`` (tables),
        ``total_bytes`` (with code), ``error`` (percent), ``chosen`` (bool); the smallest first.
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
