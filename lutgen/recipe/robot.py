"""The [robot] part of a recipe: parameters, links, joints, contacts and wheels.

Dataclasses with every angle in radians, and the rules that a robot must keep.  How a
robot moves is not known here (`kinematics`), nor how it is sampled (`recipe`).
"""

import math
import re
from collections.abc import Callable
from dataclasses import replace

from lutgen.errors import suggestion
from lutgen.parts import (
    ZERO,
    Contact,
    Joint,
    Link,
    Parameter,
    Vector,
    Wheel,
    parents_first,
    to_internal,
)
from lutgen.quantities import CHANNELS
from lutgen.recipe.keys import names
from lutgen.recipe.robot_keys import ANGLE_UNITS, IDENTIFIER, JOINT_TYPES, MAX_CONTACTS
from lutgen.recipe.table import Table

# Names of a map file's other dimensions and variables, which no parameter may take.
RESERVED = ("face", "v", "u", *CHANNELS)


def read_parameters(robot: Table, length_unit: str) -> tuple[Parameter, ...]:
    """Read ``[[robot.parameter]]`` in order."""
    result: list[Parameter] = []
    taken: set[str] = set()
    for table in robot.tables("parameter", names("robot.parameter")):
        if "urdf" not in robot:
            table.refuse(("joint",), "means nothing without `robot.urdf`", "remove it")
            way_out = "give links that share the parameter a joint with a scale each"
            table.refuse(("drive",), "means nothing without `robot.urdf`", way_out)
        name = table.new_name("parameter", taken)
        taken.add(name)
        if not re.fullmatch(IDENTIFIER, name):
            table.fail("name", "is not an identifier", name, "use letters, digits and _ only")
        if name in RESERVED:
            table.fail("name", "is reserved for the map file", name, "choose another name")
        units = (*ANGLE_UNITS, length_unit)
        unit = table.string("unit", f"use one of: {', '.join(units)}")
        if unit not in units:
            way_out = f"use one of: {', '.join(units)}"
            table.fail("unit", "is neither an angle nor the robot's length_unit", unit, way_out)
        low = table.number("min", f"write a number in {unit}")
        high = table.number("max", f"write a number in {unit}")
        if not low < high:
            table.fail("min", f"must be below max = {high:g}", low, "swap or widen the limits")
        result.append(
            Parameter(
                name,
                to_internal(low, unit),
                to_internal(high, unit),
                "rad" if unit in ANGLE_UNITS else unit,
                unit,
            )
        )
    return tuple(result)


def read_home(robot: Table, parameters: tuple[Parameter, ...]) -> dict[str, float]:
    """Read `home`, the posture to stand in: values (rad or length) of some or all parameters."""
    if "home" not in robot:
        return {}
    names = [p.name for p in parameters]
    table = robot.table("home", names, "write home = { name = value }")
    result = {}
    for p in parameters:
        if p.name in table:
            number = table.number(p.name, f"write a number in {p.display_unit}")
            result[p.name] = p.stored(number)
            if not p.minimum <= result[p.name] <= p.maximum:
                what = "lies outside the parameter's min and max"
                table.fail(p.name, what, number, "widen the limits or correct the posture")
    return result


