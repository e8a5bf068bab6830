"""The cost that `lutgen check` foretells against what sweeps take: `python -m benchmarks.cost`."""

import tempfile
import time
from pathlib import Path

import numba

from benchmarks.cases import legged_recipe
from benchmarks.files import write_raw
from benchmarks.report import table
from lutgen.mapping.blocks import BLOCK_NODES, plan
from lutgen.mapping.compute import expected_seconds
from lutgen.mapping.layout import lay_out
from lutgen.mapping.sweeper import sweep
from lutgen.recipe.recipe import Recipe, load_recipe, parse_recipe

ROOT = Path(__file__).resolve().parent.parent


def recipes() -> list[Recipe]:
    """Return three sweeps of which each is bound by something else.

    By the disk (3 contacts, one cheap channel), by directions (8 contacts, two channels) and by the
    search for facets and for gaps (12 discs, three channels).
    """
    disk = legged_recipe(3, (150, 150), 'chart = "cone"\nmax_tilt = 60.0\nnodes = 65', ("sdg",))
    gravity = 'chart = "sphere"\nnodes = 53'
    both = legged_recipe(8, (70, 70), gravity, ("sdg", "tip_angle"))
    return [
        parse_recipe(disk, "3 legs"),
        parse_recipe(both, "8 legs"),
        load_recipe(ROOT / "maps" / "absolem.toml"),
    ]


def main() -> None:
    """Print the table."""
    rows = []
    buffer = bytes(range(256)) * (BLOCK_NODES // 64)
    threads = numba.config.NUMBA_NUM_THREADS
    with tempfile.TemporaryDirectory(dir=ROOT / "build", prefix="cost-") as folder:
        for recipe in recipes():
            target = Path(folder) / "map.h5"
            layout = plan(recipe)
            for _ in range(2):
                # The first run loads the kernels.
                foretold = expected_seconds(recipe)
                begin = time.perf_counter()
                write_raw(target, buffer, lay_out(recipe, layout).size, True)
                raw = time.perf_counter() - begin
                begin = time.perf_counter()
                sweep(recipe, target)
                taken = time.perf_counter() - begin
            size = target.stat().st_size
            assert size == lay_out(recipe, layout).size
            target.unlink()
            rows.append(
                [
                    Path(recipe.source).stem,
                    str(len(recipe.contact_names)),
                    str(len(recipe.channels)),
                    f"{recipe.grid.size:,}",
                    f"{layout.nodes:,}",
                    str(threads),
                    f"{4e-9 * layout.nodes * len(recipe.channels):.3f}",
                    f"{size / 1e9:.3f}",
                    f"{foretold:.2f}",
                    f"{raw:.2f}",
                    f"{taken:.2f}",
                    f"{taken / (foretold + raw):.2f}",
                ]
            )
    head = ["sweep", "contacts", "channels", "postures", "nodes", "thr", "GB foretold", "GB"]
    print(table([*head, "computing s", "raw s", "sweep s", "ratio"], rows))


if __name__ == "__main__":
    main()
