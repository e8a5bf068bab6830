"""Measure the runtime with a cross compiler: code, RAM and stack for each set of features.

    python -m targets.size [--update] [EXPORT_DIR ...]

Prints a table on stdout.  With --update it rewrites runtime/sizes.json, which exports read instead
of compiling anything, and the table of docs/measured/targets.md.  A runtime that needs more of a
library than memcpy and memset is an error.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from firmware_export.emit import report
from firmware_export.emit.runtime import SWITCHES, control_parts, parts_of
from firmware_export.emit.size import FILE, TARGET
from firmware_export.host import RUNTIME
from lutgen.errors import ExportError, LutgenError
from targets.cases import ROOT

__all__ = [
    "Measure",
    "deepest",
    "feature_sets",
    "main",
    "measure",
    "measure_set",
    "program",
    "settings_of",
]

# What exports read instead of compiling.
SIZES = ROOT / "firmware_export" / "runtime" / FILE
COMPILER = "arm-none-eabi-gcc"
TARGET_FLAGS = ("-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-Os")
# Nothing of the C library is linked; picolibc has string.h.
FLAGS = (*TARGET_FLAGS, "-std=c99", "-ffp-contract=off", "--specs=picolibc.specs")
# Of string.h, which every C library has.
ALLOWED = frozenset(("memcpy", "memset"))
# Arrays on the stack are as large as a map needs: two joints, and three points or twelve discs.
USUAL = {"SMAP_MAX_PARAMS": 2, "SMAP_MAX_ENTRIES": 8, "SMAP_MAX_COORDINATES": 42}
# Of many contacts those that marv has, on two rails, and articulated, whose axes are not parallel.
CAPACITIES = ("CONTACTS", "RAILS", "AXLES", "FACETS", "EDGES", "SHOWN", "WALLS", "LINKS", "SIDES")
MANY = {"SMAP_MANY_BY_RAILS": (8, 2, 0, 7, 20, 7, 30, 36, 6)}
MANY["SMAP_MANY_SEARCH"] = (4, 0, 1, 3, 7, 3, 18, 20, 2)
GAPS = ("SMAP_MANY_GAPS", "SMAP_FLOATS", "SMAP_INTEGERS")
SETS = (
    ("SMAP_POINTS", "SMAP_FLOATS", "SMAP_INTEGERS"),
    ("SMAP_POLY", "SMAP_FLOATS", "SMAP_INTEGERS"),
    ("SMAP_TABLES", "SMAP_FLOATS", "SMAP_INTEGERS"),
    ("SMAP_TABLES", "SMAP_INTEGERS"),
    ("SMAP_MANY", "SMAP_MANY_BY_RAILS", *GAPS),
    ("SMAP_MANY", "SMAP_MANY_BY_RAILS", *GAPS[1:]),
    ("SMAP_MANY", "SMAP_MANY_SEARCH", *GAPS),
    ("SMAP_MANY", "SMAP_MANY_SEARCH", *GAPS[1:]),
    ("SMAP_POINTS", "SMAP_SERIES", "SMAP_FLOATS", "SMAP_INTEGERS"),
    ("SMAP_MANY", "SMAP_MANY_BY_RAILS", "SMAP_SERIES", *GAPS),
    ("SMAP_MANY", "SMAP_MANY_SEARCH", "SMAP_SERIES", *GAPS),
    ("SMAP_GRID", "SMAP_INTEGERS"),
)
TITLES = (
    "`contacts`, three points",
    "`poly`",
    "`grid` of three points, floats too",
    "`grid` of three points, integers",
    "`contacts` on rails",
    "`contacts` on rails, never rocking",
    "`contacts`, axes not parallel",
    "`contacts`, axes not parallel, never rocking",
    "`contacts`, three points given by code",
    "`contacts` on rails, given by code",
    "`contacts`, others given by code",
    "`grid` over gravity, integers",
)
PAGE = ROOT / "docs" / "measured" / "targets.md"
BEGIN, END = "<!-- sizes -->\n", "\n<!-- end of sizes -->"

Measure = dict[str, int]


def _run(arguments: Sequence[str], folder: Path) -> str:
    """Run a tool of the cross compiler; return what it prints."""
    try:
        done = subprocess.run(
            list(arguments), cwd=folder, capture_output=True, text=True, timeout=120.0, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise ExportError(
            f"{arguments[0]}: the cross compiler cannot be run (got {type(error).__name__}); "
            "install gcc-arm-none-eabi and picolibc-arm-none-eabi."
        ) from error
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error" in line] or ["nothing"]
        raise ExportError(
            f"{arguments[0]}: the runtime does not compile (got {lines[0]!r}); correct its parts."
        )
    return done.stdout


def _prefix() -> str:
    return COMPILER.removesuffix("gcc")


def _sections(text: str) -> Measure:
    """Return code, data and bss from the output of ``size -A``."""
    kinds = {"text": "code", "rodata": "code", "data": "data", "bss": "bss"}
    result = {"code": 0, "data": 0, "bss": 0}
    for name, size in re.findall(r"^\.(text|rodata|data|bss)\S*\s+(\d+)", text, re.MULTILINE):
        result[kinds[name]] += int(size)
    return result


def deepest(graph: str, entry: str = "", without: str = "\n") -> int:
    """Return the deepest stack of any chain of calls, from GCC's call graph (VCG).

    Chains begin with functions whose title ends with `entry`; none has one whose title contains
    `without`.
    """
    own = {
        title: int(size)
        for title, size in re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*?(\d+) bytes', graph)
    }
    calls: dict[str, list[str]] = {}
    for source, target in re.findall(
        r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"', graph
    ):
        calls.setdefault(source, []).append(target)

    def depth(title: str, seen: tuple[str, ...]) -> int:
        if title in seen:
            raise ExportError(f"smap.c: {title} calls itself (got a recursion); write a loop.")
        further = [name for name in calls.get(title, ()) if without not in name]
        below = [depth(name, (*seen, title)) for name in further]
        return own.get(title, 0) + max(below, default=0)

    return max((depth(title, ()) for title in own if title.endswith(entry)), default=0)


def program(config: Mapping[str, int], control: bool = False) -> str:
    """Return a file that has the parts that some settings need, with a blob in memory.

    `control`: with those of on-board control, and a policy in memory.
    """
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
    return "\n".join(
        [
            *lines,
            "extern const smap_runtime_t *const seen;",
            "const smap_runtime_t *const seen = &smap_run;",
            "",
        ]
    )


def measure(config: Mapping[str, int], folder: Path, control: bool = False) -> Measure:
    """Compile the runtime with these settings; return bytes of code, data, bss and stack.

    Parameters
    ----------
    config : mapping
        Value of each setting.
    folder : path
        Where to work.
    control : bool
        Whether with on-board control.
    """
    (folder / "all.c").write_text(program(config, control), encoding="utf-8")
    flags = [*FLAGS, f"-I{RUNTIME}", "-ffunction-sections", "-fcallgraph-info=su"]
    _run([COMPILER, *flags, "-c", "all.c", "-o", "smap.o"], folder)
    missing = set(_run([f"{_prefix()}nm", "-u", "smap.o"], folder).split()[1::2])
    if missing - ALLOWED:
        raise ExportError(
            f"smap.c: needs a function of a library (got {', '.join(sorted(missing - ALLOWED))}); "
            "write it without."
        )
    graph = next(folder.glob("*.ci")).read_text(encoding="utf-8")
    return _sections(_run([f"{_prefix()}size", "-A", "smap.o"], folder)) | {"stack": deepest(graph)}


def settings_of(features: Sequence[str]) -> dict[str, int]:
    """Return the settings of a runtime with these switches on and all others off."""
    more = {
        f"SMAP_MANY_{key}": value
        for switch, values in MANY.items()
        if switch in features
        for key, value in zip(CAPACITIES, values, strict=True)
    }
    switches = {name: int(name in features) for name in SWITCHES}
    return {**switches, **USUAL, **more, "SMAP_MANY_KNOWN": int(bool(more))}


def steers(features: Sequence[str]) -> bool:
    """Tell whether on-board control reads such maps: with floats, and no verdict alone."""
    return "SMAP_FLOATS" in features and "SMAP_GRID" not in features


def measure_set(features: Sequence[str], folder: Path) -> Measure:
    """Measure the runtime with these switches on and all others off."""
    config = settings_of(features)
    alone = measure(config, folder)
    steered = measure(config, folder, control=True) if steers(features) else alone
    return {**alone, "control": steered["code"] - alone["code"]}


def feature_sets() -> list[list[str]]:
    """Return the sets of features that are measured."""
    return [sorted(one) for one in SETS]


def _settings_of(directory: Path) -> dict[str, int]:
    """Return the settings in the NAME.c of an export."""
    name = report.load_report(directory)["name"]
    text = (directory / f"{name}.c").read_text(encoding="utf-8")
    return {name: int(value) for name, value in re.findall(r"#define (SMAP_\w+) (\d+)", text)}


def shown(page: str, rows: Sequence[dict[str, Any]]) -> str:
    """Return the document with its table of sizes made from what was measured."""
    lines = ["| runtime | switches | code | stack | on-board control |", "|---|---|---|---|---|"]
    known = {frozenset(row["features"]): row for row in rows}
    for title, features in zip(TITLES, SETS, strict=True):
        row = known[frozenset(features)]
        more = f"{row['control']:,}" if row["control"] else "-"
        cells = f"{row['code']:,} | {row['stack']:,} | {more}"
        lines.append(f"| {title} | `{' '.join(features)}` | {cells} |")
    head, begin, rest = page.partition(BEGIN)
    _, end, tail = rest.partition(END)
    return head + begin + "\n".join(lines) + end + tail


def _row(label: str, result: Measure) -> str:
    cells = [f"{result[key]:>7,}" for key in ("code", "data", "bss", "stack")]
    return f"{label:<58} {' '.join(cells)}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return an exit code."""
    program_name = "python -m targets.size"
    parser = argparse.ArgumentParser(prog=program_name, description=__doc__)
    parser.add_argument("exports", nargs="*", type=Path, help="folders of `lutgen export`")
    parser.add_argument("--update", action="store_true", help="rewrite runtime/sizes.json")
    options = parser.parse_args(arguments)
    if shutil.which(COMPILER) is None:
        print(f"{COMPILER} is not installed: nothing is measured", file=sys.stderr)
        return 1
    try:
        with tempfile.TemporaryDirectory(prefix="lutgen-") as name:
            _table(Path(name), options.exports, options.update)
    except LutgenError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    return 0


def _table(folder: Path, exports: Sequence[Path], update: bool) -> None:
    """Measure and print everything; rewrite sizes.json if asked to."""
    print(f"{f'{TARGET}, bytes':<58}    code    data     bss   stack")
    rows: list[dict[str, Any]] = []
    for features in feature_sets():
        result = measure_set(features, folder)
        rows.append({"features": sorted(features), **result})
        print(_row(" ".join(sorted(name.removeprefix("SMAP_") for name in features)), result))
    for directory in exports:
        content = report.load_report(directory)
        result = measure(_settings_of(directory), folder)
        print(_row(f"export {content['name']} ({content['spec']})", result))
    if update:
        SIZES.write_text(json.dumps({"sets": rows}, indent=2) + "\n", encoding="utf-8")
        PAGE.write_text(shown(PAGE.read_text("utf-8"), rows), encoding="utf-8")
        print(f"{SIZES.name} and {PAGE.name} are rewritten", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
