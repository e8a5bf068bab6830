"""Measure everything and print it: `python -m benchmarks.run [--json FILE] [--quick]`."""

import os

# Before NumPy is imported: one thread is what its column says.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import sys
import tempfile
import time
from dataclasses import asdict, is_dataclass
from math import radians
from pathlib import Path
from typing import Any

import numba

from benchmarks import report
from benchmarks.cases import CASES, Case
from benchmarks.cell import NODES, Bench, Cell
from benchmarks.directions import DIRECTIONS, measure_directions
from benchmarks.enumeration import measure_enumeration
from benchmarks.files import measure_file
from benchmarks.machine import machine
from benchmarks.postures import measure_postures
from benchmarks.process import measure_processes
from benchmarks.targets import verdicts

# Sphere charts of 1,014, 16,854 and 99,846 directions.
FACE_NODES = (13, 53, 129)
DEFAULT_LIMITS = (radians(90.0), radians(30.0))
LIMITED_NODES = 1 << 20
BUILD = Path("build")


def plain(value: Any) -> Any:
    """Return dataclasses as dictionaries, for JSON."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    raise TypeError(f"cannot write {type(value).__name__} as JSON")


def section(title: str, text: str) -> None:
    """Print one part of the report."""
    print(f"\n== {title}\n{text}", flush=True)


def measure_cells(bench: Bench, threads: tuple[int, ...]) -> list[Cell]:
    """Measure and print the main table and the block with the default limits."""
    cells = [
        cell
        for face_nodes in FACE_NODES
        for case in CASES
        for cell in bench.cells(case, face_nodes, threads)
    ]
    section(
        "Sweep to memory, limits off: million evaluations per second (medians)\n"
        "   large: into one output of 64 MiB per channel; reused: block after block into a buffer "
        "of 4 MiB per channel, as for a file",
        report.rates_table(cells),
    )
    section(
        "Ratios of median times, and agreement\n   diff: largest relative difference of sdg "
        "(tip: absolute, rad); NaN: nodes NaN in one only",
        report.ratios_table(cells),
    )
    limited = [
        cell
        for case in (Case("ground", 4), Case("inside", 8), Case("ground", 8))
        for cell in bench.cells(case, 53, threads, DEFAULT_LIMITS, LIMITED_NODES)
    ]
    section(
        "The same with the default limits: upright 90 deg, rock angle 30 deg; 4 MiB per channel",
        report.rates_table(limited) + "\n\n" + report.ratios_table(limited),
    )
    return cells + limited


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.run", description=__doc__)
    parser.add_argument("--json", type=Path, help="also write every number here")
    parser.add_argument("--quick", action="store_true", help="an eighth of the work, noisier")
    arguments = parser.parse_args()
    begin = time.perf_counter()
    threads = (1, 2) if numba.config.NUMBA_NUM_THREADS >= 2 else (1,)
    BUILD.mkdir(exist_ok=True)
    found = machine()
    section("Machine", "\n".join(f"{key}: {value}" for key, value in found.items()))
    with tempfile.TemporaryDirectory(dir=BUILD, prefix="bench-") as name:
        folder = Path(name)
        cells = measure_cells(Bench(folder, NODES // 8 if arguments.quick else NODES), threads)
        enumeration = measure_enumeration()
        section(
            "Support facets: microseconds per posture, 1 thread; share of facets and region in a "
            "sweep of sdg over 1,014 directions",
            report.enumeration_table(enumeration),
        )
        postures = [measure_postures(folder, 4, t) for t in threads]
        postures.append(measure_postures(folder, 8, threads[-1]))
        section(
            "One direction, 1,000 x 1,000 postures, sdg + tip_angle; shares of the time to memory",
            report.postures_table(postures),
        )
        directions = [measure_directions(folder, t) for t in threads]
        section(
            f"One posture of 4 feet, {DIRECTIONS:,} directions: ns of `lutgen.stability`, best\n"
            "   two: sdg + tip_angle; three: tip_angle + margin + energy_margin; four: all of them",
            report.directions_table(directions),
        )
        files = [
            *(measure_file(folder, 4, ("sdg",), t) for t in threads),
            *(measure_file(folder, 4, ("sdg", "tip_angle"), t) for t in threads),
        ]
        section("`lutgen.sweep` to HDF5 against raw writing, medians", report.files_table(files))
        section("Where the time of one such sweep goes", report.stages_table(files))
        processes = measure_processes(folder)
    section("Processes", report.processes_text(processes))
    judged = verdicts(cells, files, processes, directions)
    section("Targets (worst case of each)", "\n".join(verdict.line() for verdict in judged))
    seconds = time.perf_counter() - begin
    print(f"\ntook {seconds:.0f} s", file=sys.stderr)
    if arguments.json:
        every = {
            "machine": found,
            "cells": cells,
            "enumeration": enumeration,
            "postures": postures,
            "directions": directions,
            "files": files,
            "processes": processes,
            "targets": [{**v._asdict(), "reached": v.reached} for v in judged],
            "seconds": seconds,
        }
        arguments.json.write_text(json.dumps(every, default=plain, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    main()
