"""Make the cycles of a ride: along a path, or of what a real robot has recorded."""

import math
import os
from dataclasses import dataclass

import numpy as np

from firmware_export.control.steering import Steering
from lutgen import bounds
from lutgen.chart import STANDARD_GRAVITY, unit_directions
from lutgen.errors import InputError, reject
from lutgen.search import Path, read_rows
from lutgen.vector import Floats

UP, RATE = ("ax", "ay", "az"), ("gx", "gy", "gz")


@dataclass(frozen=True, eq=False)
class Ride:
    """A ride of n cycles.

    `path` has a point for each cycle; of a log the time takes the place of x.  `slope` (n, 3) is
    gravity, unit, in the frame of the ground, with inertia if it was recorded, and `size` (n,) what
    the accelerometer measures, m/s^2.  In a log: `driven` (n, k), the posture, which is the
    driver's request; `felt` (n, 3), gravity in the body frame; `turning` (n, 3), rad/s.
    """

    path: Path
    slope: Floats
    size: Floats
    driven: Floats | None = None
    felt: Floats | None = None
    turning: Floats | None = None


def ride_along(path: Path, cycle: float, speed: float | None) -> Ride:
    """Return the ride along a path: with a cycle at each point, or at a speed (length per s).

    A speed that gives too many cycles, or fewer than two, is refused.
    """
    if speed is not None:
        length = float(path.distance[-1])
        if speed * cycle > 0.5 * length:
            what = f"{length:g} of path take at least two cycles of {cycle:g} s"
            way_out = "go slower, or take a shorter --cycle"
            reject("--speed", what, f"{speed:g}", way_out, InputError)
        at = _times(length / (speed * cycle)) * (speed * cycle)
        path = Path(
            _between(at, path.distance, path.position),
            np.interp(at, path.distance, np.unwrap(path.heading)),
            unit_directions(_between(at, path.distance, path.gravity)),
        )
    return Ride(path, path.gravity, np.full(len(path.gravity), STANDARD_GRAVITY))


def ride_logged(file: str | os.PathLike[str], steering: Steering) -> Ride:
    """Return the ride that a real robot has recorded.

    The first line of the CSV names the columns, in any order: time (s, ascending), ax, ay, az
    (m/s^2, body frame, at rest up), if there is a gyroscope gx, gy, gz (rad/s), and each parameter
    of the recipe by its name, in its unit there.  The ground's slope follows from accelerometer and
    joints as `smap_ground` has it.
    """
    source, parameters = os.fspath(file), steering.recipe.parameters

    def columns(names: list[str]) -> tuple[list[str], list[str]]:
        gyroscope = RATE if any(name in names for name in RATE) else ()
        wanted = ["time", *UP, *gyroscope, *(p.name for p in parameters)]
        return wanted, wanted

    rows, lines = read_rows(file, columns, "a log needs at least 2 rows")
    time, up = rows["time"], np.stack([rows[name] for name in UP], axis=1)
    late = np.diff(time) <= 0.0
    if late.any():
        row = int(late.argmax()) + 1
        what = f"line {lines[row]} is not after the one before it"
        got = f"time {time[row]:g} after {time[row - 1]:g}"
        reject(source, what, got, "sort the log by time", InputError)
    nothing = np.abs(up).max(axis=1) < 1e-6
    if nothing.any():
        where = f"{source}: line {lines[int(nothing.argmax())]}"
        what = "the accelerometer reads nothing"
        reject(where, what, "0, 0, 0", "leave the row out", InputError)
    count = (time[-1] - time[0]) / steering.cycle * (1.0 + 1e-9)
    at: Floats = time[0] + _times(count) * steering.cycle
    driven = np.stack([p.stored(rows[p.name]) for p in parameters], axis=1)
    ups, joints = _between(at, time, up), _between(at, time, driven)
    size = np.linalg.norm(ups, axis=1)
    felt = -ups / np.maximum(size, 1e-12)[:, None]
    slope, _ = steering.controller().ground(joints, ups)
    slope = unit_directions(np.where(np.any(slope, axis=1)[:, None], slope, felt))
    nowhere = np.zeros(len(at))
    path = Path(np.stack([at - at[0], nowhere, nowhere], axis=1), nowhere, slope)
    turning = None
    if RATE[0] in rows:
        turning = _between(at, time, np.stack([rows[name] for name in RATE], axis=1))
    return Ride(path, slope, size, joints, felt, turning)


def _between(at: Floats, known: Floats, rows: Floats) -> Floats:
    """Return rows (r, c) that are known at some places, at others."""
    return np.stack([np.interp(at, known, column) for column in rows.T], axis=1)


def _times(cycles: float) -> Floats:
    """Return the numbers of the cycles, from 0; refuse more of them than points of a path."""
    most = int(min(cycles, 1e15)) + 1
    bounds.check(most, bounds.POINTS, "the cycles of the ride", "ride for less time")
    return np.arange(math.floor(cycles) + 1, dtype=np.float64)
