"""libFuzzer with sanitizers: claims about every reading, tried on queries that it makes up."""

import re
import shutil
import struct
from dataclasses import dataclass
from pathlib import Path

from proofs.subjects import Subject
from proofs.tools import FAILED, OK, Clock, Result, run

__all__ = ["Length", "flip", "fuzz", "fuzz_fault_is_found"]

HERE = Path(__file__).resolve().parent
# What is asked, and what else the compiler is told: a damaged blob is read from memory.
HARNESSES = {"fuzz": (), "damage": ("-DSMAP_HOST",)}
FLAGS = (
    *("-std=c99", "-O1", "-g", "-ffp-contract=off", "-fno-sanitize-recover=all"),
    "-fsanitize=fuzzer,address,undefined,float-cast-overflow",
)
# A fault that no sanitizer sees: readings that tip are said to stand.
FAULTS = {
    False: ("return stands ? good : (int8_t)SMAP_TIPS;", "return good;"),
    True: ("if (least < 0 || tip < 0) {", "if (least < -2000000000) {"),
}
# It stops at the first fault, long before.
FAULT_RUNS = 500_000
# A run of so many ends within minutes on any machine; what is slower than that is cut, and fails.
PATIENCE = 600


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


@dataclass(frozen=True)
class Length:
    """How long an export is tried: for so many inputs, the same everywhere, or for seconds."""

    runs: int = 0
    seconds: int = 0

    @property
    def most(self) -> int:
        """Seconds after which the fuzzer stops by itself."""
        return self.seconds or PATIENCE


def _copy(subject: Subject, folder: Path, host: bool) -> None:
    """Copy an export but for smap.c; on a host a pose counts what gaps took, in a word more."""
    for name in (f"{subject.name}.c", f"{subject.name}.h", "smap.h", "smap_config.h"):
        shutil.copy(subject.folder / name, folder / name)
    header = folder / f"{subject.name}.h"
    if host:
        text = re.sub(r"(_WORDS) (\d+)u", r"\1 (\2u + 2u)", header.read_text("utf-8"))
        header.write_text(text, encoding="utf-8")


def _run(
    subject: Subject, source: str, folder: Path, length: Length, harness: str
) -> tuple[int, str]:
    folder.mkdir(exist_ok=True)
    (folder / "smap.c").write_text(source, encoding="utf-8")
    _copy(subject, folder, bool(HARNESSES[harness]))
    template = (HERE / f"{harness}.c").read_text("utf-8")
    (folder / "harness.c").write_text(subject.filled(template), "utf-8")
    _seeds(subject, folder / "corpus")
    command = ["clang", *FLAGS, *HARNESSES[harness], "-I", ".", "harness.c", "-o", "fuzzer"]
    built = run(command, folder, 600.0)
    if built.code:
        return built.code, built.text
    limits = [f"-max_total_time={length.most}", "-max_len=160", "-timeout=10"]
    if length.runs:
        limits.append(f"-runs={length.runs}")
    # The same seed each time: the same inputs, as far as it comes.
    command = [str(folder / "fuzzer"), *limits, "-print_final_stats=1", "-seed=1", "corpus"]
    done = run(command, folder, length.most + 120.0)
    return done.code, done.text


def fuzz(subject: Subject, folder: Path, length: Length, harness: str = "fuzz") -> Result:
    """Try an export at some length: "fuzz" its queries, or "damage" its blob."""
    with Clock() as clock:
        code, text = _run(subject, subject.source, folder, length, harness)
    tried = re.search(r"stat::number_of_executed_units: (\d+)", text)
    if code or tried is None or int(tried[1]) < max(length.runs, 1):
        said = re.search(r"broken claim: .*|runtime error: .*|ERROR: .*|.*error: .*", text)
        reason = said[0] if said else "too few queries"
        return Result(harness, subject.name, FAILED, reason[:100], clock.seconds)
    what = "queries" if harness == "fuzz" else "damaged maps"
    return Result(harness, subject.name, OK, f"{int(tried[1]):,} {what}", clock.seconds)


def flip(subject: Subject, folder: Path, patience: float) -> Result:
    """Flip bits of an export's blob, each alone and in pairs: smap_check has to tell."""
    template = (HERE / "flips.c").read_text("utf-8")
    (folder / "flips.c").write_text(subject.filled(template), "utf-8")
    _copy(subject, folder, host=True)
    include = ["-I", str(subject.folder), "flips.c", "-o", "flips"]
    with Clock() as clock:
        built = run(["gcc", "-std=c99", "-O1", "-DSMAP_HOST", *include], folder, patience)
        done = run([str(folder / "flips")], folder, patience) if built.code == 0 else built
    rows = re.findall(r"^(single|pairs) (\d+) (\d+)$", done.text, re.MULTILINE)
    if done.code or len(rows) != 2 or any(int(passed) for _, _, passed in rows):
        return Result("flips", subject.name, FAILED, done.text[:100], clock.seconds)
    said = ", ".join(f"{int(tried):,} {name}" for name, tried, _ in rows)
    return Result("flips", subject.name, OK, f"{said}: none passes", clock.seconds)


def fuzz_fault_is_found(subject: Subject, folder: Path) -> Result:
    """Show that the fuzzer finds a fault which only its claims can tell."""
    text, instead = FAULTS[subject.integer]
    if text not in subject.source:
        reason = f"the place of the seeded fault is missing: {text}"
        return Result("fuzz, seeded fault", subject.name, FAILED, reason)
    with Clock() as clock:
        faulty = subject.source.replace(text, instead)
        code, said = _run(subject, faulty, folder, Length(runs=FAULT_RUNS), "fuzz")
    broken = re.search(r"broken claim: .*", said)
    if code == 0 or broken is None:
        return Result("fuzz, seeded fault", subject.name, FAILED, "not found", clock.seconds)
    return Result("fuzz, seeded fault", subject.name, OK, broken[0], clock.seconds)
