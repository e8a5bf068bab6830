"""Find what touches the ground in a robot description, and how far joints move it."""

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from lutgen.arrays import Floats
from lutgen.errors import RecipeError, reject, suggestion
from lutgen.parts import Contact
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import Motion
from lutgen.urdf.links import (
    Place,
    carried,
    centre_of_mass,
    downwards,
    link_contacts,
    may_touch,
    places,
)

MAX_CANDIDATES = 200
# Share of the com's height.  Feet, wheels and flippers of real robots reach to within 7 % of it;
# rotors, antennas and sensors stay above it or near it.
NEAR = 0.25
# Share of the robot's size by which shapes may be wrong.
SLACK = 0.01
# Links that a refusal lists, and names that any other sentence does.
SHOWN, LISTED = 6, 12


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

    Where the com is not above these, the robot leans on something else: then those below the com.
    RecipeError is raised where shapes that are not understood are lower, and for more than 200.
    """
    com = centre_of_mass(robot, where)
    touching = [link for link in robot.links if may_touch(link)]
    found = [contact for link in touching for contact in link_contacts(link)]
    below = [contact for contact in found if lowest_of(contact, where[contact.link]) < com[2]]
    if below:
        _refuse_lower_shapes(robot, where, min(lowest_of(c, where[c.link]) for c in below))
    result = near_ground(robot, below, where)
    if not is_above(com, placed(result, where)[0]):
        result = below
    if len(result) > MAX_CANDIDATES:
        what = f"more than {MAX_CANDIDATES} spheres and discs lie below the centre of mass"
        got = len(result)
        reject(robot.source, what, got, "name the links that touch the ground with --contact")
    return result


def near_ground(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> list[Contact]:
    """Return the contacts of links that reach within `NEAR` of the com's height of the lowest."""
    lowest = [lowest_of(contact, where[contact.link]) for contact in contacts]
    ground = min(lowest, default=0.0)
    limit = ground + NEAR * (float(centre_of_mass(robot, where)[2]) - ground)
    links = {one.link for one, low in zip(contacts, lowest, strict=True) if low <= limit}
    return [contact for contact in contacts if contact.link in links]


