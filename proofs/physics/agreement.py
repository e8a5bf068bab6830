"""Compare verdicts with the physics engine over thousands of seeded cases, and print a table.

python -m proofs.physics.agreement [--cases N] [--processes N] [--update]

`--update` writes what was measured to docs/measured/physics.json and its tables into physics.md
beside it.  Exits with 1 where a target is missed.
"""

import argparse
import json
import math
import sys
import time
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from multiprocessing import get_context

import mujoco
import numpy as np

from proofs.physics import rolling, sides
from proofs.physics.cases import CASES, drawn
from proofs.physics.page import MEASURED, page
from proofs.physics.real import real_cases
from proofs.physics.release import DOWN, release

PAGE, STORED = MEASURED / "physics.md", MEASURED / "physics.json"
# Verdicts nearer to the limit than this (deg) are beyond the engine's own accuracy.
CLEAR = 0.1
# Targets: share of all verdicts that agree; shares that wrong predictions must stay below.
LEAST, COM_OFF, LEVEL = 0.995, 0.96, 0.60
# How far the com is put wrong (m) in the first of them.
SHIFT = 0.03
CHUNK, SEED = 50, 20
# The robots of URDF files come last, so that the others are the same where those are absent.
REAL, ABSENT = real_cases()
EVERY = {**CASES, **REAL}


@dataclass(frozen=True)
class Verdict:
    """One case: lutgen's tip angle (deg), the engine's verdict, and two wrong predictions'."""

    tip_angle: float
    tipped: bool
    over_gap: bool
    com_off_tips: bool
    level_tips: bool

    @property
    def agrees(self) -> bool:
        """Whether lutgen and the engine say the same."""
        return (self.tip_angle < 0.0) == self.tipped

    @property
    def held(self) -> bool:
        """Whether it is the price of the catch: in balance over a gap, called tips, and held."""
        return self.over_gap and self.tip_angle < 0.0 and not self.tipped


@dataclass(frozen=True)
class Row:
    """What came of one kind of robot: counts, and the largest |tip_angle| (deg) that disagrees.

    What was called tips over a gap and held is counted as `held`, and in `agree`, `clear`,
    `clear_agree` and `worst` left out.
    """

    name: str
    cases: int
    stand: int
    over_gap: int
    held: int
    agree: int
    clear: int
    clear_agree: int
    worst: float
    com_off: int
    level: int


def judged(name: str, chunk: int) -> list[Verdict]:
    """Return the verdicts of one chunk of `CHUNK` cases, the same in every run."""
    rng = np.random.default_rng([SEED, list(EVERY).index(name), chunk])
    found = []
    for _ in range(CHUNK):
        posture, gravity_dir, begin = drawn(EVERY[name], rng)
        shift = rng.normal(size=3)
        shift *= SHIFT / np.linalg.norm(shift)
        found.append(
            Verdict(
                math.degrees(posture.tip_angle(gravity_dir)),
                release(posture, begin, gravity_dir).tipped,
                begin.balanced,
                posture.tip_angle(gravity_dir, shift) < 0.0,
                posture.tip_angle(DOWN) < 0.0,
            )
        )
    return found


def row(name: str, verdicts: Sequence[Verdict]) -> Row:
    """Count."""
    sharp = [v for v in verdicts if not v.held]
    clear = [v for v in sharp if abs(v.tip_angle) >= CLEAR]
    return Row(
        name,
        len(verdicts),
        sum(not v.tipped for v in verdicts),
        sum(v.over_gap for v in verdicts),
        sum(v.held for v in verdicts),
        sum(v.agrees for v in sharp),
        len(clear),
        sum(v.agrees for v in clear),
        max((abs(v.tip_angle) for v in sharp if not v.agrees), default=0.0),
        sum(v.com_off_tips == v.tipped for v in verdicts),
        sum(v.level_tips == v.tipped for v in verdicts),
    )


