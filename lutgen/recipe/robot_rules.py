"""Rules that links, joints, contacts, wheels, payloads and forces keep, and their names."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence

from lutgen.parts import Contact, parents_first, way_up
from lutgen.recipe.load import Fault
from lutgen.recipe.robot import unit
from lutgen.recipe.rules import absent, given, known_name, twice
from lutgen.recipe.schema import ANGLE_UNITS, MAX_CONTACTS, Joint, Parameter, Robot

# Numbers that say the same thing twice may differ by their last digits.
SAME = 1e-9


def link_faults(robot: Robot) -> Iterator[Fault]:
    """Yield the faults of the tree of links and of its joints."""
    yield from twice("robot.link", [[link.name] for link in robot.link])
    parents: dict[str, str | None] = {"body": None}
    parents |= {link.name: link.parent for link in robot.link if link.name != "body"}
    known = {one.name: one for one in robot.parameter}
    used: set[str] = set()
    for place, link in enumerate(robot.link, 1):
        key = f"robot.link[{place}]"
        if "mass" not in link.model_fields_set:
            what = "changes nothing without a mass"
            yield from given(link, key, ("com",), what, "give mass too")
        if link.name == "body":
            fixed = ("parent", "origin", "rpy", "joint")
            what = "is not allowed for the root link"
            yield from given(link, key, fixed, what, "remove it")
            continue
        yield from absent(link, key, "parent")
        yield from known_name(f"{key}.parent", link.parent, parents, "link")
        if link.joint is not None:
            used.add(link.joint.parameter or "")
            yield from _joint_faults(link.joint, known, f"{key}.joint")
    if all(parent is None or parent in parents for parent in parents.values()):
        _, loop = parents_first(parents)
        for place, link in enumerate(robot.link, 1):
            if loop and link.name == loop[0]:
                what, way = "makes a loop of links", " -> ".join(loop)
                yield Fault(
                    f"robot.link[{place}].parent", what, way, "attach one of them to 'body'"
                )
    masses = [link.mass for link in robot.link if "mass" in link.model_fields_set]
    if masses and not any(masses):
        what = "masses are given but all are zero"
        yield Fault("robot.link", what, 0.0, "give a mass or remove the mass keys")
    for place, parameter in enumerate(robot.parameter, 1):
        # A joint that names no parameter may have meant this one.
        if parameter.name not in used and used <= {"", *known}:
            what, way_out = "is used by no joint", "use it in a joint or remove it"
            yield Fault(f"robot.parameter[{place}].name", what, parameter.name, way_out)


def _joint_faults(joint: Joint, known: Mapping[str, Parameter], key: str) -> Iterator[Fault]:
    if joint.type == "none":
        others = ("axis", "parameter", "scale", "offset")
        way_out = "remove it or set the type"
        yield from given(joint, key, others, "means nothing for type none", way_out)
        return
    yield from absent(joint, key, "axis", "parameter")
    yield from known_name(f"{key}.parameter", joint.parameter, known, "parameter")
    parameter = known.get(joint.parameter or "")
    turns = joint.type == "revolute"
    if parameter is not None and (parameter.unit in ANGLE_UNITS) != turns:
        needed = "an angle" if turns else "a length"
        what = f"of a {joint.type} joint must be {needed}, not in {parameter.unit}"
        way_out = "change the joint's type or the parameter's unit"
        yield Fault(f"{key}.parameter", what, parameter.name, way_out)


def contact_faults(robot: Robot, links: Collection[str]) -> Iterator[Fault]:
    """Yield the faults of each contact by itself; `links` are the names of the robot's links."""
    for place, contact in enumerate(robot.contact, 1):
        key = f"robot.contact[{place}]"
        yield from known_name(f"{key}.link", contact.link, links, "link")
        if contact.position is None and robot.urdf is not None:
            what = "means nothing without a position"
            yield from given(contact, key, ("radius", "axis"), what, "give position")
            continue
        yield from absent(contact, key, "name", "position")
        if contact.radius == 0.0:
            way_out = "give the disc's radius"
            yield from given(contact, key, ("axis",), "needs a radius above 0", way_out)
            if contact.rolling:
                what, way_out = "needs a radius above 0", "a point slides: remove it"
                yield Fault(f"{key}.rolling", what, True, way_out)
        if contact.axis is None:
            yield from given(contact, key, ("width", "belt"), "needs a disc", "give axis too")


