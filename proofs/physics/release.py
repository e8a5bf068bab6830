"""Let a robot go on a slope, watch it until it lies still, and say whether it fell.

Gravity in the body frame turns with the robot, so "it rocks" promises that the robot comes to rest
near where it was.  The engine loses energy and the definition does not: a fall here is a fall on
any ground.
"""

import math
from dataclasses import replace
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from proofs.physics.body import Floats, Posture, mjcf, turned_to
from proofs.physics.start import DOWN, Start, heights

GRAVITY = 9.81
# Above every slope that is asked: a robot that slides trips.
FRICTION, STEEPEST = 10.0, math.radians(80.0)
# A swing loses little energy; what has not come to rest after so many seconds is judged as it is.
SECONDS, CHUNK = 6.0, 50
# A body that turns less than this (rad) in `REST` chunks, from 0.1 s after its release on, has come
# to rest: one let go 0.002 deg beyond its axis turns further.
STILL, REST = math.radians(0.001), 8
# The push (rad) out of a balance: far above the engine's softness (0.003 deg), far below every gap
# that is tried (1 deg).
PUSH = math.radians(0.05)
# A foot sinks in by 1e-5 m, and a robot that rests on an edge of its polygon leans by some tenths
# of a degree on small balls.
SPARE = math.radians(0.5)
# A swing so wide goes on to a fall: no gap and no rest is as wide.
OVER = math.radians(90.0)


class Run:
    """A robot in the engine, put on a plane under a direction of gravity given in its frame."""

    def __init__(
        self, posture: Posture, begin: Start, gravity_dir: Floats, mu: float = FRICTION
    ) -> None:
        self.laid = turned_to(begin.normal, DOWN)
        gravity = GRAVITY * (self.laid @ gravity_dir)
        xml = mjcf(posture, self.laid, begin.height, gravity, mu)
        self.model: Any = mujoco.MjModel.from_xml_string(xml)
        self.data: Any = mujoco.MjData(self.model)
        self.body = mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, "robot")
        self.normals = [begin.normal]
        mujoco.mj_forward(self.model, self.data)

    def step(self, count: int = CHUNK) -> None:
        """Go on by a number of milliseconds."""
        mujoco.mj_step(self.model, self.data, nstep=count)
        self.normals.append(self.data.xmat[self.body].reshape(3, 3).T @ DOWN)

    def tilt(self, gravity_dir: Floats) -> None:
        """Let gravity go on in another direction, given in the frame of the robot at the start."""
        self.model.opt.gravity[:] = GRAVITY * (self.laid @ gravity_dir)

    @property
    def turned(self) -> float:
        """Angle (rad) by which the ground's normal, seen from the body, has turned."""
        return _angle(self.normals[0], self.normals[-1])

    @property
    def resting(self) -> bool:
        """Whether it has turned no further for a while."""
        n = self.normals
        return len(n) > REST + 2 and _angle(n[-1], n[-1 - REST]) < STILL


def _angle(first: Floats, second: Floats) -> float:
    return 2.0 * math.asin(min(1.0, float(np.linalg.norm(first - second)) / 2.0))


def falls(posture: Posture, begin: Start, gravity_dir: Floats) -> bool:
    """Let a robot go at rest, and tell whether it fell."""
    return fell(Run(posture, begin, gravity_dir), posture)


def fell(run: Run, posture: Posture) -> bool:
    """Watch a robot, and tell whether it ends more than `rock_angle` away, or beyond `upright`."""
    while run.data.time < SECONDS and run.turned <= OVER and not run.resting:
        run.step()
    lying = -run.normals[-1][2] < math.cos(min(math.pi, posture.upright + STILL))
    return run.turned > posture.rock_angle + SPARE or bool(lying)


def pushed(
    posture: Posture, begin: Start, gravity_dir: Floats, angle: float
) -> tuple[Start, Floats]:
    """Return a start, and gravity there, with the robot turned about the line that carries it."""
    sides = begin.points - np.roll(begin.points, 1, axis=0)
    line = max(sides, key=np.linalg.norm)
    turn = Rotation.from_rotvec(angle * line / np.linalg.norm(line)).as_matrix()
    normal = turn @ begin.normal
    height = float(heights(posture, normal[None]).max())
    return replace(begin, normal=normal, height=height), turn @ gravity_dir


def falls_either_way(posture: Posture, begin: Start, gravity_dir: Floats) -> bool:
    """Let a robot go, in balance twice: pushed to either side; tell whether it ever fell."""
    if not begin.balanced(posture):
        return falls(posture, begin, gravity_dir)
    ways = (pushed(posture, begin, gravity_dir, angle) for angle in (-PUSH, PUSH))
    return any(falls(posture, *way) for way in ways)