def read_links(robot: Table, parameters: tuple[Parameter, ...]) -> tuple[Link, ...]:
    """Read ``[[robot.link]]``; "body" comes first unless the recipe declares it itself."""
    tables = robot.tables("link", names("robot.link"))
    links: list[Link] = []
    taken: set[str] = set()
    for table in tables:
        name = table.new_name("link", taken)
        taken.add(name)
        mass = table.number("mass", "write a mass in any unit", 0.0)
        if mass < 0.0:
            table.fail("mass", "must not be negative", mass, "write a mass of 0 or more")
        if "mass" not in table:
            table.refuse(("com",), "changes nothing without a mass", "give mass too")
        com = table.vector("com", "write [x, y, z] in the link's frame", ZERO)
        if name == "body":
            placement = ("parent", "origin", "rpy", "joint")
            table.refuse(placement, "is not allowed for the root link", "remove it")
            links.append(Link(name, mass=mass, com=com))
            continue
        parent = table.string("parent", "name the parent link, for example 'body'")
        origin = table.vector("origin", "write [x, y, z] in the parent's frame", ZERO)
        roll, pitch, yaw = table.vector("rpy", "write [roll, pitch, yaw] in deg", ZERO)
        rpy = (math.radians(roll), math.radians(pitch), math.radians(yaw))
        links.append(Link(name, parent, origin, rpy, _read_joint(table, parameters), mass, com))
    if any("mass" in table for table in tables) and sum(link.mass for link in links) == 0.0:
        robot.fail(
            "link", "masses are given but all are zero", 0.0, "give a mass or remove the mass keys"
        )
    if not any(link.name == "body" for link in links):
        links.insert(0, Link("body"))
    _check_tree(tables, links)
    used = {link.joint.parameter for link in links if link.joint is not None}
    for i, parameter in enumerate(parameters, 1):
        if parameter.name not in used:
            robot.fail(
                f"parameter[{i}].name",
                "is used by no joint and would change nothing",
                parameter.name,
                "use it in a joint or remove it",
            )
    return tuple(links)


def _read_joint(link: Table, parameters: tuple[Parameter, ...]) -> Joint | None:
    """Read the joint of a link; absent or of type "none" means a fixed link."""
    if "joint" not in link:
        return None
    known = names("robot.link.joint")
    table = link.table("joint", known, "write joint = { type = ..., axis = ... }")
    kind = table.string("type", "use revolute or prismatic", JOINT_TYPES)
    if kind == "none":
        table.refuse(known[1:], "means nothing for type none", "remove it or set the type")
        return None
    driving = [p.name for p in parameters]
    way_out = "name the parameter that drives the joint"
    name = table.one_of("parameter", way_out, driving, "is not a parameter of the robot")
    parameter = parameters[driving.index(name)]
    if (parameter.unit == "rad") != (kind == "revolute"):
        needed = "an angle" if kind == "revolute" else "a length"
        table.fail(
            "parameter",
            f"of a {kind} joint must be {needed}, not in {parameter.display_unit}",
            name,
            "change the joint's type or the parameter's unit",
        )
    axis = table.unit_vector("axis", "write a direction such as [0, 1, 0]")
    scale = table.number("scale", "write a factor such as 1.0 or -1.0", 1.0)
    if scale == 0.0:
        table.fail("scale", "must not be zero", scale, "use 1.0, or remove the joint")
    offset = table.number("offset", f"write a number in {parameter.display_unit}", 0.0)
    return Joint(kind, axis, name, scale, parameter.stored(offset))


def _check_tree(tables: list[Table], links: list[Link]) -> None:
    """Refuse unknown parents and loops."""
    parents = {link.name: link.parent for link in links}
    for table in tables:
        parent = table.values.get("parent")
        if parent is not None and parent not in parents:
            way_out = suggestion(parent, parents, "use one of")
            table.fail("parent", "is not a link of the robot", parent, way_out)
    _, loop = parents_first(parents)
    for table in tables:
        if loop and table.values["name"] == loop[0]:
            way = " -> ".join(loop)
            table.fail("parent", "makes a loop of links", way, "attach one of them to 'body'")


def carrier(table: Table, noun: str, links: tuple[Link, ...]) -> str:
    """Return the name of the link that carries a part of the robot."""
    way_out = f"name the link that carries the {noun}"
    known = [link.name for link in links]
    return table.one_of("link", way_out, known, "is not a link of the robot")


