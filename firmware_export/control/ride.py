"""What a robot rides over, cycle by cycle: a path, or what a real robot has recorded.

Owns how points in space and rows of a log become cycles.
"""

import math
from dataclasses import dataclass

import numpy as np

from firmware_export.control.steering import Steering
from lutgen import bounds
from lutgen.chart import unit_directions
from lutgen.errors import InputError
from lutgen.search import Path
from lutgen.vector import Floats

# m/s^2.
GRAVITY = 9.80665


@dataclass(frozen=True, eq=False)
class Ride:
    """A ride of n cycles.

    Parameters
    ----------
    path : Path
        Where it goes, a point for each cycle; of a log the time takes the place of x.
    slope : (n, 3) float64
        Gravity, unit, in the frame of the ground under the robot, with inertia where it was
        recorded.
    size : (n,) float64
        What the accelerometer measures, m/s^2.
    driven : (n, k) float64, optional
        The posture that was recorded, which the driver asks for.
    felt : (n, 3) float64, optional
        Gravity, unit, in the body frame as it was recorded.
    turning : (n, 3) float64, optional
        Angular velocity as it was recorded, rad/s.
    """

    path: Path
    slope: Floats
    size: Floats
    driven: Floats | None = None
    felt: Floats | None = None
    turning: Floats | None = None


def ride_along(path: Path, cycle: float, speed: float | None) -> Ride:
    """Return the ride along a path: with a cycle at each point, or at a speed (length per s).

    Raises
    ------
    InputError
        For a speed that is none, and one at which there are too many cycles, or one alone.
    """
    if speed is not None:
        if not 0.0 < speed < math.inf:
            raise InputError(f"--speed: above 0 and finite (got {speed:g}); give another one.")
        length = float(path.distance[-1])
        if speed * cycle > 0.5 * length:
            raise InputError(
                f"--speed: {length:g} of path take at least two cycles of {cycle:g} s "
                f"(got {speed:g}); go slower, or take a shorter --cycle."
            )
        _check(length / (speed * cycle))
        count = math.floor(length / (speed * cycle)) + 1
        at = np.asarray(np.arange(count) * (speed * cycle), np.float64)
        path = Path(
            _between(at, path.distance, path.position),
            np.interp(at, path.distance, np.unwrap(path.heading)),
            unit_directions(_between(at, path.distance, path.gravity)),
        )
    return Ride(path, path.gravity, np.full(len(path.gravity), GRAVITY))


def ride_logged(
    time: Floats, up: Floats, rate: Floats | None, driven: Floats, steering: Steering
) -> Ride:
    """Return the ride that a robot has recorded.

    The ground's slope follows from accelerometer and joints as `smap_ground` has it.

    Parameters
    ----------
    time : (r,) float64
        Ascending, s.
    up, rate : (r, 3) float64
        Of the accelerometer, m/s^2, at rest up; of the gyroscope, rad/s, or None.
    driven : (r, k) float64
        Joints, rad or length.
    steering : Steering
        What is to steer.
    """
    _check((time[-1] - time[0]) / steering.cycle)
    count = math.floor((time[-1] - time[0]) / steering.cycle * (1.0 + 1e-9)) + 1
    at: Floats = time[0] + np.arange(count, dtype=np.float64) * steering.cycle
    ups, joints = _between(at, time, up), _between(at, time, driven)
    size = np.linalg.norm(ups, axis=1)
    felt = -ups / np.maximum(size, 1e-12)[:, None]
    slope, _ = steering.controller().ground(joints, ups)
    slope = unit_directions(np.where(np.any(slope, axis=1)[:, None], slope, felt))
    nowhere = np.zeros(count)
    path = Path(np.stack([at - at[0], nowhere, nowhere], axis=1), nowhere, slope)
    turning = None if rate is None else _between(at, time, rate)
    return Ride(path, slope, size, joints, felt, turning)


def _between(at: Floats, known: Floats, rows: Floats) -> Floats:
    """Return rows (r, c) that are known at some places, at others."""
    return np.stack([np.interp(at, known, column) for column in rows.T], axis=1)


def _check(cycles: float) -> None:
    """Refuse more cycles than points of a path."""
    most = int(min(cycles, 1e15)) + 1
    bounds.check(most, bounds.POINTS, "the cycles of the ride", "ride for less time")
