"""What of a robot description matters for standing: its contacts and the joints that move them.

Owns the rules by which a recipe is proposed where nobody said which links touch the ground and
which joints change the robot's shape.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from lutgen.errors import RecipeError, suggestion
from lutgen.parts import Contact
from lutgen.urdf import (
    TOUCHING,
    Collision,
    Motion,
    Place,
    UrdfRobot,
    centre_of_mass,
    downwards,
    link_contacts,
    places,
)
from lutgen.vector import Floats

MAX_CANDIDATES = 200
# Share of the com's height.  Of real robots feet, wheels and flippers reach to within 7 % of it,
# rotors, antennas and sensors stay above it or near it.
NEAR = 0.25
# Share of the robot's size by which shapes may be wrong.
SLACK = 0.01
# Links that a refusal lists.
SHOWN = 6
# Lengths that differ by less than this share of the robot's size are equal: descriptions round
# their angles (1.570795 for a right angle).
SAME = 1e-6


def named_contacts(robot: UrdfRobot, names: Sequence[str]) -> list[Contact]:
    """Return the contacts of links; a link that is unknown or has none raises RecipeError."""
    links = {link.name: link for link in robot.links}
    result = []
    for name in dict.fromkeys(names):
        if name not in links:
            way_out = suggestion(name, links, "use one of")
            raise RecipeError(f"{robot.source}: there is no such link (got {name!r}); {way_out}.")
        made = link_contacts(links[name])
        if not made:
            kinds = ", ".join(shape.kind for shape in links[name].collisions) or "no collision"
            raise RecipeError(
                f"{robot.source}: link {name!r} has no collision sphere, cylinder or box (got "
                f"{kinds}); give its contacts as points: --contact '{name}=X,Y,Z'."
            )
        result += made
    return result


def proposed_contacts(robot: UrdfRobot, where: Mapping[str, Place]) -> list[Contact]:
    """Return the spheres, rim discs and points near the ground, in the posture of these places.

    The ground is where the lowest of them is; near are those whose lowest point lies within a
    quarter of the com's height above it, and all others below the com on the same link.  Where
    the com is not above these, the robot leans on something else: then those below the com.
    RecipeError is raised where meshes that were not opened are lower than all of them, and for more
    than 200.
    """
    com = centre_of_mass(robot, where)
    below: list[tuple[float, Contact]] = []
    for link in robot.links:
        if any(shape.kind in TOUCHING for shape in link.collisions):
            for contact in link_contacts(link):
                lowest = lowest_of(contact, where[link.name])
                if lowest < com[2]:
                    below.append((lowest, contact))
    if below:
        _refuse_lower_meshes(robot, where, min(lowest for lowest, _ in below))
    result = near_ground(robot, [contact for _, contact in below], where)
    if not is_above(com, placed(result, where)[0]):
        result = [contact for _, contact in below]
    if len(result) > MAX_CANDIDATES:
        raise RecipeError(
            f"{robot.source}: more than {MAX_CANDIDATES} spheres and discs lie below the centre of "
            f"mass (got {len(result)}); name the links that touch the ground with --contact."
        )
    return result


def near_ground(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> list[Contact]:
    """Return the contacts of links whose lowest point is near that of all.

    Within a quarter of the com's height above it.
    """
    lowest = [lowest_of(contact, where[contact.link]) for contact in contacts]
    ground = min(lowest, default=0.0)
    limit = ground + NEAR * (float(centre_of_mass(robot, where)[2]) - ground)
    links = {one.link for one, low in zip(contacts, lowest, strict=True) if low <= limit}
    return [contact for contact in contacts if contact.link in links]


def lower_links(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> list[str]:
    """Return the links whose shapes reach below all contacts: the robot would lie on these.

    Below by more than 1 % of the robot's size, the frame of the root level; links with contacts
    and meshes do not count.
    """
    touching = {contact.link for contact in contacts}
    ground = min(lowest_of(contact, where[contact.link]) for contact in contacts)
    ground -= SLACK * robot_size(contacts, where)
    return [
        link.name
        for link in robot.links
        if link.name not in touching
        and any(lowest_of(part, where[link.name]) < ground for part in link_contacts(link))
    ]


def lowest_of(contact: Contact, place: Place) -> float:
    """Return the height of a contact's lowest point in the frame of the root."""
    turn, origin = place
    reach = contact.radius
    if contact.axis is not None:
        reach *= math.sqrt(max(0.0, 1.0 - float(turn[2] @ contact.axis) ** 2))
    return float((origin + turn @ contact.position)[2]) - reach


