"""Close the loop: the C steers a robot over a ride, with what sensors and actuators add.

A sample is taken in the attitude that the robot has on its ground; the command acts some cycles
later, and joints go there no faster than they can.  The recipe says where the robot tips.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from firmware_export.control.ride import Ride
from firmware_export.control.steering import Steering
from lutgen.channels import body_gravity, evaluate_each
from lutgen.errors import InputError, reject
from lutgen.search import Drive
from lutgen.vector import Floats

# How the robot leans while its shape changes, see `lutgen.channels`: as the C takes it.
LEANS = "plane"
CHANNELS = ("sdg", "height", "tip_angle", "margin")


@dataclass(frozen=True, eq=False)
class Plant:
    """The parts between the C and the ground.

    From sample to motion it takes `latency` (s), a cycle at least; joints change by `rates` (k,) in
    a second; `noise` is the standard deviation of each axis of the accelerometer, m/s^2.
    """

    latency: float
    rates: Floats
    noise: float = 0.0
    seed: int = 0
    gyroscope: bool = True

    def lag(self, cycle: float) -> int:
        """Return the cycles by which commands are late."""
        return max(1, math.ceil(self.latency / cycle - 1e-9))


@dataclass(frozen=True, eq=False)
class Loop:
    """A ride under control: `drive` as of `lutgen path`, where `wanted` is what the C commanded.

    `moves` (smap_move_t), `alarms` (levels) and `poses` (made) are of each of n cycles.
    """

    drive: Drive
    moves: NDArray[np.uint8]
    alarms: NDArray[np.uint8]
    poses: NDArray[np.uint8]


def uncontrolled(steering: Steering, ride: Ride, start: Floats) -> Drive:
    """Return the ride as it was recorded, or with the shape that the robot has in the beginning."""
    if ride.driven is not None and ride.felt is not None:
        return _judged(steering, ride, ride.driven, ride.driven, ride.felt)
    params = np.tile(start, (len(ride.slope), 1))
    down = body_gravity(steering.recipe, params, ride.slope, LEANS)
    return _judged(steering, ride, params, params, down)


def controlled(steering: Steering, ride: Ride, start: Floats, plant: Plant) -> Loop:
    """Return the ride that the C steers, from posture (k,) `start`; rates are above 0."""
    if not (plant.rates > 0.0).all():
        reject("--rate", "is not above 0", plant.rates.tolist(), "leave it out", InputError)
    recipe, cycle = steering.recipe, steering.cycle
    rng, controller = np.random.default_rng(plant.seed), steering.controller()
    low, high = np.array([(p.minimum, p.maximum) for p in recipe.parameters]).T
    lag, most = plant.lag(cycle), plant.rates * cycle
    count = len(ride.slope)
    params, wanted = (np.empty((count, len(start))) for _ in range(2))
    down, seen = np.empty((count, 3)), np.zeros((3, count), np.uint8)
    posture = np.clip(start, low, high)
    for i in range(count):
        goal = wanted[i - lag] if i >= lag else posture
        posture = np.clip(posture + np.clip(goal - posture, -most, most), low, high)
        params[i] = posture
        down[i] = body_gravity(recipe, posture[None, :], ride.slope[i], LEANS)[0]
        up = -ride.size[i] * down[i] + rng.normal(0.0, 1.0, 3) * plant.noise
        command, said, _ = controller.step(
            posture[None, :],
            up[None, :],
            _turning(ride, down, i, cycle, plant)[None, :],
            desired=None if ride.driven is None else ride.driven[i : i + 1],
        )
        wanted[i] = command[0]
        seen[:, i] = said["move"][0], said["alarm"][0], said["poses"][0]
    return Loop(_judged(steering, ride, params, wanted, down), *seen)


def _turning(ride: Ride, down: Floats, i: int, cycle: float, plant: Plant) -> Floats:
    """Return what the gyroscope reads (3,), rad/s: across gravity, of which alone anyone knows."""
    if not plant.gyroscope:
        return np.zeros(3)
    if ride.turning is not None:
        return np.asarray(ride.turning[i])
    if i == 0 or ride.driven is not None:
        return np.zeros(3)
    axis = np.cross(down[i], down[i - 1])
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, float(down[i] @ down[i - 1]))
    return np.asarray(axis * (angle / (max(sine, 1e-12) * cycle)))


def _judged(steering: Steering, ride: Ride, params: Floats, wanted: Floats, down: Floats) -> Drive:
    """Return a ride with the recipe's verdict on it."""
    channels = evaluate_each(steering.recipe, params, down, CHANNELS)
    still = np.zeros(len(params))
    return Drive(ride.path, params, wanted, still, ride.path.heading, down, channels, 0)
