"""Terrains whose columns, separators, quotes and numbers are not what a path has."""

import random

from proofs.fuzzing import hostile
from proofs.fuzzing.case import Case
from proofs.fuzzing.hostile import pick
from proofs.fuzzing.seeds import TERRAIN, recipes

__all__ = ["make"]

INPUT = frozenset((0, 2, 3))
COLUMNS = ("x", "y", "z", "heading", "nx", "ny", "nz", "X", "", "time", "x ", '"x"', "\ufeffx")


def _change(rng: random.Random, rows: list[list[str]]) -> str:
    how = pick(
        rng, ("cell", "cell", "cell", "cell", "column", "head", "row", "drop", "many", "same")
    )
    row = pick(rng, rows)
    if how == "cell" and len(rows) > 1:
        row = rows[rng.randrange(1, len(rows))]
        if row:
            row[rng.randrange(len(row))] = hostile.text_number(rng)
    elif how == "column" and rows[0]:
        at = rng.randrange(len(rows[0]))
        for each in rows:
            del each[at : at + 1]
    elif how == "head" and rows[0]:
        rows[0][rng.randrange(len(rows[0]))] = pick(rng, COLUMNS)
    elif how == "row":
        rows.insert(rng.randrange(len(rows)), list(row) * pick(rng, (0, 1, 2, 300)))
    elif how == "drop":
        del rows[rng.randrange(len(rows)) :]
        rows = rows or [[]]
    elif how == "many":
        for i in range(pick(rng, (10, 300, 3000))):
            rows.append([f"{0.5 + 0.01 * i}", "0", "0", "0", "0", "0", "1"][: len(rows[0])])
    elif how == "same":
        rows.append(list(row))
    return str(how)


def make(rng: random.Random) -> Case:
    """Return a case: a drive over a terrain that no robot has seen."""
    rows = [line.split(",") for line in TERRAIN.splitlines()]
    done = []
    for _ in range(rng.randrange(1, 4)):
        done.append(_change(rng, rows))
        rows = rows or [["x", "y", "z"]]
    separator = pick(rng, (",",) * 20 + (";", "\t", ", ", " ", ",,"))
    ending = pick(rng, ("\n",) * 10 + ("\r\n", "\r", "\n\n", "\x00\n", "\u2028"))
    data = ending.join(separator.join(row) for row in rows).encode("utf-8", "replace")
    if rng.random() < 0.05:
        data, done = hostile.damaged(rng, data), [*done, "bytes"]
    if rng.random() < 0.03:
        data = data.decode("utf-8", "replace").encode(pick(rng, ("utf-16", "utf-8-sig", "utf-32")))
    name = pick(rng, ("tripod", "rover"))
    words = ["path", "r.toml", "--terrain", "t.csv", "--json"]
    controlled = rng.random() < 0.3
    words += ["--method", pick(rng, ("search", "nelder-mead"))] if controlled else ["--no-control"]
    if rng.random() < 0.1:
        words += [pick(rng, ("--turn", "--speed", "--lag")), str(rng.randrange(-3, 400))]
    if rng.random() < 0.1:
        words += ["-o", "run.csv"]
    files = {"r.toml": recipes()[name].encode(), "t.csv": data}
    return Case(f"{name}: {' '.join(done)}", files, tuple(words), INPUT, ("run.csv",))
