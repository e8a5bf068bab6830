"""Look up bytes of code and stack of the runtime on a Cortex-M4, as measured.

The measurements need a cross compiler and an export does not: it reads runtime/counts.json, which
has the exports of the gallery themselves (`python -m targets.run`), and for any other runtime/
sizes.json, which has the most measured of a family (`python -m targets.size`).
"""

import json
from collections.abc import Mapping
from functools import cache
from typing import Any

from firmware_export.emit.runtime import runtime_file
from firmware_export.host import family_of
from firmware_export.protocol import Export, describe

TARGET = "Cortex-M4, -Os"
# The compiler's cell of an export in counts.json that has its bytes.
CELL = "m4f -Os"
FILE, COUNTS = "sizes.json", "counts.json"
# The target of reports, and how its cells begin.
COUNTED, BOARD = "Cortex-M4F", "m4f"
# Behind the name of a family: of robots given by code, whose contacts are series, and of those
# with axles that swing.
BY_CODE, SWINGING = ", by code", ", with axles"


@cache
def measured(name: str) -> dict[str, Any]:
    """Return the rows of a file of measurements in runtime/."""
    rows: dict[str, Any] = json.loads(runtime_file(name))["rows"]
    return rows


def family_row(family: str, macros: Mapping[str, int]) -> dict[str, int]:
    """Return the most bytes of `code`, `stack` and `control` that were measured of a family.

    `macros` say which robots' of it; `pose` is the size of the pose that the stack was measured
    with.
    """
    kind = BY_CODE if macros.get("SMAP_SERIES") else SWINGING if macros.get("SMAP_PIVOTS") else ""
    rows = measured(FILE)
    row: dict[str, int] = rows.get(f"{family}{kind}", rows[family])
    return row


def identity(export: Export) -> dict[str, Any]:
    """Return what tells an export from all others."""
    return {
        "recipe_sha256": export.recipe.digest,
        "spec": str(export.tables.spec.label),
        "arithmetic": export.arithmetic,
        "channels": list(export.channels),
        "tables": export.body.bytes,
    }


def _counted_row(export: Export) -> dict[str, Any]:
    """Return the row of counts.json of this very export, empty if it was not counted."""
    rows, own = measured(COUNTS).values(), identity(export)
    return next((row for row in rows if row["export"] == own), {})


def flash_bytes(export: Export) -> dict[str, Any]:
    """Return the bytes of an export: tables, descriptor, code, total, and the stack of any call.

    With a policy there are those of the code that follows it, and of the policy itself.
    `measured`: this very export was; else code and stack are the most that its family takes.
    """
    body, blob = export.body, describe(export)
    most = family_row(family_of(blob.codec, blob.integer), dict(body.macros))
    cell = _counted_row(export).get(CELL, {})
    code, more = cell.get("code", most["code"]), {}
    stack = most["stack"] + max(0, 4 * body.pose[0] + 4 - most["pose"])
    if export.policy is not None:
        packed = export.policy.packed(blob.bytes)
        more = {"control": most["control"], "policy": len(packed)}
    descriptors = len(blob.bytes) - body.bytes
    return {
        "tables": body.bytes,
        "descriptors": descriptors,
        "code": code,
        **more,
        "total": body.bytes + descriptors + code + sum(more.values()),
        "stack": cell.get("stack", stack),
        "measured": bool(cell) and not more,
        "target": TARGET,
    }


def counted(export: Export) -> list[dict[str, Any]] | None:
    """Return the counted cost of a read of this very export, None where it was not counted.

    For each compiler option and call ``target``, ``option``, ``unit``, ``call``, ``median``,
    ``max`` and ``stack`` (bytes, None where it is not known).
    """
    head = {"target": COUNTED, "unit": "instructions"}
    found = [
        head
        | {"option": key.split()[1], "call": call}
        | {"median": numbers[0], "max": numbers[1], "stack": numbers[2]}
        for key, cell in _counted_row(export).items()
        if key.startswith(BOARD)
        for call, numbers in cell.items()
        if isinstance(numbers, list)
    ]
    return found or None
