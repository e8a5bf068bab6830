"""Meshes, boxes and looks on which a robot stands, as shapes that a recipe has."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lutgen.arrays import Floats
from lutgen.errors import InputError
from lutgen.parts import ZERO
from lutgen.propose.contacts import NEAR, has_support, lowest_of
from lutgen.urdf.description import Collision, UrdfJoint, UrdfLink, UrdfRobot
from lutgen.urdf.feet import foot_of, wheel_of
from lutgen.urdf.joints import TURN
from lutgen.urdf.links import Place, centre_of_mass, downwards, link_contacts, may_touch
from lutgen.urdf.meshes import Meshes
from lutgen.urdf.read import JOINT_KINDS

# Share of the com's height above the ground by which one link of a leg is lower than another: the
# shank ends above the sole, and the mesh around a ball is not below the ball.
LOWER = 0.02
DRAWN = "as there is no collision shape"


@dataclass(frozen=True)
class _Link:
    """A link whose meshes were opened; heights (m) in the root's frame, or infinite.

    `corners` (n, 3) are the meshes', in its own frame; `low` is where its lowest shape ends, and
    `ball` where the lowest of its spheres and cylinders does.
    """

    link: UrdfLink
    corners: Floats
    low: float
    ball: float


def opened_meshes(
    robot: UrdfRobot, meshes: Meshes, where: Mapping[str, Place], named: Sequence[str] | None = None
) -> UrdfRobot:
    """Return the description with simple shapes for the meshes that touch the ground.

    Those of the links that are `named`, or of each chain of links the lowest, near the ground.  A
    mesh that was opened is placed as the box about it, one that cannot be read has a note why; on
    links that touch, one shape stands for all.  The visual meshes of a link without collision
    shapes serve, if it is named, or if the robot does not stand on spheres and cylinders.
    """
    found = {link.name: _open(link, meshes, where[link.name]) for link in robot.links}
    chosen = _touching(robot, found, where) if named is None else set(named)
    looks = {}
    for link in robot.links:
        visuals = tuple(shape for shape in link.visuals if shape.kind == "mesh")
        if visuals and not link.collisions and (named is None or link.name in chosen):
            looks[link.name] = replace(link, collisions=visuals)
    if named is None and not chosen and has_support(_replaced(robot, found, chosen, where), where):
        looks = {}
    found |= {name: _open(link, meshes, where[name]) for name, link in looks.items()}
    if looks and named is None:
        chosen = _touching(robot, found, where)
    # A link that touches nothing has no shapes from its looks.
    bare = {link.name: link for link in robot.links}
    for name in set(looks) - chosen:
        visuals = found[name].link.collisions
        found[name] = replace(found[name], link=replace(bare[name], visuals=visuals))
    return _replaced(robot, found, chosen, where)


def _open(link: UrdfLink, meshes: Meshes, place: Place) -> _Link:
    turn, origin = place
    shapes, parts = [], [np.zeros((0, 3))]
    for shape in link.collisions:
        if shape.kind == "mesh":
            try:
                parts.append(meshes.corners(shape))
                low, high = parts[-1].min(axis=0), parts[-1].max(axis=0)
                size, (x, y, z) = tuple((high - low).tolist()), ((low + high) / 2.0).tolist()
                shape = replace(shape, size=size, origin=(x, y, z), rpy=ZERO)
            except InputError as error:
                shape = replace(shape, note=str(error))
        shapes.append(shape)
    corners = np.unique(np.concatenate(parts), axis=0)
    simple = min((lowest_of(one, place) for one in link_contacts(link)), default=math.inf)
    lowest = float((corners @ turn[2] + origin[2]).min(initial=math.inf))
    opened = replace(link, collisions=tuple(shapes))
    return _Link(opened, corners, min(simple, lowest), simple if may_touch(link) else math.inf)


def _touching(robot: UrdfRobot, found: Mapping[str, _Link], where: Mapping[str, Place]) -> set[str]:
    """Return the links whose meshes touch: near the ground, the lowest of those above and below.

    Among links fixed to each other only the lowest counts, and none beside a ball about as low.
    """
    com = float(centre_of_mass(robot, where)[2])
    ground = min(one.low for one in found.values())
    if not ground < com:
        return set()
    allowed, near = LOWER * (com - ground), ground + NEAR * (com - ground)
    lowest = {name: one.low for name, one in found.items()}
    lows, rigid = _along_chains(robot, lowest), _along_chains(robot, lowest, ("fixed",))
    balls = _along_chains(robot, {name: one.ball for name, one in found.items()})
    return {
        name
        for name, one in found.items()
        if len(one.corners)
        and one.low <= min(near, lows[name] + allowed, rigid[name])
        and one.low < min(one.ball, balls[name]) - allowed
    }


def _along_chains(
    robot: UrdfRobot, heights: Mapping[str, float], kinds: Sequence[str] = JOINT_KINDS
) -> dict[str, float]:
    """Return for each link the least height of those above and below it, by joints of `kinds`."""
    joints = [joint for joint in downwards(robot) if joint.kind in kinds]
    above = dict.fromkeys(heights, math.inf)
    for joint in joints:
        above[joint.child] = min(above[joint.parent], heights[joint.parent])
    below = dict.fromkeys(heights, math.inf)
    for joint in reversed(joints):
        lower = min(below[joint.child], heights[joint.child])
        below[joint.parent] = min(below[joint.parent], lower)
    return {name: min(above[name], below[name]) for name in heights}


def _replaced(
    robot: UrdfRobot,
    found: Mapping[str, _Link],
    chosen: Collection[str],
    where: Mapping[str, Place],
) -> UrdfRobot:
    """Return the robot with its meshes opened, and one shape for those of each chosen link."""
    # The joint about which a link turns freely, of those that do.
    axles: dict[str, UrdfJoint] = {}
    for joint in downwards(robot):
        if joint.kind in ("continuous", "revolute") and joint.upper - joint.lower >= TURN:
            axles[joint.child] = joint
        elif joint.kind == "fixed" and joint.parent in axles:
            axles[joint.child] = axles[joint.parent]
    bare = {link.name for link in robot.links if not link.collisions}
    links = []
    for name, one in found.items():
        link = one.link
        # A link that is named for its ball has that.
        if name in chosen and len(one.corners) and one.low < one.ball:
            made = _shape(one.corners, name, axles.get(name), where)
            if name in bare:
                made = replace(made, note=f"{made.note}; a visual mesh, {DRAWN}")
            rest = [shape for shape in link.collisions if shape.kind != "mesh" or not shape.size]
            link = replace(link, collisions=(made, *rest))
        links.append(link)
    return replace(robot, links=tuple(links))


def _shape(
    corners: Floats, name: str, axle: UrdfJoint | None, where: Mapping[str, Place]
) -> Collision:
    turn, origin = where[name]
    if axle is not None:
        about, centre = where[axle.child]
        own = axle.child == name
        along = np.array(axle.axis) if own else turn.T @ about @ axle.axis
        wheel = wheel_of(corners, np.zeros(3) if own else turn.T @ (centre - origin), along)
        if wheel is not None:
            return wheel
    return foot_of(corners, -turn[2])


def with_support(robot: UrdfRobot, where: Mapping[str, Place]) -> UrdfRobot:
    """Return the description with the shapes on which it stands, of each chain the lowest.

    Where these are not spheres, cylinders and meshes, the boxes of links without these count as
    corners, and then the looks of links without collision shapes.  Boxes also count where they
    hang from a link with a sphere or cylinder and are lower than all of those: feet below shanks.
    """
    stands = has_support(robot, where)
    ways = (_cornered, lambda link: _cornered(drawn(link)))
    for dress in ways[:1] if stands else ways:
        dressed = {link.name: dress(link) for link in robot.links}
        heights = {
            name: min((lowest_of(c, where[name]) for c in link_contacts(link)), default=math.inf)
            for name, link in dressed.items()
        }
        lows = _along_chains(robot, heights)
        allowed = LOWER * (float(centre_of_mass(robot, where)[2]) - min(heights.values()))
        if stands and not _hang_lower(robot, heights, allowed):
            return robot
        links = tuple(
            dressed[link.name] if heights[link.name] <= lows[link.name] + allowed else link
            for link in robot.links
        )
        if has_support(replace(robot, links=links), where, near=True):
            return replace(robot, links=links)
    return robot


def _hang_lower(robot: UrdfRobot, heights: Mapping[str, float], allowed: float) -> bool:
    """Return True if a box is lower than all spheres and cylinders, and hangs from one of these."""
    round_ = {link.name for link in robot.links if may_touch(link)}
    hang = set(round_)
    for joint in downwards(robot):
        if joint.parent in hang:
            hang.add(joint.child)
    ground = min(heights[name] for name in round_) - allowed
    return any(heights[name] < ground for name in hang - round_)


def drawn(link: UrdfLink) -> UrdfLink:
    """Return a link with the simple shapes of its looks, if it has no collision shapes."""
    if link.collisions:
        return link
    shapes = [shape for shape in link.visuals if shape.size]
    noted = [replace(shape, note=f"a visual {shape.kind}, {DRAWN}") for shape in shapes]
    return replace(link, collisions=tuple(noted))


def _cornered(link: UrdfLink) -> UrdfLink:
    if not all(shape.kind == "box" for shape in link.collisions):
        return link
    parts = []
    for shape in link.collisions:
        corners = link_contacts(replace(link, collisions=(shape,)))
        points = tuple(x for corner in corners for x in corner.position)
        parts.append(Collision("points", points, note=shape.note))
    return replace(link, collisions=tuple(parts))
