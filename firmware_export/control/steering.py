"""A robot and what steers it, ready to be asked: of a folder of `lutgen policy`, or of a recipe.

Owns the two ways there.  Of a folder nothing is compiled: its map and its policy are asked by the C
that lutgen carries.
"""

import base64
import binascii
import os
from dataclasses import dataclass
from typing import Any

import numpy as np

from firmware_export.codecs import usable
from firmware_export.control.folder import steered
from firmware_export.control.maker import Wishes
from firmware_export.device import ExportFolder
from firmware_export.emit import default_name
from firmware_export.host import Controller
from firmware_export.protocol import Blob, Export, describe
from firmware_export.truth import Model
from lutgen.errors import InputError
from lutgen.recipe import Recipe
from lutgen.vector import Floats

CHANNELS = ("tip_angle",)


@dataclass(frozen=True, eq=False)
class Steering:
    """A robot, its map and its policy.

    Parameters
    ----------
    recipe : Recipe
        The robot; the truth comes from it.
    blob : Blob
        The map.
    policy : bytes
        Of `protocol.Policy.packed`.
    cycle, latency : float
        Of the policy, s.
    rates : (k,) float64
        Of the policy: changes in a second.
    codec : str
        Of the map.
    """

    recipe: Recipe
    blob: Blob
    policy: bytes
    cycle: float
    latency: float
    rates: Floats
    codec: str

    def controller(self, robots: int = 1) -> Controller:
        """Return the C that steers so many robots."""
        return Controller(self.blob, self.policy, robots)


def steering_in(directory: str | os.PathLike[str]) -> Steering:
    """Return what a folder of `lutgen policy` holds.

    Raises
    ------
    InputError
        If it is none, was changed, or holds no policy.
    """
    folder = ExportFolder(directory)
    held: Any = folder.report.get("policy")
    if held is None:
        raise InputError(
            f"{directory}: is an export without a policy (got no key policy in its report); write "
            "one that has it with `lutgen policy`."
        )
    recipe = folder.recipe()
    if recipe.parameters and recipe.python is not None and recipe.function is None:
        raise InputError(
            f"{directory}: the robot is given by code, which no folder runs (got "
            f"{recipe.python}); give its recipe with --allow-python."
        )
    try:
        packed = base64.b64decode(held["blob"], validate=True)
        cycle, latency = float(held["cycle_s"]), float(held["latency_s"])
        rates = _rates(packed, len(recipe.parameters)) / cycle
    except (KeyError, TypeError, ValueError, ZeroDivisionError, binascii.Error) as error:
        raise InputError(
            f"{directory}: the policy of its report is damaged (got {type(error).__name__}: "
            f"{error}); write it again with `lutgen policy`."
        ) from error
    return Steering(recipe, folder.blob, packed, cycle, latency, rates, folder.report["codec"])


def steering_of(recipe: Recipe, wishes: Wishes, codec: str = "contacts") -> Steering:
    """Return a robot with a map and a policy, made now and not certified.

    Raises
    ------
    InputError
        For wishes that mean nothing, and robots without such a map.
    """
    model = Model(recipe)
    info = usable(model, "float", codec)[0]
    tables = info.encode(model, CHANNELS, info.sizes(model, CHANNELS)[0])
    export = Export(default_name(recipe.name), recipe, model, info.name, "float", CHANNELS, tables)
    export, found = steered(export, wishes)
    blob = describe(export)
    packed = found.policy.packed(blob.bytes)
    rates = np.array([joint.rate for joint in found.policy.joints]) / wishes.cycle
    return Steering(recipe, blob, packed, wishes.cycle, wishes.latency, rates, info.name)


def _rates(packed: bytes, joints: int) -> Floats:
    """Return the changes in a cycle (k,) that a policy allows; see runtime/smap_state.h."""
    singles = np.frombuffer(packed, "<f4", 8 * joints, 48).reshape(joints, 8)
    return np.asarray(singles[:, 2].astype(np.float64))
