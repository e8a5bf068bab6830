"""libFuzzer with sanitizers: claims about every reading, tried on queries that it makes up."""

import re
import shutil
import struct
from dataclasses import dataclass
from pathlib import Path

from proofs.subjects import Subject
from proofs.tools import FAILED, OK, Result
from targets.image import run

HERE = Path(__file__).resolve().parent
# A harness, and more flags of the compiler: a damaged blob is read from memory.
HARNESSES = {"fuzz": (), "damage": ("-DSMAP_HOST",)}
FLAGS = (
    *("-std=c99", "-O1", "-g", "-ffp-contract=off", "-fno-sanitize-recover=all"),
    "-fsanitize=fuzzer,address,undefined,float-cast-overflow",
)
# Seconds; a run of so many inputs ends within minutes on any machine.
PATIENCE = 600


@dataclass(frozen=True)
class Length:
    """How long an export is tried: for so many inputs, the same everywhere, or for seconds."""

    runs: int = 0
    seconds: int = 0

    @property
    def most(self) -> int:
        """Seconds after which the fuzzer stops by itself."""
        return self.seconds or PATIENCE


def _seeds(subject: Subject, folder: Path) -> None:
    """Write a few queries to start from: level, tilted, on a side, upside down, none."""
    folder.mkdir(exist_ok=True)
    downs = ((0, 0, -1), (0.3, 0.1, -1), (1, 0.2, 0.1), (0, 0, 1), (0, 0, 0), (-0.1, -0.4, -2))
    for at, down in enumerate(downs):
        for step, value in enumerate((0.0, 0.31, -1.0, 1e9)):
            numbers = [value] * subject.params + list(down)
            whole = [int(9000 * x) for x in down]
            data = struct.pack(f"<{len(numbers)}f3h", *numbers, *whole)
            (folder / f"{at}-{step}").write_bytes(data)


def _run(subject: Subject, folder: Path, length: Length, harness: str) -> tuple[int, str]:
    """Compile and run a harness; return the exit code and all that was printed."""
    folder.mkdir(exist_ok=True)
    for path in subject.folder.glob("*.[ch]"):
        shutil.copy(path, folder)
    template = (HERE / f"{harness}.c").read_text("utf-8")
    (folder / "harness.c").write_text(subject.filled(template), "utf-8")
    _seeds(subject, folder / "corpus")
    command = ["clang", *FLAGS, *HARNESSES[harness], "-I", ".", "harness.c", "-o", "fuzzer"]
    built = run(command, folder, 600.0)
    if built.returncode:
        return built.returncode, built.stderr
    limits = [f"-max_total_time={length.most}", "-max_len=160", "-timeout=10"]
    limits += [f"-runs={length.runs}"] if length.runs else []
    # The same seed each time: the same inputs, as far as it comes.
    command = [str(folder / "fuzzer"), *limits, "-print_final_stats=1", "-seed=1", "corpus"]
    done = run(command, folder, length.most + 120.0)
    return done.returncode, done.stdout + done.stderr


def fuzz(subject: Subject, folder: Path, length: Length, harness: str = "fuzz") -> Result:
    """Try an export at some length: "fuzz" its queries, or "damage" its blob."""
    code, text = _run(subject, folder, length, harness)
    tried = re.search(r"stat::number_of_executed_units: (\d+)", text)
    if code or tried is None or int(tried[1]) < max(length.runs, 1):
        said = re.search(r"broken claim: .*|runtime error: .*|ERROR: .*|.*error: .*", text)
        reason = said[0] if said else "too few queries"
        return Result(harness, subject.name, FAILED, reason[:100])
    what = "queries" if harness == "fuzz" else "damaged maps"
    return Result(harness, subject.name, OK, f"{int(tried[1]):,} {what}")
