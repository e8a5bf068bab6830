"""Speed of what reaches a disk: sweeps to HDF5 and whole processes."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from unittest import mock

import numba

from benchmarks.cases import legged_recipe
from benchmarks.rows import Row, interleave
from lutgen.mapping.compute import expected_seconds
from lutgen.mapping.sweeper import sweep
from lutgen.recipe.recipe import Recipe, load_recipe, parse_recipe

ROOT = Path(__file__).resolve().parent.parent
BYTES, PIECE = 1 << 28, 1 << 22
FACE_NODES = 53
DOWN = 'chart = "cone"\nmax_tilt = 45.0\nnodes = 1'


def write_raw(path: Path, size: int, sync: bool) -> Callable[[], None]:
    """Write `size` bytes from one reused buffer into a new file; return what removes it."""
    piece = memoryview(bytes(range(256)) * (PIECE // 256))
    with path.open("wb", buffering=0) as file:
        for begin in range(0, size, PIECE):
            file.write(piece[: min(PIECE, size - begin)])
        if sync:
            os.fsync(file.fileno())
    return path.unlink


def legged(legs: int, side: int, gravity: str, *channels: str) -> Recipe:
    """Return a recipe of a robot on legs, side x side postures."""
    return parse_recipe(legged_recipe(legs, (side, side), gravity, channels), f"{legs} legs")


def files(folder: Path) -> Iterator[Row]:
    """Hold `lutgen.sweep` against writing as many bytes, with and without waiting for the disk."""
    target, raw = folder / "map.h5", folder / "raw"
    sphere = f'chart = "sphere"\nnodes = {FACE_NODES}'
    for threads in sorted({1, numba.config.NUMBA_NUM_THREADS}):
        side = round((BYTES / 4 / (6 * FACE_NODES**2)) ** 0.5)
        recipe = legged(4, side, sphere, "sdg")

        def swept(recipe: Recipe = recipe, threads: int = threads) -> Callable[[], None]:
            sweep(recipe, target, threads)
            return target.unlink

        def without_sync(swept: Callable[[], Callable[[], None]] = swept) -> Callable[[], None]:
            with mock.patch("os.fsync"), mock.patch("lutgen.mapping.part.begin_writing"):
                return swept()

        size = side * side * 6 * FACE_NODES**2 * 4
        plain, ours, plain_synced, ours_synced = interleave(
            partial(write_raw, raw, size, False),
            without_sync,
            partial(write_raw, raw, size, True),
            swept,
            repeats=5,
        )
        name = f"4 legs, {size / 1e6:.0f} MB of sdg"
        yield Row(name, threads, ours, "raw write", plain, 2.0)
        yield Row(f"{name}, fsync", threads, ours_synced, "raw write, fsync", plain_synced, 1.15)


def costs(folder: Path) -> Iterator[Row]:
    """Hold sweeps against what `lutgen check` foretells for computing plus a raw write.

    The first is bound by the disk, the second by directions, the third by facets and gaps.
    """
    target = folder / "map.h5"
    for recipe in (
        legged(3, 150, 'chart = "cone"\nmax_tilt = 60.0\nnodes = 65', "sdg"),
        legged(8, 70, f'chart = "sphere"\nnodes = {FACE_NODES}', "sdg", "tip_angle"),
        load_recipe(ROOT / "maps" / "absolem.toml"),
    ):
        sweep(recipe, target)  # loads the kernels
        foretold = expected_seconds(recipe)
        begin = time.perf_counter()
        sweep(recipe, target)
        taken = time.perf_counter() - begin
        size = target.stat().st_size
        begin = time.perf_counter()
        write_raw(target, size, True)()
        foretold += time.perf_counter() - begin
        name = f"{Path(recipe.source).stem}, {size / 1e6:.0f} MB"
        yield Row(name, numba.config.NUMBA_NUM_THREADS, taken, "foretold", foretold)


def postures(folder: Path) -> Iterator[Row]:
    """Hold a million postures in one direction against a hundredth of them."""
    times = []
    for side in (100, 100, 1000):  # the first loads the kernels
        begin = time.perf_counter()
        recipe = legged(4, side, DOWN, "sdg", "tip_angle")
        sweep(recipe, folder / f"postures{side}.h5")
        times.append((time.perf_counter() - begin) / side**2)
    threads = numba.config.NUMBA_NUM_THREADS
    yield Row(
        "4 legs, 1,000 x 1,000 postures, one direction", threads, times[2], "100 x 100", times[1]
    )


def processes(folder: Path) -> Iterator[Row]:
    """Hold `lutgen --help` and a small sweep against the start of Python with NumPy."""
    recipe = folder / "small.toml"
    recipe.write_text(legged_recipe(3, (50, 50), DOWN, ("sdg", "tip_angle")), "utf-8")
    lutgen = [sys.executable, "-m", "lutgen"]
    target = str(folder / "small.h5")

    def started(*command: str) -> None:
        subprocess.run(command, check=True, capture_output=True)

    bare, shown, swept = interleave(
        partial(started, sys.executable, "-c", "import numpy"),
        partial(started, *lutgen, "--help"),
        partial(started, *lutgen, "sweep", str(recipe), "-o", target, "--force"),
    )
    yield Row("lutgen --help", 1, shown, "python -c 'import numpy'", bare, 2.0)
    yield Row("lutgen sweep, 50 x 50 postures, one direction", 2, swept, "lutgen --help", shown)
