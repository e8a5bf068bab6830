"""The links of a robot description as a recipe has them, and where they are."""

from collections.abc import Mapping

import numpy as np

from lutgen.errors import reject
from lutgen.parts import Joint, Link
from lutgen.rotation import angles, axis_rotation, rotation
from lutgen.urdf.description import UrdfJoint, UrdfRobot
from lutgen.urdf.joints import Motion
from lutgen.vector import Floats, Vector

# Rotation (3, 3) and origin (3,) of a link in the frame of the root.
Place = tuple[Floats, Floats]


def downwards(robot: UrdfRobot) -> list[UrdfJoint]:
    """Return the joints with parents before children."""
    below: dict[str, list[UrdfJoint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    result = list(below.get(robot.root, ()))
    for joint in result:
        result += below.get(joint.child, ())
    return result


def require_mass(robot: UrdfRobot) -> None:
    """Refuse a description without any mass, whose com is unknown."""
    if not any(link.mass > 0.0 for link in robot.links):
        what = "no link has a mass, so the centre of mass is unknown"
        reject(robot.source, what, "0 kg", "give the links an <inertial> with <mass>")


def links_of(robot: UrdfRobot, motion: Motion, parameters: Mapping[str, str]) -> tuple[Link, ...]:
    """Turn all links into those of a recipe (m, kg), the root first, under their own names.

    A joint held away from zero is part of its link's placement; `parameters` has the name of the
    parameter for each free joint.  Without any mass RecipeError is raised.
    """
    require_mass(robot)
    described = {link.name: link for link in robot.links}
    top = described[robot.root]
    result = [Link(top.name, mass=top.mass, com=top.com)]
    for joint in downwards(robot):
        drive = motion.drive(joint.name)
        moving = None
        origin, rpy = joint.origin, joint.rpy
        if drive.by is not None:
            kind = "prismatic" if joint.kind == "prismatic" else "revolute"
            moving = Joint(kind, joint.axis, parameters[drive.by], drive.scale, drive.offset)
        elif drive.offset != 0.0:
            turn, where = _moved(joint, drive.offset)
            origin, rpy = as_vector(where), angles(turn)
        link = described[joint.child]
        result.append(Link(link.name, joint.parent, origin, rpy, moving, link.mass, link.com))
    return tuple(result)


def places(
    robot: UrdfRobot, motion: Motion, values: Mapping[str, float] | None = None
) -> dict[str, Place]:
    """Place every link: rotation (3, 3) and origin (3,) in the frame of the root, m.

    Free joints without one of the `values` (rad or m) stand where they are at rest.
    """
    result: dict[str, Place] = {robot.root: (np.eye(3), np.zeros(3))}
    for joint in downwards(robot):
        drive = motion.drive(joint.name)
        value = drive.offset
        if drive.by is not None:
            value += drive.scale * (values or motion.rest).get(drive.by, motion.rest[drive.by])
        turn, where = result[joint.parent]
        own, origin = _moved(joint, value)
        result[joint.child] = turn @ own, where + turn @ origin
    return result


def carried(
    robot: UrdfRobot, where: Mapping[str, Place]
) -> tuple[dict[str, float], dict[str, Floats]]:
    """Return for each link mass and first moment (kg m) of it and of what hangs from it."""
    mass = {link.name: link.mass for link in robot.links}
    moment = {
        link.name: link.mass * (where[link.name][1] + where[link.name][0] @ link.com)
        for link in robot.links
    }
    for joint in reversed(downwards(robot)):
        mass[joint.parent] += mass[joint.child]
        moment[joint.parent] = moment[joint.parent] + moment[joint.child]
    return mass, moment


def centre_of_mass(robot: UrdfRobot, where: Mapping[str, Place]) -> Floats:
    """Return the com (3,) in the frame of the root, whose origin it is without any mass."""
    mass, moment = carried(robot, where)
    return moment[robot.root] / (mass[robot.root] or 1.0)


def _moved(joint: UrdfJoint, value: float) -> Place:
    turn, origin = rotation(joint.rpy), np.array(joint.origin)
    if value == 0.0 or joint.kind in ("fixed", "floating", "planar"):
        return turn, origin
    if joint.kind == "prismatic":
        return turn, origin + turn @ joint.axis * value
    return turn @ axis_rotation(joint.axis, value), origin


def as_vector(values: Floats) -> Vector:
    """Return an array (3,) as a vector of the recipe."""
    x, y, z = values.tolist()
    return x, y, z
