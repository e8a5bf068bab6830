"""Rules about several keys of a recipe, and about names, each a generator of faults."""

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import numpy as np
from pydantic import BaseModel

from lutgen import bounds
from lutgen.errors import suggestion
from lutgen.parts import Contact, parents_first, way_up
from lutgen.quantities import CHANNELS, UNLOADED
from lutgen.recipe.load import NOTHING, Fault, example
from lutgen.recipe.model import knots_of, unit
from lutgen.recipe.schema import ANGLE_UNITS, MAX_CONTACTS, File, Joint, Parameter, Robot, Sweep

# Names of a map file's other dimensions and variables, which no parameter may take.
RESERVED = ("face", "v", "u", *CHANNELS)
# Numbers that say the same thing twice may differ by their last digits.
SAME = 1e-9


def given(
    table: BaseModel, key: str, names: Iterable[str], what: str, way_out: str = "remove it"
) -> Iterator[Fault]:
    """Yield a fault for each of these keys that a table has."""
    for name in names:
        if name in table.model_fields_set:
            got = table.model_dump(include={name}, exclude_unset=True)[name]
            yield Fault(f"{key}.{name}", what, got, way_out)


def absent(table: BaseModel, key: str, *names: str) -> Iterator[Fault]:
    """Yield a fault for each of these keys that a table does not have."""
    for name in names:
        if getattr(table, name) is None:
            way_out = example(name, type(table).model_fields[name])
            yield Fault(f"{key}.{name}", "is missing", NOTHING, way_out)


def known_name(key: str, name: str | None, known: Collection[str], noun: str) -> Iterator[Fault]:
    """Yield a fault for a name that is there, but none of those that are known."""
    if name is not None and name not in known:
        what, way_out = f"is not a {noun} of the robot", suggestion(name, known, "use one of")
        yield Fault(key, what, name, way_out)


def twice(key: str, names: Iterable[Sequence[str]], taken: Iterable[str] = ()) -> Iterator[Fault]:
    """Yield a fault for each entry of an array that has a name which was given before."""
    there = set(taken)
    for place, some in enumerate(names, 1):
        again = [name for name in some if name in there]
        if again:
            yield Fault(f"{key}[{place}].name", "is given twice", again[0], "choose another name")
        there.update(some)


def head_faults(file: File) -> Iterator[Fault]:
    """Yield the faults of everything but links and what is on them."""
    robot = file.robot
    yield from twice("robot.parameter", [[one.name] for one in robot.parameter])
    for place, parameter in enumerate(robot.parameter, 1):
        yield from _parameter_faults(robot, parameter, f"robot.parameter[{place}]")
    known = {one.name: one for one in robot.parameter}
    for name, value in robot.home.items():
        key = f"robot.home.{name}"
        yield from known_name(key, name, known, "parameter")
        if name in known:
            yield from _outside(key, value, known[name], "correct the posture")
    yield from _sample_faults(file.sweep, known)
    yield from _map_faults(file.sweep, robot)
    if robot.urdf is not None:
        what = "cannot be combined with `robot.urdf`"
        yield from given(robot, "robot", ("python", "link"), what)
        if robot.length_unit != "m":
            what, way_out = "of a robot description is m", 'write length_unit = "m"'
            yield Fault("robot.length_unit", what, robot.length_unit, way_out)
    elif robot.python is not None:
        # Code gives places only: which way an axle on them points is not known.
        parts = ("link", "contact", "axle", "wheel", "group", "payload", "force", "mass")
        yield from given(robot, "robot", parts, "cannot be combined with `robot.python`")


def _parameter_faults(robot: Robot, parameter: Parameter, key: str) -> Iterator[Fault]:
    if robot.urdf is None:
        way_out = "remove it; links that share a parameter have a joint with a scale each"
        what = "means nothing without `robot.urdf`"
        yield from given(parameter, key, ("joint", "drive"), what, way_out)
    elif parameter.drive is not None:
        yield from given(parameter, key, ("joint",), "cannot be combined with `drive`")
    if parameter.name in RESERVED:
        what = "is reserved for the map file"
        yield Fault(f"{key}.name", what, parameter.name, "choose another name")
    if parameter.unit not in (*ANGLE_UNITS, robot.length_unit):
        what = "is neither an angle nor the robot's length_unit"
        way_out = f"use one of: {', '.join((*ANGLE_UNITS, robot.length_unit))}"
        yield Fault(f"{key}.unit", what, parameter.unit, way_out)
    if not parameter.min < parameter.max:
        what = f"must be below max = {parameter.max:g}"
        yield Fault(f"{key}.min", what, parameter.min, "swap or widen the limits")


def _outside(key: str, value: float, parameter: Parameter, way_out: str) -> Iterator[Fault]:
    if value < parameter.min < parameter.max or parameter.min < parameter.max < value:
        what = "lies outside the parameter's min and max"
        yield Fault(key, what, value, f"widen the limits or {way_out}")


