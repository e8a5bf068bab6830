"""One run of the command line in a process of its own with limits, and what is wrong with it."""

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

from lutgen.cli import main
from lutgen.cli.import_ import STANDS_NOWHERE

# 0 all is fine, 1 the task failed, 2 the input is wrong, 3 the robot tips or nobody can tell.
ANSWERS = frozenset((0, 1, 2, 3))
# Seconds of computing and, where it waits for ever, of the clock; bytes beyond those that the
# process has when it starts, and of a file.
PATIENCE, WAIT, MEMORY, LARGEST = 30, 600, 3 << 30, 1 << 30
# Of what a run says so many bytes are read, and the longest message that one still reads.
MOST_SAID, LONGEST = 4 << 20, 8000
ENVIRONMENT = {
    **dict.fromkeys(("NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), "1"),
    **{"MPLBACKEND": "agg", "PYTHONWARNINGS": "ignore"},
}


@dataclass(frozen=True)
class Case:
    """What is run in an empty folder that holds `files`, by name, and nothing else.

    `must` are the exit codes that are right, `written` the names that the run may write, and
    `then` what is run after it where it ended with 0: this has to end with 0, too.
    """

    words: tuple[str, ...]
    files: Mapping[str, bytes]
    must: frozenset[int] = ANSWERS
    written: tuple[str, ...] = ()
    then: tuple[str, ...] = ()


def perform(words: tuple[str, ...], folder: Path) -> None:
    """Run a command in a process that is for nothing else; it says what it says to two files."""
    os.setsid()
    os.chdir(folder)
    for number, name in ((1, "../stdout"), (2, "../stderr")):
        file = os.open(name, os.O_WRONLY)
        os.dup2(file, number)
    pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
    most = pages * resource.getpagesize() + MEMORY
    for limit, value in (
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_CPU, PATIENCE),
        (resource.RLIMIT_FSIZE, LARGEST),
        (resource.RLIMIT_AS, most),
    ):
        resource.setrlimit(limit, (value, value))
    sys.argv = ["lutgen", *words]
    main()


def ended(words: tuple[str, ...], folder: Path) -> tuple[int, str, str]:
    """Return the exit code of a run (negative: the signal) and what it said."""
    said = [folder.parent / "stdout", folder.parent / "stderr"]
    for file in said:
        file.write_bytes(b"")
    process = get_context("forkserver").Process(target=perform, args=(words, folder))
    process.start()
    process.join(WAIT)
    process.kill()
    process.join()
    out, err = (file.read_bytes()[:MOST_SAID].decode("utf-8", "replace") for file in said)
    return process.exitcode or 0, out, err


def run(case: Case) -> str:
    """Return what is wrong with how a case ends, "" if nothing."""
    os.environ.update(ENVIRONMENT)
    get_context("forkserver").set_forkserver_preload([__name__, "proofs.fuzzing.warm"])
    with tempfile.TemporaryDirectory(prefix="fuzzing-") as scratch:
        # What climbs out of its folder by a few steps is still in ours.
        folder = Path(scratch, "a", "b", "case")
        (folder / "folder").mkdir(parents=True)
        for name, data in case.files.items():
            (folder / name).write_bytes(data)
        code, out, err = ended(case.words, folder)
        what = fault(case, code, out, err)
        touched = [
            path.name
            for path in folder.iterdir()
            if path.name not in (*case.written, "folder")
            and (path.name not in case.files or path.read_bytes() != case.files[path.name])
        ]
        if not what and touched:
            what = f"files: it left or changed {', '.join(sorted(touched))}"
        if not what and case.then and code == 0 and STANDS_NOWHERE not in err:
            code, out, err = ended(case.then, folder)
            if what := fault(Case(case.then, {}, frozenset((0,))), code, out, err):
                what = f"output: what it wrote is not taken: {what}"
    return what


def fault(case: Case, code: int, out: str, err: str) -> str:
    """Return what is wrong with what a run said, "" if nothing."""
    if "Traceback (most recent call last)" in err or "this is a fault of lutgen" in err:
        return f"traceback: {err[-2000:]}"
    if "the memory is not enough" in err:
        return "memory: it asks for more than there is"
    if code in (-24, -9):
        return f"slow: it takes over {PATIENCE} s"
    if code < 0:
        return f"signal: {-code}"
    if code not in case.must:
        return f"exit code: {code}: {err[-300:]}"
    if code in (1, 2) and not re.search(r"^(Error|lutgen)?: ?\S|Error: +\S", err, re.M):
        return f"message: it ended with {code} and gave no reason"
    if len(err) > LONGEST or re.search(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]", err):
        return f"message: control characters, or {len(err):,} characters"
    if code in (0, 3) and "--json" in case.words and not is_json(out):
        return f"output: no JSON: {out[:300]}"
    return ""


def is_json(text: str) -> bool:
    """Tell whether a text is JSON without NaN; --help beside --json prints help."""
    numbers = re.sub(r'"(\\.|[^"\\])*"', '""', text)
    try:
        json.loads(text)
    except ValueError:
        return text.startswith("Usage:") or "version" in text[:40]
    return not re.search("NaN|Infinity", numbers)
