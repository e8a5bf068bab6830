"""Compile the kernels that README's first commands need, so that nobody waits for them there.

Called at the end of `make venv`; what is compiled stays in the cache that `lutgen.jit` chooses.
A compiler uses one core, so sweeps and exports are compiled side by side.
"""

import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import lutgen
from firmware_export import export

RECIPE = Path(__file__).resolve().parent.parent / "maps" / "paper_two.toml"
DOWN = [[0.0, 0.0, -1.0]]


def compile_sweep() -> None:
    """Sweep a small robot once."""
    with tempfile.TemporaryDirectory() as folder:
        lutgen.sweep(lutgen.load_recipe(RECIPE), Path(folder) / "map.h5")


def compile_export() -> None:
    """Evaluate and export a small robot once."""
    recipe = lutgen.load_recipe(RECIPE)
    lutgen.evaluate(recipe, [[0.5, 0.5]], DOWN)
    with tempfile.TemporaryDirectory() as folder:
        export(recipe, Path(folder) / "firmware", codec="contacts", max_error="5%", points=100)


def main() -> None:
    """Compile both, each in a process of its own."""
    print("compiling the kernels, half a minute on an idle machine", file=sys.stderr)
    start = time.perf_counter()
    with ProcessPoolExecutor(2, get_context("spawn")) as processes:
        for done in [processes.submit(compile_export), processes.submit(compile_sweep)]:
            done.result()
    print(f"compiled in {time.perf_counter() - start:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except lutgen.LutgenError as error:
        sys.exit(str(error))
