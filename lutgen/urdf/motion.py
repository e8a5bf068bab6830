"""How the joints of a robot description move: which are free, which follow, which are held.

Every joint that is not fixed is scale * free joint + offset, or held at a value.  Values in rad
or m.  What a joint moves is not known here.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from lutgen.errors import RecipeError, suggestion
from lutgen.urdf.read import LARGEST, UrdfJoint, UrdfRobot

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Drive:
    """Value of a joint: scale * value of the joint `by` + offset; constant where `by` is None."""

    by: str | None
    scale: float
    offset: float


@dataclass(frozen=True)
class Motion:
    """Limits of the free joints, the drive of every joint that is not fixed, and why some hold.

    `rest` has the free joints' values at rest.
    """

    free: dict[str, tuple[float, float]]
    drives: dict[str, Drive]
    held: dict[str, str]
    rest: dict[str, float] = field(default_factory=dict)

    def drive(self, joint: str) -> Drive:
        """Return what drives a joint; a fixed one stands at 0."""
        return self.drives.get(joint, Drive(None, 0.0, 0.0))


def read_motion(
    robot: UrdfRobot,
    chosen: Sequence[str] | None = None,
    posture: Mapping[str, float] | None = None,
) -> Motion:
    """Sort the joints.

    Parameters
    ----------
    robot : UrdfRobot
        The description.
    chosen : sequence of str, optional
        The free joints; None for all that can be.  A joint that cannot be free raises
        RecipeError.
    posture : mapping of str to float, optional
        Values at rest (rad or m), 0 for joints that it does not name; those of joints that mimic
        others do not count.

    Returns
    -------
    Motion
        A joint that turns by 360 deg or more, or without limits, has -180 to 180 deg.  The limits
        of joints that mimic a free one bound it too.  At rest a joint has the value of the
        posture, or its limit nearest to that; a held one stands there, and what mimics it
        where that puts it.
    """
    posture = posture or {}
    leaders = _leaders(robot)
    ranges: dict[str, tuple[float, float]] = {}
    for joint in robot.joints:
        leader, scale, offset = leaders[joint.name]
        if scale != 0.0 and _alike(joint, leader):
            ends = [(end - offset) / scale for end in (joint.lower, joint.upper)]
            low, high = ranges.get(leader.name, (-math.inf, math.inf))
            ranges[leader.name] = max(low, min(ends)), min(high, max(ends))
    drives: dict[str, Drive] = {}
    held: dict[str, str] = {}
    for joint in robot.joints:
        if joint.kind == "fixed":
            continue
        leader, scale, offset = leaders[joint.name]
        why = _why_held(joint, leader, scale, ranges, chosen)
        if why is None:
            drives[joint.name] = Drive(leader.name, scale, offset)
        else:
            held[joint.name] = why
            rest = 0.0
            if leader.kind != "fixed":
                rest = min(max(posture.get(leader.name, 0.0), leader.lower), leader.upper)
            drives[joint.name] = Drive(None, 0.0, scale * rest + offset)
    free, at_rest = {}, {}
    for name, drive in drives.items():
        if drive.by == name:
            low, high = ranges[name]
            value = posture.get(name, 0.0)
            if leaders[name][0].kind != "prismatic" and high - low >= TURN:
                low, high = -math.pi, math.pi
                # The same way round: such a joint comes back to where it was.
                value = math.remainder(value, TURN)
            free[name] = low, high
            at_rest[name] = min(max(value, low), high)
    _check_chosen(robot, chosen or (), free, held)
    return Motion(free, drives, held, at_rest)


def _leaders(robot: UrdfRobot) -> dict[str, tuple[UrdfJoint, float, float]]:
    """Return for each joint the one at the end of its mimics, with scale and offset."""
    joints = {joint.name: joint for joint in robot.joints}
    result: dict[str, tuple[UrdfJoint, float, float]] = {}
    for joint in robot.joints:
        followers = []
        here = joint
        while here.mimic is not None and here.name not in result:
            followers.append((here.name, here.mimic))
            here = joints[here.mimic.joint]
        result.setdefault(here.name, (here, 1.0, 0.0))
        for name, mimic in reversed(followers):
            leader, scale, offset = result[mimic.joint]
            scale, offset = mimic.multiplier * scale, mimic.multiplier * offset + mimic.offset
            if not (abs(scale) <= LARGEST and abs(offset) <= LARGEST):
                raise RecipeError(
                    f"{robot.source}: joint {name!r}: its mimics multiply beyond {LARGEST:g} "
                    f"(got {scale:g} times {leader.name!r} + {offset:g}); correct them."
                )
            result[name] = leader, scale, offset
    return result


def _alike(joint: UrdfJoint, leader: UrdfJoint) -> bool:
    """Return whether both turn or both slide."""
    kinds = {joint.kind, leader.kind}
    return kinds == {"prismatic"} or kinds <= {"revolute", "continuous"}


def _why_held(
    joint: UrdfJoint,
    leader: UrdfJoint,
    scale: float,
    ranges: dict[str, tuple[float, float]],
    chosen: Sequence[str] | None,
) -> str | None:
    """Return why a joint does not move, or None."""
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
    robot: UrdfRobot,
    chosen: Sequence[str],
    free: dict[str, tuple[float, float]],
    held: dict[str, str],
) -> None:
    """Refuse chosen joints that are unknown or cannot be free."""
    joints = {joint.name: joint for joint in robot.joints}
    for name in chosen:
        if name in free:
            continue
        if name not in joints:
            known = [joint.name for joint in robot.joints if joint.kind != "fixed"]
            way_out = suggestion(name, known, "use one of")
            raise RecipeError(f"{robot.source}: there is no such joint (got {name!r}); {way_out}.")
        mimic = joints[name].mimic
        why = f"follows {mimic.joint!r}" if mimic else held.get(name, "is fixed")
        raise RecipeError(
            f"{robot.source}: joint {name!r} cannot be a parameter: it {why} "
            f"(got the type {joints[name].kind}); choose another one."
        )
