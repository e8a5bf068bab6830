"""NAME_report.json and NAME_report.md: everything about an export, for programs and for people.

The JSON is also how a folder is recognised as an export and how its code is asked without C being
parsed: `load_report` reads it back.
"""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from firmware_export.emit.config import features, runtime_version
from firmware_export.emit.facts import channel_unit, counted, flash_bytes, movement
from firmware_export.emit.header import axis_macros
from firmware_export.protocol import CBody, Export
from lutgen._version import __version__
from lutgen.errors import InputError

__all__ = ["FORMAT", "SUFFIX", "find", "json_text", "load_file", "load_report", "report"]

FORMAT = 1
MARKER = "lutgen_export"
SUFFIX = "_report.json"


def plain(value: Any) -> Any:
    """Return a value as JSON knows it: no NumPy types, no NaN, no infinity."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value if value is None or isinstance(value, str) else str(value)


def report(export: Export, body: CBody, names: list[str]) -> dict[str, Any]:
    """Return the content of NAME_report.json.

    Parameters
    ----------
    export : Export
        The export.
    body : CBody
        Its tables.
    names : list of str
        The files of the folder.
    """
    recipe, model, tables = export.recipe, export.model, export.tables
    certificate = export.certificate or {}
    errors = certificate.get("channels", {})
    content = {
        MARKER: FORMAT,
        "name": export.name,
        "robot": recipe.name,
        "lutgen_version": __version__,
        "smap_version": runtime_version(),
        "recipe_sha256": recipe.digest,
        "length_unit": recipe.length_unit,
        "codec": export.codec,
        "spec": getattr(tables.spec, "label", str(tables.spec)),
        "arithmetic": export.arithmetic,
        "features": sorted(features(export.codec, export.arithmetic, model.k, model.faces, body)),
        "parameters": [
            {
                "name": parameter.name,
                "macro": name,
                "unit": parameter.unit,
                "display_unit": parameter.display_unit,
                "min": low,
                "max": high,
                "meaning": movement(parameter, recipe),
            }
            for parameter, name, low, high in zip(
                recipe.parameters, axis_macros(export), model.lower, model.upper, strict=True
            )
        ],
        "chart": {
            "kind": recipe.chart.kind,
            "faces": model.faces,
            "max_tilt_deg": math.degrees(recipe.chart.max_tilt)
            if recipe.chart.kind == "cone"
            else None,
        },
        "channels": {
            channel: {"unit": channel_unit(channel, recipe), "error": errors.get(channel)}
            for channel in export.channels
        },
        "steps": dict(body.steps),
        "bytes": flash_bytes(export, body),
        "counts": counted(export),
        "guard_deg": math.degrees(float(tables.guard)),
        "guard_text": tables.guard_text,
        "given_up": certificate.get("given_up"),
        "false_safe": certificate.get("false_safe"),
        "points": certificate.get("points"),
        "certificate": certificate or None,
        "pareto": export.pareto,
        "files": names,
    }
    result: dict[str, Any] = plain(content)
    return result


def json_text(content: dict[str, Any]) -> str:
    """Return a report as the text of its file."""
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def find(directory: Path) -> list[Path]:
    """Return the reports in a folder, sorted by name."""
    return sorted(path for path in directory.glob(f"*{SUFFIX}") if path.is_file())


def load_report(directory: Path) -> dict[str, Any]:
    """Return the report of an export folder; refuse a folder that is none."""
    found = find(directory)
    if len(found) != 1:
        raise InputError(
            f"{directory}: is no folder of `lutgen export` (got {len(found)} files "
            f"*{SUFFIX}); name the folder that was given to -o."
        )
    return load_file(found[0])


def load_file(path: Path) -> dict[str, Any]:
    """Return the content of a report; refuse a file that is damaged or of another format."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        version = content[MARKER]
        names = {str(parameter["name"]) for parameter in content["parameters"]}
        known = {"name", "robot", "length_unit", "arithmetic", "channels", "files"} <= set(content)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise _damaged(path, f"{type(error).__name__}: {error}") from error
    if version != FORMAT:
        raise InputError(
            f"{path}: is of another format (got {version!r}, this lutgen knows {FORMAT}); "
            "export again."
        )
    if not known or len(names) != len(content["parameters"]):
        raise _damaged(path, "keys are missing")
    result: dict[str, Any] = content
    return result


def _damaged(path: Path, got: str) -> InputError:
    return InputError(f"{path}: the report is damaged (got {got}); export again.")