def _sample_faults(sweep: Sweep, known: Mapping[str, Parameter]) -> Iterator[Fault]:
    key = "sweep.samples"
    if sweep.samples is None:
        if known:
            way_out = f"give the nodes of each parameter: {', '.join(known)}"
            yield Fault(key, "is missing", NOTHING, way_out)
        return
    for name in sweep.samples:
        yield from known_name(f"{key}.{name}", name, known, "parameter")
    for name, parameter in known.items():
        here = f"{key}.{name}"
        if name not in sweep.samples:
            way_out = "give a number of nodes or a list of knots"
            yield Fault(here, "is missing", NOTHING, way_out)
            continue
        samples = sweep.samples[name]
        steady = np.diff(knots_of(parameter, samples)) > 0.0
        if isinstance(samples, int):
            if not steady.all():
                what = "has nodes that are one and the same number, so close are the limits"
                yield Fault(here, what, samples, "move min and max apart, or use fewer nodes")
            continue
        for place, (knot, rises) in enumerate(zip(samples, [True, *steady], strict=True), 1):
            if not rises:
                yield Fault(f"{here}[{place}]", "does not increase", knot, "sort the knots")
            yield from _outside(f"{here}[{place}]", knot, parameter, "remove the knot")


def _map_faults(sweep: Sweep, robot: Robot) -> Iterator[Fault]:
    """Yield the faults of the chart, of the map's size, and of channels that a load undefines."""
    gravity, samples, key = sweep.gravity, sweep.samples or {}, "sweep.gravity"
    if gravity.chart == "sphere":
        if gravity.nodes < 2:
            what = "must be 2 or more for the sphere"
            yield Fault(f"{key}.nodes", what, gravity.nodes, "use more nodes")
        yield from given(gravity, key, ("max_tilt",), "belongs to the cone only")
    else:
        yield from absent(gravity, key, "max_tilt")
    nodes = math.prod(len(one) if isinstance(one, list) else one for one in samples.values())
    nodes *= gravity.nodes**2 * (6 if gravity.chart == "sphere" else 1)
    if nodes > bounds.NODES.most:
        what = f"is beyond the limit of {bounds.NODES.most:,} {bounds.NODES.what}"
        yield Fault("sweep.samples", what, nodes, "use fewer")
    if gravity.channels is not None:
        what = "is given in [sweep.gravity] too"
        yield from given(sweep, "sweep", ("channels",), what, "keep one of them")
    if sweep.channels is None:
        yield from absent(gravity, key, "channels")
    where = "sweep.channels" if gravity.channels is None else f"{key}.channels"
    channels = gravity.channels or sweep.channels or []
    acts = any(any(force.force) or any(force.moment) for force in robot.force)
    for place, channel in enumerate(channels):
        if channel in channels[:place]:
            yield Fault(f"{where}[{place + 1}]", "is given twice", channel, "remove one")
        if channel in UNLOADED and (acts or robot.com_uncertainty > 0.0):
            what = "is not defined under a force or with com_uncertainty"
            yield Fault(f"{where}[{place + 1}]", what, channel, "leave it out")


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
        if link.shape is None:
            yield from given(link, key, ("shape_at",), "needs a shape", "give shape too")
        if link.name == "body":
            what, fixed = "is not allowed for the root link", ("parent", "origin", "rpy", "joint")
            yield from given(link, key, fixed, what)
            continue
        yield from absent(link, key, "parent")
        yield from known_name(f"{key}.parent", link.parent, parents, "link")
        if link.joint is not None:
            used.add(link.joint.parameter or "")
            yield from _joint_faults(link.joint, known, f"{key}.joint")
    if all(parent is None or parent in parents for parent in parents.values()):
        _, loop = parents_first(parents)
        if loop:
            key = f"robot.link[{[link.name for link in robot.link].index(loop[0]) + 1}].parent"
            what, way_out = "makes a loop of links", "attach one of them to 'body'"
            yield Fault(key, what, " -> ".join(loop), way_out)
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
        rest = ("axis", "parameter", "scale", "offset")
        yield from given(joint, key, rest, "means nothing for type none", "remove it or set type")
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
            yield from given(contact, key, ("radius", "axis"), "means nothing without a position")
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

    `links` has the parent of each; `massive` is True if any has a mass; `contacts` are all,
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
                for side, each in enumerate([some] if isinstance(some, str) else some, 1):
                    here = f"{key}.{name}" if each is some else f"{key}.{name}[{side}]"
                    yield from known_name(here, each, there, name.removesuffix("s"))
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
            yield Fault(f"{key}.contact", "carries a wheel already", name, "remove one")
        there.add(name)
        if wheel.steered and wheel.rollers is not None:
            what = "cannot be combined with steered"
            yield Fault(f"{key}.rollers", what, wheel.rollers, "remove one")
        disc = contacts.get(name)
        if disc is None or disc.axis is None:
            # Only a disc has an axle and a rolling radius of its own.
            yield from absent(wheel, key, *(("axis", "radius") if disc else ()))
            continue
        if wheel.axis and np.linalg.norm(np.cross(unit(wheel.axis), disc.axis)) > SAME:
            what = "is not along the axis of its contact"
            yield Fault(f"{key}.axis", what, wheel.axis, "remove it")
        if wheel.radius is not None and not math.isclose(wheel.radius, disc.radius, rel_tol=SAME):
            what = f"differs from the {disc.radius:g} of its contact"
            yield Fault(f"{key}.radius", what, wheel.radius, "remove it")
