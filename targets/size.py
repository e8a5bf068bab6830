"""Measure the runtime with a cross compiler: code, RAM and stack for each set of features.

    python -m targets.size [--update]

Prints a table on stdout.  With --update it rewrites runtime/sizes.json, which exports read instead
of compiling anything, and the table of docs/measured/targets.md.  A runtime that needs more of a
library than memcpy and memset is an error.
"""

import argparse
import json
import shutil
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from firmware_export.emit.runtime import SWITCHES, control_parts, parts_of
from firmware_export.emit.size import FILE, TARGET
from firmware_export.host import RUNTIME
from lutgen.errors import ExportError, LutgenError
from targets.boards import BOARDS
from targets.cases import ROOT
from targets.elf import section_bytes, undefined
from targets.image import build, deepest, flags_of
from targets.pages import PAGE, between, markdown

# What exports read instead of compiling.
SIZES = ROOT / "firmware_export" / "runtime" / FILE
BOARD = BOARDS[0]
# Of string.h, which every C library has.
ALLOWED = frozenset(("memcpy", "memset"))
# Arrays on the stack are as large as a map needs: two joints, and three points or twelve discs.
USUAL = {"SMAP_MAX_PARAMS": 2, "SMAP_MAX_ENTRIES": 8, "SMAP_MAX_COORDINATES": 42}
# Of many contacts those that marv has, whose axes are parallel, and articulated, whose are not.
CAPACITIES = ("CONTACTS", "RAILS", "AXLES", "FACETS", "EDGES", "RESTS", "CORNERS", "GAPS", "ARCS")
MANY = {"SMAP_MANY_BY_RAILS": (8, 2, 0, 7, 20, 7, 20, 5, 38)}
MANY["SMAP_MANY_SEARCH"] = (4, 0, 1, 3, 7, 3, 7, 2, 11)
BOTH = ("SMAP_FLOATS", "SMAP_INTEGERS")
GAPS = ("SMAP_MANY_GAPS", *BOTH)
RAILS, SEARCH = ("SMAP_MANY", "SMAP_MANY_BY_RAILS"), ("SMAP_MANY", "SMAP_MANY_SEARCH")
# All that three contacts can have, for the proofs.
THREE = ("SMAP_POINTS", "SMAP_SERIES", "SMAP_TABLES", *BOTH)
# Title of a row: its switches.
SETS = {
    "`contacts`, three points": ("SMAP_POINTS", *BOTH),
    "`grid` of three points, floats too": ("SMAP_TABLES", *BOTH),
    "`grid` of three points, integers": ("SMAP_TABLES", "SMAP_INTEGERS"),
    "`grid` over gravity, integers": ("SMAP_GRID", "SMAP_INTEGERS"),
    "`contacts`, parallel axes": (*RAILS, *GAPS),
    "`contacts`, parallel axes, never rocking": (*RAILS, *BOTH),
    "`contacts`, axes not parallel": (*SEARCH, *GAPS),
    "`contacts`, axes not parallel, never rocking": (*SEARCH, *BOTH),
    "`contacts`, three points given by code": ("SMAP_POINTS", "SMAP_SERIES", *BOTH),
    "`contacts`, parallel axes, given by code": (*RAILS, "SMAP_SERIES", *GAPS),
    "`contacts`, others given by code": (*SEARCH, "SMAP_SERIES", *GAPS),
}

Measure = dict[str, int]


def program(config: Mapping[str, int], control: bool = False) -> str:
    """Return a file of the parts that some settings need, on request with on-board control."""
    on = frozenset(name for name, value in config.items() if value)
    lines = ["#define SMAP_HOST", *(f"#define {name} {value}" for name, value in config.items())]
    lines += ['#include "smap.h"', '#include "smap_config.h"']
    lines += [f'#include "{part}.c"' for part in parts_of(on)]
    if control:
        lines.insert(1, "#define SMAP_CONTROL 1")
        lines += ['#include "smap_control.h"']
        lines += [f'#include "{part}.c"' for part in control_parts(on)]
        lines += ["extern const smap_control_runtime_t *const steers;"]
        lines += ["const smap_control_runtime_t *const steers = &smap_control_run;"]
    lines += ["extern const smap_runtime_t *const seen;"]
    lines += ["const smap_runtime_t *const seen = &smap_run;", ""]
    return "\n".join(lines)


