"""One run of the command line in a fork of this process with limits, and what is wrong with it."""

import json
import os
import re
import resource
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

from numba.np.ufunc import parallel

from lutgen.cli import main

# Seconds of computing, and of waiting; bytes beyond those at the start, and of a file.
PATIENCE, WAIT, MEMORY, LARGEST = 30, 600, 3 << 30, 1 << 30


@dataclass(frozen=True)
class Case:
    """Words that run beside `files` and write out.*, right exit codes, and who reads out.*."""

    words: tuple[str, ...]
    files: Mapping[str, bytes]
    must: frozenset[int] = frozenset((0, 1, 2, 3))  # fine, failed, wrong input, tips or unknown
    then: tuple[str, ...] = ()


def perform(words: tuple[str, ...], folder: Path) -> None:
    """Run a command in a process that is for nothing else; it says what it says to two files."""
    parallel._backend_init_process_lock = None  # a fork killed with it would stop all others
    os.chdir(folder)
    for number, file in ((1, "../stdout"), (2, "../stderr")):
        os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
    pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
    most = pages * resource.getpagesize() + MEMORY
    for name, value in (("CPU", PATIENCE), ("FSIZE", LARGEST), ("AS", most)):
        resource.setrlimit(getattr(resource, f"RLIMIT_{name}"), (value, value))
    sys.argv = ["lutgen", *words]
    main()


def ended(words: tuple[str, ...], folder: Path) -> tuple[int, str, str]:
    """Return the exit code of a run (negative: the signal) and what it said."""
    process = get_context("fork").Process(target=perform, args=(words, folder))
    process.start()
    process.join(WAIT)
    process.kill()
    process.join()
    out, err = ((folder / f"../{at}").read_text("utf-8", "replace") for at in ("stdout", "stderr"))
    return process.exitcode or 0, out, err


def run(case: Case) -> str:
    """Return what is wrong with how a case ends, "" if nothing."""
    with tempfile.TemporaryDirectory(prefix="fuzzing-") as scratch:
        # What climbs out of its folder by a few steps is still in ours.
        folder = Path(scratch, "a", "b", "case")
        folder.mkdir(parents=True)
        for name, data in case.files.items():
            (folder / name).write_bytes(data)
        code, out, err = ended(case.words, folder)
        if what := fault(case, code, out, err):
            return what
        for path in set(folder.iterdir()) - set(folder.glob("out.*")):
            if path.name not in case.files or path.read_bytes() != case.files[path.name]:
                return f"files: it left or changed {path.name}"
        if case.then and code == 0:
            return fault(Case(case.then, {}, frozenset((0, 3))), *ended(case.then, folder))
    return ""


def fault(case: Case, code: int, out: str, err: str) -> str:
    """Return what is wrong with what a run said, "" if nothing."""
    if re.search(r"Traceback \(most recent|this is a fault of lutgen|memory is not enough", err):
        return f"traceback: {err[-2000:]}"
    if re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]", err):
        return f"message: control characters: {err[-300:]!r}"
    if code not in case.must or (code in (1, 2) and not err.strip()):
        return f"exit code: {code} (-24 after {PATIENCE} s, -9 after {WAIT} s): {err[-300:]}"
    if code in (0, 3) and "--json" in case.words and not out.startswith(("Usage:", "lutgen,")):
        try:
            json.loads(out, parse_constant=int)  # no NaN and no Infinity
        except ValueError:
            return f"output: no JSON, or a NaN in it: {out[:300]}"
    return ""
