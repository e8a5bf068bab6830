"""Damage map files at random, and see what is said of them: COUNT FOLDER.

In a process of its own, because a crash of HDF5 would end it.
"""

import sys
from pathlib import Path

import numpy as np

import lutgen
from lutgen.errors import LutgenError, MapFileError
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import plan
from lutgen.mapping.verification import verify
from tests.fixtures.recipes import tripod

RECIPE = lutgen.parse_recipe(tripod())


def damaged(content: bytes, rng: np.random.Generator) -> tuple[str, bytes]:
    """Return what was done to a file, and the file."""
    data = bytearray(content)
    kind = str(rng.choice(["flip", "flips", "head", "cut", "longer", "hole", "moved", "mark"]))
    if kind in ("flip", "flips"):
        for at in rng.integers(len(data), size=1 if kind == "flip" else rng.integers(2, 30)):
            data[at] ^= int(rng.integers(1, 256))
    elif kind == "head":
        for at in rng.integers(6000, size=rng.integers(1, 4)):
            data[at] ^= int(rng.integers(1, 256))
    elif kind == "mark":
        # Without its mark the digest is not found, and HDF5 meets the other flips.
        data[content.index(b"lutgen-digest") + int(rng.integers(10))] ^= 1
        for at in rng.integers(len(data), size=rng.integers(1, 6)):
            data[at] ^= int(rng.integers(1, 256))
    elif kind == "cut":
        del data[int(rng.integers(len(data))) :]
    elif kind == "longer":
        data += rng.bytes(int(rng.integers(1, 5000)))
    else:
        size = int(rng.integers(1, 4096))
        to, source = (int(at) for at in rng.integers(len(data) - size, size=2))
        data[to : to + size] = bytes(size) if kind == "hole" else data[source : source + size]
    return kind, bytes(data)


def one_sentence(error: Exception) -> None:
    """Refuse a message of several lines."""
    assert "\n" not in str(error), error


def main(count: int, folder: Path) -> None:
    """Damage `count` finished files, and as many unfinished ones that are then resumed."""
    sweeper.plan = lambda recipe: plan(recipe, 98)  # type: ignore[attr-defined]
    good, path = folder / "good.h5", folder / "damaged.h5"
    lutgen.sweep(RECIPE, good, threads=1)
    content = good.read_bytes()
    whole = lutgen.load_map(good)
    values = {name: whole.channel(name).tobytes() for name in whole.channels}
    knots = [axis.knots.tobytes() for axis in whole.axes]
    rng = np.random.default_rng(21)
    refused = harmless = wrong = 0
    for _ in range(count):
        kind, data = damaged(content, rng)
        path.write_bytes(data)
        try:
            # Without --verify: nothing but a sentence either, wherever it is noticed.
            opened = lutgen.load_map(path, unsealed=True)
            for name in opened.channels:
                opened.channel(name)
        except MapFileError as error:
            one_sentence(error)
        try:
            verify(lutgen.load_map(path))
        except MapFileError as error:
            one_sentence(error)
            refused += 1
            continue
        accepted = lutgen.load_map(path)
        same = values == {name: accepted.channel(name).tobytes() for name in accepted.channels}
        same &= knots == [axis.knots.tobytes() for axis in accepted.axes]
        harmless += same
        wrong += not same
        if not same:
            print(f"wrong values accepted after {kind}")
    stopped = Stop()
    try:
        lutgen.sweep(RECIPE, path, threads=1, progress=stopped)
    except KeyboardInterrupt:
        part = Path(f"{path}.part")
        content = part.read_bytes()
    turned_down = 0
    for _ in range(count):
        _, data = damaged(content, rng)
        part.write_bytes(data)
        try:
            lutgen.sweep(RECIPE, path, threads=1, resume=True)
        except LutgenError as error:
            one_sentence(error)
            turned_down += 1
            continue
        assert path.read_bytes() == good.read_bytes()
    print(f"{count} damaged unfinished files: {turned_down} refused, the others finished right")
    print(
        f"{count} damaged files: {wrong} wrong values accepted, {refused} refused, {harmless} "
        "with all values right"
    )


class Stop:
    """Presses Ctrl-C after five blocks."""

    left = 5

    def __call__(self, done: int, total: int) -> None:
        """Count down."""
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
