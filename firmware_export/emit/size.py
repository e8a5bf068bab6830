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
from firmware_export.protocol import Export

TARGET = "Cortex-M4, -Os"
# The compiler's cell of an export in counts.json that has its bytes.
CELL = "m4f -Os"
FILE, COUNTS = "sizes.json", "counts.json"
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

    `macros` tell which robots' of it; `pose` is the size of the pose that the stack was measured
    with.
    """
    kind = BY_CODE if macros.get("SMAP_SERIES") else SWINGING if macros.get("SMAP_PIVOTS") else ""
    rows = measured(FILE)
    row: dict[str, int] = rows.get(f"{family}{kind}", rows[family])
    return row


def code_bytes(family: str) -> int:
    """Return the most bytes of code that were measured of a family."""
    return family_row(family, {})["code"]


def counted_row(export: Export) -> dict[str, Any] | None:
    """Return the row of counts.json of this very export, None if it was not counted."""
    same = {
        "recipe_sha256": export.recipe.digest,
        "spec": str(export.tables.spec.label),
        "arithmetic": export.arithmetic,
        "channels": list(export.channels),
    }
    rows = measured(COUNTS).values()
    return next((row for row in rows if same.items() <= row["export"].items()), None)
