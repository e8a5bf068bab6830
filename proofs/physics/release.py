"""Let a robot go on a slope, watch it, and say what came of it.

Owns the run and what "tipped" means to the engine.
"""

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from proofs.physics.begin import Start
from proofs.physics.body import Floats, Posture, mjcf, turned_to

GRAVITY = 9.81
DOWN = np.array([0.0, 0.0, -1.0])
# Above every slope that is asked: a robot that slides trips.
FRICTION = 10.0
STEEPEST = math.radians(80.0)
SECONDS, CHUNK = 4.0, 50
# A body that turns less than this in `REST` chunks, from 0.1 s after its release on, has come to
# rest: one let go 0.002 deg beyond its axis turns further.
STILL, REST = math.radians(0.001), 8
# A balance is as unstable as a pencil on its point, so it is not watched for long: what counts is
# which contacts carry in `LAST` steps after `FIRST` (ms).  One under a hundredth of the weight
# flutters, which is why one instant would not do: seen to be in the air for 60 ms on end.
FIRST, LAST = 100, 100


@dataclass(frozen=True)
class Outcome:
    """What the engine did: verdict, turn of the ground's normal (rad), way (m), time (s)."""

    tipped: bool
    turned: float
    moved: float
    seconds: float


class Run:
    """A robot in the engine, put on a plane under a direction of gravity given in its frame."""

    def __init__(
        self, posture: Posture, begin: Start, gravity_dir: Floats, mu: float = FRICTION
    ) -> None:
        rotation = turned_to(begin.normal, DOWN)
        gravity = GRAVITY * (rotation @ gravity_dir)
        self.laid = rotation
        xml = mjcf(posture, rotation, begin.height, gravity, mu)
        self.model: Any = mujoco.MjModel.from_xml_string(xml)
        self.data: Any = mujoco.MjData(self.model)
        self.body = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, "robot")
        self.normals = [begin.normal]
        mujoco.mj_forward(self.model, self.data)
        self.place = self.data.xpos[self.body].copy()

    def step(self, count: int = CHUNK) -> None:
        """Go on by a number of milliseconds."""
        mujoco.mj_step(self.model, self.data, nstep=count)
        self.normals.append(self.rotation.T @ DOWN)

    def tilt(self, gravity_dir: Floats) -> None:
        """Let gravity go on in another direction, given in the frame of the robot at the start."""
        down = self.laid @ gravity_dir
        self.model.opt.gravity[:] = GRAVITY * down / np.linalg.norm(down)

    @property
    def rotation(self) -> Floats:
        """Rotation (3, 3) from the body to the world."""
        return np.asarray(self.data.xmat[self.body].reshape(3, 3))

    @property
    def turned(self) -> float:
        """Angle (rad) by which the ground's normal, seen from the body, has turned."""
        return _angle(self.normals[0], self.normals[-1])

    @property
    def moved(self) -> Floats:
        """Displacement (3,) of the body in the world."""
        return np.asarray(self.data.xpos[self.body] - self.place)

    @property
    def resting(self) -> bool:
        """Whether it has turned no further for a while."""
        n = self.normals
        return len(n) > REST + 2 and _angle(n[-1], n[-1 - REST]) < STILL

    def carried(self) -> list[Floats]:
        """Return the points, in the body frame, at which the ground pushes."""
        force = np.zeros(6)
        points = []
        for index, touch in enumerate(self.data.contact):
            mujoco.mj_contactForce(self.model, self.data, index, force)
            if force[0] > 0.0:
                points.append(self.rotation.T @ (touch.pos - self.data.xpos[self.body]))
        return points


def _angle(first: Floats, second: Floats) -> float:
    return float(2.0 * math.asin(min(1.0, float(np.linalg.norm(first - second)) / 2.0)))


def release(posture: Posture, begin: Start, gravity_dir: Floats) -> Outcome:
    """Let a robot go at rest on a plane that it touches, and watch it for at most 4 s.

    On a facet it has tipped when the ground's normal, seen from the body, has turned by more than
    `rock_angle`, or when it ends up further than `upright` from the body's -z.  In balance over a
    gap it stands as long as contacts on both sides of the ray along gravity carry it.
    """
    run = Run(posture, begin, gravity_dir)
    if begin.balanced:
        run.step(FIRST)
        shares: list[float] = []
        for _ in range(LAST):
            run.step(1)
            shares += [_share(begin, point) for point in run.carried()]
        pierced = _share(begin, gravity_dir * (begin.height / float(begin.normal @ gravity_dir)))
        stands = bool(shares) and min(shares) <= pierced <= max(shares)
        return _outcome(run, not stands)
    while run.data.time < SECONDS and run.turned <= posture.rock_angle and not run.resting:
        run.step()
    lying = -run.normals[-1][2] < math.cos(min(math.pi, posture.upright + STILL))
    return _outcome(run, run.turned > posture.rock_angle or bool(lying))


def _share(begin: Start, point: Floats) -> float:
    """Return how far along the line of contact a point lies: 0 at its start, 1 at its end."""
    line = begin.points[1] - begin.points[0]
    return float((point - begin.points[0]) @ line / (line @ line))


def _outcome(run: Run, tipped: bool) -> Outcome:
    return Outcome(tipped, run.turned, float(np.linalg.norm(run.moved)), float(run.data.time))
