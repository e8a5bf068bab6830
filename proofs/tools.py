"""Programs that the proofs run, and the rows of their table."""

import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from lutgen.errors import ExportError

__all__ = ["FAILED", "OK", "PACKAGES", "SKIPPED", "Clock", "Outcome", "Result", "run"]

# Program: Debian packages that bring it.
PACKAGES = {"frama-c": "frama-c-base", "gcc": "gcc", "clang": "clang libclang-rt-14-dev llvm"}
OK, FAILED, SKIPPED = "passed", "FAILED", "SKIPPED"


@dataclass(frozen=True)
class Outcome:
    """The exit code of a program, and all it printed."""

    code: int
    text: str


@dataclass(frozen=True)
class Result:
    """One row of the table: `state` is "passed", "FAILED" or "SKIPPED"."""

    proof: str
    subject: str
    state: str
    text: str
    seconds: float = 0.0


def run(arguments: Sequence[str], folder: Path, patience: float) -> Outcome:
    """Run a program in a folder for at most `patience` seconds; stdout and stderr together.

    Raises
    ------
    ExportError
        It is not installed, or takes longer.
    """
    try:
        done = subprocess.run(
            list(arguments),
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=patience,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise ExportError(
            f"{arguments[0]}: did not end (got {patience:.0f} s); run again on an idle machine, or "
            "with more time by --patience."
        ) from error
    except OSError as error:
        raise ExportError(
            f"{arguments[0]}: cannot be run (got {type(error).__name__}); install it."
        ) from error
    return Outcome(done.returncode, done.stdout)


class Clock:
    """Measure wall time: ``with Clock() as clock: ...; clock.seconds``."""

    seconds = 0.0

    def __enter__(self) -> "Clock":
        """Start."""
        self._begin = time.perf_counter()
        return self

    def __exit__(self, *_: object) -> None:
        """Stop."""
        self.seconds = time.perf_counter() - self._begin
