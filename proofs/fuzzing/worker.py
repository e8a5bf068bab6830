"""The process in which commands run one after another, since a start takes longer than most runs.

`python -m proofs.fuzzing.worker` reads a line of JSON for each run from its standard input, and
answers with one; it is killed and started anew by whoever asks where a run is too long.
"""

import contextlib
import json
import logging
import os
import resource
import sys
import time
import traceback
from pathlib import Path
from typing import Any

__all__ = ["LARGEST_FILE", "MEMORY", "SPARE", "delay", "peak", "serve"]

# Bytes that a run may hold; and may ask for, beyond what the process has once it is warm.
MEMORY = 2 << 30
SPARE = 3 << 30
LARGEST_FILE = 1 << 30


def _status(name: str) -> int:
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if name in line)
    return 1024 * int(line.split()[1])


def peak() -> int:
    """Return the most memory that this process held since `forget`, in bytes."""
    return _status("VmHWM:")


def delay(process: int | str = "self") -> float:
    """Return how many seconds a process was ready to run and did not, as others had the cores."""
    try:
        return int(Path(f"/proc/{process}/schedstat").read_text().split()[1]) * 1e-9
    except (OSError, IndexError, ValueError):
        return 0.0


def forget() -> None:
    """Begin to measure the most memory anew."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def perform(words: list[str]) -> int:
    """Run a command as its program would, and return the exit code."""
    from lutgen.cli import main

    sys.argv = ["lutgen", *words]
    logging.getLogger().handlers.clear()
    try:
        main()
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
            return 1
        return int(end.code or 0)
    except BaseException:
        traceback.print_exc()
        return 1
    return 0


def _run(request: dict[str, Any]) -> dict[str, Any]:
    os.chdir(request["folder"])
    said = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    for number, name in ((1, "stdout"), (2, "stderr")):
        file = os.open(request[name], said, 0o600)
        os.dup2(file, number)
        os.close(file)
    forget()
    began = time.perf_counter() - delay()
    code = perform(request["words"])
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    return {"code": code, "seconds": time.perf_counter() - delay() - began, "peak": peak()}


def serve() -> None:
    """Answer until the input ends.  The first runs warm up: a limit of memory comes after them."""
    asked, answered = os.fdopen(os.dup(0), "r"), os.fdopen(os.dup(1), "w")
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
    unlimited = True
    for line in asked:
        request = json.loads(line)
        if request["limited"] and unlimited:
            unlimited = False
            most = _status("VmSize:") + SPARE
            resource.setrlimit(resource.RLIMIT_AS, (most, resource.RLIM_INFINITY))
        answer = _run(request)
        answered.write(json.dumps(answer) + "\n")
        answered.flush()


if __name__ == "__main__":
    serve()
