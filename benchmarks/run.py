"""Measure speed, print it, and with --update write it into docs/measured/benchmarks.md."""

import argparse
import os
import platform
import re
import tempfile
import time
from collections.abc import Iterator
from datetime import date
from pathlib import Path

# Before NumPy is loaded: its column is of one thread.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numba
import numpy as np

from benchmarks import files, memory
from benchmarks.references import COMMAND
from benchmarks.rows import Row, table
from targets.marks import MEASURED, ROOT, between

PAGE = MEASURED / "benchmarks.md"


def machine() -> str:
    """Return what identifies a run."""
    known = Path("/proc/cpuinfo")
    text = known.read_text("utf-8") if known.is_file() else ""
    name = re.search(r"model name\s*: (.+)", text)
    return (
        f"{date.today()}: {os.cpu_count()} cores, {name[1] if name else platform.machine()}, load "
        f"average {os.getloadavg()[0]:.1f} at the start; Python {platform.python_version()}, NumPy "
        f"{np.__version__}, numba {numba.__version__}; C by `{' '.join(COMMAND[:3])}`."
    )


def parts(folder: Path, nodes: int) -> Iterator[tuple[str, Iterator[Row]]]:
    """Yield the title and the rows of each part."""
    yield "Sweep to memory, time of an evaluation", memory.sweeps(folder, nodes)
    yield "Support facets and region, time of a posture", memory.facets()
    yield "`lutgen.stability`, time of a direction", memory.directions(folder)
    yield "`lutgen.sweep` to HDF5", files.files(folder)
    yield "Processes", files.processes(folder)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.run", description=__doc__)
    parser.add_argument("--update", action="store_true", help=f"write {PAGE.name}")
    parser.add_argument("--quick", action="store_true", help="an eighth of the nodes, noisier")
    options = parser.parse_args()
    begin = time.perf_counter()
    (ROOT / "build").mkdir(exist_ok=True)
    said = [machine()]
    print(said[0], flush=True)
    with tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="bench-") as name:
        nodes = memory.NODES // 8 if options.quick else memory.NODES
        for title, rows in parts(Path(name), nodes):
            numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
            said.append(f"### {title}\n\n{table(rows)}")
            print(f"\n{said[-1]}", flush=True)
    print(f"\ntook {time.perf_counter() - begin:.0f} s")
    if options.update:
        between(PAGE, "run", "\n\n".join(said))


if __name__ == "__main__":
    main()