def total(rows: Sequence[Row]) -> Row:
    """Add up rows."""
    counts = {
        key: sum(getattr(r, key) for r in rows)
        for key in asdict(rows[0])
        if key not in ("name", "worst")
    }
    return Row(name="all", worst=max(r.worst for r in rows), **counts)


def missed(whole: Row) -> list[str]:
    """Return the targets that were missed, one line each."""
    faults = []
    if whole.clear_agree < whole.clear:
        faults.append(f"{whole.clear - whole.clear_agree} wrong beyond {CLEAR} deg")
    sharp = whole.cases - whole.held
    if whole.agree < LEAST * sharp:
        faults.append(f"only {percent(whole.agree, sharp)} agree (at least {LEAST:.1%})")
    if whole.com_off >= COM_OFF * whole.cases:
        faults.append(f"a com off by 3 cm still agrees in {percent(whole.com_off, whole.cases)}")
    if whole.level >= LEVEL * whole.cases:
        faults.append(f"ignoring the tilt still agrees in {percent(whole.level, whole.cases)}")
    return faults


def percent(part: int, whole: int) -> str:
    """Return a share in per cent; 100 % only where nothing is missing."""
    share = 100.0 * part / whole
    return "100 %" if part == whole else f"{min(share, 99.99):.2f} %"


def table(rows: Iterable[Row]) -> str:
    """Return the table of rows as Markdown."""
    lines = [
        "| robots | cases | stand | over a gap | called tips there and held | agree "
        "| agree, 0.1 deg or more from the limit "
        "| largest tip angle of a disagreement | com off by 3 cm | tilt ignored |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        sharp = r.cases - r.held
        worst = f"{r.worst:.3f} deg" if r.agree < sharp else "none"
        lines.append(
            f"| {r.name} | {r.cases:,} | {percent(r.stand, r.cases)} | {r.over_gap} "
            f"| {r.held} | {percent(r.agree, sharp)} "
            f"| {percent(r.clear_agree, r.clear)} of {r.clear:,} "
            f"| {worst} | {percent(r.com_off, r.cases)} | {percent(r.level, r.cases)} |"
        )
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run everything, or fewer cases of each kind."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=int, default=0, help="of each kind (default: all)")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument(
        "--update", action="store_true", help=f"write {PAGE.name} and {STORED.name}"
    )
    options = parser.parse_args()
    began = time.monotonic()
    jobs = [
        (name, chunk)
        for name, case in EVERY.items()
        for chunk in range(-(-(options.cases or case.number) // CHUNK))
    ]
    with get_context("spawn").Pool(options.processes) as pool:
        found = pool.starmap(judged, jobs, chunksize=1)
        wheels = pool.starmap(rolling.judged, [(part,) for part in rolling.PARTS], chunksize=1)
        slivers = pool.map(sides.measured, list(sides.ROBOTS), chunksize=1)
    verdicts: dict[str, list[Verdict]] = {name: [] for name in EVERY}
    for (name, _), part in zip(jobs, found, strict=True):
        verdicts[name] += part
    rows = [row(name, part) for name, part in verdicts.items()]
    rows.append(total(rows))
    tables = {
        "agreement": table(rows),
        "rolling": rolling.table(wheels),
        "gaps": sides.table(slivers),
    }
    for name, text in tables.items():
        print(f"{name}\n{text}")
    for sentence in ABSENT:
        print(sentence)
    for name, part in verdicts.items():
        for k, verdict in enumerate(part):
            if not verdict.agrees and not verdict.held:
                print(f"disagrees: {name}, case {k}: {verdict}")
    print(f"MuJoCo {mujoco.__version__}, {time.monotonic() - began:.0f} s")
    if options.update:
        stored = {"mujoco": mujoco.__version__, "rows": [asdict(r) for r in rows], "tables": tables}
        STORED.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
        text = PAGE.read_text(encoding="utf-8")
        for name, content in tables.items():
            text = page(text, name, content)
        PAGE.write_text(text, encoding="utf-8")
    faults = missed(rows[-1]) + rolling.missed(wheels)
    for fault in faults:
        print(f"missed: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
