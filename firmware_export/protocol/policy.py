"""Lay a policy out as bytes: settings and table, as runtime/smap_state.h has them."""

import zlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.vector import Floats

CONTROL_VERSION = 1


class Joint(NamedTuple):
    """What the C knows of a parameter beside the map; rad or the recipe's length unit.

    Attributes
    ----------
    low, code : float
        Value of code 0, and of a step of codes.
    rate : float
        The most that it changes in a cycle.
    delta : float
        The range around what is desired.
    near : float
        A change that needs no new pose.
    reach : float
        Length by which one unit of it moves contacts that no other joint moves further, seen from
        the com, beyond what it moves others, at most; of a grid how far (rad) it changes the tip
        angle.
    bend : float
        Length by which one unit of it moves those others, at most; of three points the second
        derivative of a tip angle (rad) by it.
    lean : float
        Angle (rad) by which one unit of it turns the body on a plane, at most.
    """

    low: float
    code: float
    rate: float
    delta: float
    near: float
    reach: float
    bend: float
    lean: float


@dataclass(frozen=True, eq=False)
class Policy:
    """The best posture for each slope, and how fast and how safely the robot goes there.

    Parameters
    ----------
    codes : (n, n, k) uint8
        The table over u = x / -z and v = y / -z of gravity in the ground's frame, u first.
    limit : float
        Largest |u| and |v| of it.
    joints : tuple of Joint
        One for each parameter.
    cycle, latency : float
        s.
    margin : float
        Tip angle (rad) that every way is to keep, where the robot has it.
    levels : (float, float, float)
        Tip angles (rad) below which the alarm has level 1, 2, 3.
    swerve : float
        By how much (rad) `up` may turn in a cycle beyond what the gyroscope says.
    poses : int
        Poses that a cycle may make of many contacts, 1 or 2.
    """

    codes: NDArray[np.uint8]
    limit: float
    joints: tuple[Joint, ...]
    cycle: float
    latency: float
    margin: float
    levels: tuple[float, float, float]
    swerve: float
    poses: int = 1

    @property
    def table_bytes(self) -> int:
        """Bytes of the table."""
        return int(self.codes.size)

    def packed(self, stability_map: bytes) -> bytes:
        """Return the policy of a map, both as they stand in flash."""
        nodes, k = self.codes.shape[0], self.codes.shape[2]
        singles = [self.limit, self.cycle, self.latency, self.margin, *self.levels, self.swerve]
        settings = (
            stability_map[:4]
            + bytes([CONTROL_VERSION, k, nodes, self.poses])
            + np.array(singles, "<f4").tobytes()
            + np.array(self.joints, "<f4").tobytes()
        )
        table = np.ascontiguousarray(self.codes).tobytes()
        checks = (zlib.crc32(part).to_bytes(4, "little") for part in (settings, table))
        return b"".join(checks) + settings + table

    def values(self) -> Floats:
        """Return the postures (n, n, k) that the codes stand for."""
        joints = np.array(self.joints)
        return np.asarray(joints[:, 0] + joints[:, 1] * self.codes)
