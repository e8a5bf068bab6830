"""Axles that swing: joints about the way ahead that no motor holds and that carry two contacts."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lutgen.parts import Axle, Contact, way_up
from lutgen.recipe.robot import unit
from lutgen.rotation import rotation
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.links import Place

# The axle's line is within 30 deg of the way ahead.
AHEAD = math.cos(math.radians(30.0))


def swinging_axles(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> tuple[Axle, ...]:
    """Return the axles of a description that swing: the joint is revolute and has no effort.

    `where` has each link's rotation and origin; the two contacts are on either side of the pivot.
    """
    found = []
    parents = {child: joint.parent for child, joint in robot.above.items()}
    for joint in robot.joints:
        turn, hinge = where[joint.child]
        ahead = turn @ joint.axis
        if joint.effort != 0.0 or joint.kind != "revolute" or abs(ahead[0]) < AHEAD:
            continue
        carried = [one for one in contacts if joint.child in way_up(parents, one.link)]
        if len(carried) != 2:
            continue
        places = [where[one.link][1] + where[one.link][0] @ one.position for one in carried]
        sides = [float(np.cross(ahead, place - hinge)[2]) for place in places]
        if sides[0] * sides[1] < 0.0:
            axis = unit((rotation(joint.rpy) @ joint.axis).tolist())
            names = (carried[0].name, carried[1].name)
            stops = max(abs(joint.lower), abs(joint.upper))
            limit = stops if math.isfinite(stops) and stops > 0.0 else None
            found.append(Axle(joint.name, names, joint.parent, joint.origin, axis, limit))
    return tuple(found)


def held(robot: UrdfRobot, axles: Sequence[Axle]) -> UrdfRobot:
    """Return a description whose axles are held amid their swing: no parameter moves them."""
    names = {axle.name for axle in axles}
    joints = [
        replace(joint, kind="fixed") if joint.name in names else joint for joint in robot.joints
    ]
    return replace(robot, joints=tuple(joints))
