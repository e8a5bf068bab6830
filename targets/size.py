"""Measure the runtime with a cross compiler: the most code and stack of exports of each family.

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
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from firmware_export.emit import package
from firmware_export.emit.runtime import control_file
from firmware_export.emit.size import BY_CODE, FILE, SWINGING, TARGET
from firmware_export.host import RUNTIME
from firmware_export.protocol import Export
from lutgen.errors import ExportError, LutgenError
from targets.boards import BOARDS
from targets.cases import ROOT, TABLES, of_recipe, trained
from targets.elf import section_bytes, undefined
from targets.image import build, compiled, flags_of, version
from targets.marks import between, markdown
from targets.pages import PAGE
from tests.fixtures.exports import coded_export, tripod_export

# What exports read instead of compiling.
SIZES = ROOT / "firmware_export" / "runtime" / FILE
BOARD = BOARDS[0]
# Functions of string.h, which every C library has.
ALLOWED = frozenset(("memcpy", "memset"))
# Arrays are as large as a map needs: two joints, and three points or twelve discs.
USUAL = {"SMAP_MAX_PARAMS": 2, "SMAP_MAX_ENTRIES": 8, "SMAP_MAX_COORDINATES": 42, "SMAP_SERIES": 1}
# Of many contacts those that marv has, whose axes are parallel, and articulated, whose are not.
CAPACITIES = ("CONTACTS", "RESTS", "CORNERS", "GAPS", "ARCS", "FACETS", "SIDES")
MANY = {"rails": (8, 7, 20, 5, 38, 1, 8), "search": (4, 3, 7, 2, 11, 7, 4)}
FAMILIES = ("points", "tables", "tables_i", "grid", "rails", "search")
Measure = dict[str, int]


# Row of sizes.json: exports of the family that are measured, those with all that there is.
EXPORTS: dict[str, tuple[Callable[[], Export], ...]] = {
    "points": (
        *(partial(of_recipe, name, "contacts") for name in ("paper_two", "three_leg_sphere")),
        partial(tripod_export, "tripod"),
    ),
    "points" + BY_CODE: tuple(partial(coded_export, one, one) for one in ("legs", "stops")),
    "tables": (
        partial(of_recipe, "paper_two", "grid", "float", TABLES["float"]),
        partial(tripod_export, "tables", "grid"),
    ),
    "tables_i": (
        partial(of_recipe, "paper_two", "grid", "integer", TABLES["integer"]),
        partial(tripod_export, "tables_i", "grid", arithmetic="integer"),
    ),
    "grid": tuple(partial(trained, "trained", chart) for chart in ("cone", "sphere")),
    "rails": tuple(partial(of_recipe, name, "contacts") for name in ("marv", "absolem")),
    "search": (partial(of_recipe, "articulated", "contacts"),),
    "search" + BY_CODE: tuple(partial(coded_export, one, one) for one in ("wheels", "scissors")),
    "search" + SWINGING: (partial(of_recipe, "tractor", "contacts"),),
}


def program(family: str, control: bool = False) -> str:
    """Return a file that takes in a family, on request with on-board control.

    It knows nothing of its tables, so that it has all that any export of the family can have.
    """
    config = {"SMAP_HOST": 1, **USUAL}
    known = zip(CAPACITIES, MANY.get(family, ()), strict=family in MANY)
    config |= {f"SMAP_MAX_{key}": value for key, value in known}
    config |= {"SMAP_RAILS": 2, "SMAP_DISCS": 4, "SMAP_PIVOTS": 0, "SMAP_TURNS": 1}
    config |= {"SMAP_CONTROL": 1} if control else {}
    lines = [f"#define {name} {value}" for name, value in config.items()]
    lines += ['#include "smap.h"', '#include "smap_control.h"', f'#include "smap_{family}.c"']
    if control:
        lines += [f'#include "{control_file(family)}"']
        lines += ["const smap_control_runtime_t *const steers = &smap_control_run;"]
    lines += ["const smap_runtime_t *const seen = &smap_run;"]
    return "\n".join([*lines, ""])


def measure(export: Export, folder: Path) -> Measure:
    """Compile an export; return bytes of code, of the deepest stack, and of a pose."""
    package.write(export, folder)
    source = folder / f"{export.name}.c"  # as if a joint turned all the way round
    source.write_text(source.read_text("utf-8").replace("SMAP_TURNS 0", "SMAP_TURNS 1"), "utf-8")
    size = compiled(export.name, BOARD, "-Os", folder, {})
    if more := undefined(folder / f"{export.name}.o") - ALLOWED:
        raise ExportError(
            f"{export.name}.c: needs a function of a library (got {', '.join(sorted(more))}); "
            "write it without."
        )
    return {"code": size.code, "stack": size.stack or 0, "pose": 4 * export.body.pose[0] + 4}


def measure_control(family: str, folder: Path) -> int:
    """Return what on-board control adds to the code of a family at most."""
    sizes = []
    for control in (False, True):
        (folder / "all.c").write_text(program(family, control), encoding="utf-8")
        build([*flags_of(BOARD, "-Os"), f"-I{RUNTIME}", "-c", "all.c", "-o", "all.o"], folder)
        sizes.append(section_bytes(folder / "all.o", ".text", ".rodata"))
    return sizes[1] - sizes[0]


def measure_row(row: str, folder: Path) -> Measure:
    """Return the most that the exports of a row take, and what control adds to its family."""
    found = [measure(make(), folder / f"{row} {at}") for at, make in enumerate(EXPORTS[row])]
    most = {key: max(one[key] for one in found) for key in ("code", "stack", "pose")}
    family = row.split(",")[0]
    return {**most, "control": measure_control(family, folder) if control_file(family) else 0}


def table(found: Mapping[str, Measure]) -> str:
    """Return the table of targets.md."""
    rows = []
    for name, one in found.items():
        numbers = [f"{one[key]:,}" if one[key] else "-" for key in ("code", "stack", "control")]
        rows.append([name, *numbers])
    return markdown("| family | code | stack | on-board control |", rows)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return an exit code."""
    parser = argparse.ArgumentParser(prog="python -m targets.size", description=__doc__)
    parser.add_argument("--update", action="store_true", help="rewrite runtime/sizes.json")
    options = parser.parse_args(arguments)
    if shutil.which(BOARD.tool) is None:
        print(f"{BOARD.tool} is not installed: nothing is measured", file=sys.stderr)
        return 1
    found = dict[str, Measure]()
    try:
        with tempfile.TemporaryDirectory(prefix="lutgen-") as name:
            for row in EXPORTS:
                found[row] = measure_row(row, Path(name))
    except LutgenError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    print(f"{TARGET}, bytes\n\n{table(found)}")
    if options.update:
        compiler = json.dumps(version(BOARD))
        lines = ",\n".join(f'  "{key}": {json.dumps(row)}' for key, row in found.items())
        text = f'{{"compiler": {compiler},\n"rows": {{\n{lines}\n}}}}\n'
        SIZES.write_text(text, encoding="utf-8")
        between(PAGE, "sizes", table(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
