"""From the models of a recipe to the parts of a robot: radians, unit vectors, no checks."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from lutgen.parts import ZERO, Contact, Joint, Link, Parameter, Vector, Wheel, to_internal
from lutgen.recipe import schema
from lutgen.recipe.schema import ANGLE_UNITS, Robot
from lutgen.vector import Floats

Part = TypeVar("Part")


def three(vector: Sequence[float]) -> Vector:
    """Return the three numbers of a list."""
    x, y, z = vector
    return x, y, z


def unit(vector: Sequence[float]) -> Vector:
    """Return a direction with length 1."""
    x, y, z = vector
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


# What a value becomes, by its key; others stay, and lists become tuples.
_INSIDE: dict[str, Callable[[Any], Any]] = {
    "axis": unit,
    "rpy": lambda rpy: three([math.radians(angle) for angle in rpy]),
    **dict.fromkeys(("stops", "rollers", "upright", "rock_angle"), math.radians),
}


def part(kind: type[Part], table: BaseModel, /, **others: Any) -> Part:
    """Return a table as a dataclass with fields of the same names, beside which it has `others`.

    A key that is None is left out, so that the field's own default holds.
    """
    values = dict(others)
    for field in fields(kind):  # type: ignore[arg-type]
        value = getattr(table, field.name, None)
        if value is not None and field.name not in others:
            values[field.name] = tuple(value) if isinstance(value, list) else value
            if field.name in _INSIDE:
                values[field.name] = _INSIDE[field.name](value)
    return kind(**values)


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
    links = [part(Link, one, joint=_joint(one.joint, units)) for one in robot.link]
    body = () if any(link.name == "body" for link in links) else (Link("body"),)
    return (*body, *links)


def _joint(joint: schema.Joint | None, units: Mapping[str, str]) -> Joint | None:
    if joint is None or joint.axis is None or joint.parameter is None:
        return None
    offset = to_internal(joint.offset, units[joint.parameter])
    return part(Joint, joint, kind=joint.type, offset=offset)


def contacts_of(robot: Robot, shapes: Mapping[int, Sequence[Contact]]) -> tuple[Contact, ...]:
    """Return the contacts of a robot; `shapes` has those of places that stand for a link's."""
    result: list[Contact] = []
    for place, one in enumerate(robot.contact):
        # A name and a position that are missing are a fault, which the rules say.
        own = part(Contact, one, name=one.name or "", position=three(one.position or ZERO))
        for found in shapes.get(place, [own]):
            result.append(replace(found, rolling=own.rolling, width=own.width, belt=own.belt))
    return tuple(result)


def wheels_of(robot: Robot, contacts: Sequence[Contact]) -> tuple[Wheel, ...]:
    """Return the wheels of a robot; on a disc, what they do not say is the disc's."""
    carriers = {contact.name: contact for contact in contacts}
    result = []
    for one in robot.wheel:
        disc = carriers[one.contact]
        axis = unit(one.axis) if one.axis else disc.axis or ZERO
        result.append(part(Wheel, one, axis=axis, radius=one.radius or disc.radius))
    return tuple(result)


def weighed(links: tuple[Link, ...], mass: float | None) -> tuple[Link, ...]:
    """Return links whose masses add up to `mass` (kg), each by the same factor; None is as is."""
    total = math.fsum(link.mass for link in links)
    if mass is None or total == 0.0:
        return links
    return tuple(replace(link, mass=link.mass * (mass / total)) for link in links)
