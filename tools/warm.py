"""Compile the kernels that README's first commands need, so that nobody waits for them there.

Called at the end of `make venv`; what is compiled stays in the cache that `lutgen.jit` chooses.
"""

import sys
import tempfile
import time
from pathlib import Path

import lutgen
from firmware_export import export

RECIPE = Path(__file__).resolve().parent.parent / "maps" / "paper_two.toml"
DOWN = [[0.0, 0.0, -1.0]]


def main() -> None:
    """Sweep, read and export a small robot once."""
    print("compiling the kernels, half a minute on an idle machine", file=sys.stderr)
    start = time.perf_counter()
    recipe = lutgen.load_recipe(RECIPE)
    with tempfile.TemporaryDirectory() as folder:
        lutgen.sweep(recipe, Path(folder) / "map.h5")
        lutgen.evaluate(recipe, [[0.5, 0.5]], DOWN)
        export(recipe, Path(folder) / "firmware", codec="contacts", max_error="5%", points=100)
    print(f"compiled in {time.perf_counter() - start:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except lutgen.LutgenError as error:
        sys.exit(str(error))
