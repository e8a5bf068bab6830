"""Bytes of code, RAM and stack of the runtime for each set of features, as measured.

The measurement (`make size`, `targets.size`) needs a cross compiler; an export does not:
it reads runtime/sizes.json, which is committed.
"""

import json
from collections.abc import Iterable, Mapping
from functools import cache
from importlib.resources import files
from typing import Any

from lutgen.errors import ExportError

TARGET = "Cortex-M4, -Os"
FILE = "sizes.json"


def parse_sizes(text: str) -> dict[str, Any]:
    """Return the content of sizes.json; refuse anything that is not such a file."""
    try:
        content = json.loads(text)
        sets = {
            frozenset(map(str, row["features"])): {
                key: int(row.get(key, 0) if key == "control" else row[key])
                for key in ("code", "data", "bss", "stack", "control")
            }
            for row in content["sets"]
        }
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ExportError(
            f"{FILE}: is not the file of measured sizes (got {type(error).__name__}: {error}); "
            "run `make size` with --update, or install lutgen again."
        ) from error
    return {"sets": sets}


@cache
def measured() -> Mapping[str, Any]:
    """Return ``sets`` (features -> code, data, bss, stack, and the code of control)."""
    try:
        text = (files("firmware_export") / "runtime" / FILE).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ExportError(
            f"{FILE}: the measured sizes cannot be read (got {error}); install lutgen again."
        ) from error
    return parse_sizes(text)


def control_bytes(features: Iterable[str]) -> int:
    """Return the bytes of code that on-board control adds to these switches; 0 if not measured."""
    row = measured()["sets"].get(frozenset(features))
    return 0 if row is None else int(row["control"])


def code_bytes(features: Iterable[str]) -> int | None:
    """Return the bytes of code of the runtime with these switches on.

    Parameters
    ----------
    features : iterable of str
        See `runtime.features`.

    Returns
    -------
    int or None
        Of exactly this set, or of the smallest measured one that contains it; None if there is
        none.
    """
    wanted = frozenset(features)
    sets = measured()["sets"]
    if wanted in sets:
        return int(sets[wanted]["code"])
    larger = [int(row["code"]) for key, row in sets.items() if key > wanted]
    return min(larger, default=None)
