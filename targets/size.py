"""Measure the runtime with a cross compiler: code, RAM and stack of each family at its largest.

    python -m targets.size [--update]

Prints a table on stdout.  With --update it rewrites runtime/sizes.json, which exports read instead
of compiling anything, and the table of docs/measured/targets.md.  A runtime that needs more of a
library than memcpy and memset is an error.
"""

import argparse
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from firmware_export.emit.size import FILE, TARGET
from firmware_export.host import RUNTIME
from lutgen.errors import ExportError, LutgenError
from targets.boards import BOARDS
from targets.cases import ROOT
from targets.elf import section_bytes, undefined
from targets.image import build, deepest, flags_of, version
from targets.pages import PAGE, between, markdown

# What exports read instead of compiling.
SIZES = ROOT / "firmware_export" / "runtime" / FILE
BOARD = BOARDS[0]
# Of string.h, which every C library has.
ALLOWED = frozenset(("memcpy", "memset"))
# Arrays are as large as a map needs: two joints, and three points or twelve discs.
USUAL = {"SMAP_MAX_PARAMS": 2, "SMAP_MAX_ENTRIES": 8, "SMAP_MAX_COORDINATES": 42, "SMAP_SERIES": 1}
# Of many contacts those that marv has, whose axes are parallel, and articulated, whose are not.
CAPACITIES = ("CONTACTS", "RAILS", "AXLES", "FACETS", "EDGES", "RESTS", "CORNERS", "GAPS", "ARCS")
MANY = {"rails": (8, 2, 0, 7, 20, 7, 20, 5, 38), "search": (4, 0, 1, 3, 7, 3, 7, 2, 11)}
# Family: title of a row.
FAMILIES = {
    "points": "`contacts`, three points",
    "tables": "`grid` of three points, floats too",
    "tables_i": "`grid` of three points, integers",
    "grid": "`grid` over gravity, integers",
    "rails": "`contacts`, parallel axes",
    "search": "`contacts`, any other robot",
}

Measure = dict[str, int]


def steered(family: str) -> str:
    """Return the file of on-board control for a family; nothing where it has no floats."""
    text = (RUNTIME / f"smap_{family}.c").read_text(encoding="utf-8")
    found = re.search(r'define SMAP_STEERED_BY "(.*)"', text)
    return found[1] if found else ""


def program(family: str, control: bool = False) -> str:
    """Return a file that takes in a family, on request with on-board control.

    It knows nothing of its tables, so that it has all that any export of the family can have.
    """
    config = {"SMAP_HOST": 1, **USUAL}
    known = zip(CAPACITIES, MANY.get(family, ()), strict=family in MANY)
    config |= {f"SMAP_MANY_{key}": value for key, value in known} | {"SMAP_MANY_KNOWN": 1}
    config |= {"SMAP_CONTROL": 1} if control else {}
    lines = [f"#define {name} {value}" for name, value in config.items()]
    lines += ['#include "smap.h"', '#include "smap_control.h"', f'#include "smap_{family}.c"']
    if control:
        lines += [f'#include "{steered(family)}"']
        lines += ["extern const smap_control_runtime_t *const steers;"]
        lines += ["const smap_control_runtime_t *const steers = &smap_control_run;"]
    lines += ["extern const smap_runtime_t *const seen;"]
    lines += ["const smap_runtime_t *const seen = &smap_run;"]
    return "\n".join([*lines, ""])


def measure(family: str, folder: Path, control: bool = False) -> Measure:
    """Compile a family; return bytes of code, data, bss, stack and of a pose of both forms."""
    text = program(family, control) + "char pose_bytes_of[sizeof(smap_pose_memory_t)];\n"
    (folder / "all.c").write_text(text, encoding="utf-8")
    command = [*flags_of(BOARD, "-Os"), f"-I{RUNTIME}", "-fcallgraph-info=su"]
    build([*command, "-c", "all.c", "-o", "all.o"], folder)
    made = folder / "all.o"
    if more := undefined(made) - ALLOWED:
        raise ExportError(
            f"smap_{family}.c: needs a function of a library (got {', '.join(sorted(more))}); "
            "write it without."
        )
    pose = section_bytes(made, ".bss.pose_bytes_of")
    return {
        "code": section_bytes(made, ".text", ".rodata"),
        "data": section_bytes(made, ".data"),
        "bss": section_bytes(made, ".bss") - pose,
        "stack": deepest((folder / "all.ci").read_text(encoding="utf-8")),
        "pose": pose,
    }


def measure_family(family: str, folder: Path) -> Measure:
    """Measure a family, and what control adds to its code."""
    alone = measure(family, folder)
    # On-board control reads floats.
    both = measure(family, folder, control=True) if steered(family) else alone
    return {**alone, "control": both["code"] - alone["code"]}


def table(found: Mapping[str, Measure]) -> str:
    """Return the table of targets.md."""
    rows = []
    for family, one in found.items():
        numbers = [f"{one[key]:,}" if one[key] else "-" for key in ("code", "stack", "control")]
        rows.append([FAMILIES[family], f"`smap_{family}.c`", *numbers])
    return markdown("| runtime | file | code | stack | on-board control |", rows)


def _row(label: str, result: Measure) -> str:
    cells = [f"{result[key]:>7,}" for key in ("code", "data", "bss", "stack")]
    return f"{label:<10} {' '.join(cells)}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.size", description=__doc__)
    parser.add_argument("--update", action="store_true", help="rewrite runtime/sizes.json")
    options = parser.parse_args(arguments)
    if shutil.which(BOARD.tool) is None:
        print(f"{BOARD.tool} is not installed: nothing is measured", file=sys.stderr)
        return 1
    print(f"{f'{TARGET}, bytes':<10}    code    data     bss   stack")
    found = dict[str, Measure]()
    try:
        with tempfile.TemporaryDirectory(prefix="lutgen-") as name:
            for family in FAMILIES:
                found[family] = measure_family(family, Path(name))
                print(_row(family, found[family]))
    except LutgenError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    if options.update:
        compiler = json.dumps(version(BOARD))
        lines = ",\n".join(f'  "{key}": {json.dumps(row)}' for key, row in found.items())
        text = f'{{"compiler": {compiler},\n"rows": {{\n{lines}\n}}}}\n'
        SIZES.write_text(text, encoding="utf-8")
        between(PAGE, "sizes", table(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
