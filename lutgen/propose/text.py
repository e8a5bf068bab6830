"""Write the recipe of a robot description as TOML."""

import json
import math
import re
import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace

from lutgen.parts import Contact, Link
from lutgen.recipe.rules import RESERVED
from lutgen.urdf import TOUCHING, Couple, Motion, UrdfRobot, link_contacts, links_of

# Nodes of a parameter in the sweep that is proposed, and postures of the whole; where the fewest
# nodes make more postures than `TOO_MANY`, their ends alone are proposed.
FEWEST, MOST, POSTURES, TOO_MANY = 3, 37, 5_000, 20_000
# Characters of a line of comment.
LONGEST = 100


def recipe_text(
    robot: UrdfRobot, motion: Motion, contacts: Sequence[Contact], warnings: Sequence[str] = ()
) -> str:
    """Return a complete recipe, TOML, whose parameters are the free joints and the couples.

    `contacts` are in the frames of the description's links, each with a name of its own; links
    without mass and contacts, and all that hangs from them, are left out.
    """
    parameters = parameter_names(motion)
    names = _link_names(robot)
    units = {j.name: "m" if j.kind == "prismatic" else "deg" for j in robot.joints}
    home = [f"{parameters[j]} = {_shown(motion.rest[j], units[j])!r}" for j in motion.free]
    lines = [
        f"# From the robot description {_quoted(robot.name)}; its root is {_quoted(robot.root)}.",
        "# Check which contacts touch the ground, and which parameters matter.",
        *(line for words in warnings for line in _comment(f"Warning: {words}.")),
        "[robot]",
        f"name = {_quoted(robot.name)}",
        'length_unit = "m"',
        "upright = 80.0",
        "rock_angle = 30.0",
        *([f"home = {{ {', '.join(home)} }}"] if home else []),
        "",
    ]
    couples = {couple.first: couple for couple in motion.couples}
    for joint, ends in motion.free.items():
        low, high = (_shown(end, units[joint]) for end in ends)
        lines += _couple_lines(couples[joint], units[joint]) if joint in couples else []
        lines += ["[[robot.parameter]]", f'name = "{parameters[joint]}"']
        lines += [f"min = {low!r}", f"max = {high!r}", f'unit = "{units[joint]}"', ""]
    held = {j.child: j.name for j in robot.joints if j.name in motion.held}
    carrying = carrying_links(robot, contacts)
    for link in links_of(robot, motion, parameters):
        if link.name in carrying:
            lines += _link_lines(link, names)
            if joint := held.get(link.name, ""):
                lines.append(f"# Held: joint {_quoted(joint)} {motion.held[joint]}.")
            lines.append("")
    notes = guesses(robot, contacts)
    told: set[tuple[str, str]] = set()
    for contact in contacts:
        note = notes.get(contact.name)
        if note is not None and (contact.link, note) not in told:
            told.add((contact.link, note))
            what = "looks" if note.startswith("a visual") else "mesh"
            lines.append(f"# Guessed from the {what} of {_quoted(contact.link)}: {note}.")
        lines += ["[[robot.contact]]", f"name = {_quoted(contact.name)}"]
        lines += [f"link = {_quoted(names[contact.link])}"]
        lines += [f"position = {_vector(contact.position)}"]
        lines += [f"radius = {contact.radius!r}"] if contact.radius else []
        lines += [f"axis = {_vector(contact.axis)}"] if contact.axis else []
        lines += [""]
    lines.append("[sweep]")
    if parameters:
        nodes = min(max(int(POSTURES ** (1.0 / len(parameters))), FEWEST), MOST)
        # An odd number has a node in the middle.
        nodes -= 1 - nodes % 2
        nodes = nodes if nodes ** len(parameters) <= TOO_MANY else 2
        samples = ", ".join(f"{name} = {nodes}" for name in parameters.values())
        lines.append(f"samples = {{ {samples} }}")
    lines += ["[sweep.gravity]", 'chart = "cone"', "max_tilt = 60.0", "nodes = 33"]
    return "\n".join([*lines, 'channels = ["sdg", "tip_angle", "height"]', ""])


def _couple_lines(couple: Couple, unit: str) -> list[str]:
    """Return which joints a parameter drives, as a comment."""
    drives = []
    for joint, (scale, offset) in couple.joints.items():
        shown = _shown(offset, unit)
        words = [f"times {scale:g}"] if scale != 1.0 else []
        words += [f"{shown:+.6g} {unit}"] if shown else []
        drives.append(_quoted(joint) + (f" ({', '.join(words)})" if words else ""))
    return _comment(f"Drives {', '.join(drives)}: {couple.why}.")


def _comment(text: str) -> list[str]:
    """Return a sentence as lines of comment."""
    lines = textwrap.wrap(text, LONGEST - 2, break_long_words=False, break_on_hyphens=False)
    return [f"# {line}" for line in lines]


def carrying_links(robot: UrdfRobot, contacts: Sequence[Contact]) -> set[str]:
    """Return the links with mass or contacts and those that they hang from."""
    parents = {joint.child: joint.parent for joint in robot.joints}
    result = {robot.root}
    for name in {link.name for link in robot.links if link.mass > 0.0} | {c.link for c in contacts}:
        while name not in result:
            result.add(name)
            name = parents[name]
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
    # Names that were asked for come first; a joint may be called so, too.
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


def _link_lines(link: Link, names: Mapping[str, str]) -> Iterator[str]:
    """Yield a link and how it is attached."""
    yield "[[robot.link]]"
    yield f"name = {_quoted(names[link.name])}"
    if link.mass > 0.0:
        yield f"mass = {link.mass!r}"
        yield f"com = {_vector(link.com)}"
    if link.parent is not None:
        yield f"parent = {_quoted(names[link.parent])}"
        yield f"origin = {_vector(link.origin)}"
        yield f"rpy = {[_shown(angle, 'deg') for angle in link.rpy]}"
    if (joint := link.joint) is not None:
        unit = "m" if joint.kind == "prismatic" else "deg"
        moving = f'type = "{joint.kind}", axis = {_vector(joint.axis)}'
        moving += f', parameter = "{joint.parameter}"'
        if joint.scale != 1.0 or joint.offset:
            moving += f", scale = {joint.scale!r}, offset = {_shown(joint.offset, unit)!r}"
        yield f"joint = {{ {moving} }}"


def _shown(value: float, unit: str) -> float:
    """Return a value in its unit; 12 decimals of a degree are 2e-14 rad, of a metre 1 pm."""
    return round(math.degrees(value) if unit == "deg" else value, 12) + 0.0


def _vector(values: Sequence[float]) -> list[float]:
    """Return lengths or a direction without the last digits' noise."""
    return [_shown(value, "m") for value in values]


def _quoted(text: str) -> str:
    """Return a TOML string."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
