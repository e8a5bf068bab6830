"""A checked recipe, and how its parts come from the models of `schema`: in rad, without checks."""

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, TypeVar

import numpy as np
from pydantic import BaseModel

from lutgen.arrays import Floats, Vector
from lutgen.chart import Chart
from lutgen.grid import Grid
from lutgen.parts import (
    ZERO,
    Axle,
    Contact,
    Force,
    Group,
    Joint,
    Link,
    Parameter,
    Wheel,
    three,
    to_internal,
)
from lutgen.recipe import schema
from lutgen.recipe.schema import ANGLE_UNITS, Robot


@dataclass(frozen=True)
class ExportDefaults:
    """The defaults of ``lutgen export``, as the recipe wrote them."""

    flash: str | None = None
    max_error: str | None = None


@dataclass(frozen=True, repr=False)
class Recipe:
    """A checked recipe; angles in rad, lengths in `length_unit`.

    `text` is the TOML itself, `source` its file name for messages, and `urdf` the content of the
    robot description that it names.  `function` is that of `python` for a robot given by code.
    Payloads are links; `rest_width` and `contact_tolerance` are None if they are left to the
    size, `home` has what the recipe says of its posture, and `snapped` says which contacts are not
    quite where the text has them.
    """

    name: str
    length_unit: str
    friction: float | None
    upright: float
    rock_angle: float
    parameters: tuple[Parameter, ...]
    links: tuple[Link, ...]
    contacts: tuple[Contact, ...]
    python: str | None
    grid: Grid
    chart: Chart
    channels: tuple[str, ...]
    export: ExportDefaults
    text: str
    source: str
    function: Callable[..., Any] | None = field(default=None, compare=False)
    wheels: tuple[Wheel, ...] = ()
    axles: tuple[Axle, ...] = ()
    urdf: str | None = None
    groups: tuple[Group, ...] = ()
    forces: tuple[Force, ...] = ()
    com_uncertainty: float = 0.0
    com_offset: Vector = ZERO
    rest_width: float | None = None
    contact_tolerance: float | None = None
    home: dict[str, float] = field(default_factory=dict)
    snapped: tuple[str, ...] = field(default=(), compare=False)
    title: str | None = None

    def __repr__(self) -> str:
        names = ", ".join(p.name for p in self.parameters) or "no parameters"
        return f"<Recipe {self.name!r}: {len(self.contacts)} contacts, {names}, {self.source}>"

    def __hash__(self) -> int:
        # The text alone will do: the robot is looked up by its recipe in every evaluation.
        return hash(self.text)

    @property
    def digest(self) -> str:
        """The ``recipe_digest`` of the text and the description that it names."""
        return recipe_digest(self.text, self.urdf)

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts, in order."""
        return tuple(contact.name for contact in self.contacts)

    @property
    def nodes(self) -> int:
        """Nodes of the map, per channel."""
        return self.grid.size * math.prod(self.chart.shape)

    @property
    def home_params(self) -> tuple[float, ...]:
        """The posture at `home`, rad or length: the middle of the range where it says nothing."""
        return tuple(self.home.get(p.name, (p.minimum + p.maximum) / 2.0) for p in self.parameters)

    @property
    def has_wrench(self) -> bool:
        """True if any force or moment acts beside the weight."""
        return any(force.acts for force in self.forces)

    @property
    def loaded(self) -> bool:
        """True if forces act beside the weight, or the com is uncertain."""
        return self.has_wrench or self.com_uncertainty > 0.0


def recipe_digest(text: str, urdf: str | None = None) -> str:
    """Return the SHA-256 of a recipe's text, in hex; a zero byte and the URDF follow the text."""
    whole = text if urdf is None else f"{text}\0{urdf}"
    return hashlib.sha256(whole.encode()).hexdigest()


Part = TypeVar("Part")


def unit(vector: Sequence[float]) -> Vector:
    """Return a direction with length 1."""
    x, y, z = vector
    length = math.hypot(x, y, z)
    return x / length, y / length, z / length


# Conversions of values, by key; others stay, and lists become tuples.
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
    for one in fields(kind):  # type: ignore[arg-type]
        value = getattr(table, one.name, None)
        if value is not None and one.name not in others:
            values[one.name] = tuple(value) if isinstance(value, list) else value
            if one.name in _INSIDE:
                values[one.name] = _INSIDE[one.name](value)
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
    links = [] if any(one.name == "body" for one in robot.link) else [Link("body")]
    for one in robot.link:
        joint, moves = None, one.joint
        if moves is not None and moves.axis is not None and moves.parameter is not None:
            offset = to_internal(moves.offset, units[moves.parameter])
            joint = part(Joint, moves, kind=moves.type, offset=offset)
        links.append(part(Link, one, joint=joint))
    return tuple(links)


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
