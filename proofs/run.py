"""Prove the C runtime: `python -m proofs.run [--only PART] [--sample] [--strict] [--update]`.

Prints one table; the exit code is 1 if anything fails.  What lacks a program is skipped, and the
table says so; with --strict, or where the environment variable CI is set, that is a failure too.
"""

import argparse
import os
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from lutgen.errors import LutgenError
from proofs import analysers, eva, exhaustive, fuzz, loops, structure
from proofs.annotate import MUTANTS
from proofs.document import DOCUMENT, code, with_counts, with_rows
from proofs.eva_control import prove_steered
from proofs.fuzz import Length
from proofs.parts import place, runtime_parts
from proofs.subjects import Subject, mapped, small
from proofs.tools import FAILED, PACKAGES, SKIPPED, Result, missing

__all__ = ["main", "proved"]

BUILD = Path("build")
# Inputs for each export and harness, and seconds of one run of the analyser.
FUZZ_RUNS = 2500
PATIENCE = 900.0
# Of a sample: one in so many of what is tried exhaustively.
SPARSE = 61
JOBS = 2
# Of robots on rails, of which each takes some minutes: one without gaps, and the smallest with.
SAMPLED = ("excavator", "four_wheels", "wheels_by_code")

Job = Callable[[], list[Result]]


def _guarded(proof: str, subject: str, job: Job) -> Job:
    """Return the job with an error of ours as a failed row."""

    def done() -> list[Result]:
        try:
            return job()
        except LutgenError as error:
            return [Result(proof, subject, FAILED, str(error))]

    return done


def proved(name: str, programs: tuple[str, ...], jobs: list[Job]) -> list[Job]:
    """Return the jobs, or one that says which packages they lack."""
    lacking = missing(programs)
    if not lacking:
        return jobs
    row = Result(name, "everything", SKIPPED, f"needs apt-get install {' '.join(lacking)}")
    return [lambda: [row]]


