"""What a real robot has recorded, from a CSV file: accelerometer, gyroscope and joints over time.

Owns the columns; how a file is read row by row `lutgen.search` knows.
"""

import os

import numpy as np

from lutgen.errors import InputError
from lutgen.recipe import Recipe
from lutgen.search import check_columns, read_rows
from lutgen.vector import Floats

UP, RATE = ("ax", "ay", "az"), ("gx", "gy", "gz")


def read_log(
    file: str | os.PathLike[str], recipe: Recipe
) -> tuple[Floats, Floats, Floats | None, Floats]:
    """Read a log.

    Parameters
    ----------
    file : path
        CSV in UTF-8.  The first line names the columns, in any order: time (s, ascending), ax, ay,
        az (m/s^2, body frame, at rest up), if there is a gyroscope gx, gy, gz (rad/s), and each
        parameter of the recipe by its name, in its unit there.
    recipe : Recipe
        The robot.

    Returns
    -------
    time : (r,) float64
    up : (r, 3) float64
    rate : (r, 3) float64 or None
    driven : (r, k) float64
        rad or length.

    Raises
    ------
    InputError
        For anything else, with line and column.
    """
    source, joints = os.fspath(file), [p.name for p in recipe.parameters]

    def check_names(_: str, names: list[str]) -> None:
        gyroscope = RATE if any(name in names for name in RATE) else ()
        wanted = ["time", *UP, *gyroscope, *joints]
        check_columns(source, names, wanted, wanted)

    rows, lines = read_rows(file, check_names, "a log needs at least 2 rows")
    time = rows["time"]
    if (np.diff(time) <= 0.0).any():
        at = int((np.diff(time) <= 0.0).argmax()) + 1
        raise InputError(
            f"{source}: line {lines[at]} is not after the one before it (got time {time[at]:g} "
            f"after {time[at - 1]:g}); sort the log by time"
        )
    up = np.stack([rows[name] for name in UP], axis=1)
    if (np.abs(up).max(axis=1) < 1e-6).any():
        at = int((np.abs(up).max(axis=1) < 1e-6).argmax())
        raise InputError(
            f"{source}: line {lines[at]}: the accelerometer reads nothing (got 0, 0, 0); leave the "
            "row out"
        )
    rate = np.stack([rows[name] for name in RATE], axis=1) if RATE[0] in rows else None
    driven = [p.stored(rows[p.name]) for p in recipe.parameters]
    return time, up, rate, np.stack(driven, axis=1)
