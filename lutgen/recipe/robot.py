"""From the models of a recipe to the parts of a robot: radians, unit vectors, no checks."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lutgen.parts import ZERO, Axle, Contact, Joint, Link, Parameter, Vector, Wheel, to_internal
from lutgen.recipe import schema
from lutgen.recipe.schema import ANGLE_UNITS, Robot
from lutgen.vector import Floats


def three(vector: Sequence[float]) -> Vector:
    """Return the three numbers of a list."""
    x, y, z = vector
    return x, y, z


def unit(vector: Sequence[float]) -> Vector:
    """Return a direction with length 1."""
    x, y, z = vector
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


def parameters_of(robot: Robot) -> tuple[Parameter, ...]:
    """Return the parameters of a robot."""
    return tuple(
        Parameter(
            one.name,
            to_internal(one.min, one.unit),
            to_internal(one.max, one.unit),
            "rad" if one.unit in ANGLE_UNITS else one.unit,
            one.unit,
            one.meaning or "",
        )
        for one in robot.parameter
    )


def knots_of(parameter: schema.Parameter, samples: int | list[float]) -> Floats:
    """Return the nodes of a parameter's axis, rad or length."""
    if isinstance(samples, list):
        return np.array([to_internal(knot, parameter.unit) for knot in samples])
    low, high = (to_internal(end, parameter.unit) for end in (parameter.min, parameter.max))
    return np.linspace(low, high, samples)


def links_of(robot: Robot) -> tuple[Link, ...]:
    """Return the links of a robot; `body` comes first where the recipe does not have it."""
    units = {one.name: one.unit for one in robot.parameter}
    links = [
        Link(
            one.name,
            one.parent,
            three(one.origin),
            three([math.radians(angle) for angle in one.rpy]),
            _joint(one.joint, units),
            one.mass,
            three(one.com),
            three(one.shape) if one.shape else None,
        )
        for one in robot.link
    ]
    if not any(link.name == "body" for link in links):
        links.insert(0, Link("body"))
    return tuple(links)


def _joint(joint: schema.Joint | None, units: Mapping[str, str]) -> Joint | None:
    if joint is None or joint.axis is None or joint.parameter is None:
        return None
    offset = to_internal(joint.offset, units[joint.parameter])
    return Joint(joint.type, unit(joint.axis), joint.parameter, joint.scale, offset)


def contacts_of(robot: Robot, shapes: Mapping[int, Sequence[Contact]]) -> tuple[Contact, ...]:
    """Return the contacts of a robot; `shapes` has those of places that stand for a link's."""
    result: list[Contact] = []
    for place, one in enumerate(robot.contact):
        # A name and a position that are missing are a fault, which the rules say.
        centre, axis = three(one.position or ZERO), unit(one.axis) if one.axis else None
        alone = Contact(one.name or "", one.link, centre, one.radius, axis)
        for contact in shapes.get(place, [alone]):
            width, belt = one.width or 0.0, one.belt or ""
            result.append(replace(contact, rolling=one.rolling, width=width, belt=belt))
    return tuple(result)


def axles_of(robot: Robot) -> tuple[Axle, ...]:
    """Return the axles of a robot that swing."""
    return tuple(
        Axle(
            one.name,
            (one.contacts[0], one.contacts[1]),
            one.link,
            three(one.pivot),
            unit(one.axis),
            None if one.stops is None else math.radians(one.stops),
        )
        for one in robot.axle
    )


def wheels_of(robot: Robot, contacts: Sequence[Contact]) -> tuple[Wheel, ...]:
    """Return the wheels of a robot; on a disc, what they do not say is the disc's."""
    carriers = {contact.name: contact for contact in contacts}
    return tuple(
        Wheel(
            one.contact,
            unit(one.axis) if one.axis else carriers[one.contact].axis or ZERO,
            one.radius or carriers[one.contact].radius,
            one.steered,
            None if one.rollers is None else math.radians(one.rollers),
        )
        for one in robot.wheel
    )


def weighed(links: tuple[Link, ...], mass: float | None) -> tuple[Link, ...]:
    """Return links whose masses add up to `mass` (kg), each by the same factor; None is as is."""
    total = math.fsum(link.mass for link in links)
    if mass is None or total == 0.0:
        return links
    return tuple(replace(link, mass=link.mass * (mass / total)) for link in links)
