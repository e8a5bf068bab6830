"""Read the runtime's files and put the text of a family together.

The text of a family is the same bytes in every export of a version: each `#include "smap_..."` in
a file of runtime/ is replaced by the file that it names.
"""

import re
from functools import cache
from importlib.resources import files

from lutgen.errors import ExportError, reject

# The licence's lines on top of every C file.
LICENCE = "/* SPDX-License-Identifier: MIT\n * Copyright (c) The lutgen authors */\n"
_INCLUDE = re.compile(r'^#include "(smap_\w+\.[ch])"\n+', re.MULTILINE)
_STEERED = re.compile(r'^#define SMAP_STEERED_BY "(.*)"$', re.MULTILINE)


@cache
def runtime_file(name: str) -> str:
    """Return the text of a file of the runtime."""
    try:
        return (files("firmware_export") / "runtime" / name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        what = "this file of the runtime cannot be read"
        reject(name, what, error, "install lutgen again", ExportError)


@cache
def runtime_text(family: str) -> str:
    """Return the text of a family."""
    return _marked(f"the runtime for {family}", f"smap_{family}.c")


@cache
def control_text(family: str) -> str:
    """Return the text of on-board control for a family that computes in floats."""
    return _marked(f"on-board control for {family}", control_file(family))


def control_file(family: str) -> str:
    """Return the file of on-board control for a family, empty for a family without floats."""
    found = _STEERED.search(runtime_file(f"smap_{family}.c"))
    return found[1] if found else ""


def _marked(title: str, file: str) -> str:
    return f"/* ==== {title} ==== */\n\n{_whole(file)}\n/* ==== end of {title} ==== */"


def _whole(file: str) -> str:
    """Return a file with those that it includes in their places, without the licence's lines."""
    text = runtime_file(file).removeprefix(LICENCE)
    return _INCLUDE.sub(lambda found: f"{_whole(found[1])}\n", text)
