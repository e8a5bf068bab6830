"""NAME_report.json: the facts of an export, for programs.

It is also how a folder is recognised as an export and how its code is asked without C being parsed:
`load_report` reads it back.
"""

import json
from pathlib import Path
from typing import Any

from firmware_export.emit.facts import FORMAT, MARKER
from lutgen import bounds
from lutgen.errors import InputError

SUFFIX = "_report.json"


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
        with path.open("rb") as file:
            raw = file.read(bounds.REPORT_BYTES.most + 1)
        bounds.check(len(raw), bounds.REPORT_BYTES, str(path), "export again")
        content = json.loads(raw.decode("utf-8"))
        version = content[MARKER]
        names = {str(parameter["name"]) for parameter in content["parameters"]}
        known = {"name", "robot", "length_unit", "arithmetic", "channels", "files"} <= set(content)
    except InputError:
        raise
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
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
