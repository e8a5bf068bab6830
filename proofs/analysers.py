"""Static analysers over the whole runtime: what they find must be known and explained.

Known findings are the tables of docs/measured/c-runtime.md.  A finding that is not there fails, and
so does another number of them, which `--update` writes into the document.
"""

import re
from collections import Counter
from pathlib import Path

from proofs.document import findings
from proofs.parts import PROGRAMS
from proofs.tools import FAILED, OK, Clock, Result, run
from targets.size import FLAGS as ARM_FLAGS

__all__ = ["ANALYSERS", "analyse", "compare", "heading"]

# Name: program, command without the file, how a finding looks in what it prints: where and what.
_GCC = ("-std=c99", "-Wall", "-Wextra", "-fanalyzer", "-c", "-o", "smap.o")
_WARNED = r"(\w+\.[ch]:\d+:\d+): warning: .*\[-W(?:error=)?([\w-]+)\]$"
_CHECKS = "--checks=-*,bugprone-*,cert-*,clang-analyzer-*"
_TEMPLATE = "--template={file}:{line}:{column}: {id}"
ANALYSERS: dict[str, tuple[str, tuple[str, ...], str]] = {
    "gcc -fanalyzer, host": ("gcc", ("-O2", *_GCC), _WARNED),
    "gcc -fanalyzer, Cortex-M4": ("arm-none-eabi-gcc", (*ARM_FLAGS, *_GCC), _WARNED),
    "clang-tidy": (
        "clang-tidy",
        (
            "--quiet",
            "--header-filter=.*",
            _CHECKS,
        ),
        r"(\w+\.[ch]:\d+:\d+): warning: .*\[([\w.,-]+)\]$",
    ),
    "cppcheck": (
        "cppcheck",
        ("--std=c99", "--enable=warning,portability", _TEMPLATE, "-q", "-D__GNUC__=12"),
        r"^(\S+:\d+:\d+): (\w+)$",
    ),
    "MISRA": (
        "cppcheck",
        ("--std=c99", "--addon=misra", _TEMPLATE, "-q", "-D__GNUC__=12"),
        r"^(\S+:\d+:\d+): misra-c2012-(\d+\.\d+)$",
    ),
}
# What an analyser says of a file that it gave up.
UNREAD = {"internalAstError", "internalError", "syntaxError", "preprocessorErrorDirective"}


def heading(name: str) -> str:
    """Return the heading of an analyser's table in the document."""
    return "MISRA deviations" if name == "MISRA" else f"Findings of {name}"


def count(name: str, folder: Path, patience: float) -> tuple[dict[str, int], str]:
    """Return at how many places each finding occurs, and why the analyser failed or "".

    A place that several programs have counts once; the files that take the parts in are not the
    runtime.
    """
    program, arguments, pattern = ANALYSERS[name]
    places: set[tuple[str, str]] = set()
    for part in PROGRAMS:
        file = f"of_{part}.c"
        more = ("--", "-std=c99") if program == "clang-tidy" else ()
        done = run([program, *arguments, file, *more], folder, patience)
        found = set(re.findall(pattern, done.text, re.MULTILINE))
        wrong = next((line for line in done.text.splitlines() if "error:" in line), "")
        if wrong or (done.code and not found):
            return {}, wrong or f"exit code {done.code}"
        if unread := {kind for _, kind in found} & UNREAD:
            return {}, f"{file} is not read: {', '.join(sorted(unread))}"
        places |= {(place, kind) for place, kind in found if not place.startswith("of_")}
    return dict(Counter(kind for _, kind in places)), ""


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