def read_contacts(
    robot: Table,
    links: tuple[Link, ...],
    derive: Callable[[Table, str], list[Contact]] | None = None,
) -> tuple[Contact, ...]:
    """Read ``[[robot.contact]]`` in order; without a position `derive` gives a link's contacts."""
    result: list[Contact] = []
    for table in robot.tables("contact", names("robot.contact")):
        link = carrier(table, "contact", links)
        rolling = table.values.get("rolling", False)
        if not isinstance(rolling, bool):
            table.fail("rolling", "must be true or false", rolling, "write rolling = true")
        if derive is not None and "position" not in table:
            table.refuse(("radius", "axis"), "means nothing without a position", "give position")
            for contact in derive(table, link):
                if rolling and contact.radius == 0.0:
                    table.fail("rolling", "needs a round shape", rolling, "a box slides: remove it")
                table.refuse_twice(contact.name, {other.name for other in result})
                result.append(replace(contact, rolling=rolling))
            continue
        name = table.new_name("contact", {other.name for other in result})
        position = table.vector("position", "write [x, y, z] in the link's frame")
        radius = table.number("radius", "write a length", 0.0)
        if radius < 0.0:
            table.fail("radius", "must not be negative", radius, "write a length of 0 or more")
        axis = None
        if "axis" in table:
            axis = table.unit_vector("axis", "write a direction such as [0, 1, 0]")
            if radius == 0.0:
                got = table.values["axis"]
                table.fail("axis", "needs a radius above 0", got, "give the disc's radius")
        if rolling and radius == 0.0:
            table.fail("rolling", "needs a radius above 0", rolling, "a point slides: remove it")
        result.append(Contact(name, link, position, radius, axis, rolling))
    if not 3 <= len(result) <= MAX_CONTACTS:
        robot.fail(
            "contact",
            f"a robot needs 3 to {MAX_CONTACTS} contacts",
            len(result),
            "add contacts"
            if len(result) < 3
            else "keep those that can touch the ground, of a curved sole one every few degrees",
        )
    return tuple(result)


# Numbers that say the same thing twice may differ by their last digits.
SAME = 1e-9


def read_wheels(robot: Table, contacts: tuple[Contact, ...]) -> tuple[Wheel, ...]:
    """Read ``[[robot.wheel]]`` in order; on a disc, axis and radius are the contact's own."""
    carriers = {contact.name: contact for contact in contacts}
    result: list[Wheel] = []
    for table in robot.tables("wheel", names("robot.wheel")):
        way_out = "name the contact through which it touches the ground"
        name = table.one_of("contact", way_out, carriers, "is not a contact of the robot")
        if any(name == wheel.contact for wheel in result):
            table.fail("contact", "carries a wheel already", name, "give each contact one wheel")
        disc = carriers[name] if carriers[name].kind == "disc" else None
        steered = table.values.get("steered", False)
        if not isinstance(steered, bool):
            table.fail("steered", "must be true or false", steered, "write steered = true")
        rollers = None
        if "rollers" in table:
            rollers = table.number("rollers", "write an angle in deg")
            if not -90.0 < rollers < 90.0:
                way_out = "use 0 for an omniwheel, 45 or -45 for a mecanum wheel"
                table.fail("rollers", "must lie between -90 and 90 deg", rollers, way_out)
            if steered:
                table.fail("rollers", "cannot be combined with steered", rollers, "remove one")
            rollers = math.radians(rollers)
        axis, radius = _read_axle(table, disc), _read_radius(table, disc)
        result.append(Wheel(name, axis, radius, steered, rollers))
    return tuple(result)


def _read_axle(wheel: Table, disc: Contact | None) -> Vector:
    """Return the direction of a wheel's axle, which on a disc may only point the other way."""
    if disc is None or disc.axis is None:
        return wheel.unit_vector("axis", "write the axle's direction such as [0, 1, 0]")
    if "axis" not in wheel:
        return disc.axis
    axis = wheel.unit_vector("axis", "write the axle's direction such as [0, 1, 0]")
    sign = math.copysign(1.0, sum(a * b for a, b in zip(axis, disc.axis, strict=True)))
    if math.dist(axis, [sign * c for c in disc.axis]) > SAME:
        got = wheel.values["axis"]
        wheel.fail("axis", "is not along the axis of its contact", got, "remove it")
    return axis


def _read_radius(wheel: Table, disc: Contact | None) -> float:
    """Return a wheel's rolling radius, which on a disc is the disc's."""
    if disc is not None and "radius" not in wheel:
        return disc.radius
    radius = wheel.number("radius", "write the rolling radius")
    if radius <= 0.0:
        wheel.fail("radius", "must be above 0", radius, "write the rolling radius")
    if disc is not None and not math.isclose(radius, disc.radius, rel_tol=SAME):
        what = f"differs from the {disc.radius:g} of its contact"
        wheel.fail("radius", what, radius, "remove it")
    return radius
