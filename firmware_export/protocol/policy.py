"""Lay a policy out as bytes: settings and table, as runtime/smap_state.h has them."""

import zlib
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lutgen.vector import Floats

CONTROL_VERSION = 1


class Joint(NamedTuple):
    """Knowledge of the C about a parameter, beside the map; rad or the recipe's length unit.

    `low` and `code` are the value of code 0 and of a step; `rate` is the most that it changes in a
    cycle, `delta` the range around what is desired, `near` a change that needs no new pose.  One
    unit of it moves contacts that no other joint moves further by at most `reach` (length, seen
    from the com) beyond what it moves others, and those by at most `bend`; it turns the body on a
    plane by at most `lean` (rad).  For a grid `reach` is how far (rad) it changes the tip angle, of
    three points `bend` the second derivative of a tip angle (rad).
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

    `codes` (n, n, k) are the table over u = x / -z and v = y / -z of gravity in the ground's frame,
    u first, up to `limit`.  The robot keeps a tip angle of `margin` (rad) on every way where it has
    it; below `levels` (rad) the alarm has level 1, 2, 3.  By `swerve` (rad) `up` may turn in a
    cycle beyond what the gyroscope says; `poses` are those that a cycle may make of many contacts,
    1 or 2.
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
