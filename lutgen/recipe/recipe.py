"""Read and check a recipe: the robot, its sweep, and the defaults of its export.

A recipe is TOML; the result is a frozen ``Recipe`` with every angle in radians.  This
file does not compute postures (`kinematics`) and writes nothing.
"""

import hashlib
import math
import os
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lutgen import bounds
from lutgen.chart import Chart
from lutgen.errors import suggestion
from lutgen.grid import Axis, Grid
from lutgen.parts import ZERO, Contact, Force, Link, Parameter, Wheel
from lutgen.quantities import CHANNELS, UNLOADED
from lutgen.recipe.gallery import GALLERY, gallery_text
from lutgen.recipe.keys import CHARTS, SHARE, SIZE, names
from lutgen.recipe.loads import read_com_uncertainty, read_forces, read_payloads
from lutgen.recipe.plugin import load_function
from lutgen.recipe.robot import (
    read_contacts,
    read_home,
    read_links,
    read_parameters,
    read_wheels,
)
from lutgen.recipe.robot_keys import LENGTH_UNITS
from lutgen.recipe.table import Table, parse_table, read_text


@dataclass(frozen=True)
class ExportDefaults:
    """What ``lutgen export`` uses unless it is told otherwise, as the recipe wrote it."""

    flash: str | None = None
    max_error: str | None = None


@dataclass(frozen=True)
class Recipe:
    """A checked recipe; angles in rad, lengths in `length_unit`.

    `python` is ``"module:function"`` for a robot given by code; `function` is then
    that function.  `text` is the TOML itself and `source` its file name for messages.
    `urdf` is the content of the robot description that the recipe names.
    Payloads are links; `com_uncertainty` is the radius of the ball in which the com lies.
    `rest_width` and `contact_tolerance` are None where the recipe leaves them to the size.
    `home` has the parameters of the posture that it stands in, as far as the recipe says.
    `snapped` says which contacts are not quite where the text has them, see `snap`.
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
    function: Callable[..., Any] | None = field(default=None, compare=False, repr=False)
    wheels: tuple[Wheel, ...] = ()
    urdf: str | None = field(default=None, repr=False)
    forces: tuple[Force, ...] = ()
    com_uncertainty: float = 0.0
    rest_width: float | None = None
    contact_tolerance: float | None = None
    home: dict[str, float] = field(default_factory=dict)
    snapped: tuple[str, ...] = field(default=(), compare=False)

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
    root = parse_table(text, source, names(""))
    robot = root.table("robot", names("robot"), "add a [robot] table")
    name = robot.string("name", "name the robot")
    length_unit = robot.string("length_unit", "use one of: m, cm, mm, 1", LENGTH_UNITS)
    friction = robot.number("friction", "write a number above 0") if "friction" in robot else None
    if friction is not None and friction <= 0.0:
        robot.fail("friction", "must be above 0", friction, "leave it out if it is not known")
    upright = robot.number("upright", "write an angle in deg", 80.0)
    if not 0.0 < upright <= 180.0:
        robot.fail("upright", "must lie in (0, 180] deg", upright, "use 80, or 180 for no limit")
    rock_angle = robot.number("rock_angle", "write an angle in deg", 30.0)
    if not 0.0 <= rock_angle <= 45.0:
        why = "must lie in [0, 45] deg: a mass that falls from balance leaves its pivot at 48.2 deg"
        robot.fail("rock_angle", why, rock_angle, "30 is the default")
    rest_width = _read_length(robot, "rest_width", "leave it out for 1 % of the size")
    tolerance = _read_length(robot, "contact_tolerance", "leave it out for 1e-4 of the size")
    parameters = read_parameters(robot, length_unit)
    home = read_home(robot, parameters)
    python = robot.string("python", "write module:function") if "python" in robot else None
    sweep = root.table("sweep", names("sweep"), "add a [sweep] table")
    grid = _read_grid(sweep, parameters)
    chart, channels = _read_gravity(sweep)
    export = _read_export(root)
    function = content = None
    com_uncertainty = read_com_uncertainty(robot)
    if "urdf" in robot:
        robot.refuse(("python", "link"), "cannot be combined with `robot.urdf`", "remove it")
        # What reads descriptions takes a while to import, and few recipes have one.
        from lutgen.recipe.described import read_content, read_urdf

        content = read_content(robot, inert) if urdf is None else urdf
        links, contacts = read_urdf(robot, parameters, content)
    elif python is None:
        links = read_links(robot, parameters)
        contacts = read_contacts(robot, links)
    else:
        # Code gives places only: which way an axle on them points is not known.
        robot.refuse(
            ("link", "contact", "wheel", "payload", "force"),
            "cannot be combined with `robot.python`",
            "remove it",
        )
        count = 0
        if not inert:
            function, count = load_function(robot, python, parameters, allow_python)
        links = (Link("body"),)
        contacts = tuple(Contact(f"P{i}", "body", ZERO) for i in range(1, count + 1))
    wheels = read_wheels(robot, contacts)
    forces = read_forces(robot, links)
    links = read_payloads(robot, links)
    recipe = Recipe(
        name,
        length_unit,
        friction,
        math.radians(upright),
        math.radians(rock_angle),
        parameters,
        links,
        contacts,
        python,
        grid,
        chart,
        channels,
        export,
        text,
        source,
        function,
        wheels,
        content,
        forces,
        com_uncertainty,
        rest_width,
        tolerance,
        home,
    )
    sweep.at_most("samples", recipe.nodes, bounds.NODES)
    undefined = [name for name in UNLOADED if name in channels]
    if recipe.loaded and undefined:
        sweep.fail(
            "channels",
            f"{undefined[0]} is not defined under a force or with com_uncertainty",
            list(channels),
            "leave it out",
        )
    # The size, of which tolerances are parts, is that of a recipe.
    from lutgen.recipe.snap import snap

    return snap(recipe)


def _read_length(robot: Table, key: str, way_out: str) -> float | None:
    """Read a length of [robot] that may be left out."""
    if key not in robot:
        return None
    value = robot.number(key, way_out)
    if value < 0.0:
        robot.fail(key, "must not be negative", value, way_out)
    return value


def _read_grid(sweep: Table, parameters: tuple[Parameter, ...]) -> Grid:
    """Read `samples` of [sweep]: nodes or knots of each parameter."""
    known = [p.name for p in parameters]
    if not known and "samples" not in sweep:
        return Grid(())
    samples = sweep.need("samples", f"give the nodes of each parameter: {', '.join(known)}")
    if not isinstance(samples, dict):
        sweep.fail("samples", "must be a table", samples, "write samples = { name = 50 }")
    for name in samples:
        if name not in known:
            way_out = suggestion(name, known, "use one of")
            sweep.fail(f"samples.{name}", "is not a parameter of the robot", name, way_out)
    table = Table(samples, sweep.source, sweep.path("samples"), known)
    return Grid(tuple(Axis(p.name, p.unit, _read_knots(table, p)) for p in parameters))


def _read_knots(samples: Table, parameter: Parameter) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the knots of one parameter in rad or length."""
    name = parameter.name
    way_out = "give a number of nodes or a list of knots"
    value = samples.need(name, way_out)
    if isinstance(value, list):
        if len(value) < 2:
            samples.fail(name, "needs at least 2 knots", value, "add knots")
        numbers = [samples.as_number(f"{name}[{i}]", v, way_out) for i, v in enumerate(value, 1)]
        knots = [parameter.stored(number) for number in numbers]
        for i, knot in enumerate(knots):
            if i and knot <= knots[i - 1]:
                samples.fail(f"{name}[{i + 1}]", "does not increase", numbers[i], "sort the knots")
            if not parameter.minimum <= knot <= parameter.maximum:
                samples.fail(
                    f"{name}[{i + 1}]",
                    "lies outside the parameter's min and max",
                    numbers[i],
                    "widen the limits or remove the knot",
                )
        return np.array(knots)
    count = samples.integer(name, way_out)
    if count < 2:
        samples.fail(name, "needs at least 2 nodes", count, "use 2 or more")
    samples.at_most(name, count, bounds.KNOTS)
    evenly = np.linspace(parameter.minimum, parameter.maximum, count)
    if not (np.diff(evenly) > 0.0).all():
        problem = "has nodes that are one and the same number, so close are the parameter's limits"
        samples.fail(name, problem, count, "move min and max apart, or use fewer nodes")
    return evenly