def lower_links(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> list[str]:
    """Return the links whose shapes reach below all contacts: the robot would lie on these.

    Below by more than `SLACK`, the frame of the root level; links with contacts do not count.
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


def has_support(robot: UrdfRobot, where: Mapping[str, Place], near: bool = False) -> bool:
    """Return True if the com is above what would be proposed, or the part of it near the ground."""
    try:
        found = proposed_contacts(robot, where)
    except RecipeError:
        return False
    found = near_ground(robot, found, where) if near else found
    return is_above(centre_of_mass(robot, where), placed(found, where)[0])


def refuse_bolted(
    robot: UrdfRobot, contacts: Sequence[Contact], where: Mapping[str, Place]
) -> None:
    """Raise RecipeError for an arm or a hand: the com is not above its lowest limb, or its root."""
    near = near_ground(robot, contacts, where)
    limbs = {robot.root: robot.root}
    for joint in downwards(robot):
        begins = limbs[joint.parent] == robot.root and joint.kind not in ("fixed", "floating")
        limbs[joint.child] = joint.child if begins else limbs[joint.parent]
    on = {limbs[contact.link] for contact in near}
    names = ", ".join(dict.fromkeys(contact.link for contact in near)) or "no sphere or cylinder"
    if len(on) < 2 and not is_above(centre_of_mass(robot, where), placed(near, where)[0]):
        raise RecipeError(
            f"{robot.source}: nothing stands on the ground: the centre of mass is not above what "
            f"is lowest in this posture (got {names}), as of an arm or a hand that is bolted down; "
            "name what touches the ground with --contact, or another posture with --posture or -p."
        )


def _refuse_lower_shapes(robot: UrdfRobot, where: Mapping[str, Place], ground: float) -> None:
    """Refuse a proposal that would have the robot stand on its hands: its feet are unknown."""
    lower = []
    for link in robot.links:
        turn, origin = where[link.name]
        heights = [(origin + turn @ s.origin)[2] for s in link.collisions if not s.size]
        if min(heights, default=ground) < ground:
            lower.append((min(heights), link.name))
    if lower:
        names = [name for _, name in sorted(lower, key=lambda one: one[0])]
        raise RecipeError(
            f"{robot.source}: links with meshes or shapes that were not understood are below all "
            f"spheres and cylinders (got {closed_shapes(robot, names)}); give points on the feet: "
            "--contact 'LINK=X,Y,Z[,RADIUS]'."
        )


def closed_shapes(robot: UrdfRobot, names: Sequence[str] | None = None) -> str:
    """Return the first links, of all or those named, with shapes of unknown size, and why."""
    links = {link.name: link for link in robot.links}
    reasons: dict[str, list[str]] = {}
    for name in links if names is None else names:
        notes = [shape.note for shape in links[name].collisions if not shape.size]
        notes += [shape.note for shape in links[name].visuals if not shape.size and shape.note]
        for note in notes[:1]:
            reasons.setdefault(note, []).append(name)
    return "; ".join(
        listed(those, SHOWN) + (f": {note}" if note else "") for note, those in reasons.items()
    )


def listed(names: Collection[str], most: int = LISTED) -> str:
    """Return names with commas, the first of them if they are many."""
    first, rest = [*names][:most], [*names][most:]
    return ", ".join(first) + (f" and {len(rest)} more" if rest else "")


def is_above(com: Floats, points: Floats) -> bool:
    """Return True if points (n, 3) are on all sides of the com, seen from above."""
    away = points[:, :2] - com[:2]
    around = np.sort(np.arctan2(away[:, 1], away[:, 0]))
    if len(around) < 3:
        return False
    gaps = np.diff(around, append=around[0] + 2.0 * math.pi)
    return bool(gaps.max() < math.pi)


def hanging(robot: UrdfRobot, contacts: Sequence[Contact]) -> dict[str, list[int]]:
    """Return for each link which contacts are on it and on what hangs from it, by their places."""
    found: dict[str, list[int]] = {link.name: [] for link in robot.links}
    for i, contact in enumerate(contacts):
        found[contact.link].append(i)
    for joint in reversed(downwards(robot)):
        found[joint.parent] = sorted(found[joint.parent] + found[joint.child])
    return found


def robot_size(contacts: Sequence[Contact], where: Mapping[str, Place]) -> float:
    """Return the largest extent of the contacts along an axis at rest, wheels included (m)."""
    centre, _ = placed(contacts, where)
    radius = np.array([contact.radius for contact in contacts])[:, None]
    return float(((centre + radius).max(axis=0) - (centre - radius).min(axis=0)).max())


def placed(contacts: Sequence[Contact], where: Mapping[str, Place]) -> tuple[Floats, Floats]:
    """Return centres and axes (n, 3) in the frame of the root; no axis is a zero vector."""
    centre, axis = np.zeros((len(contacts), 3)), np.zeros((len(contacts), 3))
    for i, contact in enumerate(contacts):
        turn, origin = where[contact.link]
        centre[i] = origin + turn @ contact.position
        if contact.axis is not None:
            axis[i] = turn @ contact.axis
    return centre, axis


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
    # Parallel to within the tolerance at the rim; zero vectors of other contacts are.
    lean = np.linalg.norm(np.cross(axis[:, None], axis), axis=2)
    alike = (part[:, None] == part) & (round_[:, None] == round_)
    alike &= radius[:, None] * lean <= same
    apart = np.linalg.norm(centre[:, None] - centre, axis=2) + np.abs(radius[:, None] - radius)
    # Equal ones first: each of them lies in the hull of the other.
    inner = np.triu(alike & (apart <= same), 1).any(axis=1)
    alike &= ~inner
    np.fill_diagonal(alike, False)
    for k in np.flatnonzero(~inner).tolist():
        inner[k] = _between(k, np.flatnonzero(alike[k]), centre, radius, same)
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
