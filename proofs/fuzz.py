"""libFuzzer with sanitizers: claims about every reading, tried on queries that it makes up."""

import re
import struct
from pathlib import Path

from proofs.subjects import Subject
from proofs.tools import FAILED, OK, Clock, Result, run

__all__ = ["fuzz", "fuzz_fault_is_found"]

HARNESS = Path(__file__).with_name("fuzz.c")
FLAGS = (
    *("-std=c99", "-O2", "-g", "-ffp-contract=off", "-fno-sanitize-recover=all"),
    "-fsanitize=fuzzer,address,undefined,float-cast-overflow",
)
# A fault that no sanitizer sees: readings that tip are said to stand.
FAULTS = {
    False: ("if (RARELY(!(reading.tip_angle >= 0.0f))) {", "if (reading.tip_angle < -9.0f) {"),
    True: ("if (out->tip < 0) {", "if (out->tip < -32767) {"),
}
# It stops at the first fault, long before.
FAULT_SECONDS = 20


def _seeds(subject: Subject, folder: Path) -> None:
    """Write a few queries to start from: level, tilted, on a side, upside down, none."""
    folder.mkdir(exist_ok=True)
    downs = ((0, 0, -1), (0.3, 0.1, -1), (1, 0.2, 0.1), (0, 0, 1), (0, 0, 0), (-0.1, -0.4, -2))
    code, scale = ("h", 9000) if subject.integer else ("f", 1)
    for at, down in enumerate(downs):
        for step, value in enumerate((0.0, 0.31, -1.0, 1e9)):
            place = int(max(-1.0, min(1.0, value)) * 32767) if subject.integer else value
            numbers = [place] * subject.params + [type(place)(scale * x) for x in down]
            (folder / f"{at}-{step}").write_bytes(struct.pack(f"<{len(numbers)}{code}", *numbers))


def _run(subject: Subject, source: str, folder: Path, seconds: int) -> tuple[int, str]:
    folder.mkdir(exist_ok=True)
    (folder / "smap.c").write_text(source, encoding="utf-8")
    (folder / "fuzz.c").write_text(subject.filled(HARNESS.read_text("utf-8")), "utf-8")
    _seeds(subject, folder / "corpus")
    tables = str(subject.folder / f"{subject.name}.c")
    command = ["clang", *FLAGS, "-I", str(subject.folder), "fuzz.c", "smap.c", tables]
    built = run([*command, "-o", "fuzzer"], folder, 300.0)
    if built.code:
        return built.code, built.text
    limits = [f"-max_total_time={seconds}", "-max_len=128", "-timeout=10", "-print_final_stats=1"]
    # The same seed each time; what differs is how far it comes.
    done = run(
        [str(folder / "fuzzer"), *limits, "-seed=1", "corpus"], folder, seconds * 3.0 + 120.0
    )
    return done.code, done.text


def fuzz(subject: Subject, source: str, folder: Path, seconds: int) -> Result:
    """Try an export, read by this text of smap.c, for some seconds."""
    with Clock() as clock:
        code, text = _run(subject, source, folder, seconds)
    tried = re.search(r"stat::number_of_executed_units: (\d+)", text)
    if code or tried is None or int(tried[1]) < 1000:
        said = re.search(r"broken claim: .*|runtime error: .*|ERROR: .*|.*error: .*", text)
        reason = said[0] if said else "too few queries"
        return Result("fuzz", subject.name, FAILED, reason[:100], clock.seconds)
    return Result("fuzz", subject.name, OK, f"{int(tried[1]):,} queries", clock.seconds)


def fuzz_fault_is_found(subject: Subject, source: str, folder: Path) -> Result:
    """Show that the fuzzer finds a fault which only its claims can tell."""
    text, instead = FAULTS[subject.integer]
    if text not in source:
        reason = f"the place of the seeded fault is missing: {text}"
        return Result("fuzz, seeded fault", subject.name, FAILED, reason)
    with Clock() as clock:
        code, said = _run(subject, source.replace(text, instead), folder, FAULT_SECONDS)
    broken = re.search(r"broken claim: .*", said)
    if code == 0 or broken is None:
        return Result("fuzz, seeded fault", subject.name, FAILED, "not found", clock.seconds)
    return Result("fuzz, seeded fault", subject.name, OK, broken[0], clock.seconds)
