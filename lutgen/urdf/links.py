"""The links of a robot description as a recipe has them: where they are, and their contacts.

A sphere is a sphere, a cylinder its two rim discs, a capsule the spheres at its ends, a box its
eight corners; a mesh is what was recognised in it.
"""

import itertools
from collections.abc import Iterator, Mapping

import numpy as np

from lutgen.arrays import Floats, Vector
from lutgen.errors import reject
from lutgen.parts import Contact, Joint, Link
from lutgen.urdf.description import Collision, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.joints import Motion
from lutgen.vector import angles, axis_rotation, rotation

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

    A joint held away from zero is part of its link's placement; `parameters` names free joints'.
    A link that is one box, or one mesh that was opened, has a box for figures.
    """
    require_mass(robot)
    described = {link.name: link for link in robot.links}
    top = described[robot.root]
    sides, middle = _box(top)
    result = [Link(top.name, mass=top.mass, com=top.com, shape=sides, shape_at=middle)]
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
        seen = link.mass, link.com, *_box(link)
        result.append(Link(link.name, joint.parent, origin, rpy, moving, *seen))
    return tuple(result)


def _box(link: UrdfLink) -> tuple[Vector | None, Vector | None]:
    """Return sides and middle of a box along a link's axes about its only shape, a box or a mesh.

    None for other shapes, a mesh that was not opened and a link without mass.
    """
    if len(link.collisions) != 1 or not link.mass:
        return None, None
    (one,) = link.collisions
    if one.kind not in ("box", "mesh") or not one.size:
        return None, None
    return as_vector(np.abs(rotation(one.rpy)) @ one.size), one.origin


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


# Shapes that are taken for feet and wheels; points are what a mesh that was opened has at its foot.
TOUCHING = ("sphere", "cylinder", "capsule", "points")


def may_touch(link: UrdfLink) -> bool:
    """Return True if a link has a shape that is taken for a foot or a wheel."""
    return any(shape.kind in TOUCHING for shape in link.collisions)


def used_shapes(link: UrdfLink) -> list[Collision]:
    """Return the collision shapes that touch the ground: all but boxes, or else the boxes.

    A box between the wheels of a track is no further out than they are, where it meets the ground.
    """
    shapes = [shape for shape in link.collisions if shape.kind in TOUCHING]
    return shapes or [shape for shape in link.collisions if shape.kind == "box"]


def link_contacts(link: UrdfLink, name: str | None = None) -> list[Contact]:
    """Return the contacts of a link's collision shapes, in its frame (m), in order of the file.

    They have the given name, the link's by default; where there are several, the number of the
    shape and that of the disc, corner or point follow it.
    """
    shapes, name = used_shapes(link), name or link.name
    result = []
    for i, shape in enumerate(shapes, 1):
        first = name if len(shapes) == 1 else f"{name}_{i}"
        parts = list(_primitives(shape))
        for k, (position, radius, axis) in enumerate(parts, 1):
            full = first if len(parts) == 1 else f"{first}_{k}"
            result.append(Contact(full, link.name, position, radius, axis))
    return result


def _primitives(shape: Collision) -> Iterator[tuple[Vector, float, Vector | None]]:
    """Yield position, radius and axis; a radius of 0 makes a point."""
    turn, centre = rotation(shape.rpy), np.array(shape.origin)
    if shape.kind == "sphere":
        yield shape.origin, shape.size[0], None
    elif shape.kind in ("cylinder", "capsule"):
        radius, length = shape.size
        flat = shape.kind == "cylinder" and radius > 0.0
        for end in (0.5, -0.5):
            axis = as_vector(turn[:, 2]) if flat else None
            yield as_vector(centre + end * length * turn[:, 2]), radius, axis
    elif shape.kind == "points":
        for point in np.array(shape.size).reshape(-1, 3):
            yield as_vector(point), 0.0, None
    else:
        for corner in itertools.product((0.5, -0.5), repeat=3):
            yield as_vector(centre + turn @ (np.array(corner) * shape.size)), 0.0, None
