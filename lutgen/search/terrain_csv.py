"""Paths in CSV files, as other programs write them; logs of robots are read by the same rows."""

import csv
import math
import os
from collections.abc import Callable, Sequence
from io import StringIO
from pathlib import Path as File

import numpy as np

from lutgen import bounds
from lutgen.errors import InputError
from lutgen.search.terrain import EQUAL, Floats, Path, along

# Numbers whose products still are numbers.
LARGEST = 1e100
COLUMNS = ("x", "y", "z", "heading", "nx", "ny", "nz")


def read_path(file: str | os.PathLike[str]) -> Path:
    """Read a path from a CSV file: UTF-8, comma separated.

    The first line names the columns in any order: x, y, z, and if wanted heading (deg) and the
    ground's normal nx, ny, nz; see `along`.  Anything else is refused with line and column.
    """
    rows, lines = read_rows(file, _check_names)
    point = np.column_stack([rows[name] for name in ("x", "y", "z")])
    steps = np.linalg.norm(np.diff(point, axis=0), axis=1)
    same = np.flatnonzero(steps <= EQUAL * steps.sum())
    if len(same):
        at = int(same[0]) + 1
        raise InputError(
            f"{os.fspath(file)}: line {lines[at]} repeats the point before it "
            f"(got {point[at].tolist()}); leave it out"
        )
    heading = np.radians(rows["heading"]) if "heading" in rows else None
    normal = np.column_stack([rows[n] for n in ("nx", "ny", "nz")]) if "nx" in rows else None
    try:
        return along(point, heading, normal)
    except InputError as error:
        raise InputError(f"{os.fspath(file)}: {error}") from error


def read_rows(
    file: str | os.PathLike[str],
    check_names: Callable[[str, list[str]], None],
    what: str = "a path needs at least 2 points",
    least: int = 2,
) -> tuple[dict[str, Floats], list[int]]:
    """Return the columns of a CSV file by name, each (p,), and the line of each row.

    It is UTF-8, comma separated, the names of the columns in the first line, finite numbers in all
    others; as large as a terrain may be.  Anything else is refused with line and column.
    `check_names` refuses a header, given the file's name and the columns; `what` is the sentence
    for a file of fewer than `least` rows.
    """
    source, way_out = os.fspath(file), "cut the path into parts"
    try:
        with File(file).open("rb") as opened:
            raw = opened.read(bounds.TERRAIN_BYTES.most + 1)
        bounds.check(len(raw), bounds.TERRAIN_BYTES, source, way_out)
        text = raw.decode("utf-8-sig")
    except OSError as error:
        raise InputError(
            f"{source}: cannot be read (got {error.strerror}); check the path"
        ) from error
    except UnicodeDecodeError as error:
        raise InputError(
            f"{source}: is no text in UTF-8 (got byte {error.object[error.start]:#x} at place "
            f"{error.start}); save it as CSV in UTF-8"
        ) from error
    reader = csv.reader(StringIO(text, newline=""))
    rows: list[list[float]] = []
    lines: list[int] = []
    try:
        names = [name.strip() for name in next(reader, [])]
        check_names(source, names)
        for cells in reader:
            if cells:
                bounds.check(len(rows) + 1, bounds.POINTS, source, way_out)
                rows.append(_read_row(f"{source}: line {reader.line_num}", names, cells))
                lines.append(reader.line_num)
    except csv.Error as error:
        raise InputError(
            f"{source}: line {reader.line_num} is no CSV (got {error}); save it again"
        ) from error
    if len(rows) < least:
        raise InputError(f"{source}: {what} (got {len(rows)}); add lines")
    return dict(zip(names, np.array(rows).T, strict=True)), lines


def check_columns(
    source: str, names: Sequence[str], wanted: Sequence[str], known: Sequence[str]
) -> None:
    """Refuse columns of a file of which one is missing, unknown or there twice."""
    got = f"(got {','.join(names) or 'nothing'})"
    missing = [name for name in wanted if name not in names]
    if missing:
        raise InputError(
            f"{source}: line 1 names no column {missing[0]} {got}; begin with {','.join(wanted)}"
        )
    unknown = [name for name in names if name not in known]
    if unknown:
        raise InputError(
            f"{source}: line 1 names the unknown column {unknown[0]!r} {got}; leave only columns "
            f"of {', '.join(known)}"
        )
    if len(set(names)) < len(names):
        raise InputError(f"{source}: line 1 names a column twice {got}; rename or drop one")


def _check_names(source: str, names: list[str]) -> None:
    """Refuse a header that does not name the columns of a path."""
    check_columns(source, names, COLUMNS[:3], COLUMNS)
    if 0 < sum(name in names for name in COLUMNS[4:]) < 3:
        raise InputError(
            f"{source}: line 1 names only a part of nx, ny, nz (got {','.join(names)}); a normal "
            "needs all three"
        )


def _read_row(where: str, names: list[str], cells: list[str]) -> list[float]:
    """Return the numbers of one line."""
    if len(cells) != len(names):
        raise InputError(
            f"{where} must have {len(names)} cells, as the first line has (got {len(cells)}); "
            "give one number for each column"
        )
    numbers = []
    for name, cell in zip(names, cells, strict=True):
        try:
            number = float(cell)
        except ValueError:
            number = math.nan
        if not abs(number) < LARGEST:
            raise InputError(
                f"{where}, column {name}: is no finite number (got {cell!r}); write one such as "
                "1.25"
            )
        numbers.append(number)
    return numbers
