"""A recipe: the robot, its sweep, and the defaults of its export.

A recipe is TOML; the result is a frozen ``Recipe`` with every angle in radians.  This
file does not compute postures (`kinematics`) and writes nothing.
"""

import hashlib
import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from lutgen.chart import Chart
from lutgen.grid import Axis, Grid
from lutgen.parts import ZERO, Contact, Force, Link, Parameter, Wheel
from lutgen.recipe.code import load_function
from lutgen.recipe.gallery import GALLERY, gallery_text
from lutgen.recipe.load import fail, read_tables, read_text, refuse
from lutgen.recipe.robot import (
    contacts_of,
    forces_of,
    knots_of,
    links_of,
    parameters_of,
    payloads_of,
    three,
    weighed,
    wheels_of,
)
from lutgen.recipe.robot_rules import contact_faults, link_faults, part_faults
from lutgen.recipe.rules import head_faults
from lutgen.recipe.schema import Export, File, Gravity, Robot, Sweep
from lutgen.vector import Vector


@dataclass(frozen=True)
class ExportDefaults:
    """What ``lutgen export`` uses unless it is told otherwise, as the recipe wrote it."""

    flash: str | None = None
    max_error: str | None = None


@dataclass(frozen=True, repr=False)
class Recipe:
    """A checked recipe; angles in rad, lengths in `length_unit`.

    `python` is ``"module:function"`` for a robot given by code; `function` is then
    that function.  `text` is the TOML itself and `source` its file name for messages.
    `urdf` is the content of the robot description that the recipe names.
    Payloads are links; `com_offset` is added to the com that links give, and `com_uncertainty` is
    the radius of the ball in which the com lies.
    `rest_width` and `contact_tolerance` are None where the recipe leaves them to the size.
    `home` has the parameters of the posture that it stands in, as far as the recipe says.
    `snapped` says which contacts are not quite where the text has them, see `snap`.
    `title` is what figures call the robot.
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
    urdf: str | None = None
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
        # Of the text alone: the robot is looked up by its recipe in every evaluation.
        return hash(self.text)

    @property
    def digest(self) -> str:
        """What ``recipe_digest`` gives for the text and the description that it names."""
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


def load_recipe(path: str | os.PathLike[str], allow_python: bool = False) -> Recipe:
    """Read a recipe file.

    Parameters
    ----------
    path : path
        A TOML file, UTF-8, or `recipe:NAME` for one of the gallery, which comes with the package.
    allow_python : bool
        Whether a recipe may run the code that its `python` key names.

    Returns
    -------
    Recipe
        Checked; a file with any fault raises RecipeError.
    """
    source = os.fspath(path)
    text = gallery_text(source) if source.startswith(GALLERY) else read_text(path)
    return parse_recipe(text, source, allow_python)


def parse_recipe(
    text: str,
    source: str = "<recipe>",
    allow_python: bool = False,
    inert: bool = False,
    urdf: str | None = None,
) -> Recipe:
    """Check the text of a recipe.

    Parameters
    ----------
    text : str
        TOML.
    source : str
        File name for messages; its folder is where the code of a `python` key and the file of a
        `urdf` key are.
    allow_python : bool
        Whether a recipe may run the code that its `python` key names.
    inert : bool
        Leave that code alone even so, and open no file: enough to read a map.
    urdf : str, optional
        Content of the robot description that the recipe names, instead of the file.

    Returns
    -------
    Recipe
        Checked; a text with any fault raises RecipeError.
    """
    file = read_tables(text, source, File)
    robot, gravity, export = file.robot, file.sweep.gravity, file.export or Export()
    faults = list(head_faults(file))
    if robot.urdf is not None or robot.python is not None:
        # What follows opens files or runs code.
        refuse(source, faults)
    parameters = parameters_of(robot)
    function = None
    links: tuple[Link, ...] = (Link("body"),)
    shapes: dict[int, list[Contact]] = {}
    if robot.urdf is not None:
        # What reads descriptions takes a while to import, and few recipes have one.
        from lutgen.recipe.described import links_and_shapes, read_description

        if urdf is None and inert:
            what, way_out = "is not stored beside the recipe", "sweep the recipe again"
            fail(source, "robot.urdf", what, robot.urdf, way_out)
        urdf = read_description(source, robot.urdf) if urdf is None else urdf
        links, shapes = links_and_shapes(robot, parameters, urdf, source)
    contacts = contacts_of(robot, shapes)
    if robot.python is not None:
        count = 0
        if not inert:
            function, count = load_function(source, robot.python, parameters, allow_python)
        contacts = tuple(Contact(f"P{i}", "body", ZERO) for i in range(1, count + 1))
    else:
        carriers = robot.link if robot.urdf is None else links
        root = ["body"] if robot.urdf is None else []
        names = dict.fromkeys([*root, *(link.name for link in carriers)])
        faults += link_faults(robot) if robot.urdf is None else ()
        faults += contact_faults(robot, names)
        faults += part_faults(robot, names, any(link.mass for link in carriers), contacts, shapes)
        refuse(source, faults)
        links = links_of(robot) if robot.urdf is None else links
    recipe = Recipe(
        name=robot.name,
        length_unit=robot.length_unit,
        friction=robot.friction,
        upright=math.radians(robot.upright),
        rock_angle=math.radians(robot.rock_angle),
        parameters=parameters,
        links=weighed((*links, *payloads_of(robot)), robot.mass),
        contacts=contacts,
        python=robot.python,
        grid=_grid(file.sweep, robot, parameters),
        chart=_chart(gravity),
        channels=tuple(gravity.channels or file.sweep.channels or ()),
        export=ExportDefaults(_text(export.flash), _text(export.max_error)),
        text=text,
        source=source,
        function=function,
        wheels=wheels_of(robot, contacts),
        urdf=urdf if robot.urdf is not None else None,
        forces=forces_of(robot),
        com_uncertainty=robot.com_uncertainty,
        com_offset=three(robot.com_offset),
        rest_width=robot.rest_width,
        contact_tolerance=robot.contact_tolerance,
        home={p.name: p.stored(robot.home[p.name]) for p in parameters if p.name in robot.home},
        title=robot.title,
    )
    # The size, of which tolerances are parts, is that of a recipe.
    from lutgen.recipe.snap import snap

    return snap(recipe)


def _grid(sweep: Sweep, robot: Robot, parameters: tuple[Parameter, ...]) -> Grid:
    samples = sweep.samples or {}
    return Grid(
        tuple(
            Axis(internal.name, internal.unit, knots_of(one, samples[one.name]))
            for one, internal in zip(robot.parameter, parameters, strict=True)
        )
    )


def _chart(gravity: Gravity) -> Chart:
    if gravity.max_tilt is None:
        return Chart(gravity.chart, gravity.nodes)
    return Chart(gravity.chart, gravity.nodes, math.radians(gravity.max_tilt))


def _text(value: str | float | None) -> str | None:
    """Return a quantity as text, a bare number without a needless ".0"."""
    if value is None:
        return None
    return value.strip() if isinstance(value, str) else repr(value).removesuffix(".0")
