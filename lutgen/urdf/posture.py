"""Postures of a robot description: named in an SRDF file beside it, or given joint by joint.

Owns which of several named postures is the one to stand in, and what is read of an SRDF file.
Values in rad or m.  What the joints then move is not known here.
"""

import math
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from lutgen.errors import InputError, RecipeError, suggestion
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.groups import joint_groups
from lutgen.urdf.read import LARGEST, MAX_BYTES, read_bytes
from lutgen.urdf.xml import parse_xml

# Names of postures in which robots stand, the likeliest first.
STANDING = (
    *("standing", "stand", "stand_up", "standup", "home", "half_sitting", "half_sit"),
    *("nominal", "default", "start", "initial", "ready", "zero"),
)
# rad or m: files round their values, and their limits.
SAME = 1e-6


@dataclass(frozen=True)
class Srdf:
    """The postures of an SRDF file: for each name the values of joints of the description.

    A posture of several groups has the joints of all.  Joints that the description has not, and
    those with several values, such as a free body's, are not in it.  `groups` has the moving
    joints of each group.
    """

    source: str
    postures: dict[str, dict[str, float]]
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def standing(self) -> str | None:
        """Return the name of the posture to stand in, None where no name says so."""
        names = {
            name.strip().lower().replace("-", "_").replace(" ", "_"): name for name in self.postures
        }
        for wanted in STANDING:
            if wanted in names:
                return names[wanted]
        # Such as "standing_up" and "homing_nominal".
        near = (name for name in names if "stand" in name or name.startswith("homing"))
        return next((names[name] for name in near), None)

    def posture(self, name: str) -> dict[str, float]:
        """Return a posture by its name; an unknown one raises InputError."""
        if name not in self.postures:
            way_out = suggestion(name, self.postures, "use one of")
            raise InputError(f"{self.source}: there is no such posture (got {name!r}); {way_out}.")
        return self.postures[name]


def load_srdf(path: str | os.PathLike[str], robot: UrdfRobot) -> Srdf:
    """Read postures and groups (``<group_state>``, ``<group>``) of an SRDF of at most 16 MiB.

    Parameters
    ----------
    path : path
        XML whose root is <robot>.
    robot : UrdfRobot
        The description whose joints count.

    Returns
    -------
    Srdf
        A file with any fault raises RecipeError, and so does a value that is no number of at most
        1e12.
    """
    source = os.fspath(path)
    raw = read_bytes(source)
    if len(raw) > MAX_BYTES:
        raise RecipeError(
            f"{source}: is longer than {MAX_BYTES} bytes (got {len(raw)} or more); keep the "
            "<group_state> elements."
        )
    root = parse_xml(raw, source)
    if root.tag != "robot":
        raise RecipeError(
            f"{source}: root element is not <robot> (got {root.tag!r}); give an SRDF."
        )
    known = {joint.name for joint in robot.joints}
    result: dict[str, dict[str, float]] = {}
    for state in root.iterfind("group_state"):
        name = state.get("name", "")
        if not name.strip() or not name.isprintable():
            raise RecipeError(
                f"{source}: a <group_state> has no usable name (got {name!r}); name the posture."
            )
        values = result.setdefault(name, {})
        for element in state.iterfind("joint"):
            joint, text = element.get("name", ""), element.get("value", "")
            if joint not in known or len(text.split()) > 1:
                continue
            try:
                value = math.nan if "_" in text else float(text)
            except ValueError:
                value = math.nan
            if not abs(value) <= LARGEST:
                raise RecipeError(
                    f"{source}: posture {name!r}: joint {joint!r} has no number as value (got "
                    f"{text[:60]!r}); write rad, or m."
                )
            values[joint] = value
    return Srdf(source, result, joint_groups(root, robot))


def srdf_beside(path: str | os.PathLike[str]) -> Path | None:
    """Return the SRDF file that belongs to a description, None where there is none.

    Looked for in the description's folder, in ``srdf`` in it and beside it: the one whose name
    without ending begins the description's, the longest of several.
    """
    file = Path(path)
    stem = file.name.partition(".")[0]
    for folder in (file.parent, file.parent / "srdf", file.parent.parent / "srdf"):
        try:
            found = [one for one in sorted(folder.glob("*.srdf")) if one.is_file()]
        except OSError:
            continue
        fitting = [one for one in found if stem.startswith(one.stem)]
        if fitting:
            return max(fitting, key=lambda one: len(one.stem))
    return None


def joint_values(robot: UrdfRobot, given: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Return values in deg, of slides in m, as rad and m; refuse those that joints cannot take.

    InputError is raised for a joint that is unknown, fixed or follows another, that is given
    twice, and for a value outside its limits.
    """
    joints = {joint.name: joint for joint in robot.joints}
    moving = [name for name, joint in joints.items() if joint.kind != "fixed"]
    result: dict[str, float] = {}
    for name, number in given:
        if name not in moving:
            way_out = suggestion(name, moving, "use one of")
            raise InputError(
                f"{robot.source}: there is no such moving joint (got -p {name}={number:g}); "
                f"{way_out}."
            )
        joint = joints[name]
        if name in result:
            raise InputError(f"{robot.source}: joint {name!r} is given twice (got {number:g} too).")
        if joint.mimic is not None:
            raise InputError(
                f"{robot.source}: joint {name!r} follows {joint.mimic.joint!r} (got "
                f"-p {name}={number:g}); give that one."
            )
        slides = joint.kind == "prismatic"
        value = number if slides else math.radians(number)
        if not joint.lower - SAME <= value <= joint.upper + SAME:
            low, high = (end if slides else math.degrees(end) for end in (joint.lower, joint.upper))
            raise InputError(
                f"{robot.source}: joint {name!r} goes from {low:g} to {high:g} "
                f"{'m' if slides else 'deg'} (got -p {name}={number:g}); give a value within."
            )
        result[name] = value
    return result


def beyond_limits(robot: UrdfRobot, values: Mapping[str, float]) -> list[str]:
    """Return the joints whose value lies outside their limits, where they stand at the limit."""
    return [
        joint.name
        for joint in robot.joints
        if joint.name in values
        and not joint.lower - SAME <= values[joint.name] <= joint.upper + SAME
    ]
