"""The parts of the runtime as files, and programs that have every line of it between them."""

from pathlib import Path

from firmware_export.emit.runtime import SWITCHES, parts_of, runtime_file
from targets.size import GAPS, USUAL, program

__all__ = ["PROGRAMS", "place", "program_text", "runtime_parts"]

# Program: its switches.
PROGRAMS: dict[str, tuple[str, ...]] = {
    "three": (
        *("SMAP_POINTS", "SMAP_SERIES", "SMAP_POLY", "SMAP_TABLES"),
        *("SMAP_FLOATS", "SMAP_INTEGERS"),
    ),
    "three_i": ("SMAP_TABLES", "SMAP_INTEGERS"),
    "grid_w": ("SMAP_GRID", "SMAP_INTEGERS"),
    "rails": ("SMAP_MANY", "SMAP_MANY_BY_RAILS", "SMAP_SERIES", *GAPS),
    "search": ("SMAP_MANY", "SMAP_MANY_SEARCH", "SMAP_SERIES", *GAPS),
}
# Without rails there is none to hold; all else is as large as it can be.
SEARCHED = {"SMAP_MANY_RAILS": 0}


def runtime_parts() -> dict[str, str]:
    """Return the text of every part, by its file's name; headers, too."""
    names = {f"{part}.c" for on in PROGRAMS.values() for part in parts_of(frozenset(on))}
    return {name: runtime_file(name) for name in (*sorted(names), "smap.h", "smap_config.h")}


def program_text(name: str) -> str:
    """Return the file that takes in the parts of a program."""
    on = PROGRAMS[name]
    more = SEARCHED if "SMAP_MANY_SEARCH" in on else {}
    return program({**{switch: int(switch in on) for switch in SWITCHES}, **USUAL, **more})


def place(parts: dict[str, str], folder: Path) -> None:
    """Put parts, and the programs made of them, into a folder: of_NAME.c."""
    for name, text in parts.items():
        (folder / name).write_text(text, encoding="utf-8")
    for name in PROGRAMS:
        (folder / f"of_{name}.c").write_text(program_text(name), encoding="utf-8")
