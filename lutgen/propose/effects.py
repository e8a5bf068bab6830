"""Find out how far joints move contacts and com, and which contacts carry nothing alone."""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from lutgen.parts import Contact
from lutgen.propose.contacts import hanging, placed, robot_size
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import Motion
from lutgen.urdf.links import Place, carried, downwards, places
from lutgen.vector import Floats

# Lengths that differ by less than this share of the robot's size are equal: descriptions round
# their angles (1.570795 for a right angle).
SAME = 1e-6


def inner_contacts(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> list[Contact]:
    """Return the contacts that never carry the robot alone: those between two others.

    A disc in the convex hull of two discs about parallel axes touches a plane only together with
    them, and between their two points: inner road wheels of a track, inner rims of twin wheels.
    The three must be rigidly connected; of equal ones all but the last are returned.
    """
    parts = {robot.root: robot.root}
    for joint in downwards(robot):
        moves = motion.drive(joint.name).by is not None
        parts[joint.child] = joint.child if moves else parts[joint.parent]
    part = np.array([parts[contact.link] for contact in contacts])
    round_ = np.array([contact.axis is not None for contact in contacts])
    radius = np.array([contact.radius for contact in contacts])
    centre, axis = placed(contacts, where)
    same = SAME * robot_size(contacts, where)
    distinct = np.ones(len(contacts), bool)
    inner = np.zeros(len(contacts), bool)
    # Equal ones first: each of them lies in the hull of the other.
    for hull in (False, True):
        for k in range(len(contacts)):
            if not distinct[k]:
                continue
            distinct[k] = False
            others = distinct & (part == part[k]) & (round_ == round_[k])
            # Parallel to within the tolerance at the rim; zero vectors of other contacts are.
            others &= radius[k] * np.linalg.norm(np.cross(axis, axis[k]), axis=1) <= same
            if hull:
                inner[k] = _between(k, np.flatnonzero(others), centre, radius, same)
                distinct[k] = True
            else:
                gaps = np.linalg.norm(centre - centre[k], axis=1) + np.abs(radius - radius[k])
                inner[k] = bool(np.any(others & (gaps <= same)))
                distinct[k] = not inner[k]
    return [contact for contact, is_inner in zip(contacts, inner, strict=True) if is_inner]


def _between(k: int, others: NDArray[np.intp], centre: Floats, radius: Floats, same: float) -> bool:
    first, second = (index.ravel() for index in np.meshgrid(others, others))
    way = centre[second] - centre[first]
    square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    t = np.clip(((centre[k] - centre[first]) * way).sum(axis=1) / square, 0.0, 1.0)
    beside = np.linalg.norm(centre[first] + t[:, None] * way - centre[k], axis=1)
    room = (1.0 - t) * radius[first] + t * radius[second] - radius[k]
    return bool(np.any((beside <= same) & (room >= -same)))


def effects(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact]
) -> dict[str, tuple[float, float]]:
    """Return how far (m) each free joint moves any contact and the com, with the rest at random.

    A wheel on its own axle moves by nothing.
    """
    rng = np.random.default_rng(0)
    values = {name: rng.uniform(low, high) for name, (low, high) in motion.free.items()}
    where = places(robot, motion, values)
    centre, axis = placed(contacts, where)
    inside = hanging(robot, contacts)
    mass, moment = carried(robot, where)
    total = mass[robot.root]
    result = dict.fromkeys(motion.free, (0.0, 0.0))
    for joint in robot.joints:
        drive = motion.drive(joint.name)
        if drive.by is None:
            continue
        low, high = motion.free[drive.by]
        span = abs(drive.scale) * (high - low)
        turn, origin = where[joint.child]
        along, members = turn @ joint.axis, inside[joint.child]
        if joint.kind == "prismatic":
            ways = (span if members else 0.0), mass[joint.child] / total * span
        else:
            # Twice the sine of half the angle: the chord.
            chord = 2.0 * math.sin(min(span, math.pi) / 2.0)
            lever = np.linalg.norm(np.cross(along, centre[members] - origin), axis=1)
            tilt = np.linalg.norm(np.cross(along, axis[members]), axis=1)
            tilt *= [contacts[i].radius for i in members]
            arm = moment[joint.child] - mass[joint.child] * origin
            com = float(np.linalg.norm(np.cross(along, arm))) / total
            ways = chord * float(max([*lever, *tilt], default=0.0)), chord * com
        before = result[drive.by]
        result[drive.by] = max(before[0], ways[0]), before[1] + ways[1]
    return result