def part_faults(
    robot: Robot,
    links: Mapping[str, str | None],
    massive: bool,
    contacts: Sequence[Contact],
    shapes: Mapping[int, Sequence[Contact]],
) -> Iterator[Fault]:
    """Yield the faults of all contacts together, and of wheels, payloads and forces.

    `links` has the parent of each; `massive` says whether any has a mass; `contacts` are all,
    those of links' `shapes`, too.
    """
    names = [[one.name] if one.name and one.position else [] for one in robot.contact]
    for place, found in shapes.items():
        names[place] = [contact.name for contact in found]
    yield from twice("robot.contact", names)
    if not 3 <= len(contacts) <= MAX_CONTACTS:
        what = f"a robot needs 3 to {MAX_CONTACTS} contacts"
        way_out = "keep those that can touch the ground, of a curved sole one every few degrees"
        way_out = "add contacts" if len(contacts) < 3 else way_out
        yield Fault("robot.contact", what, len(contacts), way_out)
    named = {contact.name: contact for contact in contacts}
    known: dict[str, Collection[str]] = {"link": links, "contact": named, "contacts": named}
    weightless = "counts for nothing on a robot without masses", "give its links masses in kg"
    if robot.mass is not None and not massive:
        yield Fault("robot.mass", weightless[0], robot.mass, weightless[1])
    for kind in ("axle", "wheel", "group", "payload", "force"):
        parts = getattr(robot, kind)
        if kind != "wheel":
            # A payload is a link.
            taken = links if kind == "payload" else ()
            yield from twice(f"robot.{kind}", [[part.name] for part in parts], taken)
        for place, part in enumerate(parts, 1):
            key = f"robot.{kind}[{place}]"
            for name, there in known.items():
                some = getattr(part, name, [])
                for each in [some] if isinstance(some, str) else some:
                    yield from known_name(f"{key}.{name}", each, there, name.removesuffix("s"))
            for name in ("mass", "force"):
                if hasattr(part, name) and not massive:
                    yield Fault(f"{key}.{name}", weightless[0], getattr(part, name), weightless[1])
    yield from _axle_faults(robot, links, named)
    yield from _wheel_faults(robot, named)


def _axle_faults(
    robot: Robot, links: Mapping[str, str | None], contacts: Mapping[str, Contact]
) -> Iterator[Fault]:
    carried: set[str] = set()
    for place, axle in enumerate(robot.axle, 1):
        for side, name in enumerate(axle.contacts, 1):
            here = f"robot.axle[{place}].contacts[{side}]"
            if name in carried:
                yield Fault(here, "is on an axle already", name, "name two that are on no other")
            carried.add(name)
            if name in contacts and axle.link not in way_up(links, contacts[name].link):
                what = f"is not carried by {axle.link!r}, which holds the pivot"
                yield Fault(here, what, name, "name the link that carries the axle")


def _wheel_faults(robot: Robot, contacts: Mapping[str, Contact]) -> Iterator[Fault]:
    there: set[str] = set()
    for place, wheel in enumerate(robot.wheel, 1):
        key, name = f"robot.wheel[{place}]", wheel.contact
        if name in there:
            way_out = "give each contact one wheel"
            yield Fault(f"{key}.contact", "carries a wheel already", name, way_out)
        there.add(name)
        if wheel.steered and wheel.rollers is not None:
            what = "cannot be combined with steered"
            yield Fault(f"{key}.rollers", what, wheel.rollers, "remove one")
        disc = contacts.get(name)
        if disc is None or disc.axis is None:
            # Only a disc has an axle and a rolling radius of its own.
            yield from absent(wheel, key, *(("axis", "radius") if disc else ()))
            continue
        if wheel.axis is not None:
            along, back = disc.axis, [-part for part in disc.axis]
            if min(math.dist(unit(wheel.axis), way) for way in (along, back)) > SAME:
                what = "is not along the axis of its contact"
                yield Fault(f"{key}.axis", what, wheel.axis, "remove it")
        if wheel.radius is not None and not math.isclose(wheel.radius, disc.radius, rel_tol=SAME):
            what = f"differs from the {disc.radius:g} of its contact"
            yield Fault(f"{key}.radius", what, wheel.radius, "remove it")