class Plan:
    """What is to be run, on which exports; `folder` is to work in.

    Of a sample, exports that are like others are not fuzzed, nor proved where that takes minutes,
    not everything is tried that could be, and what has no proof is not counted.
    """

    def __init__(
        self, folder: Path, subjects: list[Subject], patience: float, sample: bool = False
    ) -> None:
        self.folder = folder
        self.subjects = subjects
        self.patience = patience
        self.sample = sample
        self.parts = runtime_parts()
        self.document = DOCUMENT.read_text(encoding="utf-8")
        self.found: dict[str, dict[str, int]] = {}

    def _work(self, name: str) -> Path:
        path = self.folder / name
        path.mkdir()
        return path

    def eva(self) -> list[Job]:
        """Return the proofs by Eva, a fault for each kind, and what is left where there is none."""
        jobs: list[Job] = []
        able = [subject for subject in self.subjects if subject.kind in MUTANTS]
        for subject in able:
            if not (self.sample and subject.kind == "rails" and subject.name not in SAMPLED):
                jobs.append(self._eva(subject, self._work(f"eva_{subject.name}")))
        for kind in dict.fromkeys(subject.kind for subject in able):
            # Seeded into that with the least code, of some the last, which is the smallest.
            alike = [subject for subject in reversed(able) if subject.kind == kind]
            subject = min(alike, key=lambda one: len(one.source))
            jobs.append(self._eva_fault(subject, self._work(f"fault_{subject.name}")))
        surveyed = [subject for subject in self.subjects if subject.name in eva.SURVEYED]
        for subject in [] if self.sample else surveyed:
            jobs.append(self._survey(subject, self._work(f"survey_{subject.name}")))
        work = self._work("eva_control")
        jobs.append(
            _guarded("eva, control", "steered", lambda: [prove_steered(work, self.patience)])
        )
        return proved("eva", ("frama-c", "gcc"), jobs)

    def _survey(self, subject: Subject, work: Path) -> Job:
        def done() -> list[Result]:
            result, found = eva.survey(subject, self.document, work, self.patience)
            self.found[eva.heading(subject.name)] = found
            return [result]

        return _guarded("eva, survey", subject.name, done)

    def _eva(self, subject: Subject, work: Path) -> Job:
        return _guarded("eva", subject.name, lambda: [eva.prove(subject, work, self.patience)])

    def _eva_fault(self, subject: Subject, work: Path) -> Job:
        return _guarded(
            "eva, seeded fault",
            subject.name,
            lambda: [eva.prove_fault_is_found(subject, work, self.patience)],
        )

    def exhaustive(self) -> list[Job]:
        """Return what is proved by trying everything, or a part of it."""
        work, step = self._work("exhaustive"), SPARSE if self.sample else 1
        job = _guarded(
            "exhaustive", "smap.c", lambda: exhaustive.prove(self.parts, work, self.patience, step)
        )
        return proved("exhaustive", ("gcc",), [job])

    def fuzz(self, seconds: int) -> list[Job]:
        """Return the same inputs or a share of the seconds for each export, and a seeded fault."""
        subjects = self._unlike() if self.sample else self.subjects
        share = max(1, seconds * JOBS // max(1, 2 * len(subjects)))
        length = Length(seconds=share) if seconds else Length(runs=FUZZ_RUNS)
        jobs: list[Job] = []
        for subject in subjects:
            for harness in fuzz.HARNESSES:
                work = self._work(f"{harness}_{subject.name}")
                jobs.append(self._fuzz(subject, work, length, harness))
            jobs.append(self._flip(subject, self._work(f"flips_{subject.name}")))
        # Seeded where `smap_judge` alone decides, in the smallest that has floats.
        able = set(MUTANTS) - set(eva.MANY)
        judged = [one for one in self.subjects if one.kind in able and not one.integer]
        for subject in judged[-1:]:
            jobs.append(self._fuzz_fault(subject, self._work(f"fuzz_fault_{subject.name}")))
        return proved("fuzz", ("clang", "gcc"), jobs)

    def _unlike(self) -> list[Subject]:
        """Return the last subject of each kind and of each set of forms."""
        return list({(one.kind, one.forms): one for one in self.subjects}.values())

    def _fuzz(self, subject: Subject, work: Path, length: Length, harness: str) -> Job:
        return _guarded(harness, subject.name, lambda: [fuzz.fuzz(subject, work, length, harness)])

    def _flip(self, subject: Subject, work: Path) -> Job:
        return _guarded("flips", subject.name, lambda: [fuzz.flip(subject, work, self.patience)])

    def _fuzz_fault(self, subject: Subject, work: Path) -> Job:
        return _guarded(
            "fuzz, seeded fault", subject.name, lambda: [fuzz.fuzz_fault_is_found(subject, work)]
        )

    def analysers(self) -> list[Job]:
        """Return one job for each analyser."""
        jobs: list[Job] = []
        for number, (name, (program, _, _)) in enumerate(analysers.ANALYSERS.items()):
            work = self._work(f"analyser_{number}")
            place(self.parts, work)
            jobs += proved(
                "analyser", (program,), [_guarded("analyser", name, self._one(name, work))]
            )
        return jobs

    def _one(self, name: str, work: Path) -> Job:
        def done() -> list[Result]:
            result, found = analysers.analyse(name, self.document, work, self.patience)
            self.found[analysers.heading(name)] = found
            return [result]

        return done

    def structure(self) -> list[Job]:
        """Return what the text and the object code show."""
        work = self._work("structure")
        place(self.parts, work)
        job = _guarded(
            "structure",
            "smap.c",
            lambda: structure.prove(self.parts, self.document, work, self.patience),
        )
        return proved("structure", ("gcc",), [job])

    def update(self) -> None:
        """Write the loops, and the counts of what the analysers found, into the document."""
        text = self.document
        for name, found in self.found.items():
            text = with_counts(text, name, found)
        table = [[code(head), *more] for head, *more in loops.rows(self.parts)]
        text = with_rows(text, "Loops", table)
        DOCUMENT.write_text(text, encoding="utf-8")


def _said(results: list[Result]) -> str:
    """Return the table."""
    head = ["proof", "subject", "result", "s", "what"]
    rows = [head] + [[r.proof, r.subject, r.state, f"{r.seconds:.1f}", r.text] for r in results]
    widths = [max(len(row[i]) for row in rows) for i in range(4)]
    lines = []
    for proof, subject, state, seconds, text in rows:
        cells = [proof.ljust(widths[0]), subject.ljust(widths[1]), state.ljust(widths[2])]
        lines.append("  ".join([*cells, seconds.rjust(widths[3]), text]))
    lines.insert(1, "-" * max(map(len, lines)))
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Run everything and print it; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m proofs.run", description=__doc__)
    parser.add_argument("--strict", action="store_true", help="what is skipped fails")
    parser.add_argument("--update", action="store_true", help="rewrite counts in the document")
    parser.add_argument("--only", choices=("eva", "exhaustive", "fuzz", "analysers", "structure"))
    parser.add_argument("--maps", type=Path, default=BUILD / "maps", help="where `make maps` wrote")
    parser.add_argument("--seconds", type=int, default=0, help="of fuzzing, in all")
    parser.add_argument("--sample", action="store_true", help="what takes a quarter of the time")
    parser.add_argument("--patience", type=float, default=PATIENCE, help="seconds for one program")
    options = parser.parse_args(arguments)
    strict = options.strict or bool(os.environ.get("CI"))
    BUILD.mkdir(exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(dir=BUILD, prefix="proofs-") as name:
            folder = Path(name).absolute()
            results, plan = _run(folder, options)
    except LutgenError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    print(_said(results))
    if options.update:
        plan.update()
        print(f"{DOCUMENT.name} is rewritten", file=sys.stderr)
    lacking = missing(PACKAGES)
    if lacking:
        print(f"not installed, so skipped: apt-get install {' '.join(lacking)}", file=sys.stderr)
    bad = (FAILED, SKIPPED) if strict else (FAILED,)
    return int(any(result.state in bad for result in results))


def _run(folder: Path, options: argparse.Namespace) -> tuple[list[Result], Plan]:
    """Run what was asked for; rows come in the order of the plan."""
    wanted = options.only
    subjects: list[Subject] = []
    absent: list[Result] = []
    if wanted in (None, "eva", "fuzz"):
        subjects = mapped(options.maps)
        if not subjects:
            absent = [Result("eva, fuzz", "maps", SKIPPED, f"{options.maps} is empty: make maps")]
        subjects += small(folder / "small")
    plan = Plan(folder, subjects, options.patience, options.sample)
    parts = {
        "eva": plan.eva,
        "exhaustive": plan.exhaustive,
        "fuzz": lambda: plan.fuzz(options.seconds),
        "analysers": plan.analysers,
        "structure": plan.structure,
    }
    jobs = [job for name, part in parts.items() if wanted in (None, name) for job in part()]
    with ThreadPoolExecutor(JOBS) as pool:
        rows = [row for done in pool.map(lambda job: job(), jobs) for row in done]
    return absent + rows, plan


if __name__ == "__main__":
    sys.exit(main())
