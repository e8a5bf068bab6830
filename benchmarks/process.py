"""Whole processes: the help text, and a small map from the command line, cold and warm."""

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks.cases import legged_recipe
from benchmarks.postures import STRAIGHT_DOWN
from benchmarks.timing import Times, interleave

MAP_SIDE = 50


@dataclass(frozen=True)
class Processes:
    """Wall times in seconds, None where the command is not installed."""

    help: Times | None
    map_warm: Times | None
    map_cold: float | None


def _run(command: list[str], environment: dict[str, str]) -> None:
    subprocess.run(command, env=environment, check=True, capture_output=True)


def measure_processes(folder: Path) -> Processes:
    """Time `lutgen --help`, and `lutgen sweep` of 50 x 50 postures in one direction."""
    command = Path(sys.executable).with_name("lutgen")
    environment = dict(os.environ)
    if not command.exists():
        return Processes(None, None, None)
    recipe = folder / "small.toml"
    recipe.write_text(
        legged_recipe(3, (MAP_SIDE, MAP_SIDE), STRAIGHT_DOWN, ("sdg", "tip_angle")), "utf-8"
    )
    sweep = [str(command), "sweep", str(recipe), "-o", str(folder / "small.h5")]
    times = interleave(
        {
            "help": partial(_run, [str(command), "--help"], environment),
            "map": partial(_run, sweep, environment),
        }
    )
    cache = folder / "empty-cache"
    cache.mkdir()
    begin = time.perf_counter()
    _run(sweep, {**environment, "NUMBA_CACHE_DIR": str(cache)})
    cold = time.perf_counter() - begin
    return Processes(times["help"], times["map"], cold)
