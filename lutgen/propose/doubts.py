"""Find what may make a robot less stable than its description: mistakes, free joints.

Axles that swing are joints about the way ahead that no motor holds and that carry two contacts.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from lutgen.parts import Axle, Contact
from lutgen.propose.contacts import hanging, placed
from lutgen.recipe import Recipe
from lutgen.recipe.model import unit
from lutgen.urdf.description import Collision, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.joints import TURN, read_motion
from lutgen.urdf.links import Place, places
from lutgen.urdf.read import parse_urdf
from lutgen.vector import rotation

# The axle's line is within 30 deg of the way ahead.
AHEAD = math.cos(math.radians(30.0))


def swinging_axles(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> tuple[Axle, ...]:
    """Return the axles of a description that swing: the joint is revolute and has no effort.

    `where` has each link's rotation and origin; the two contacts are on either side of the pivot.
    """
    found = []
    inside, centre = hanging(robot, contacts), placed(contacts, where)[0]
    for joint in robot.joints:
        turn, hinge = where[joint.child]
        ahead, carried = turn @ joint.axis, inside[joint.child]
        if joint.effort != 0.0 or joint.kind != "revolute" or abs(ahead[0]) < AHEAD:
            continue
        sides = np.cross(ahead, centre[carried] - hinge)[:, 2]
        if len(carried) == 2 and sides[0] * sides[1] < 0.0:
            axis = unit((rotation(joint.rpy) @ joint.axis).tolist())
            names = (contacts[carried[0]].name, contacts[carried[1]].name)
            stops = max(abs(joint.lower), abs(joint.upper))
            limit = stops if math.isfinite(stops) and stops > 0.0 else None
            found.append(Axle(joint.name, names, joint.parent, joint.origin, axis, limit))
    return tuple(found)


# A shape so many times larger than what the joints span is in another unit.
UNITS = 100.0
# A com this many times the size of its link away from it is a mistake, if it is also this share of
# the robot's size away.
AWAY, SHARE = 3.0, 0.5
# A turn, and more than joints of published robots have, rad: of these some have 20 between limits.
MORE, DEGREES = TURN + 0.01, 2.0 * TURN


def recipe_doubts(recipe: Recipe) -> tuple[str, ...]:
    """Return the doubts about the description of a recipe, its joints at zero; () without one."""
    if recipe.urdf is None:
        return ()
    robot = parse_urdf(recipe.urdf, recipe.source)
    carried = {name for axle in recipe.axles for name in axle.contacts}
    loose = [contact for contact in recipe.contacts if contact.name not in carried]
    return doubts(robot, loose, places(robot, read_motion(robot)))


def doubts(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> tuple[str, ...]:
    """Return a sentence for each thing that looks like a mistake in the posture `where`."""
    origins = np.array([origin for _, origin in where.values()])
    coms = [np.abs(link.com).max() for link in robot.links]
    joints = float(np.ptp(origins, axis=0).max())
    span = max(joints, float(max(coms)))
    found = []
    for link in robot.links:
        large = max((_reach(shape) for shape in link.collisions), default=0.0)
        if 0.0 < UNITS * span < large:
            found.append(
                f"link {link.name!r}: its shapes reach {large:.4g} m, {large / span:.0f} times as "
                "far as joints and centres of mass: if they are in millimetres, write scale="
                "'0.001 0.001 0.001' at <mesh>"
            )
        off = _off(link, joints)
        if off:
            found.append(
                f"link {link.name!r}: its centre of mass is {off:.4g} m away from its shapes: "
                "check the <origin> of its <inertial>"
            )
    turned = [f"link {k.name!r}" for k in robot.links if any(map(_turned, k.collisions))]
    turned += [f"joint {joint.name!r}" for joint in robot.joints if _turned(joint)]
    if turned:
        found.append(f"{', '.join(turned)}: rpy is in rad, and more than a turn looks like degrees")
    return (*found, *_limits(robot), *_loose(robot, contacts, where))


def _limits(robot: UrdfRobot) -> list[str]:
    most = {
        joint.name: max((abs(x) for x in (joint.lower, joint.upper) if math.isfinite(x)), default=0)
        for joint in robot.joints
        if joint.kind == "revolute"
    }
    if max(most.values(), default=0.0) <= DEGREES:
        return []
    names = ", ".join(repr(name) for name, value in most.items() if value > MORE)
    return [f"joint {names}: limits are in rad, and more than a turn looks like degrees"]


def _turned(part: Collision | UrdfJoint) -> bool:
    return max(map(abs, part.rpy)) > MORE


def _reach(shape: Collision) -> float:
    """Return a bound on how far a shape reaches from its link's origin, m."""
    return max(map(abs, (*shape.size, *shape.origin)), default=0.0)


def _off(link: UrdfLink, span: float) -> float:
    shapes = [shape for shape in (*link.collisions, *link.visuals) if shape.size]
    if link.mass <= 0.0 or not shapes or len(shapes) < len(link.collisions):
        return 0.0
    size = max(map(_reach, shapes))
    away = math.hypot(*link.com) - size
    return away if away > AWAY * size and away > SHARE * span else 0.0


def _loose(robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]) -> list[str]:
    """Return the joints that no motor holds though contacts hang from them."""
    inside, centre, found = hanging(robot, contacts), placed(contacts, where)[0], []
    for joint in robot.joints:
        about, hinge = where[joint.child]
        levers = np.cross(about @ joint.axis, centre[inside[joint.child]] - hinge)
        moved = len(levers) > 0 and joint.kind == "prismatic"
        if joint.effort == 0.0 and (
            moved or np.linalg.norm(levers, axis=1).max(initial=0.0) > 1e-6
        ):
            found.append(repr(joint.name))
    if not found:
        return []
    return [
        f"joint {', '.join(found)}: effort is 0, and contacts hang from it: if nothing "
        "holds it, the robot tips earlier than is said; write two contacts on a free pivot as a "
        "[[robot.axle]]"
    ]