def measure(config: Mapping[str, int], folder: Path, control: bool = False) -> Measure:
    """Compile the runtime with these settings; return bytes of code, data, bss and stack."""
    (folder / "all.c").write_text(program(config, control), encoding="utf-8")
    command = [*flags_of(BOARD, "-Os"), f"-I{RUNTIME}", "-fcallgraph-info=su"]
    build([*command, "-c", "all.c", "-o", "all.o"], folder)
    made = folder / "all.o"
    if more := undefined(made) - ALLOWED:
        raise ExportError(
            f"smap.c: needs a function of a library (got {', '.join(sorted(more))}); "
            "write it without."
        )
    return {
        "code": section_bytes(made, ".text", ".rodata"),
        "data": section_bytes(made, ".data"),
        "bss": section_bytes(made, ".bss"),
        "stack": deepest((folder / "all.ci").read_text(encoding="utf-8")),
    }


def settings_of(features: Sequence[str]) -> dict[str, int]:
    """Return the settings of a runtime with these switches on and all others off."""
    more = {
        f"SMAP_MANY_{key}": value
        for switch, values in MANY.items()
        if switch in features
        for key, value in zip(CAPACITIES, values, strict=True)
    }
    known = {"SMAP_MANY_KNOWN": int(bool(more))}
    switches = {name: int(name in features) * more.pop(name, 1) for name in SWITCHES}
    return {**switches, **USUAL, **more, **known}


def measure_set(features: Sequence[str], folder: Path) -> Measure:
    """Measure the runtime with these switches on and all others off, and what control adds."""
    config = settings_of(features)
    alone = measure(config, folder)
    # On-board control reads floats.
    floats = "SMAP_FLOATS" in features
    steered = measure(config, folder, control=True) if floats else alone
    return {**alone, "control": steered["code"] - alone["code"]}


def table(found: Mapping[str, Measure]) -> str:
    """Return the table of targets.md."""
    rows = []
    for title, one in found.items():
        numbers = [f"{one[key]:,}" if one[key] else "-" for key in ("code", "stack", "control")]
        rows.append([title, f"`{' '.join(SETS[title])}`", *numbers])
    return markdown("| runtime | switches | code | stack | on-board control |", rows)


def _row(label: str, result: Measure) -> str:
    cells = [f"{result[key]:>7,}" for key in ("code", "data", "bss", "stack")]
    return f"{label:<58} {' '.join(cells)}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.size", description=__doc__)
    parser.add_argument("--update", action="store_true", help="rewrite runtime/sizes.json")
    options = parser.parse_args(arguments)
    if shutil.which(BOARD.tool) is None:
        print(f"{BOARD.tool} is not installed: nothing is measured", file=sys.stderr)
        return 1
    print(f"{f'{TARGET}, bytes':<58}    code    data     bss   stack")
    found = dict[str, Measure]()
    try:
        with tempfile.TemporaryDirectory(prefix="lutgen-") as name:
            for title, features in SETS.items():
                found[title] = measure_set(features, Path(name))
                print(_row(title.replace("`", ""), found[title]))
    except LutgenError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    if options.update:
        rows: list[dict[str, Any]] = [
            {"features": sorted(SETS[title]), **one} for title, one in found.items()
        ]
        lines = ",\n".join(f"  {json.dumps(row)}" for row in rows)
        SIZES.write_text(f'{{"sets": [\n{lines}\n]}}\n', encoding="utf-8")
        between(PAGE, "sizes", table(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
