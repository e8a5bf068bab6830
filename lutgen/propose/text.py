"""Write the recipe of a robot description as TOML."""

import math
import re
import textwrap
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from lutgen.parts import Axle, Contact, Link
from lutgen.recipe.load import toml
from lutgen.recipe.rules import RESERVED
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import Couple, Motion
from lutgen.urdf.links import TOUCHING, link_contacts, links_of

# Nodes of a parameter in the sweep that is proposed, and postures of the whole; where the fewest
# nodes make more postures than `TOO_MANY`, their ends alone are proposed.
FEWEST, MOST, POSTURES, TOO_MANY = 3, 37, 5_000, 20_000
# Characters of a line of comment.
LONGEST = 100


def recipe_text(
    robot: UrdfRobot,
    motion: Motion,
    contacts: Sequence[Contact],
    warnings: Sequence[str] = (),
    axles: Sequence[Axle] = (),
) -> str:
    """Return a complete recipe, TOML, whose parameters are the free joints and the couples.

    `contacts` are in the frames of the description's links, each with a name of its own; links
    without mass and contacts, and all that hangs from them, are left out.
    """
    parameters, names = parameter_names(motion), _link_names(robot)
    units = {j.name: "m" if j.kind == "prismatic" else "deg" for j in robot.joints}
    home = {parameters[j]: _shown(motion.rest[j], units[j]) for j in motion.free}
    lines = [
        f"# From the robot description {toml(robot.name)}; its root is {toml(robot.root)}.",
        "# Check which contacts touch the ground, and which parameters matter.",
    ]
    for words in warnings:
        lines += _comment(f"Warning: {words}.")
    limits = {"upright": 80.0, "rock_angle": 30.0, "home": home or None}
    lines += [*_table("[robot]", {"name": robot.name, "length_unit": "m", **limits}), ""]
    couples = {couple.first: couple for couple in motion.couples}
    for joint, ends in motion.free.items():
        unit, name = units[joint], parameters[joint]
        low, high = (_shown(end, unit) for end in ends)
        if joint in couples:
            lines += _comment(_drives(couples[joint], unit))
        values = {"name": name, "min": low, "max": high, "unit": unit}
        lines += [*_table("[[robot.parameter]]", values), ""]
    held = {j.child: j.name for j in robot.joints if j.name in motion.held}
    carrying = carrying_links(robot, contacts)
    for link in links_of(robot, motion, parameters):
        if link.name in carrying:
            lines += _table("[[robot.link]]", _link_values(link, names))
            if name := held.get(link.name, ""):
                lines.append(f"# Held: joint {toml(name)} {motion.held[name]}.")
            lines.append("")
    notes = guesses(robot, contacts)
    told: set[tuple[str, str]] = set()
    for contact in contacts:
        note = notes.get(contact.name)
        if note is not None and (contact.link, note) not in told:
            told.add((contact.link, note))
            what = "looks" if note.startswith("a visual") else "mesh"
            lines.append(f"# Guessed from the {what} of {toml(contact.link)}: {note}.")
        values = {
            "name": contact.name,
            "link": names[contact.link],
            "position": _vector(contact.position),
            "radius": contact.radius or None,
            "axis": _vector(contact.axis) if contact.axis else None,
        }
        lines += [*_table("[[robot.contact]]", values), ""]
    for axle in axles:
        lines += _comment(f"Guessed: {axle_note(axle)}.")
        values = {
            "name": axle.name,
            "contacts": list(axle.contacts),
            "pivot": _vector(axle.pivot),
            "axis": _vector(axle.axis),
            "link": names[axle.link],
            "stops": None if axle.stops is None else _shown(axle.stops, "deg"),
        }
        lines += [*_table("[[robot.axle]]", values), ""]
    samples = None
    if parameters:
        nodes = min(max(int(POSTURES ** (1.0 / len(parameters))), FEWEST), MOST)
        # An odd number has a node in the middle.
        nodes -= 1 - nodes % 2
        nodes = nodes if nodes ** len(parameters) <= TOO_MANY else 2
        samples = dict.fromkeys(parameters.values(), nodes)
    lines += _table("[sweep]", {"samples": samples})
    gravity = {"chart": "cone", "max_tilt": 60.0, "nodes": 33}
    channels = ["sdg", "tip_angle", "height"]
    lines += _table("[sweep.gravity]", {**gravity, "channels": channels})
    return "\n".join([*lines, ""])


def _table(head: str, values: Mapping[str, object]) -> list[str]:
    return [head, *(f"{key} = {toml(one)}" for key, one in values.items() if one is not None)]