def _read_gravity(sweep: Table) -> tuple[Chart, tuple[str, ...]]:
    """Read ``[sweep.gravity]`` and the channels, which may stand there or in ``[sweep]``."""
    table = sweep.table("gravity", names("sweep.gravity"), "add a [sweep.gravity] table")
    kind = table.string("chart", "use cone or sphere", CHARTS)
    nodes = table.integer("nodes", "write the nodes per side of a face")
    fewest = 1 if kind == "cone" else 2
    if nodes < fewest:
        table.fail("nodes", f"must be {fewest} or more for the {kind}", nodes, "use more nodes")
    table.at_most("nodes", nodes, bounds.SIDE)
    if kind == "sphere":
        table.refuse(("max_tilt",), "belongs to the cone only", "remove it")
        chart = Chart(kind, nodes)
    else:
        tilt = table.number("max_tilt", "write the largest tilt in deg")
        if not 0.0 < tilt <= 85.0:
            table.fail(
                "max_tilt",
                "must lie in (0, 85] deg",
                tilt,
                "use the chart 'sphere' for larger tilts",
            )
        chart = Chart(kind, nodes, math.radians(tilt))
    if "channels" in table:
        sweep.refuse(("channels",), "is given in [sweep.gravity] too", "keep one of them")
    where = sweep if "channels" in sweep else table
    channels = where.strings("channels", f"choose from: {', '.join(CHANNELS)}")
    for i, channel in enumerate(channels, 1):
        if channel not in CHANNELS:
            way_out = suggestion(channel, CHANNELS, "choose from")
            where.fail(f"channels[{i}]", "is not a channel", channel, way_out)
        if channel in channels[: i - 1]:
            where.fail(f"channels[{i}]", "is given twice", channel, "remove one")
    return chart, tuple(channels)


def _read_export(root: Table) -> ExportDefaults:
    """Read ``[export]``, which may be absent."""
    if "export" not in root:
        return ExportDefaults()
    table = root.table("export", names("export"), "write an [export] table")
    return ExportDefaults(
        _quantity(table, "flash", SIZE, "write bytes or '16KiB'"),
        _quantity(table, "max_error", SHARE, "write '1%' or 0.01"),
    )


def _quantity(table: Table, name: str, pattern: str, way_out: str) -> str | None:
    """Return a size or share above 0 as text; a bare number becomes text too."""
    if name not in table:
        return None
    value = table.values[name]
    text = value if isinstance(value, str) else repr(table.as_number(name, value, way_out))
    if isinstance(value, int) or text.endswith(".0"):
        text = str(value) if isinstance(value, int) else text[:-2]
    match = re.fullmatch(pattern, text.strip())
    if match is None or not re.search(r"[1-9]", text.partition("e")[0]):
        table.fail(name, "is not a quantity above 0", value, way_out)
    return text.strip()
