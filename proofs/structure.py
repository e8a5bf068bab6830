"""What the runtime shows by itself: loops, lengths, recursion, globals, library calls."""

import re
from pathlib import Path

from lutgen.errors import ExportError
from proofs import loops
from proofs.document import cells
from proofs.parts import PROGRAMS
from proofs.tools import FAILED, OK, Clock, Result, run
from targets.size import ALLOWED, deepest

__all__ = ["LONGEST", "long_ones", "prove", "undocumented", "writable"]

FLAGS = ("-std=c99", "-O1", "-ffp-contract=off", "-fcallgraph-info=su", "-c")
# Lines of a function, its brackets among them.
LONGEST = 60


def long_ones(source: str) -> list[str]:
    """Return the functions of more than `LONGEST` lines, with how many they have."""
    text = loops.plain(source)
    found = []
    for at, name in loops.functions(text)[1:]:
        lines = text[at : text.index("\n}", at)].count("\n") + 2
        if lines > LONGEST:
            found.append(f"{name}: {lines} lines")
    return found


def undocumented(parts: dict[str, str], document: str) -> list[str]:
    """Return loops that have no bound, that the document does not list, and that are gone."""
    source = "\n".join(text for _, text in sorted(parts.items()))
    present = {tuple(row) for row in loops.rows(parts)}
    listed = {tuple(cell.replace("\\|", "|") for cell in row) for row in cells(document, "Loops")}
    new = [f"{row[0]} of {row[2]} is not listed" for row in sorted(present - listed)]
    gone = [f"{row[0]} of {row[2]} is listed and not there" for row in sorted(listed - present)]
    return loops.unbounded(source) + new + gone


def writable(listing: str) -> list[str]:
    """Return the symbols of an ``nm`` listing that lie in memory that can be written."""
    return re.findall(r"^[0-9a-f]+ [bBcCdDgGsS] (\S+)", listing, re.MULTILINE)


def prove(parts: dict[str, str], document: str, folder: Path, patience: float) -> list[Result]:
    """Check parts of the runtime that lie in a folder; see `proofs.parts.place`."""
    results = []
    source = "\n".join(text for name, text in sorted(parts.items()))

    def add(subject: str, wrong: str, text: str, seconds: float) -> None:
        state = FAILED if wrong else OK
        results.append(Result("structure", subject, state, wrong[:160] or text, seconds))

    with Clock() as clock:
        wrong = "; ".join(undocumented(parts, document))
    add(
        "loops",
        wrong,
        f"{len(list(loops.loops(source)))} loops, each with its bound",
        clock.seconds,
    )
    add("length", "; ".join(long_ones(source)), f"no function over {LONGEST} lines", 0.0)
    deep, recursions, globals_, needed = 0, "", set(), set()
    with Clock() as clock:
        for name in PROGRAMS:
            built = run(["gcc", *FLAGS, f"of_{name}.c", "-o", f"{name}.o"], folder, patience)
            if built.code:
                add("object code", f"{name} does not compile: {built.text}", "", clock.seconds)
                return results
            listing = run(["nm", f"{name}.o"], folder, patience).text
            globals_ |= set(writable(listing))
            needed |= set(re.findall(r"^ +U (\S+)", listing, re.MULTILINE)) - ALLOWED
            try:
                graph = (folder / f"{name}.ci").read_text(encoding="utf-8")
                deep = max(deep, deepest(graph))
            except ExportError as error:
                recursions = str(error)
    add("recursion", recursions, f"none; {deep} bytes of stack here, all codecs", clock.seconds)
    # The address of the functions is a constant that the loader may have to write.
    globals_ = {name for name in globals_ if name not in ("seen", "smap_run")}
    add("globals", ", ".join(sorted(globals_)), "none that can be written", 0.0)
    # The host's compiler may guard the stack.
    needed -= {"__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_"}
    add("library", ", ".join(sorted(needed)), "memcpy and memset at most", 0.0)
    return results