def _drives(couple: Couple, unit: str) -> str:
    drives = []
    for joint, (scale, offset) in couple.joints.items():
        shown = _shown(offset, unit)
        words = [f"times {scale:g}"] if scale != 1.0 else []
        words += [f"{shown:+.6g} {unit}"] if shown else []
        drives.append(toml(joint) + (f" ({', '.join(words)})" if words else ""))
    return f"Drives {', '.join(drives)}: {couple.why}."


def _comment(text: str) -> list[str]:
    lines = textwrap.wrap(text, LONGEST - 2, break_long_words=False, break_on_hyphens=False)
    return [f"# {line}" for line in lines]


def axle_note(axle: Axle) -> str:
    """Return what was assumed of an axle that swings."""
    one, two = axle.contacts
    return (
        f"axle {axle.name!r} swings freely with {one!r} and {two!r}, as its joint has no effort; "
        "where a motor or a lock holds it, remove it, or name the joints that move with --joint"
    )


def carrying_links(robot: UrdfRobot, contacts: Sequence[Contact]) -> set[str]:
    """Return the links with mass or contacts and those that they hang from."""
    above = robot.above
    result = {robot.root}
    for name in {link.name for link in robot.links if link.mass > 0.0} | {c.link for c in contacts}:
        while name not in result:
            result.add(name)
            name = above[name].parent
    return result


def guesses(robot: UrdfRobot, contacts: Sequence[Contact]) -> dict[str, str]:
    """Return how each contact that was recognised in a mesh was, by its name."""
    notes = {}
    for link in robot.links:
        for shape in link.collisions:
            if shape.note and shape.kind in TOUCHING:
                for one in link_contacts(replace(link, collisions=(shape,))):
                    notes[replace(one, name="")] = shape.note
    found = {contact.name: notes.get(replace(contact, name="")) for contact in contacts}
    return {name: note for name, note in found.items() if note is not None}


def _link_names(robot: UrdfRobot) -> dict[str, str]:
    """Return the recipe's name of each link: its own, but "body" for the root."""
    names = {link.name: link.name for link in robot.links}
    if "body" in names:
        # Another link of that name makes room.
        names["body"] = next(n for i in range(len(names)) if (n := f"body_{i}") not in names)
    return names | {robot.root: "body"}


def parameter_names(motion: Motion) -> dict[str, str]:
    """Return an identifier for each free joint, and for the first joint of each couple."""
    given = {couple.first: couple.name for couple in motion.couples}
    result: dict[str, str] = {}
    # Names that were given come first; a joint may be called so, too.
    for joint in sorted(motion.free, key=lambda joint: joint not in given):
        base = re.sub(r"[^A-Za-z0-9_]", "_", given.get(joint, joint))
        if not base[0].isalpha() or base in RESERVED:
            base = f"joint_{base}"
        result[joint] = unused(base, result.values())
    return {joint: result[joint] for joint in motion.free}


def unused(base: str, used: Collection[str]) -> str:
    """Return a name, with a number behind it if it is used already."""
    name, count = base, 1
    while name in used:
        count += 1
        name = f"{base}_{count}"
    return name


def _link_values(link: Link, names: Mapping[str, str]) -> dict[str, object]:
    values: dict[str, object] = {"name": names[link.name]}
    if link.mass > 0.0:
        values |= {"mass": link.mass, "com": _vector(link.com)}
        if link.shape and link.shape_at:
            values |= {"shape": _vector(link.shape), "shape_at": _vector(link.shape_at)}
    if link.parent is not None:
        rpy = [_shown(angle, "deg") for angle in link.rpy]
        values |= {"parent": names[link.parent], "origin": _vector(link.origin), "rpy": rpy}
    if (joint := link.joint) is not None:
        moves: dict[str, object] = {"type": joint.kind, "axis": _vector(joint.axis)}
        moves["parameter"] = joint.parameter
        if joint.scale != 1.0 or joint.offset:
            unit = "m" if joint.kind == "prismatic" else "deg"
            moves |= {"scale": joint.scale, "offset": _shown(joint.offset, unit)}
        values["joint"] = moves
    return values


def _shown(value: float, unit: str) -> float:
    """Return a value in its unit; 12 decimals of a degree are 2e-14 rad, of a metre 1 pm."""
    return round(math.degrees(value) if unit == "deg" else value, 12) + 0.0


def _vector(values: Sequence[float]) -> list[float]:
    return [_shown(value, "m") for value in values]
