"""Facts of the runtime that its text and its object code show: loops, lengths, calls, globals."""

import re
from pathlib import Path

from firmware_export.emit.runtime import control_file
from firmware_export.host import RUNTIME
from lutgen.errors import ExportError
from proofs.tools import FAILED, OK, Result
from targets.elf import undefined, writable
from targets.image import deepest, run
from targets.size import ALLOWED, FAMILIES, program

FLAGS = ("-std=c99", "-O0", "-fcallgraph-info=su", "-fno-stack-protector", "-w")
# Lines of a function, its brackets among them.
LONGEST = 60
# The descriptors of the functions: the loader may have to write it.
SEEN = {"seen", "smap_run", "steers", "smap_control_run", "_GLOBAL_OFFSET_TABLE_"}


def plain(source: str) -> str:
    """Return C without its comments, line by line as before."""
    return re.sub(r"/\*.*?\*/", lambda found: "\n" * found[0].count("\n"), source, flags=re.DOTALL)


def endless(source: str) -> list[str]:
    """Return the jumps of C source, and the loops whose head has no condition."""
    jumps = r"\b(?:goto|setjmp|longjmp)\b"
    heads = r"\bfor \([^;]*;\s*;|\bwhile \(1\)"
    return [found[0] for found in re.finditer(f"{jumps}|{heads}", plain(source))]


def long_ones(source: str) -> list[str]:
    """Return the functions of more than `LONGEST` lines: the line of each, and how many."""
    found = []
    lines = plain(source).split("\n")
    for at, line in enumerate(lines):
        if line == "{":
            length = lines.index("}", at) - at + 2
            found += [f"line {at}: {length} lines"] if length > LONGEST else []
    return found


def prove(folder: Path, patience: float, parts: Path = RUNTIME) -> list[Result]:
    """Check the parts of the runtime in `parts`; `folder` is to work in."""
    texts = {
        path.name: path.read_text(encoding="utf-8")
        for path in sorted(parts.glob("*.[ch]"))
        if not path.name.startswith("smap_host")
    }
    wrong: dict[str, list[str]] = {
        "loops": [f"{name}: {one}" for name, text in texts.items() for one in endless(text)],
        "length": [f"{name}: {one}" for name, text in texts.items() for one in long_ones(text)],
        "object code": [],
    }
    deep = 0
    for family in FAMILIES:
        text = program(family, control=bool(control_file(family)))
        (folder / "all.c").write_text(text, "utf-8")
        command = ["gcc", *FLAGS, f"-I{parts}", "-c", "all.c", "-o", "all.o"]
        if (built := run(command, folder, patience)).returncode:
            wrong["object code"].append(f"does not compile: {built.stderr[:200]}")
            continue
        for name in writable(folder / "all.o") - SEEN:
            wrong["object code"].append(f"{name} can be written")
        for name in undefined(folder / "all.o") - ALLOWED - SEEN:
            wrong["object code"].append(f"{name} of a library")
        try:
            deep = max(deep, deepest((folder / "all.ci").read_text("utf-8")))
        except ExportError as error:
            wrong["object code"].append(str(error))
    good = {
        "loops": "each has a condition, and nothing jumps",
        "length": f"no function over {LONGEST} lines",
        "object code": f"no recursion, {deep:,} bytes of stack here; nothing that can be written; "
        "memcpy and memset at most",
    }
    return [
        Result("structure", name, FAILED if said else OK, "; ".join(said) or good[name])
        for name, said in wrong.items()
    ]
