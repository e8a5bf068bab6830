"""Prove the C runtime: `python -m proofs.run [--only PART] [--sample] [--seconds N]`.

Prints one table; the exit code is 1 if anything fails.  A proof whose program is missing is
skipped, and a failure where the environment variable CI is set.  docs/explanation/c-runtime.md
explains the rows.
"""

import argparse
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from firmware_export.emit.render import columns
from lutgen.errors import LutgenError
from proofs import eva, exhaustive, fuzz, structure
from proofs.fuzz import HARNESSES, Length
from proofs.subjects import SUBJECTS, made
from proofs.tools import FAILED, PACKAGES, SKIPPED, Result

BUILD = Path("build")
PARTS = ("structure", "eva", "exhaustive", "fuzz")
NEEDED = {"structure": "gcc", "eva": "frama-c", "exhaustive": "gcc", "fuzz": "clang"}
# Inputs of the fuzzer for each export and harness; a sample has fewer.
RUNS, FEW = 2500, 500
# Of a sample: one in so many of the exhaustive cases, and exports that Eva leaves to the full run.
SPARSE, LATER = 61, ("three_leg_sphere",)
JOBS = 2

Job = Callable[[], list[Result]]


def _jobs(wanted: tuple[str, ...], options: argparse.Namespace, folder: Path) -> list[Job]:
    """Return the jobs of some parts, the longest first."""

    def work(name: str) -> Path:
        (folder / name).mkdir()
        return folder / name

    jobs: list[Job] = []
    sample, patience = options.sample, options.patience
    names = list(SUBJECTS) if {"eva", "fuzz"} & set(wanted) else []
    subjects = [made(name, folder / "exports") for name in names]
    if "eva" in wanted:
        for one in subjects:
            if one.proved and not (sample and one.name in LATER):
                jobs.append(partial(_row, eva.prove, one, work(f"eva_{one.name}"), patience))
        if not sample:
            jobs.append(partial(_row, eva.prove_control, work("eva_control"), patience))
    if "exhaustive" in wanted:
        step = SPARSE if sample else 1
        jobs.append(partial(exhaustive.prove, work("exhaustive"), patience, step))
    if "structure" in wanted:
        jobs.append(partial(structure.prove, work("structure"), patience))
    if "fuzz" in wanted:
        # Each export is asked by two harnesses, and as many jobs run at a time.
        share = options.seconds * JOBS // (2 * len(subjects))
        length = Length(seconds=share) if share else Length(runs=FEW if sample else RUNS)
        for one in subjects:
            for how in HARNESSES:
                place = folder / f"{how}_{one.name}"
                jobs.append(partial(_row, fuzz.fuzz, one, place, length, how))
    return jobs


def _row(prove: Callable[..., Result], *given: Any) -> list[Result]:
    return [prove(*given)]


def _done(job: Job) -> list[Result]:
    """Run a job; its rows tell the seconds that it took, and an error of ours is a failed row."""
    begin = time.perf_counter()
    try:
        rows = job()
    except LutgenError as error:
        rows = [Result("proofs", "run", FAILED, str(error))]
    return [replace(row, seconds=time.perf_counter() - begin) for row in rows]


def main(arguments: list[str] | None = None) -> int:
    """Run everything and print it; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m proofs.run", description=__doc__)
    parser.add_argument("--only", choices=PARTS)
    parser.add_argument("--seconds", type=int, default=0, help="of fuzzing, in all")
    parser.add_argument("--sample", action="store_true", help="less of everything, for CI")
    parser.add_argument("--patience", type=float, default=900.0, help="seconds for one program")
    options = parser.parse_args(arguments)
    wanted = PARTS if options.only is None else (options.only,)
    lacking = {part: NEEDED[part] for part in wanted if shutil.which(NEEDED[part]) is None}
    results = [
        Result(part, "everything", SKIPPED, f"needs apt-get install {PACKAGES[program]}")
        for part, program in lacking.items()
    ]
    BUILD.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=BUILD, prefix="proofs-") as name:
        there = tuple(part for part in wanted if part not in lacking)
        jobs = _jobs(there, options, Path(name).absolute())
        with ThreadPoolExecutor(JOBS) as pool:
            results += [row for done in pool.map(_done, jobs) for row in done]
    rows = [["proof", "subject", "result", "s", "what"]]
    rows += [[r.proof, r.subject, r.state, f"{r.seconds:.1f}", r.text] for r in results]
    print("\n".join(columns(rows, margin="")))
    bad = (FAILED, SKIPPED) if os.environ.get("CI") else (FAILED,)
    return int(any(result.state in bad for result in results))


if __name__ == "__main__":
    sys.exit(main())
