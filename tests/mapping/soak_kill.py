"""Kill -9 sweeps at random moments, resume them, and compare the files: COUNT FOLDER.

The kernels are loaded once; every sweep runs in a fork, which dies or ends.
"""

import os
import signal
import sys
import time
from pathlib import Path

import numpy as np

import lutgen
from lutgen.mapping import sweeper
from lutgen.mapping.blocks import plan
from tests.fixtures.forks import end, fork, running
from tests.fixtures.recipes import tripod

RECIPE = lutgen.parse_recipe(tripod("reach = 20, swing = 15", nodes=21))
# 132,300 nodes: 1,800 blocks down to 8.
BLOCKS = (84, 400, 2_000, 20_000)


def start(path: Path, nodes: int, resume: bool, threads: int = 1) -> int:
    """Begin a sweep in a process of its own; return its number."""

    def sweep() -> int:
        sweeper.plan = lambda recipe: plan(recipe, nodes)  # type: ignore[attr-defined]
        lutgen.sweep(RECIPE, path, threads=threads, resume=resume)
        return 0

    return fork(sweep)


def resumed(path: Path, nodes: int) -> int:
    """Resume a sweep to its end; return its exit status."""
    return end(start(path, nodes, True))


def main(count: int, folder: Path) -> None:
    """Kill `count` sweeps; each third is killed a second time while it is resumed."""
    rng = np.random.default_rng(9)
    lutgen.sweep(RECIPE, folder / "warm.h5", threads=1)
    whole, takes = {}, {}
    for nodes in BLOCKS:
        path = folder / f"{nodes}.h5"
        begin = time.perf_counter()
        assert resumed(path, nodes) == 0
        takes[nodes] = time.perf_counter() - begin
        whole[nodes] = path.read_bytes()
        print(f"blocks of {nodes} nodes: {takes[nodes]:.2f} s, {len(whole[nodes]) / 1e6:.1f} MB")
    kills = same = at_once = 0
    while kills < count:
        nodes = BLOCKS[kills % len(BLOCKS)]
        path = folder / "killed.h5"
        part = Path(f"{path}.part")
        for resume in (False, True) if kills % 3 == 0 else (False,):
            process = start(path, nodes, resume, 1 + (kills % 7 == 0))
            # Some die before there is a file, most while it is filled.
            while kills % 4 and not resume and not part.exists() and running(process):
                time.sleep(0.0002)
            time.sleep(rng.uniform(0.0, takes[nodes]))
            os.kill(process, signal.SIGKILL)
            killed = end(process) == -signal.SIGKILL
        if path.exists():
            # It was done before the signal came.
            assert path.read_bytes() == whole[nodes]
            path.unlink()
        if not killed:
            continue
        kills += 1
        at_once += not part.exists()
        assert resumed(path, nodes) == 0
        same += path.read_bytes() == whole[nodes]
        assert not part.exists()
        path.unlink()
    print(f"{at_once} of them before the file was made")
    print(f"{kills} kills, {same} identical files")


if __name__ == "__main__":
    main(int(sys.argv[1]), Path(sys.argv[2]))
