"""Give an export a policy, write it, and steer a robot with it.

A folder's map and policy are read by the C that lutgen carries; nothing of it is compiled.
"""

import base64
import binascii
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from firmware_export.codecs import usable
from firmware_export.control.maker import Design, PolicyOptions, design
from firmware_export.device import ExportFolder
from firmware_export.emit import check_directory, default_name, write
from firmware_export.exporter import ExportOptions, certified
from firmware_export.host import Controller
from firmware_export.model import Model
from firmware_export.protocol import Blob, Export, describe
from lutgen.errors import InputError, reject
from lutgen.mapping import StabilityMap
from lutgen.recipe import Recipe
from lutgen.vector import Floats

CHANNELS = ("tip_angle",)


def steered(export: Export, policy_options: PolicyOptions) -> tuple[Export, Design]:
    """Return an export with the requested policy, and what is known of it.

    Options that mean nothing and exports that are read without floats are refused.
    """
    found = design(export.model, policy_options)
    blob = describe(export)
    Controller(blob, found.policy.packed(blob.bytes))  # refuses what the C would not take
    return replace(export, policy=found.policy), found


def policy(
    source: str | os.PathLike[str] | StabilityMap | Recipe,
    directory: str | os.PathLike[str],
    policy_options: PolicyOptions | None = None,
    progress: Callable[[str], None] = lambda text: None,
    **options: Any,
) -> tuple[dict[str, Any], Design]:
    """Write a robot's map, its policy and the C that follows it into a folder.

    `source`, `directory` and `options` (name, flash, max_error, channels, codec, allow_python,
    points) are those of `firmware_export.export`, and so are the errors; `progress` is called with
    a text for people before each step.  Returns the content of NAME_report.json, the policy and
    what it loses.
    """
    check_directory(directory)
    export = certified(source, ExportOptions(**options), progress)
    progress("looking for the best postures")
    export, found = steered(export, policy_options or PolicyOptions())
    progress("writing")
    return write(export, directory, progress), found


@dataclass(frozen=True, eq=False)
class Steering:
    """A robot, its map and its policy as bytes.

    Exact answers come from the recipe; `cycle` and `latency` (s) and `rates` (k,), changes in a
    second, are the policy's; `codec` is the map's.
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
    """Return what a folder of `lutgen policy` holds; refuse any other, and a changed one."""
    folder = ExportFolder(directory)
    stored: Any = folder.report.get("policy")
    if stored is None:
        what, got = "is an export without a policy", "no key policy in its report"
        reject(directory, what, got, "write one that has it with `lutgen policy`", InputError)
    recipe = folder.recipe()
    if recipe.parameters and recipe.python is not None and recipe.function is None:
        what, way_out = "the robot is given by code", "give its recipe with --allow-python"
        reject(directory, f"{what}, which no folder runs", recipe.python, way_out, InputError)
    try:
        packed = base64.b64decode(stored["blob"], validate=True)
        cycle, latency = float(stored["cycle_s"]), float(stored["latency_s"])
        rates = _rates(packed, len(recipe.parameters)) / cycle
    except (KeyError, TypeError, ValueError, ZeroDivisionError, binascii.Error) as error:
        what, got = "the policy of its report is damaged", f"{type(error).__name__}: {error}"
        reject(directory, what, got, "write it again with `lutgen policy`", InputError)
    return Steering(recipe, folder.blob, packed, cycle, latency, rates, folder.report["codec"])


def steering_of(recipe: Recipe, policy_options: PolicyOptions) -> Steering:
    """Return a robot with a map and a policy, made now and not certified."""
    model = Model(recipe)
    info = usable(model, "float", "contacts")[0]
    export, found = steered(info.export(model, default_name(recipe.name), CHANNELS), policy_options)
    blob = describe(export)
    packed = found.policy.packed(blob.bytes)
    rates = np.array([joint.rate for joint in found.policy.joints]) / policy_options.cycle
    return Steering(
        recipe, blob, packed, policy_options.cycle, policy_options.latency, rates, info.name
    )


def _rates(packed: bytes, joints: int) -> Floats:
    """Return the changes in a cycle (k,) that a policy allows; see runtime/smap_state.h."""
    singles = np.frombuffer(packed, "<f4", 8 * joints, 48).reshape(joints, 8)
    return np.asarray(singles[:, 2].astype(np.float64))
