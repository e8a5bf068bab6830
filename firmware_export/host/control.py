"""Run the C of `smap_control.h` on this machine, for many robots at a time."""

import ctypes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmware_export.host.reader import call, stem_of
from firmware_export.protocol import Blob
from lutgen.errors import InputError, reject
from lutgen.vector import Floats

# smap_cycle_t.
CYCLE = np.dtype(
    [
        *(("slope", "<f4", 3), ("tip", "<f4"), ("least", "<f4"), ("left", "<f4")),
        *(("alarm", "u1"), ("move", "u1"), ("poses", "u1"), ("spare", "u1")),
    ]
)


class Controller:
    """A map that is read with floats and its policy, and the states of robots that they steer.

    Raises
    ------
    InputError
        If the map is read without floats, or the C refuses the policy.
    """

    def __init__(self, blob: Blob, policy: bytes, robots: int = 1) -> None:
        if blob.integer:
            what, way_out = "needs a map that is read with floats", "export with --arithmetic float"
            reject("on-board control", what, "one without", way_out, InputError)
        self.joints, self.robots = blob.params, robots
        # The C keeps their addresses.
        self._flash = [np.frombuffer(one, np.uint8) for one in (blob.bytes, policy)]
        self._stem = stem_of(blob)
        sizes = np.zeros(2, np.uint32)
        call(f"{self._stem}control_sizes", sizes)
        self._both = np.zeros(-(-int(sizes[0]) // 8), np.uint64)
        self._words = -(-int(sizes[1]) // 8)
        flash = (part for one in self._flash for part in (one, ctypes.c_uint32(len(one))))
        status = call(f"{self._stem}control", self._both, *flash)
        if status != 0:
            raise InputError(
                f"the policy is refused by the C that follows it (got status {status}); it is "
                "damaged, or of another map: make it again with `lutgen policy`."
            )
        self._states = self._started(robots)

    def step(
        self,
        posture: ArrayLike,
        up: ArrayLike,
        rate: ArrayLike | None = None,
        own: ArrayLike | None = None,
        desired: ArrayLike | None = None,
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[np.int8]]:
        """Run smap_step once for each of n robots, which keep their states.

        `posture` and `desired` (n, k) are joints, rad or length; `up` and `own` (n, 3) what the
        accelerometer reads and the acceleration that is known, m/s^2; `rate` (n, 3) the gyroscope,
        rad/s.  Without `desired` the policy goes where it will.  Returns command (n, k), cycle
        (n,), see `CYCLE`, and status (n,).
        """
        rows = self._rows(posture)
        count = len(rows)
        if count != self.robots:
            raise InputError(f"a row for each robot (got {count} of {self.robots})")
        sensors = np.zeros((count, 9), np.float32)
        for at, given in ((0, up), (3, rate), (6, own)):
            if given is not None:
                sensors[:, at : at + 3] = given
        wanted = None if desired is None else self._rows(desired)
        command = np.empty((count, self.joints), np.float32)
        cycle, status = np.empty(count, CYCLE), np.empty(count, np.int8)
        self._call("step", count, self._states, rows, wanted, sensors, command, cycle, status)
        return command, cycle, status

    def ground(self, posture: ArrayLike, up: ArrayLike) -> tuple[Floats, NDArray[np.int8]]:
        """Return gravity in the ground's frame (m, 3) under postures (m, k) and `up` (m, 3)."""
        rows, ups = self._rows(posture), np.ascontiguousarray(up, np.float32)
        slope, status = np.empty((len(rows), 3), np.float32), np.empty(len(rows), np.int8)
        self._call("ground", len(rows), self._started(), rows, ups, slope, status)
        return slope.astype(np.float64), status

    def _started(self, robots: int = 1) -> NDArray[np.uint64]:
        """Return states of robots that begin."""
        states = np.zeros(robots * self._words, np.uint64)
        self._call("start", robots, states)
        return states

    def _rows(self, posture: ArrayLike) -> NDArray[np.float32]:
        rows = np.ascontiguousarray(posture, np.float32)
        if rows.ndim != 2 or rows.shape[1] != self.joints:
            raise InputError(
                f"postures must have the shape (m, {self.joints}) (got {rows.shape}); give one row "
                "for each robot."
            )
        return rows

    def _call(self, what: str, count: int, *arrays: NDArray[Any] | None) -> None:
        """Call a function of the library with map and policy, a count, and arrays."""
        call(self._stem + what, self._both, ctypes.c_int64(count), *arrays)
