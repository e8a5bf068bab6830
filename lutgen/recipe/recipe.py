"""Read a recipe, TOML, and check it."""

import math
import os

from lutgen.chart import Chart
from lutgen.grid import Axis, Grid
from lutgen.parts import ZERO, Axle, Contact, Force, Group, Link, three
from lutgen.recipe.described import links_and_shapes, load_function, read_description
from lutgen.recipe.gallery import GALLERY, gallery_text
from lutgen.recipe.load import fail, read_tables, read_text, refuse
from lutgen.recipe.model import (
    ExportDefaults,
    Recipe,
    contacts_of,
    knots_of,
    links_of,
    parameters_of,
    part,
    weighed,
    wheels_of,
)
from lutgen.recipe.rules import contact_faults, head_faults, link_faults, part_faults
from lutgen.recipe.schema import Export, File
from lutgen.recipe.snap import snap


def load_recipe(path: str | os.PathLike[str], allow_python: bool = False) -> Recipe:
    """Read a recipe file, TOML in UTF-8, or `recipe:NAME` of the gallery inside the package.

    One with any fault raises RecipeError; it may run the code that its `python` key names with
    `allow_python` alone.
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
    """Check the text of a recipe, TOML; one with any fault raises RecipeError.

    In the folder of `source`, its file for messages, are the code of a `python` key, which runs
    with `allow_python` alone, and the description of a `urdf` key, if its content is not given.
    An `inert` recipe runs no code and opens no file: enough to read a map.
    """
    file = read_tables(text, source, File)
    robot, gravity, export = file.robot, file.sweep.gravity, file.export or Export()
    faults = list(head_faults(file))
    if robot.urdf is not None or robot.python is not None:
        # The next steps open files or run code.
        refuse(source, faults)
    parameters = parameters_of(robot)
    function = None
    links: tuple[Link, ...] = (Link("body"),)
    if robot.python is not None:
        count = 0
        if not inert:
            function, count = load_function(source, robot.python, parameters, allow_python)
        contacts = tuple(Contact(f"P{i}", "body", ZERO) for i in range(1, count + 1))
    else:
        shapes: dict[int, list[Contact]] = {}
        if robot.urdf is not None:
            if urdf is None and inert:
                what, way_out = "is not stored beside the recipe", "sweep the recipe again"
                fail(source, "robot.urdf", what, robot.urdf, way_out)
            urdf = read_description(source, robot.urdf) if urdf is None else urdf
            links, shapes = links_and_shapes(robot, parameters, urdf, source)
        contacts = contacts_of(robot, shapes)
        carriers = robot.link if robot.urdf is None else links
        names: dict[str, str | None] = {"body": None} if robot.urdf is None else {}
        names |= {link.name: link.parent for link in carriers}
        faults += link_faults(robot) if robot.urdf is None else ()
        faults += contact_faults(robot, names)
        faults += part_faults(robot, names, any(link.mass for link in carriers), contacts, shapes)
        refuse(source, faults)
        links = links_of(robot) if robot.urdf is None else links
    payloads = [Link(p.name, p.link, three(p.position), mass=p.mass) for p in robot.payload]
    samples = file.sweep.samples or {}
    axes = (
        Axis(one.name, parameter.unit, knots_of(one, samples[one.name]))
        for one, parameter in zip(robot.parameter, parameters, strict=True)
    )
    tilt = () if gravity.max_tilt is None else (math.radians(gravity.max_tilt),)
    recipe = part(
        Recipe,
        robot,
        friction=robot.friction,
        parameters=parameters,
        links=weighed((*links, *payloads), robot.mass),
        contacts=contacts,
        python=robot.python,
        grid=Grid(tuple(axes)),
        chart=Chart(gravity.chart, gravity.nodes, *tilt),
        channels=tuple(gravity.channels or file.sweep.channels or ()),
        export=ExportDefaults(_text(export.flash), _text(export.max_error)),
        text=text,
        source=source,
        function=function,
        wheels=wheels_of(robot, contacts),
        axles=tuple(part(Axle, one) for one in robot.axle),
        urdf=urdf if robot.urdf is not None else None,
        groups=tuple(part(Group, one) for one in robot.group),
        forces=tuple(part(Force, one) for one in robot.force),
        home={p.name: p.stored(robot.home[p.name]) for p in parameters if p.name in robot.home},
    )
    return snap(recipe)


def _text(value: str | float | None) -> str | None:
    if value is None:
        return None
    return value.strip() if isinstance(value, str) else repr(value).removesuffix(".0")
