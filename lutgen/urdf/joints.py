"""How the joints of a robot description move: which are free, which follow, which are held.

Every joint that is not fixed is scale * parameter + offset, or held at a value; a parameter is a
free joint, or drives several.  Values in rad or m.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from lutgen.errors import RecipeError, reject, suggestion
from lutgen.parts import parents_first
from lutgen.urdf.description import UrdfJoint, UrdfRobot
from lutgen.urdf.xml import LARGEST

TURN = 2.0 * math.pi
TURNING = ("revolute", "continuous")


@dataclass(frozen=True)
class Couple:
    """Joints that one parameter drives and `why`: each is at scale * parameter + offset."""

    name: str
    joints: dict[str, tuple[float, float]]
    why: str = ""

    @property
    def first(self) -> str:
        """The joint that stands for the parameter."""
        return next(iter(self.joints))


@dataclass(frozen=True)
class Drive:
    """Value of a joint: scale * parameter + offset, constant if `by`, its joint, is None."""

    by: str | None
    scale: float
    offset: float


@dataclass(frozen=True)
class Motion:
    """Limits of the parameters, the drive of every joint that is not fixed, and why some hold.

    `rest` has the parameters' values at rest; `couples` are those that drive several joints.
    """

    free: dict[str, tuple[float, float]]
    drives: dict[str, Drive]
    held: dict[str, str]
    rest: dict[str, float] = field(default_factory=dict)
    couples: tuple[Couple, ...] = ()

    def drive(self, joint: str) -> Drive:
        """Return what drives a joint; a fixed one stands at 0."""
        return self.drives.get(joint, Drive(None, 0.0, 0.0))


def soft_limited(robot: UrdfRobot) -> UrdfRobot:
    """Return the description with the soft limits of its joints' controllers as limits."""
    joints = []
    for joint in robot.joints:
        if joint.soft is not None:
            lower, upper = max(joint.lower, joint.soft[0]), min(joint.upper, joint.soft[1])
            if lower > upper:
                what = f"joint {joint.name!r}: its soft limits are beyond its limits"
                reject(robot.source, what, joint.soft, "correct them, or leave --soft-limits out")
            joint = replace(joint, lower=lower, upper=upper)
        joints.append(joint)
    return replace(robot, joints=tuple(joints))


def read_motion(
    robot: UrdfRobot,
    chosen: Sequence[str] | None = None,
    posture: Mapping[str, float] | None = None,
    couples: Sequence[Couple] = (),
) -> Motion:
    """Sort the joints; RecipeError is raised for what cannot be free, or not together.

    Free are those `chosen`, or all that can be, beside those of `couples`.  `posture` has values at
    rest (rad or m), 0 for joints that it does not name; they are brought within the limits.  The
    limits of all joints that a parameter drives, and of those that mimic them, bound it; one of
    360 deg or more, or without limits, has -180 to 180 deg.
    """
    posture = posture or {}
    leaders = _leaders(robot, couples)
    if chosen is not None:
        chosen = [*chosen, *(couple.first for couple in couples)]
    ranges = _ranges(robot, leaders)
    _check_couples(robot, couples, ranges)
    drives: dict[str, Drive] = {}
    held: dict[str, str] = {}
    for joint in robot.joints:
        if joint.kind == "fixed":
            continue
        leader, scale, offset = leaders[joint.name]
        why = _why_held(joint, leader, scale, ranges, chosen)
        drives[joint.name] = Drive(leader.name, scale, offset)
        if why is not None:
            held[joint.name] = why
            rest = min(max(posture.get(leader.name, 0.0), leader.lower), leader.upper)
            rest = 0.0 if leader.kind == "fixed" else rest
            drives[joint.name] = Drive(None, 0.0, scale * rest + offset)
    free, at_rest = {}, {}
    for joint in robot.joints:
        name = joint.name
        if name in drives and (drive := drives[name]).by == name:
            low, high = ranges[name]
            value = (posture.get(name, 0.0) - drive.offset) / drive.scale
            if joint.kind != "prismatic" and high - low >= TURN:
                low, high = -math.pi, math.pi
                # The same way round: such a joint comes back to where it was.
                value = math.remainder(value, TURN)
            free[name] = low, high
            at_rest[name] = min(max(value, low), high)
    wanted = [*(chosen or ()), *(name for couple in couples for name in couple.joints)]
    _check_chosen(robot, wanted, drives, held)
    return Motion(free, drives, held, at_rest, tuple(couples))


