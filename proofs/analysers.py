"""Static analysers over the whole runtime: what they find must be known and explained.

Known findings are the tables of docs/measured/c-runtime.md.  A finding that is not there fails, and
so does another number of them, which `--update` writes into the document.
"""

import re
from collections import Counter
from pathlib import Path

from firmware_export.emit.runtime import runtime_file
from proofs.document import findings
from proofs.tools import FAILED, OK, Clock, Result, run
from targets.size import FLAGS as ARM_FLAGS

__all__ = ["ANALYSERS", "analyse", "compare", "heading", "place"]

# Name: program, command, and how a finding looks in what it prints.
_GCC = ("-std=c99", "-Wall", "-Wextra", "-fanalyzer", "-c", "smap.c", "-o", "smap.o")
_CHECKS = "--checks=-*,bugprone-*,cert-*,clang-analyzer-*"
ANALYSERS: dict[str, tuple[str, tuple[str, ...], str]] = {
    "gcc -fanalyzer, host": ("gcc", ("-O2", *_GCC), r"warning: .*\[-W(?:error=)?([\w-]+)\]$"),
    "gcc -fanalyzer, Cortex-M4": (
        "arm-none-eabi-gcc",
        (*ARM_FLAGS, *_GCC),
        r"warning: .*\[-W(?:error=)?([\w-]+)\]$",
    ),
    "clang-tidy": (
        "clang-tidy",
        ("--quiet", _CHECKS, "smap.c", "--", "-std=c99"),
        r"warning: .*\[([\w.,-]+)\]$",
    ),
    "cppcheck": (
        "cppcheck",
        ("--std=c99", "--enable=warning,portability", "--template={id}", "-q", "smap.c"),
        r"^(\w+)$",
    ),
    "MISRA": (
        "cppcheck",
        ("--std=c99", "--addon=misra", "--template={id}", "-q", "smap.c"),
        r"^misra-c2012-(\d+\.\d+)$",
    ),
}


def heading(name: str) -> str:
    """Return the heading of an analyser's table in the document."""
    return "MISRA deviations" if name == "MISRA" else f"Findings of {name}"


def place(source: str, folder: Path) -> None:
    """Put the runtime into a folder, with this text of smap.c and all codecs switched on."""
    (folder / "smap.c").write_text(source, encoding="utf-8")
    for name in ("smap.h", "smap_config.h"):
        (folder / name).write_text(runtime_file(name), encoding="utf-8")


def count(name: str, folder: Path, patience: float) -> tuple[dict[str, int], str]:
    """Return how often each finding occurs, and why the analyser failed or ""."""
    program, arguments, pattern = ANALYSERS[name]
    done = run([program, *arguments], folder, patience)
    found = dict(Counter(re.findall(pattern, done.text, re.MULTILINE)))
    wrong = next((line for line in done.text.splitlines() if "error:" in line), "")
    return found, wrong or ("" if done.code == 0 or found else f"exit code {done.code}")


def compare(found: dict[str, int], known: dict[str, int]) -> str:
    """Return what differs between findings and those that are known, or ""."""
    new = [f"{name} is not in the list" for name in sorted(found.keys() - known.keys())]
    gone = [f"{name} is no longer found" for name in sorted(known.keys() - found.keys())]
    other = [
        f"{name}: {found[name]} times, listed {known[name]}"
        for name in sorted(found.keys() & known.keys())
        if found[name] != known[name]
    ]
    return "; ".join(new + other + gone)


def analyse(
    name: str, document: str, folder: Path, patience: float
) -> tuple[Result, dict[str, int]]:
    """Run one analyser over the runtime in a folder; compare with its table in the document."""
    with Clock() as clock:
        found, failed = count(name, folder, patience)
    wrong = failed or compare(found, findings(document, heading(name)))
    text = wrong or f"{sum(found.values())} findings of {len(found)} kinds, all known"
    result = Result("analyser", name, FAILED if wrong else OK, text[:160], clock.seconds)
    return result, found
