"""The facts of an export as texts: one wording for the header, the report and the command line.

Numbers come from the export and its certificate; nothing is measured or laid out here.
"""

import json
import math
from functools import cache
from importlib.resources import files
from typing import Any

from firmware_export.emit.size import TARGET, struct_bytes
from firmware_export.protocol import CBody, Export
from lutgen.errors import ExportError
from lutgen.parts import Parameter
from lutgen.recipe import Recipe

__all__ = [
    "COUNTS",
    "axis_range",
    "bytes_text",
    "channel_unit",
    "chart_text",
    "counted",
    "descriptor_bytes",
    "error_texts",
    "flash_bytes",
    "movement",
    "share",
]

# Beside sizes.json: what reads were counted to cost, written by `python -m targets.run --update`.
COUNTS = "counts.json"
MEANING = {
    "sdg": "stability factor |SD_g|, 0 at its most stable",
    "tip_angle": "angle until the robot tips, guard subtracted",
    "height": "|OC|, height of the centre of mass over its support",
}


def number(value: float, digits: int = 4) -> str:
    """Return a number with a few significant digits; a dash for what is not known.

    Examples
    --------
    >>> number(0.0123456), number(1234567.0), number(math.nan)
    ('0.01235', '1234567', '-')
    """
    if not math.isfinite(value):
        return "-"
    return f"{value:.0f}" if abs(value) >= 10.0**digits else f"{value:.{digits}g}"


def channel_unit(channel: str, recipe: Recipe) -> str:
    """Return the unit in which the C code answers a channel."""
    return "rad" if channel == "tip_angle" else recipe.length_unit


def axis_range(parameter: Parameter) -> str:
    """Return the range of a parameter in the unit of the C code, and in deg."""
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    text = f"{number(parameter.minimum, 7)} .. {number(parameter.maximum, 7)}{unit}"
    if parameter.unit == "rad":
        low, high = math.degrees(parameter.minimum), math.degrees(parameter.maximum)
        text += f" ({number(low)} .. {number(high)} deg)"
    return text


def movement(parameter: Parameter, recipe: Recipe) -> str:
    """Return what a parameter does to the robot."""
    verbs = {"revolute": "turns", "prismatic": "shifts"}
    parts = []
    for kind, verb in verbs.items():
        moved = [
            link.name
            for link in recipe.links
            if link.joint and link.joint.kind == kind and link.joint.parameter == parameter.name
        ]
        if moved:
            parts.append(f"{verb} {', '.join(moved)}")
    return " and ".join(parts) or "parameter of the recipe's own function"


def chart_text(recipe: Recipe) -> str:
    """Return which directions the map holds."""
    if recipe.chart.kind == "sphere":
        return "every direction"
    tilt = number(math.degrees(recipe.chart.max_tilt))
    return f"up to {tilt} deg of pitch and of roll from straight down"


def share(value: float | None) -> str:
    """Return a share 0..1 in percent.

    Examples
    --------
    >>> share(0.0123), share(0.0), share(None)
    ('1.23 %', '0 %', 'not measured')
    """
    return "not measured" if value is None else f"{100.0 * value:.3g} %"


def error_texts(channel: str, entry: dict[str, Any], length_unit: str) -> tuple[str, str, str]:
    """Return maximum, 99th percentile and RMS error of a channel, with units."""
    unit = "" if length_unit == "1" else f" {length_unit}"
    texts = []
    for name in ("max", "p99", "rms"):
        # A channel that jumps has no largest error, only a largest one that was seen.
        key = "largest_seen" if name == "max" and entry.get("max") is None else name
        value = entry.get(key)
        if value is None:
            texts.append("-")
            continue
        seen = "no bound, seen: " if key == "largest_seen" else ""
        if channel == "tip_angle":
            texts.append(f"{seen}{number(math.degrees(value))} deg")
            continue
        percent = entry.get(f"{key}_percent")
        extra = "" if percent is None else f" ({number(percent, 3)} %)"
        texts.append(f"{seen}{number(value)}{unit}{extra}")
    return texts[0], texts[1], texts[2]


def descriptor_bytes(export: Export, body: CBody) -> int | None:
    """Return the bytes of the structs on the target, None where a size was not measured."""
    counts = [("smap_t", 1), (body.ctype, 1), ("smap_axis_t", export.model.k)]
    counts += [(array.ctype, len(array.values)) for array in body.arrays if not array.plain]
    total = 0
    for ctype, count in counts:
        size = struct_bytes(ctype)
        if size is None:
            return None
        total += count * size
    return total


def bytes_text(sizes: dict[str, Any]) -> str:
    """Return the bytes of flash in words; `sizes` has tables, descriptors, code, total, target.

    Examples
    --------
    >>> bytes_text({"tables": 66, "descriptors": None, "code": 1200, "total": None, "target": "M4"})
    '66 bytes of tables, 1,200 of code (M4)'
    """
    text = f"{sizes['tables']:,} bytes of tables"
    if sizes["descriptors"] is not None:
        text += f", {sizes['descriptors']:,} of descriptors"
    if sizes["code"] is not None:
        text += f", {sizes['code']:,} of code"
    if sizes["total"] is not None:
        text += f", {sizes['total']:,} together"
    known = sizes["descriptors"] is not None or sizes["code"] is not None
    return f"{text} ({sizes['target']})" if known else text


def flash_bytes(export: Export, body: CBody) -> dict[str, Any]:
    """Return the bytes of an export: tables, descriptors, code, total (None: not measured)."""
    structs, tables, code = descriptor_bytes(export, body), int(export.tables.bytes), None
    if export.code_bytes is not None:
        code = int(export.code_bytes)
    return {
        "tables": tables,
        "descriptors": structs,
        "code": code,
        "total": None if structs is None or code is None else tables + structs + code,
        "target": TARGET,
    }


@cache
def _counts() -> list[dict[str, Any]]:
    """Return the rows of counts.json; none where nothing was counted."""
    path = files("firmware_export") / "runtime" / COUNTS
    if not path.is_file():
        return []
    try:
        rows: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["rows"]
        for row in rows:
            row["recipe_sha256"], row["spec"], row["arithmetic"], row["channels"], row["targets"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ExportError(
            f"{COUNTS}: is not the file of counted reads (got {type(error).__name__}: {error}); "
            "run `make firmware` with --update, or install lutgen again."
        ) from error
    return rows


def counted(export: Export) -> list[dict[str, Any]] | None:
    """Return what a read of this very export was counted to cost, None where it was not.

    Returns
    -------
    list of dict or None
        Per target and compiler option ``target``, ``option``, ``unit`` (instructions or cycles),
        ``median`` and ``max``.
    """
    for row in _counts():
        same = (
            row["recipe_sha256"] == export.recipe.digest
            and row["spec"] == getattr(export.tables.spec, "label", None)
            and row["arithmetic"] == export.arithmetic
            and row["channels"] == list(export.channels)
        )
        if same:
            targets: list[dict[str, Any]] = row["targets"]
            return targets
    return None
