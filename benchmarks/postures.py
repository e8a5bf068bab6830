"""The other extreme of a sweep: one gravity direction and a million postures."""

import os
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numba
import numpy as np

from benchmarks.cases import legged_recipe
from benchmarks.enumeration import find_all
from benchmarks.timing import interleave
from lutgen.mapping.blocks import plan
from lutgen.mapping.compute import Computer
from lutgen.mapping.sweeper import sweep
from lutgen.recipe.kinematics import forward, radii_and_kinds
from lutgen.recipe.recipe import parse_recipe
from lutgen.support.primitive import pack
from lutgen.support.region import acceptance

# A million postures even out by themselves, so each stage runs once, after a small sweep.
SIDE, SMALL_SIDE = 1000, 20
STRAIGHT_DOWN = 'chart = "cone"\nmax_tilt = 45.0\nnodes = 1'


@dataclass(frozen=True)
class PostureSweep:
    """Evaluations per second into memory and into a file, and seconds of each stage."""

    contacts: int
    threads: int
    memory_rate: float
    file_rate: float
    stages: dict[str, float]


def measure_postures(folder: Path, contacts: int, threads: int) -> PostureSweep:
    """Sweep a grid of SIDE x SIDE postures straight down; find out where the time goes."""
    channels = ("sdg", "tip_angle")
    target = folder / "postures.h5"
    small = legged_recipe(contacts, (SMALL_SIDE, SMALL_SIDE), STRAIGHT_DOWN, channels)
    sweep(parse_recipe(small, "small.toml"), target, threads)
    text = legged_recipe(contacts, (SIDE, SIDE), STRAIGHT_DOWN, channels)
    recipe = parse_recipe(text, "bench.toml")
    layout = plan(recipe)
    computer = Computer(recipe, layout)
    (block, *_) = layout.blocks()
    grid = recipe.grid
    numba.set_num_threads(threads)
    # Finding facets has no parallel form of its own: one thread, a tenth of the postures.
    some = forward(recipe, grid.params(np.arange(0, grid.size, 10)))
    primitives = pack(some.centres, some.axes, *radii_and_kinds(recipe))
    accept = acceptance(recipe.upright, recipe.rock_angle)

    def kinematics() -> None:
        forward(recipe, grid.params(np.arange(block.first_row, block.last_row)))

    find_all(primitives[:2], accept, True)

    def whole() -> None:
        for every in layout.blocks():
            computer.compute(every)

    def write() -> None:
        with target.open("wb", buffering=0) as file:
            os.write(file.fileno(), np.zeros(2 * grid.size, np.float32).tobytes())

    times = interleave(
        {
            "kinematics": kinematics,
            "facets": partial(find_all, primitives, accept, False),
            "facets + region": partial(find_all, primitives, accept, True),
            "memory": whole,
            "writing": write,
            "file": partial(sweep, recipe, target, threads),
        },
        repeats=1,
        warm=False,
    )
    target.unlink()
    numba.set_num_threads(numba.config.NUMBA_NUM_THREADS)
    held = block.last_row - block.first_row
    share = grid.size / len(primitives) / threads
    return PostureSweep(
        contacts,
        threads,
        grid.size / times["memory"].median,
        grid.size / times["file"].median,
        {
            "kinematics": times["kinematics"].median * grid.size / held,
            "facets": times["facets"].median * share,
            "region": (times["facets + region"].median - times["facets"].median) * share,
            "memory": times["memory"].median,
            "writing": times["writing"].median,
            "file": times["file"].median,
        },
    )
