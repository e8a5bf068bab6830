"""Prove that exports on three points are never falsely safe: `python -m proofs.prove [DIR ...]`.

Proves the export folders that it is given, or else the exports of ROWS, which it makes of the
gallery's recipes.  Prints one row each; the exit code is 1 if any is not proved.
"""

import math
import sys
import time
from concurrent.futures import ProcessPoolExecutor

from firmware_export.device import ExportFolder
from firmware_export.grid import lookup
from firmware_export.protocol import describe
from lutgen.recipe import Recipe
from proofs.prove.held import CannotProveError
from proofs.prove.search import prove
from targets.cases import of_recipe

# Recipe of the gallery, size, arithmetic.
ROWS = (
    "paper_one: contacts, float",
    "paper_two: contacts, float",
    "three_leg_sphere: contacts, float",
    "paper_two: grid i8 1x3 4x1 1x1, float",
    "paper_two: grid i8 1x3 4x1 1x1, integer",
    "paper_two: grid i16 1x8 9x1 1x1, float",
    "paper_two: grid i16 1x10 11x1 1x1, integer",
    "three_leg_sphere: grid i16 7x6 7x6 7x6, float",
)


def made(row: str) -> tuple[Recipe, bytes, bool]:
    """Return an export of the gallery: its recipe, its bytes, whether it is read without floats."""
    name, size = row.split(": ")
    label, arithmetic = size.split(", ")
    codec, *words = label.split()
    nodes = tuple(tuple(map(int, word.split("x"))) for word in words[1:])
    spec = lookup.Spec(int(words[0][1:]), nodes) if words else None
    export = of_recipe(name, codec, arithmetic, spec)
    return export.recipe, describe(export).bytes, export.integer


def line(asked: str) -> tuple[bool, str]:
    """Return whether a row or a folder is proved, and its line of the table."""
    begin = time.perf_counter()
    try:
        if asked in ROWS:
            guard, cells, reason = prove(*made(asked))
        else:
            folder = ExportFolder(asked)
            guard, cells, reason = prove(folder.recipe(), folder.blob.bytes, folder.integer)
    except CannotProveError as error:
        return False, f"| {asked} | | NOT proved: {error} |"
    said = f"NOT proved: {reason}" if reason else f"{cells:,} cells"
    said = f"{said}, {time.perf_counter() - begin:.1f} s"
    return not reason, f"| {asked} | {math.degrees(guard):.3g} deg | {said} |"


def main(directories: list[str]) -> int:
    """Print the table; return an exit code."""
    print("| export | guard | proved by |\n|---|---|---|")
    failed = 0
    with ProcessPoolExecutor(2) as pool:
        for proved, text in pool.map(line, directories or ROWS):
            print(text, flush=True)
            failed |= not proved
    return failed


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
