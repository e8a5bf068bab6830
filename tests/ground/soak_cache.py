"""Damage the cache of machine code, and see that every answer is right: COUNT FOLDER.

Two tiny kernels stand for all; every try is a fork that loads them anew, so a crash is seen.
"""

import importlib
import os
import shutil
import signal
import sys
from collections import Counter
from pathlib import Path

import numpy as np

from lutgen.jit import njit
from tests.fixtures.forks import end, fork

WRONG = 98
KINDS = ("flip", "flips", "cut", "empty", "zeros", "noise", "swapped", "older", "gone")
TEXT = "from lutgen.jit import njit\n@njit()\ndef {name}(x):\n    return x * {factor} + 1\n"


def answers(folder: Path) -> tuple[list[float], int]:
    """Return what the kernels say of an integer and of a float, and how many were loaded."""
    sys.path.insert(0, str(folder))
    kernels = [getattr(importlib.import_module(name), name) for name in ("twice", "thrice")]
    found = [kernel(x) for kernel in kernels for x in (2, 2.5)]
    return found, sum(sum(kernel.stats.cache_hits.values()) for kernel in kernels)


def forked(folder: Path) -> str:
    """Ask for the answers in a process of its own; return how that ended."""

    def ask() -> int:
        found, loaded = answers(folder)
        return 10 + loaded if found == [5, 6.0, 7, 8.5] else WRONG

    code = end(fork(ask))
    if code < 0:
        return f"signal {signal.Signals(-code).name}"
    return {WRONG: "wrong", 1: "error"}.get(code, f"{code - 10} loaded")


def damage(kind: str, files: list[Path], rng: np.random.Generator) -> None:
    """Damage one entry."""
    one, other = (files[int(i)] for i in rng.choice(len(files), 2, replace=False))
    data = bytearray(one.read_bytes())
    if kind in ("flip", "flips"):
        for at in rng.integers(len(data), size=1 if kind == "flip" else 30):
            data[at] ^= 1 << int(rng.integers(8))
    elif kind == "cut":
        del data[int(rng.integers(len(data))) :]
    elif kind == "empty":
        data.clear()
    elif kind == "zeros":
        at = int(rng.integers(len(data)))
        data[at : at + 64] = bytes(len(data[at : at + 64]))
    elif kind == "noise":
        data = bytearray(rng.bytes(len(data)))
    elif kind == "swapped":
        content = other.read_bytes()
        other.write_bytes(data)
        data = bytearray(content)
    elif kind == "older":
        # An index that knows nothing beside machine code, or code beside no index.
        one.unlink()
        return
    else:
        for file in files:
            if file.suffix == one.suffix:
                file.unlink()
        return
    one.write_bytes(data)


def main(count: int, folder: Path) -> None:
    """Damage `count` entries, one after the other; what was compiled anew replaces them."""
    # What compiling needs is imported once, before the forks.
    njit()(lambda x: x)(1)
    os.environ["NUMBA_CACHE_DIR"] = str(folder / "cache")
    for name, factor in (("twice", 2), ("thrice", 3)):
        (folder / f"{name}.py").write_text(TEXT.format(name=name, factor=factor))
    assert forked(folder) == "0 loaded"
    assert forked(folder) == "4 loaded"
    good = folder / "good"
    shutil.copytree(folder / "cache", good)
    rng = np.random.default_rng(5)
    ends: Counter[str] = Counter()
    for number in range(count):
        shutil.rmtree(folder / "cache")
        shutil.copytree(good, folder / "cache")
        files = sorted(path for path in (folder / "cache").rglob("*.nb*") if path.is_file())
        damage(KINDS[number % len(KINDS)], files, rng)
        ends[forked(folder)] += 1
        if number % 20 == 0:
            # And it is whole again.
            assert forked(folder) == "4 loaded"
    for how, times in sorted(ends.items()):
        print(f"{times:4d} {how}")
    right = sum(times for how, times in ends.items() if how.endswith("loaded"))
    print(f"{count} damaged entries: {right} right answers")


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