def _leaders(
    robot: UrdfRobot, couples: Sequence[Couple]
) -> dict[str, tuple[UrdfJoint, float, float]]:
    """Return for each joint the one that stands for its parameter, with scale and offset.

    That is the one at the end of its mimics, or the first of the couple that this one is in.
    """
    joints = {joint.name: joint for joint in robot.joints}
    result: dict[str, tuple[UrdfJoint, float, float]] = {}
    masters = {one.name: one.mimic.joint if one.mimic else None for one in robot.joints}
    for name in parents_first(masters)[0]:
        mimic = joints[name].mimic
        if mimic is None:
            result[name] = joints[name], 1.0, 0.0
            continue
        leader, scale, offset = result[mimic.joint]
        scale, offset = mimic.multiplier * scale, mimic.multiplier * offset + mimic.offset
        if not (abs(scale) <= LARGEST and abs(offset) <= LARGEST):
            what = f"joint {name!r}: its mimics multiply beyond {LARGEST:g}"
            got = f"{scale:g} times {leader.name!r} + {offset:g}"
            reject(robot.source, what, got, "correct them")
        result[name] = leader, scale, offset
    coupled = {name: couple for couple in couples for name in couple.joints}
    for name, (leader, scale, offset) in result.items():
        if leader.name in coupled:
            couple = coupled[leader.name]
            own, shift = couple.joints[leader.name]
            result[name] = joints.get(couple.first, leader), scale * own, scale * shift + offset
    return result


def _ranges(
    robot: UrdfRobot, leaders: Mapping[str, tuple[UrdfJoint, float, float]]
) -> dict[str, tuple[float, float]]:
    """Return for each parameter the values at which no joint that it drives leaves its limits."""
    ranges: dict[str, tuple[float, float]] = {}
    for joint in robot.joints:
        leader, scale, offset = leaders[joint.name]
        if scale != 0.0 and _alike(joint, leader):
            ends = [(end - offset) / scale for end in (joint.lower, joint.upper)]
            low, high = ranges.get(leader.name, (-math.inf, math.inf))
            ranges[leader.name] = max(low, min(ends)), min(high, max(ends))
    return ranges


def _check_couples(
    robot: UrdfRobot, couples: Sequence[Couple], ranges: Mapping[str, tuple[float, float]]
) -> None:
    joints = {joint.name: joint for joint in robot.joints}
    for couple in couples:
        moving = [joints[name] for name in couple.joints if name in joints]
        slides = [joint for joint in moving if joint.kind == "prismatic"]
        turns = [joint for joint in moving if joint.kind in TURNING]
        if slides and turns:
            what = f"{couple.name!r} drives joints that turn and joints that slide"
            got = f"{turns[0].name!r}, {turns[0].kind}, and {slides[0].name!r}, prismatic"
            reject(robot.source, what, got, "give each kind a parameter")
        low, high = ranges.get(couple.first, (0.0, 1.0))
        if not low < high and all(joint.lower < joint.upper for joint in moving):
            what = f"the limits of {', '.join(couple.joints)} leave {couple.name!r} no range"
            got = f"{low:g} to {high:g} rad or m"
            reject(robot.source, what, got, "change scales and offsets, or separate them")


def _alike(joint: UrdfJoint, leader: UrdfJoint) -> bool:
    kinds = {joint.kind, leader.kind}
    return kinds == {"prismatic"} or kinds <= {*TURNING}


def _why_held(
    joint: UrdfJoint,
    leader: UrdfJoint,
    scale: float,
    ranges: dict[str, tuple[float, float]],
    chosen: Sequence[str] | None,
) -> str | None:
    if joint.kind in ("floating", "planar"):
        return f"is {joint.kind}"
    follows = "" if joint is leader else f"follows {leader.name!r}, which "
    if leader.kind in ("fixed", "floating", "planar"):
        return f"{follows}is {leader.kind}"
    if not _alike(joint, leader):
        return f"{follows}is {leader.kind} and not {joint.kind}"
    if scale == 0.0:
        return f"{follows}moves it by nothing"
    low, high = ranges[leader.name]
    if not low < high:
        return f"{follows}has no room between its limits"
    if leader.kind == "prismatic" and not math.isfinite(high - low):
        return f"{follows}has no limits"
    if chosen is not None and leader.name not in chosen:
        return f"{follows}is not chosen as a parameter"
    return None


def _check_chosen(
    robot: UrdfRobot, chosen: Sequence[str], drives: Mapping[str, Drive], held: Mapping[str, str]
) -> None:
    joints = {joint.name: joint for joint in robot.joints}
    for name in chosen:
        if name not in joints:
            known = [joint.name for joint in robot.joints if joint.kind != "fixed"]
            way_out = suggestion(name, known, "use one of")
            raise RecipeError(f"{robot.source}: there is no such joint (got {name!r}); {way_out}.")
        mimic = joints[name].mimic
        if mimic is not None or name not in drives or name in held:
            why = f"follows {mimic.joint!r}" if mimic else held.get(name, "is fixed")
            what = f"joint {name!r} cannot be a parameter: it {why}"
            reject(robot.source, what, f"the type {joints[name].kind}", "choose another one")
