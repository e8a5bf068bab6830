"""Kill -9 sweeps, edit what they leave, resume them, and look at the files: COUNT FOLDER.

A resumed file is that of an undisturbed sweep, or the sweep is refused in a sentence and there is
none.  What an edit takes from elsewhere, and what a link leads to, stays as it was.
"""

import os
import signal
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

import lutgen
from lutgen.errors import LutgenError
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import plan
from lutgen.mapping.layout import lay_out
from lutgen.recipe import Recipe
from tests.fixtures.forks import end, fork, running
from tests.fixtures.recipes import tripod

NODES = 84
OURS, OTHER = (
    lutgen.parse_recipe(tripod("reach = 20, swing = 15", nodes=7, max_tilt=tilt))
    for tilt in (60.0, 59.0)
)
SKELETONS = [lay_out(recipe, plan(recipe, NODES)) for recipe in (OURS, OTHER)]
EDITS = (
    "none",
    "other recipe",
    "other version",
    "foreign blocks",
    "foreign blocks and digests",
    "foreign half",
    "own blocks moved",
    "cut",
    "grown",
    "flipped",
    "link",
)
REFUSED = 3


def start(path: Path, recipe: Recipe) -> int:
    """Go on with a sweep in a process of its own; return its number."""

    def sweep() -> int:
        try:
            lutgen.sweep(recipe, path, threads=1, resume=True)
        except LutgenError as error:
            if "\n" in str(error):
                raise
            return REFUSED
        return 0

    return fork(sweep)


def edited(kind: str, data: bytearray, other: bytes, rng: np.random.Generator) -> bytearray:
    """Return what an edit makes of an unfinished file; `other` is one of another map."""
    own, foreign = SKELETONS
    count = own.places.shape[1]
    some = rng.integers(count, size=count // 3)
    if kind == "other recipe":
        return bytearray(other)
    if kind == "other version":
        return data.replace(lutgen.__version__.encode() + b"\0", b"9.9.9\0", 1)
    if kind == "cut":
        return data[: int(rng.integers(len(data)))]
    if kind == "grown":
        return data + rng.bytes(int(rng.integers(1, 9000)))
    if kind == "flipped":
        for at in rng.integers(len(data), size=20):
            data[at] ^= 1 << int(rng.integers(8))
    elif kind == "foreign half":
        half = len(data) // 2
        data[half:] = other[half : len(data)]
    elif kind.startswith("foreign") or kind == "own blocks moved":
        source, taken = (own, bytes(data)) if kind.startswith("own") else (foreign, other)
        shift = 1 if kind.startswith("own") else 0
        for number in some:
            old = (int(number) + shift) % count
            for channel, size in enumerate(own.chunk_bytes):
                to, at = own.places[channel, number], source.places[channel, old]
                data[to : to + size] = taken[at : at + size]
            if kind != "foreign blocks":
                size = (own.digests.stop - own.digests.start) // count
                to, at = own.digests.start + number * size, source.digests.start + old * size
                data[to : to + size] = taken[at : at + size]
    return data


def killed(path: Path, takes: float, rng: np.random.Generator) -> bool:
    """Kill a sweep at a random moment; return whether it died of that."""
    process = start(path, OURS)
    while not Path(f"{path}.part").exists() and running(process):
        time.sleep(0.0002)
    time.sleep(rng.uniform(0.0, takes))
    os.kill(process, signal.SIGKILL)
    return end(process) == -signal.SIGKILL


def main(count: int, folder: Path) -> None:
    """Kill `count` sweeps and edit what each leaves, with every kind of edit in turn."""
    sweeper.plan = lambda recipe: plan(recipe, NODES)  # type: ignore[attr-defined]
    rng = np.random.default_rng(12)
    path, part, victim = folder / "a.h5", folder / "a.h5.part", folder / "thesis.txt"
    lutgen.sweep(OURS, path, threads=1)
    begin = time.perf_counter()
    lutgen.sweep(OURS, folder / "again.h5", threads=1)
    takes = time.perf_counter() - begin
    whole = path.read_bytes()
    path.unlink()
    lutgen.sweep(OTHER, folder / "other.h5", threads=1)
    other = (folder / "other.h5").read_bytes()
    kills = wrong = touched = 0
    outcomes: Counter[str] = Counter()
    while kills < count:
        # One that dies between its renaming and its end has left nothing to edit.
        if not killed(path, takes, rng) or not part.exists():
            path.unlink(missing_ok=True)
            continue
        kind = EDITS[kills % len(EDITS)]
        kills += 1
        content = edited(kind, bytearray(part.read_bytes()), other, rng)
        if kind == "link":
            part.unlink()
            victim.write_bytes(content)
            part.symlink_to(victim)
        elif kind != "none":
            part.write_bytes(content)
        status = end(start(path, OURS))
        outcomes[{0: "finished", REFUSED: "refused"}.get(status, "failed") + " " + kind] += 1
        right = path.read_bytes() == whole if path.exists() else status == REFUSED
        wrong += not right or status not in (0, REFUSED)
        touched += kind == "link" and victim.read_bytes() != content
        touched += (folder / "other.h5").read_bytes() != other
        for left in (path, part):
            left.unlink(missing_ok=True)
    for outcome, times in sorted(outcomes.items()):
        print(f"{times:4d} {outcome}")
    ended = sum(times for name, times in outcomes.items() if name.startswith("finished"))
    print(
        f"{kills} kills with edits: {wrong} wrong files, {touched} foreign files touched; {ended} "
        f"finished right, {kills - ended} refused"
    )


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
