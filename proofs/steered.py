"""A robot of the gallery with a policy, and the parts of its C that no cycle shows."""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from firmware_export.codecs import usable
from firmware_export.control import PolicyOptions, steered
from firmware_export.host import Controller
from firmware_export.host.reader import call
from firmware_export.model import Model
from firmware_export.protocol import Blob, Policy, describe
from lutgen.channels import body_gravity, evaluate_each
from lutgen.recipe import load_recipe
from lutgen.vector import Floats

# Two of smap_move_t.
ESCAPES, BLIND = 3, 4


class Parts(Controller):
    """A controller of which targets, ways and budgets are asked by themselves."""

    def target(self, slope: ArrayLike, desired: ArrayLike | None = None) -> NDArray[np.float32]:
        """Return the postures (m, k) for slopes (m, 3), within the range around `desired`."""
        slopes = np.ascontiguousarray(slope, np.float32)
        target = np.zeros((len(slopes), self.joints), np.float32)
        wanted = None if desired is None else self._rows(desired)
        self._call("target", len(slopes), slopes, wanted, target)
        return target

    def transit(self, start: ArrayLike, end: ArrayLike, gravity: ArrayLike) -> NDArray[np.float32]:
        """Return the certified least tip angle (m,), rad, of the ways between postures (m, k).

        `gravity` (m, 3) is in the body frame at the start.
        """
        rows, ends = self._rows(start), self._rows(end)
        downs, least = np.ascontiguousarray(gravity, np.float32), np.empty(len(rows), np.float32)
        self._call("transit", len(rows), self._started(), rows, ends, downs, least)
        return least

    def budget(
        self, params: ArrayLike, gravity: ArrayLike, direction: ArrayLike, reads: int = 4
    ) -> NDArray[np.float32]:
        """Run smap_budget: the largest acceleration (m,), m/s^2, of each posture (m, k).

        `gravity` and `direction` (m, 3) are down and where the robot accelerates, in the body
        frame, of any length > 0; `reads` are the reads of the map for each.
        """
        rows, map_ = self._rows(params), self._flash[0]
        ways = (np.ascontiguousarray(one, np.float32) for one in (gravity, direction))
        found, status = np.empty(len(rows), np.float32), np.empty(len(rows), np.int8)
        held = map_, ctypes.c_uint32(len(map_)), ctypes.c_int64(len(rows))
        given = rows, *ways, ctypes.c_uint8(reads), found, status
        call(f"{self._stem}budget", *held, *given)
        return found


@dataclass(frozen=True, eq=False)
class Steered:
    """A robot with its export's map and policy."""

    model: Model
    blob: Blob
    policy: Policy

    @property
    def tripod(self) -> bool:
        """Whether ways are judged on the plane; else in the body's frame, and what leaning adds."""
        return self.model.is_tripod

    def controller(self, robots: int = 1, policy: Policy | None = None) -> Parts:
        """Return the C that steers so many robots."""
        return Parts(self.blob, (policy or self.policy).packed(self.blob.bytes), robots)

    def tip(self, params: Floats, gravity: Floats) -> Floats:
        """Return the true tip angles (m,), rad."""
        return np.asarray(
            evaluate_each(self.model.recipe, params, gravity, ("tip_angle",))["tip_angle"]
        )

    def down(self, params: Floats, slopes: Floats) -> Floats:
        """Return gravity (m, 3) in the body frame of robots that stand on slopes (m, 3)."""
        return np.asarray(body_gravity(self.model.recipe, params, slopes, "plane"))


def robot(name: str, codec: str = "contacts", **options: Any) -> Steered:
    """Return a robot of the gallery, its export not certified, with a policy."""
    model = Model(load_recipe(f"recipe:{name}"))
    info = usable(model, "float", codec)[0]
    export, found = steered(info.export(model, name, ("tip_angle",)), PolicyOptions(**options))
    return Steered(model, describe(export), found.policy)
