"""Postures of a description (rad, m): named in an SRDF file beside it, or given joint by joint."""

import math
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn
from xml.etree.ElementTree import Element

from lutgen import bounds
from lutgen.errors import InputError, reject, suggestion
from lutgen.urdf.description import UrdfJoint, UrdfRobot
from lutgen.urdf.xml import Elements, parse_xml

# Names of postures in which robots stand, the likeliest first.
STANDING = (
    *("standing", "stand", "stand_up", "standup", "home", "half_sitting", "half_sit"),
    *("nominal", "default", "start", "initial", "ready", "zero"),
)
# rad or m: files round their values, and their limits.
SAME = 1e-6


@dataclass(frozen=True)
class Srdf:
    """The postures of an SRDF file, and the moving joints of each of its groups.

    A posture of several groups has the joints of all.  Joints that the description has not, and
    those with several values, such as a free body's, are not in it.
    """

    source: str
    postures: dict[str, dict[str, float]]
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def standing(self) -> str | None:
        """Return the name of the posture to stand in, None where no name says so."""
        names = {
            name.strip().lower().replace("-", "_").replace(" ", "_"): name for name in self.postures
        }
        # Others are such as "standing_up" and "homing_nominal".
        near = [name for name in names if "stand" in name or name.startswith("homing")]
        return next((names[name] for name in (*STANDING, *near) if name in names), None)

    def posture(self, name: str) -> dict[str, float]:
        """Return a posture by its name; an unknown one raises InputError."""
        if name not in self.postures:
            way_out = suggestion(name, self.postures, "use one of")
            raise InputError(f"{self.source}: there is no such posture (got {name!r}); {way_out}.")
        return self.postures[name]


@dataclass(frozen=True)
class Standing:
    """Values of joints (rad, m), where they come from, and sentences on what they leave out."""

    values: dict[str, float]
    words: str
    left_out: tuple[str, ...]


def standing_posture(
    robot: UrdfRobot, srdf: Srdf | None, name: str | None, given: Mapping[str, float]
) -> Standing:
    """Return the posture to stand in: the one of that `name`, or the likeliest of the SRDF's.

    The joints that are `given`, rad or m, stand elsewhere, and all others at zero.
    """
    if srdf is None and name is not None:
        what, got = f"there is no SRDF file beside {robot.source}", f"{name!r}"
        reject("--posture", what, got, "give one with --srdf, or joints with -p", InputError)
    values: dict[str, float] = {}
    words = "joints at zero, or at their limit nearest to it"
    if srdf is None:
        words += " (no SRDF file names one)"
    elif (chosen := srdf.standing() if name is None else name) is not None:
        values, words = srdf.posture(chosen), f"{chosen} of {Path(srdf.source).name}"
    else:
        known = ", ".join(srdf.postures) or "none"
        words += f" ({Path(srdf.source).name} names none to stand in: {known})"
    if given:
        words = f"{', '.join(given)} as given; else {words}"
    beyond = [j for j in robot.joints if j.name in values and not _within(j, values[j.name])]
    left_out = tuple(
        f"joint {joint.name}: at its limit, beyond which the posture is"
        for joint in beyond
        if joint.name not in given
    )
    return Standing({**values, **given}, words, left_out)


def load_srdf(path: str | os.PathLike[str], robot: UrdfRobot) -> Srdf:
    """Read the postures and groups of an SRDF file; one with any fault raises RecipeError."""
    source = os.fspath(path)
    root, read = parse_xml(bounds.read(source, bounds.URDF_BYTES), source), Elements(source)
    if root.tag != "robot":
        read.fail("root element", "is not <robot>", root.tag, "give an SRDF")
    known = {joint.name for joint in robot.joints}
    result: dict[str, dict[str, float]] = {}
    for state in root.iterfind("group_state"):
        values = result.setdefault(read.name(state), {})
        for element in state.iterfind("joint"):
            joint = element.get("name", "")
            if joint in known and len(element.get("value", "").split()) <= 1:
                where = f"posture {state.get('name')!r}: joint {joint!r}"
                values[joint] = read.number(element, "value", where)
    return Srdf(source, result, joint_groups(root, robot))


def srdf_beside(path: str | os.PathLike[str]) -> Path | None:
    """Return the SRDF file that belongs to a description, or None.

    Looked for in the description's folder, in ``srdf`` in it and beside it: the one whose name
    without ending begins the description's, the longest of several.
    """
    file = Path(path)
    stem = file.name.partition(".")[0]
    for folder in (file.parent, file.parent / "srdf", file.parent.parent / "srdf"):
        found = [one for one in sorted(folder.glob("*.srdf")) if one.is_file()]
        fitting = [one for one in found if stem.startswith(one.stem)]
        if fitting:
            return max(fitting, key=lambda one: len(one.stem))
    return None


def joint_values(robot: UrdfRobot, given: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Return values in deg, of slides in m, as rad and m; refuse those that joints cannot take."""
    joints = {joint.name: joint for joint in robot.joints if joint.kind != "fixed"}
    result: dict[str, float] = {}

    def refuse(what: str, way_out: str) -> NoReturn:
        raise InputError(f"{robot.source}: {what} (got -p {name}={number:g}); {way_out}.")

    for name, number in given:
        if name not in joints:
            refuse("there is no such moving joint", suggestion(name, joints, "use one of"))
        joint = joints[name]
        if name in result:
            refuse(f"joint {name!r} is given twice", "leave one out")
        if joint.mimic is not None:
            refuse(f"joint {name!r} follows {joint.mimic.joint!r}", "give that one")
        unit, factor = ("m", 1.0) if joint.kind == "prismatic" else ("deg", math.pi / 180.0)
        if not _within(joint, number * factor):
            ends = f"{joint.lower / factor:g} to {joint.upper / factor:g} {unit}"
            refuse(f"joint {name!r} goes from {ends}", "give a value within")
        result[name] = number * factor
    return result


def _within(joint: UrdfJoint, value: float) -> bool:
    return joint.lower - SAME <= value <= joint.upper + SAME


def joint_groups(root: Element, robot: UrdfRobot) -> dict[str, tuple[str, ...]]:
    """Return the moving joints of each ``<group>`` of an SRDF, in order of the description.

    A joint that the description lacks, such as a floating base, is in no group.
    """
    parts: dict[str, list[Element]] = {}
    for group in root.iterfind("group"):
        if name := group.get("name", "").strip():
            parts.setdefault(name, []).extend(group)
    above = robot.above
    result = {}
    for name in parts:
        # A group that is met twice adds nothing.
        wanted, open_, seen = set[str](), [name], {name}
        while open_:
            for part in parts.get(open_.pop(), ()):
                inner = part.get("name", "")
                if part.tag == "group" and inner not in seen:
                    seen.add(inner)
                    open_.append(inner)
                wanted.update(_joints(part, above))
        moving = (joint.name for joint in robot.joints if joint.kind != "fixed")
        result[name] = tuple(joint for joint in moving if joint in wanted)
    return result


def _joints(part: Element, above: Mapping[str, UrdfJoint]) -> Iterator[str]:
    """Yield the joints of one element of a group; `above` has the joint that carries each link."""
    if part.tag == "joint":
        yield part.get("name", "")
    elif part.tag == "link" and (joint := above.get(part.get("name", ""))):
        yield joint.name
    elif part.tag == "chain":
        base, here = part.get("base_link", ""), part.get("tip_link", "")
        found = []
        while here != base and here in above:
            found.append(above[here].name)
            here = above[here].parent
        # Both ends belong to one branch, or it is not a chain.
        if here == base:
            yield from found
