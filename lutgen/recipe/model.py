"""A checked recipe: the robot, its sweep, and the defaults of its export; angles in rad."""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from lutgen.chart import Chart
from lutgen.grid import Grid
from lutgen.parts import ZERO, Axle, Contact, Force, Group, Link, Parameter, Wheel
from lutgen.vector import Vector


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
    Payloads are links; `rest_width` and `contact_tolerance` are None where they are left to the
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
        """Whether any force or moment acts beside the weight."""
        return any(force.acts for force in self.forces)

    @property
    def loaded(self) -> bool:
        """Whether forces act beside the weight, or the com is uncertain."""
        return self.has_wrench or self.com_uncertainty > 0.0


def recipe_digest(text: str, urdf: str | None = None) -> str:
    """Return the SHA-256 of a recipe's text, in hex; a zero byte and the URDF follow the text."""
    whole = text if urdf is None else f"{text}\0{urdf}"
    return hashlib.sha256(whole.encode()).hexdigest()
