"""Paths in CSV files, as other programs write them; logs of robots are read by the same rows."""

import csv
import math
import os
from collections.abc import Callable, Sequence
from io import StringIO

import numpy as np

from lutgen import bounds
from lutgen.errors import InputError, reject
from lutgen.recipe.load import utf8
from lutgen.search.terrain import EQUAL, Path, along
from lutgen.vector import Floats

# Numbers whose products still are numbers.
LARGEST = 1e100
COLUMNS = ("x", "y", "z", "heading", "nx", "ny", "nz")


def read_path(file: str | os.PathLike[str]) -> Path:
    """Read a path from a CSV file: UTF-8, comma separated.

    The first line names the columns in any order: x, y, z, and if wanted heading (deg) and the
    ground's normal nx, ny, nz; see `along`.  Anything else is refused with line and column.
    """
    rows, lines = read_rows(file, _path_columns)
    point = np.column_stack([rows[name] for name in ("x", "y", "z")])
    steps = np.linalg.norm(np.diff(point, axis=0), axis=1)
    same = np.flatnonzero(steps <= EQUAL * steps.sum())
    if len(same):
        at = int(same[0]) + 1
        what = f"line {lines[at]} repeats the point before it"
        reject(os.fspath(file), what, point[at].tolist(), "leave it out", InputError)
    heading = np.radians(rows["heading"]) if "heading" in rows else None
    normal = np.column_stack([rows[n] for n in ("nx", "ny", "nz")]) if "nx" in rows else None
    try:
        return along(point, heading, normal)
    except InputError as error:
        raise InputError(f"{os.fspath(file)}: {error}") from error


def read_rows(
    file: str | os.PathLike[str],
    columns: Callable[[list[str]], tuple[Sequence[str], Sequence[str]]],
    what: str = "a path needs at least 2 points",
    least: int = 2,
) -> tuple[dict[str, Floats], list[int]]:
    """Return the columns of a CSV file by name, each (p,), and the line of each row.

    It is UTF-8, comma separated, the names of the columns in the first line, finite numbers in all
    others; as large as a terrain may be.  Anything else is refused with line and column.
    `columns` says, of the names in a file, which it needs and which it may have; `what` is the
    sentence for a file of fewer than `least` rows.
    """
    source = os.fspath(file)
    text = utf8(bounds.read(source, bounds.TERRAIN_BYTES, InputError), source, InputError)
    reader = csv.reader(StringIO(text, newline=""))
    rows: list[list[float]] = []
    lines: list[int] = []
    try:
        names = [name.strip() for name in next(reader, [])]
        _check_columns(source, names, *columns(names))
        for cells in reader:
            if cells:
                bounds.check(len(rows) + 1, bounds.POINTS, source, "cut the path into parts")
                rows.append(_read_row(f"{source}: line {reader.line_num}", names, cells))
                lines.append(reader.line_num)
    except csv.Error as error:
        reject(source, f"line {reader.line_num} is no CSV", error, "save it again", InputError)
    if len(rows) < least:
        reject(source, what, len(rows), "add lines", InputError)
    return dict(zip(names, np.array(rows).T, strict=True)), lines


def _check_columns(
    source: str, names: Sequence[str], wanted: Sequence[str], known: Sequence[str]
) -> None:
    """Refuse columns of a file of which one is missing, unknown or there twice."""
    got = ",".join(names) or "nothing"
    for name in wanted:
        if name not in names:
            way_out = f"begin with {','.join(wanted)}"
            reject(source, f"line 1 names no column {name}", got, way_out, InputError)
    for name in names:
        if name not in known:
            what, way_out = f"the unknown column {name!r}", f"leave columns of {', '.join(known)}"
            reject(source, f"line 1 names {what}", got, way_out, InputError)
    if len(set(names)) < len(names):
        reject(source, "line 1 names a column twice", got, "rename or drop one", InputError)


def _path_columns(names: list[str]) -> tuple[Sequence[str], Sequence[str]]:
    """Return the columns that a path needs, and those that it may have."""
    normal = COLUMNS[4:] if any(name in names for name in COLUMNS[4:]) else ()
    return (*COLUMNS[:3], *normal), COLUMNS


def _read_row(where: str, names: list[str], cells: list[str]) -> list[float]:
    """Return the numbers of one line."""
    if len(cells) != len(names):
        what = f"must have {len(names)} cells, as the first line has"
        reject(where, what, len(cells), "give one number for each column", InputError)
    numbers = []
    for name, cell in zip(names, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not abs(number) < LARGEST:
            what, way_out = "is no finite number", "write one such as 1.25"
            reject(f"{where}, column {name}", what, repr(cell), way_out, InputError)
        numbers.append(number)
    return numbers
