"""What the runtime shows by itself: loops, lengths, recursion, globals, library calls."""

import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from lutgen.errors import ExportError
from proofs.document import listed_loops
from proofs.parts import PROGRAMS
from proofs.tools import FAILED, OK, Clock, Result, run
from targets.size import ALLOWED, deepest

__all__ = ["LONGEST", "functions", "long_ones", "loops", "prove", "undocumented", "writable"]

FLAGS = ("-std=c99", "-O1", "-ffp-contract=off", "-fcallgraph-info=su", "-c")
# Lines of a function, its brackets among them.
LONGEST = 60


def _plain(source: str) -> str:
    """Return C without its comments, line by line as before."""
    return re.sub(r"/\*.*?\*/", lambda found: "\n" * found[0].count("\n"), source, flags=re.DOTALL)


def _head(text: str, start: int) -> str:
    """Return a loop's keyword and condition, from `start` to the bracket that closes it."""
    depth = 0
    for at in range(text.index("(", start), len(text)):
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        if depth == 0:
            return " ".join(text[start : at + 1].split())
    raise ExportError("smap.c: a loop is not closed (got the end of the file); correct it.")


def functions(text: str) -> list[tuple[int, str]]:
    """Return where each function begins, by a bracket in the first column, and its name."""
    starts = [(0, "")]
    for found in re.finditer(r"^\{", text, re.MULTILINE):
        before = text[: found.start()].rstrip()
        signature = before[max(before.rfind(";"), before.rfind("}"), before.rfind("\n#")) + 1 :]
        name = re.search(r"(\w+)\s*\(", signature)
        starts.append((found.start(), name[1] if name else ""))
    return starts


def long_ones(source: str) -> list[str]:
    """Return the functions of more than `LONGEST` lines, with how many they have."""
    text = _plain(source)
    found = []
    for at, name in functions(text)[1:]:
        lines = text[at : text.index("\n}", at)].count("\n") + 2
        if lines > LONGEST:
            found.append(f"{name}: {lines} lines")
    return found


def loops(source: str) -> Iterator[tuple[str, str]]:
    """Yield the function and the head of every loop, in their order.

    A ``do`` is given by its ``while``.  ``goto`` is refused: it can make a loop that is not seen.
    """
    text = _plain(source)
    if re.search(r"\bgoto\b|\bsetjmp\b|\blongjmp\b", text):
        raise ExportError("smap.c: jumps (got goto or longjmp); write a loop.")
    starts = functions(text)
    for found in re.finditer(r"\b(?:for|while)\b(?=\s*\()", text):
        function = [name for at, name in starts if at <= found.start()][-1]
        yield function, _head(text, found.start())


def undocumented(source: str, document: str) -> list[str]:
    """Return loops that the document does not list, and those it lists that are not there."""
    present, listed = Counter(loops(source)), Counter(listed_loops(document))
    new = [f"{name}: {head} is not listed" for name, head in present - listed]
    gone = [f"{name}: {head} is listed and not there" for name, head in listed - present]
    return new + gone


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
        wrong = "; ".join(undocumented(source, document))
    add("loops", wrong, f"{len(list(loops(source)))} loops, each with its bound", clock.seconds)
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
