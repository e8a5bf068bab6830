"""Compile the kernels that README's first commands need, so that nobody waits for them there.

Called at the end of `make venv`; what is compiled stays in the cache that `lutgen.jit` chooses.
A compiler uses one core, so there are two at a time: first each compiles half of what sweeps and
exports share, which the other then finds in the cache, and then one of them.
"""

import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numba
import numpy as np

import lutgen
from firmware_export import export
from lutgen.support import empty_region, facet_table
from lutgen.support.boundary import find_region
from lutgen.support.region import acceptance
from lutgen.support.search import find_facets
from lutgen.support.unite import unite

RECIPE = Path(__file__).resolve().parent.parent / "maps" / "paper_two.toml"
DOWN = [[0.0, 0.0, -1.0]]
PRIMITIVES, SIZE = np.zeros((3, 8)), 1.0


def _compile(kernel: Any, *arguments: object) -> None:
    """Compile a kernel for arguments, and do not call it."""
    kernel.compile(tuple(map(numba.typeof, arguments)))


def compile_search() -> None:
    """Compile the search for the facets of a posture."""
    table = facet_table(len(PRIMITIVES))
    _compile(find_facets, table.work, PRIMITIVES, 0.0, SIZE)
    _compile(unite, table, PRIMITIVES, SIZE)


def compile_region() -> None:
    """Compile the search for its standing region."""
    table, region = facet_table(len(PRIMITIVES)), empty_region(len(PRIMITIVES))
    _compile(find_region, region, table, PRIMITIVES, acceptance(None, None), SIZE)


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


PAIRS: tuple[tuple[Callable[[], None], Callable[[], None]], ...] = (
    (compile_search, compile_region),
    (compile_sweep, compile_export),
)


def main() -> None:
    """Compile both of each pair, each in a process of its own."""
    print("compiling the kernels, half a minute on an idle machine", file=sys.stderr)
    start = time.perf_counter()
    with ProcessPoolExecutor(2, get_context("spawn")) as processes:
        for pair in PAIRS:
            for done in [processes.submit(one) for one in pair]:
                done.result()
    print(f"compiled in {time.perf_counter() - start:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except lutgen.LutgenError as error:
        sys.exit(str(error))
