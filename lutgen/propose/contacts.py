"""Find what touches the ground in a robot description."""

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from lutgen.errors import RecipeError, reject, suggestion
from lutgen.parts import Contact
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.links import TOUCHING, Place, centre_of_mass, downwards, link_contacts
from lutgen.vector import Floats

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
    touching = [link for link in robot.links if any(s.kind in TOUCHING for s in link.collisions)]
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
    """Return whether the com is above what would be proposed, or the part of it near the ground."""
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
    """Return whether points (n, 3) are on all sides of the com, seen from above."""
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
