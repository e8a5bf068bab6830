"""`lutgen.sweep` into an HDF5 file against writing as many bytes raw, same file system."""

import os
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any
from unittest import mock

from benchmarks.cases import legged_recipe
from benchmarks.timing import Times, interleave
from lutgen.mapping.blocks import BLOCK_NODES
from lutgen.mapping.sweeper import sweep
from lutgen.recipe.recipe import parse_recipe

BYTES = 1 << 28
FACE_NODES = 53
CONTENDERS = ("raw", "sweep", "raw fsync", "sweep fsync")
# Where the time of a sweep goes: what is called, under which name it is shown.
STAGES = {
    "lutgen.mapping.sweeper.lay_out": "layout",
    "lutgen.mapping.compute.Computer.compute": "compute",
    "lutgen.mapping.identity.Identity.seal": "seal",
    "lutgen.mapping.part.write_all": "write",
    "os.fsync": "disk",
}


@dataclass(frozen=True)
class FileSweep:
    """Times of one recipe of `size` bytes for each of CONTENDERS, and STAGES of one sweep in s."""

    contacts: int
    channels: tuple[str, ...]
    threads: int
    size: int
    times: dict[str, Times]
    stages: dict[str, float]

    def ratio(self, suffix: str = "") -> float:
        """Return sweep / raw, medians; `suffix` is "" or " fsync"."""
        return self.times["sweep" + suffix].median / self.times["raw" + suffix].median


def stages_of(run: Callable[[], Callable[[], None]]) -> dict[str, float]:
    """Return the wall time in s of each of STAGES in a run, and of all the rest.

    With several threads stages overlap, and the rest can be less than nothing.
    """
    taken = dict.fromkeys(STAGES.values(), 0.0)

    def timed(name: str, real: Callable[..., Any]) -> Callable[..., Any]:
        def measured(*arguments: Any) -> Any:
            begin = time.perf_counter()
            try:
                return real(*arguments)
            finally:
                taken[name] += time.perf_counter() - begin

        return measured

    with ExitStack() as stack:
        for target, name in STAGES.items():
            patch = mock.patch(target)
            real, _ = patch.get_original()  # type: ignore[attr-defined]
            stack.enter_context(mock.patch(target, timed(name, real)))
        begin = time.perf_counter()
        remove = run()
        whole = time.perf_counter() - begin
    remove()
    return {**taken, "rest": whole - sum(taken.values())}


def write_raw(path: Path, buffer: bytes, size: int, sync: bool) -> Callable[[], None]:
    """Write `size` bytes from one reused buffer into a new file; return what removes it."""
    handle = os.open(path, os.O_CREAT | os.O_TRUNC | os.O_WRONLY, 0o644)
    view = memoryview(buffer)
    try:
        written = 0
        while written < size:
            written += os.write(handle, view[: size - written])
        if sync:
            os.fsync(handle)
    finally:
        os.close(handle)
    return path.unlink


def measure_file(
    folder: Path, contacts: int, channels: tuple[str, ...], threads: int, repeats: int = 7
) -> FileSweep:
    """Time a sweep of about BYTES with and without waiting for the disk.

    To remove a file again takes as long as to write it, and is not counted.
    """
    nodes = BYTES // (4 * len(channels))
    side = round((nodes / (6 * FACE_NODES**2)) ** 0.5)
    text = legged_recipe(
        contacts, (side, side), f'chart = "sphere"\nnodes = {FACE_NODES}', channels
    )
    recipe = parse_recipe(text, "bench.toml")
    size = side * side * 6 * FACE_NODES**2 * 4 * len(channels)
    target = folder / "map.h5"
    buffer = bytes(range(256)) * (BLOCK_NODES // 64)

    def swept() -> Callable[[], None]:
        sweep(recipe, target, threads)
        return target.unlink

    def swept_without_sync() -> Callable[[], None]:
        with mock.patch("os.fsync"), mock.patch("lutgen.mapping.part.begin_writing"):
            return swept()

    runs: tuple[Callable[[], object], ...] = (
        partial(write_raw, folder / "raw", buffer, size, False),
        swept_without_sync,
        partial(write_raw, folder / "raw", buffer, size, True),
        swept,
    )
    times = interleave(dict(zip(CONTENDERS, runs, strict=True)), repeats)
    return FileSweep(contacts, channels, threads, size, times, stages_of(swept))
