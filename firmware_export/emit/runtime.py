"""The runtime of an export: the text of its family, the same bytes in every export of a version.

Each `#include "smap_..."` in a file of runtime/ is replaced by the file that it names.
"""

import re
from functools import cache
from importlib.resources import files

from firmware_export.emit.text import LICENCE
from firmware_export.protocol import CBody
from lutgen.errors import ExportError

# What stands around the text of a family, and around that of on-board control.
BEGIN, END = "/* ==== {} ==== */", "/* ==== end of {} ==== */"
_INCLUDE = re.compile(r'^#include "(smap_\w+\.[ch])"\n+', re.MULTILINE)
_STEERED = re.compile(r'^#define SMAP_STEERED_BY "(.*)"$', re.MULTILINE)


@cache
def runtime_file(name: str) -> str:
    """Return the text of a file of the runtime."""
    folder = files("firmware_export") / "runtime"
    try:
        return (folder / name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise ExportError(
            f"{name}: this file of the runtime cannot be read (got {error}); install lutgen again."
        ) from error


@cache
def runtime_version() -> int:
    """Return SMAP_VERSION of the runtime."""
    found = re.search(r"#define SMAP_VERSION (\d+)", runtime_file("smap.h"))
    if found is None:
        raise ExportError("smap.h: SMAP_VERSION is missing (got nothing); install lutgen again.")
    return int(found[1])


def settings(body: CBody, params: int) -> dict[str, int]:
    """Return the macros in front of the runtime: how many there are of what."""
    return {"SMAP_MAX_PARAMS": max(params, 1), "SMAP_SERIES": 0, **dict(body.macros)}


@cache
def runtime_text(name: str) -> str:
    """Return the text of a family."""
    return _marked(f"the runtime for {name}", f"smap_{name}.c")


@cache
def control_text(name: str) -> str:
    """Return the text of on-board control for a family that computes in floats."""
    return _marked(f"on-board control for {name}", control_file(name))


def control_file(name: str) -> str:
    """Return the file of on-board control for a family; nothing where it has no floats."""
    found = _STEERED.search(runtime_file(f"smap_{name}.c"))
    return found[1] if found else ""


def _marked(title: str, file: str) -> str:
    return f"{BEGIN.format(title)}\n\n{_whole(file)}\n{END.format(title)}"


def _whole(file: str) -> str:
    """Return a file with those that it includes in their places, without the licence's lines."""
    text = runtime_file(file).removeprefix(LICENCE)
    return _INCLUDE.sub(lambda found: f"{_whole(found[1])}\n", text)
