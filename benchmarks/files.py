"""Speed of what reaches a disk: sweeps to HDF5 and whole processes."""

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from unittest import mock

import numba

from benchmarks.cases import legged_recipe
from benchmarks.rows import Row, interleave
from lutgen.mapping.sweeper import sweep
from lutgen.recipe.recipe import Recipe, parse_recipe

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
            with mock.patch("os.fsync"):
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