def _refuse_lower_meshes(robot: UrdfRobot, where: Mapping[str, Place], ground: float) -> None:
    """Refuse a proposal that would have the robot stand on its hands: its feet are meshes."""
    lower = []
    for link in robot.links:
        turn, origin = where[link.name]
        heights = [(origin + turn @ s.origin)[2] for s in link.collisions if _is_closed(s)]
        if min(heights, default=ground) < ground:
            lower.append((min(heights), link.name))
    if lower:
        names = [name for _, name in sorted(lower, key=lambda one: one[0])]
        raise RecipeError(
            f"{robot.source}: links with meshes or shapes that were not understood are below all "
            f"spheres and cylinders (got {closed_meshes(robot, names)}); give points on the feet: "
            "--contact 'LINK=X,Y,Z[,RADIUS]'."
        )


def closed_meshes(robot: UrdfRobot, names: Sequence[str] | None = None) -> str:
    """Return the links with meshes that were not opened, the first of them, and why the first.

    Of all links, or of those named, in their order; empty where there is none.
    """
    links = {link.name: link for link in robot.links}
    closed = {
        name: [s.note for s in links[name].collisions if _is_closed(s)]
        + [s.note for s in links[name].visuals if _is_closed(s) and s.note]
        for name in (links if names is None else names)
    }
    reasons: dict[str, list[str]] = {}
    for name, notes in closed.items():
        for note in notes[:1]:
            reasons.setdefault(note, []).append(name)
    parts = []
    for note, those in reasons.items():
        shown = ", ".join(those[:SHOWN])
        shown += f" and {len(those) - SHOWN} more" if len(those) > SHOWN else ""
        parts.append(f"{shown}: {note}" if note else shown)
    return "; ".join(parts)


def _is_closed(shape: Collision) -> bool:
    """Return whether nobody knows a shape: it is of an unknown kind, or a mesh without a size."""
    return not shape.size


def has_support(robot: UrdfRobot, where: Mapping[str, Place]) -> bool:
    """Return whether the com is above the spheres, cylinders and points that would be proposed."""
    try:
        found = proposed_contacts(robot, where)
    except RecipeError:
        return False
    return is_above(centre_of_mass(robot, where), placed(found, where)[0])


def is_above(com: Floats, points: Floats) -> bool:
    """Return whether points (n, 3) are on all sides of the com, seen from above."""
    away = points[:, :2] - com[:2]
    around = np.sort(np.arctan2(away[:, 1], away[:, 0]))
    if len(around) < 3:
        return False
    gaps = np.diff(around, append=around[0] + 2.0 * math.pi)
    return bool(gaps.max() < math.pi)


def unique_names(contacts: Sequence[Contact]) -> list[Contact]:
    """Return the contacts with a number behind names that were there before."""
    used: set[str] = set()
    result = []
    for contact in contacts:
        name, count = contact.name, 1
        while name in used:
            count += 1
            name = f"{contact.name}_{count}"
        used.add(name)
        result.append(replace(contact, name=name))
    return result


