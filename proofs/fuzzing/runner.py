"""Runs a case: in a warm process that lives on, or in one of its own."""

import contextlib
import json
import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from lutgen.cli.import_ import STANDS_NOWHERE
from proofs.fuzzing.case import Case, Outcome
from proofs.fuzzing.worker import LARGEST_FILE, MEMORY, SPARE, delay

__all__ = ["PATIENCE", "Runner"]

# Seconds of one run; and of one whose kernels may have to be compiled first.  What a process waits
# for a core does not count: the machine may be others', too.
PATIENCE = 20.0
WARMING = 600.0
# Of what a run says so many bytes are read.
MOST_SAID = 4 << 20
ENVIRONMENT = {
    "NUMBA_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MPLBACKEND": "agg",
    "PYTHONWARNINGS": "ignore",
}


class Runner:
    """Folders to run in, and a process that runs; close it, or use it in a `with`."""

    def __init__(self) -> None:
        self._scratch = Path(tempfile.mkdtemp(prefix="fuzzing-"))
        # What climbs out of its folder by a few steps is still in ours.
        self._folder = self._scratch / "a" / "b" / "case"
        self._worker: subprocess.Popen[str] | None = None
        self._limited = False
        self._warming: Sequence[Case] = ()

    def __enter__(self) -> "Runner":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the process, and remove the folders."""
        self.stop()
        shutil.rmtree(self._scratch, ignore_errors=True)

    def warm(self, cases: Sequence[Case]) -> list[Outcome]:
        """Run cases without limits, so that what they need is imported and compiled."""
        self._limited, self._warming = False, ()
        found = [self.run(case) for case in cases]
        self._limited, self._warming = True, cases
        return found

    def run(self, case: Case) -> Outcome:
        """Run a case, and where it ended with 0 what is to be run after it, until one does not."""
        if self._worker is None and self._warming:
            self.warm(self._warming)
        self._lay_out(case)
        outcome = self._served(case.words)
        for words in case.then:
            if outcome.code == 0 and STANDS_NOWHERE not in outcome.stderr:
                after = self._served(words)
                if after.code:
                    said = f"after it {' '.join(words)} ended with {after.code}: {after.stderr}"
                    outcome = Outcome(-1000, "", said, after.seconds, after.peak)
        return _with(outcome, self._touched(case))

    def run_alone(self, case: Case) -> Outcome:
        """Run a case in a process of its own."""
        self._lay_out(case)
        out, err = self._scratch / "stdout", self._scratch / "stderr"
        seconds = 0.0
        with out.open("wb") as stdout, err.open("wb") as stderr:
            process = subprocess.Popen(
                [sys.executable, "-m", "lutgen", *case.words],
                cwd=self._folder,
                env=os.environ | ENVIRONMENT | dict(case.environment) | self._path(),
                stdin=subprocess.DEVNULL,
                stdout=stdout,
                stderr=stderr,
                start_new_session=True,
                preexec_fn=_limits,
            )
            spent = _Watch(process.pid)
            code, usage = None, None
            while code is None and spent() < PATIENCE:
                time.sleep(0.01)
                seconds = spent()
                done, status, usage = os.wait4(process.pid, os.WNOHANG)
                code = os.waitstatus_to_exitcode(status) if done else None
            if code is None:
                os.killpg(process.pid, signal.SIGKILL)
                _, _, usage = os.wait4(process.pid, 0)
            process.returncode = code if code is not None else -signal.SIGKILL
        seconds = seconds if code is not None else float("inf")
        peak = 1024 * (usage.ru_maxrss if usage else 0)
        said = _read(out), _read(err)
        found = Outcome(process.returncode, *said, seconds, peak)
        return _with(found, self._touched(case))

    def stop(self) -> None:
        """End the process."""
        if self._worker is not None:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(self._worker.pid, signal.SIGKILL)
            self._worker.wait()
            for stream in (self._worker.stdin, self._worker.stdout):
                if stream is not None:
                    with contextlib.suppress(OSError):
                        stream.close()
            self._worker = None

    @staticmethod
    def _path() -> dict[str, str]:
        root = str(Path(__file__).resolve().parent.parent.parent)
        return {"PYTHONPATH": os.pathsep.join([root, os.environ.get("PYTHONPATH", "")])}

    def _start(self) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-m", "proofs.fuzzing.worker"],
            cwd=self._scratch,
            env=os.environ | ENVIRONMENT | self._path(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )

    def _served(self, words: Sequence[str]) -> Outcome:
        if self._worker is None:
            self._worker = self._start()
        out, err = self._scratch / "stdout", self._scratch / "stderr"
        request = {
            "words": list(words),
            "folder": str(self._folder),
            "stdout": str(out),
            "stderr": str(err),
            "limited": self._limited,
        }
        patience = PATIENCE if self._limited else WARMING
        assert self._worker.stdin is not None
        assert self._worker.stdout is not None
        self._worker.stdin.write(json.dumps(request) + "\n")
        self._worker.stdin.flush()
        spent, ready = _Watch(self._worker.pid), False
        while not ready and spent() < patience:
            ready = bool(select.select([self._worker.stdout], [], [], min(1.0, patience))[0])
        line = self._worker.stdout.readline() if ready else ""
        if not line:
            code = self._worker.poll() if ready else None
            if ready and code is None:
                code = self._worker.wait()
            self.stop()
            seconds = float("inf") if not ready else 0.0
            # A process that leaves by itself is no better than one that is killed.
            code = code if code is not None and code < 0 else -signal.SIGKILL
            return Outcome(code, _read(out), _read(err), seconds, 0)
        answer = json.loads(line)
        if answer["peak"] > MEMORY // 2:
            # What it does not give back would count for the next.
            self.stop()
        return Outcome(answer["code"], _read(out), _read(err), answer["seconds"], answer["peak"])

    def _lay_out(self, case: Case) -> None:
        shutil.rmtree(self._scratch / "a", ignore_errors=True)
        (self._folder / "folder").mkdir(parents=True)
        for name, data in case.files.items():
            (self._folder / name).write_bytes(data)

    def _touched(self, case: Case) -> tuple[str, ...]:
        """Return the files of a case that are no longer what they were, and those that are new."""
        found = []
        for name, data in case.files.items():
            file = self._folder / name
            if name not in case.written and (not file.is_file() or file.read_bytes() != data):
                found.append(name)
        known = {*case.files, *case.written, "folder"}
        new = {path.name for path in self._folder.iterdir()} - known
        return tuple(found + sorted(new))


class _Watch:
    """Seconds since a run began in a process, without those that it waited for a core."""

    def __init__(self, process: int) -> None:
        self._process = process
        self._waited = delay(process)
        self._began = time.perf_counter() - self._waited

    def __call__(self) -> float:
        # Of a process that has ended nothing more is known.
        self._waited = max(self._waited, delay(self._process))
        return time.perf_counter() - self._waited - self._began


def _limits() -> None:
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
    # What libraries reserve and never touch is not counted by anyone.
    resource.setrlimit(resource.RLIMIT_AS, (2 * SPARE, 2 * SPARE))


def _with(outcome: Outcome, touched: tuple[str, ...]) -> Outcome:
    values = {**vars(outcome), "touched": touched}
    return Outcome(**values)


def _read(file: Path) -> str:
    try:
        with file.open("rb") as stream:
            return stream.read(MOST_SAID).decode("utf-8", "replace")
    except OSError:
        return ""
