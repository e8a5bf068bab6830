"""Programs that the proofs run: which Debian package has them, and how they are run."""

import shutil
import subprocess
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from lutgen.errors import ExportError

__all__ = ["PACKAGES", "Clock", "Outcome", "Result", "missing", "run"]

# Program: Debian packages that bring it.
PACKAGES = {
    "frama-c": ("frama-c-base",),
    "gcc": ("gcc",),
    "arm-none-eabi-gcc": ("gcc-arm-none-eabi", "picolibc-arm-none-eabi"),
    "clang": ("clang", "libclang-rt-14-dev", "llvm"),
    "clang-tidy": ("clang-tidy",),
    "cppcheck": ("cppcheck",),
}
OK, FAILED, SKIPPED = "passed", "FAILED", "SKIPPED"


@dataclass(frozen=True)
class Outcome:
    """What a program did: its exit code, and all it printed."""

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


def missing(programs: Iterable[str]) -> list[str]:
    """Return the Debian packages of those programs that are not installed."""
    lacking = [name for name in programs if shutil.which(name) is None]
    return [package for name in lacking for package in PACKAGES[name]]


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