def inner_contacts(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> list[Contact]:
    """Return the contacts that never carry the robot alone: those between two others.

    A disc in the convex hull of two discs about parallel axes touches a plane only together with
    them, and between their two points, so that no support polygon changes without it: the road
    wheels of a track but the first and the last, if they stand in a line, and the inner rims of
    a pair of wheels.  The same for spheres and points.  The three must be rigidly connected; of
    equal ones all but the last are returned.
    """
    parts = _rigid_parts(robot, motion)
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
    """Return whether a contact lies in the hull of two of the others."""
    first, second = (index.ravel() for index in np.meshgrid(others, others))
    way = centre[second] - centre[first]
    square = np.maximum((way**2).sum(axis=1), np.finfo(float).tiny)
    t = np.clip(((centre[k] - centre[first]) * way).sum(axis=1) / square, 0.0, 1.0)
    beside = np.linalg.norm(centre[first] + t[:, None] * way - centre[k], axis=1)
    room = (1.0 - t) * radius[first] + t * radius[second] - radius[k]
    return bool(np.any((beside <= same) & (room >= -same)))


def robot_size(contacts: Sequence[Contact], where: Mapping[str, Place]) -> float:
    """Return the largest extent of the contacts along an axis at rest, wheels included (m)."""
    centre, _ = placed(contacts, where)
    radius = np.array([contact.radius for contact in contacts])[:, None]
    return float(((centre + radius).max(axis=0) - (centre - radius).min(axis=0)).max())


def effects(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact]
) -> dict[str, tuple[float, float]]:
    """Return how far each free joint moves the contacts and the com at most.

    Bounds (m) on the way of a contact point that is fixed in its link, 0 for a wheel on its own
    axle, and on the way of the com, from one end of the joint's range to the other with all other
    joints at random values: a joint may move something in such a posture only.
    """
    rng = np.random.default_rng(0)
    values = {name: rng.uniform(low, high) for name, (low, high) in motion.free.items()}
    where = places(robot, motion, values)
    total = math.fsum(link.mass for link in robot.links)
    centre, axis = placed(contacts, where)
    inside = _below(robot, contacts)
    moment, mass = _carried(robot, where)
    result = dict.fromkeys(motion.free, (0.0, 0.0))
    for joint in robot.joints:
        drive = motion.drive(joint.name)
        if drive.by is None:
            continue
        low, high = motion.free[drive.by]
        span = abs(drive.scale) * (high - low)
        turn, origin = where[joint.child]
        along, share = turn @ joint.axis, mass[joint.child] / total if total > 0.0 else 0.0
        members = inside.get(joint.child, [])
        if joint.kind == "prismatic":
            ways = (span if members else 0.0), share * span
        else:
            # Twice the sine of half the angle: the chord.
            chord = 2.0 * math.sin(min(span, math.pi) / 2.0)
            lever = np.linalg.norm(np.cross(along, centre[members] - origin), axis=1)
            tilt = np.linalg.norm(np.cross(along, axis[members]), axis=1)
            tilt *= [contacts[i].radius for i in members]
            arm = moment[joint.child] - mass[joint.child] * origin
            com = float(np.linalg.norm(np.cross(along, arm))) / total if total > 0.0 else 0.0
            ways = chord * float(max([*lever, *tilt], default=0.0)), chord * com
        before = result[drive.by]
        result[drive.by] = max(before[0], ways[0]), before[1] + ways[1]
    return result


def placed(contacts: Sequence[Contact], where: Mapping[str, Place]) -> tuple[Floats, Floats]:
    """Return centres and axes (n, 3) in the frame of the root; no axis is a zero vector."""
    centre, axis = np.zeros((len(contacts), 3)), np.zeros((len(contacts), 3))
    for i, contact in enumerate(contacts):
        turn, origin = where[contact.link]
        centre[i] = origin + turn @ contact.position
        if contact.axis is not None:
            axis[i] = turn @ contact.axis
    return centre, axis


def _below(robot: UrdfRobot, contacts: Sequence[Contact]) -> dict[str, list[int]]:
    """Return for each link the contacts on it and on what hangs from it."""
    above = {joint.child: joint.parent for joint in robot.joints}
    result: dict[str, list[int]] = {}
    for i, contact in enumerate(contacts):
        here: str | None = contact.link
        while here is not None:
            result.setdefault(here, []).append(i)
            here = above.get(here)
    return result


def _carried(
    robot: UrdfRobot, where: Mapping[str, Place]
) -> tuple[dict[str, Floats], dict[str, float]]:
    """Return for each link first moment (kg m) and mass of it and of what hangs from it."""
    moment, mass = {}, {}
    for link in robot.links:
        turn, origin = where[link.name]
        mass[link.name] = link.mass
        moment[link.name] = link.mass * (origin + turn @ link.com)
    for joint in reversed(downwards(robot)):
        mass[joint.parent] += mass[joint.child]
        moment[joint.parent] = moment[joint.parent] + moment[joint.child]
    return moment, mass


def _rigid_parts(robot: UrdfRobot, motion: Motion) -> dict[str, str]:
    """Return for each link the first link of the part that moves as one."""
    result = {robot.root: robot.root}
    for joint in downwards(robot):
        moves = motion.drive(joint.name).by is not None
        result[joint.child] = joint.child if moves else result[joint.parent]
    return result
