"""Bytes of code and stack of the runtime on a Cortex-M4, as measured.

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
from lutgen.errors import ExportError

TARGET = "Cortex-M4, -Os"
# The compiler's cell of an export in counts.json that has its bytes.
CELL = "m4f -Os"
FILE, COUNTS = "sizes.json", "counts.json"
# Behind the name of a family: of robots given by code, whose contacts are series.
BY_CODE = ", by code"


def parse(text: str, name: str, update: str) -> dict[str, Any]:
    """Return the rows of a file of measurements; refuse anything that is not such a file."""
    try:
        rows: dict[str, Any] = json.loads(text)["rows"]
        if not all(isinstance(row, dict) for row in rows.values()):
            raise TypeError("a row is no object")
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ExportError(
            f"{name}: is not the file of measured numbers (got {type(error).__name__}: {error}); "
            f"run `python -m {update} --update`, or install lutgen again."
        ) from error
    return rows


@cache
def measured(name: str, update: str) -> Mapping[str, Any]:
    """Return the rows of a file in runtime/."""
    return parse(runtime_file(name), name, update)


def family_row(family: str, by_code: bool = False) -> dict[str, int]:
    """Return the most bytes of `code`, `stack` and `control` that were measured of a family.

    `pose` is the size of the pose that the stack was measured with.
    """
    rows = measured(FILE, "targets.size")
    row: dict[str, int] = rows.get(f"{family}{BY_CODE}" if by_code else family, rows[family])
    return row


def code_bytes(family: str) -> int:
    """Return the most bytes of code that were measured of a family."""
    return family_row(family)["code"]


def counted_row(export: Export) -> dict[str, Any] | None:
    """Return the row of counts.json of this very export, None where it was not counted."""
    same = {
        "recipe_sha256": export.recipe.digest,
        "spec": str(export.tables.spec.label),
        "arithmetic": export.arithmetic,
        "channels": list(export.channels),
    }
    rows = measured(COUNTS, "targets.run").values()
    return next((row for row in rows if same.items() <= row["export"].items()), None)
