"""Robots given by a robot description: ``[robot] urdf = "robot.urdf"``.

Owns which file such a recipe may name, and which joints of it are the recipe's parameters.
"""

from pathlib import Path, PurePosixPath

from lutgen.errors import suggestion
from lutgen.parts import Contact, Link, Parameter
from lutgen.recipe.keys import names
from lutgen.recipe.robot import read_contacts
from lutgen.recipe.table import Table
from lutgen.urdf import (
    MAX_BYTES,
    TURN,
    Couple,
    Motion,
    UrdfRobot,
    link_contacts,
    links_of,
    parse_urdf,
    read_motion,
)

# rad or m: descriptions round their limits, and so do recipes in deg.
SAME = 1e-6


def read_content(robot: Table, inert: bool = False) -> str:
    """Return the text of the file that the ``[robot]`` table names.

    Its `urdf` is a relative path to a file in the recipe's folder or below, also after following
    links; any other raises RecipeError, and so does every one where `inert` forbids to open files.
    """
    name = _name(robot)
    if inert:
        robot.fail("urdf", "is not stored beside the recipe", name, "sweep the recipe again")
    path = PurePosixPath(name)
    way_out = "copy the file beside the recipe and write its name"
    if path.is_absolute() or ".." in path.parts or "\\" in name or "\0" in name:
        robot.fail("urdf", "must be a relative path without '..'", name, way_out)
    folder = Path(robot.source).resolve().parent
    try:
        target = (folder / path).resolve()
        if not target.is_relative_to(folder):
            robot.fail("urdf", "leads out of the recipe's folder", name, way_out)
        if not target.is_file():
            robot.fail("urdf", "names no file", name, way_out)
        with target.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
        return raw.decode("utf-8-sig")
    except (OSError, RuntimeError) as error:
        robot.fail("urdf", f"cannot be read: {error}", name, way_out)
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        robot.fail("urdf", f"names a file whose line {line} is not UTF-8", name, "save it as UTF-8")


def read_urdf(
    robot: Table, parameters: tuple[Parameter, ...], content: str
) -> tuple[tuple[Link, ...], tuple[Contact, ...]]:
    """Return links and contacts of a recipe whose ``[robot]`` table names a robot description.

    Each parameter is the joint that its `joint` key names, or the one of its own name, or drives
    those of its `drive`, within the limits of these; joints that are none stand at zero or at their
    limit nearest to zero, and joints that mimic one follow it.  `content` is XML.  The links are
    all, under their own names, m and kg; contacts with a position are as written, the others
    derived from collision shapes.
    """
    unit = robot.values["length_unit"]
    if unit != "m":
        robot.fail("length_unit", "of a robot description is m", unit, 'write length_unit = "m"')
    described = parse_urdf(content, f"{robot.source}: {_name(robot)}")
    couples = _couples(robot, parameters, described)
    joints = {couple.first: couple.name for couple in couples}
    motion = read_motion(described, (), couples=couples)
    _check_ranges(robot, parameters, described, motion)
    links = links_of(described, motion, joints)
    bodies = {link.name: link for link in described.links}

    def derive(table: Table, name: str) -> list[Contact]:
        base = table.string("name", "name the contacts") if "name" in table else None
        found = link_contacts(bodies[name], base)
        if not found:
            kinds = [shape.kind for shape in bodies[name].collisions]
            what = "has no collision sphere, cylinder or box, and the contact no position"
            table.fail("link", what, kinds, "write position = [x, y, z] in the link's frame")
        return found

    return links, read_contacts(robot, links, derive)


def _name(robot: Table) -> str:
    """Return the path of the description as written."""
    return robot.string("urdf", "write the name of a URDF file beside the recipe")


def _couples(robot: Table, parameters: tuple[Parameter, ...], described: UrdfRobot) -> list[Couple]:
    """Return the joints of each parameter, in order."""
    known = [joint.name for joint in described.joints if joint.kind != "fixed"]
    what = "is no moving joint of the description"
    result: list[Couple] = []
    taken: set[str] = set()
    tables = robot.tables("parameter", names("robot.parameter"))
    for table, parameter in zip(tables, parameters, strict=True):
        if "drive" in table:
            table.refuse(("joint",), "cannot be combined with `drive`", "keep one of them")
            joints = _drive(table, parameter, known, what)
        else:
            key = "joint" if "joint" in table else "name"
            way_out = "name a joint of the description"
            joints = {table.one_of(key, way_out, known, what): (1.0, 0.0)}
        for name in joints:
            if name in taken:
                key = f"drive.{name}" if "drive" in table else key
                table.fail(key, "is the joint of another parameter already", name, "remove one")
        taken.update(joints)
        result.append(Couple(parameter.name, joints))
    return result


def _drive(
    table: Table, parameter: Parameter, known: list[str], what: str
) -> dict[str, tuple[float, float]]:
    """Return scale and offset (rad or m) of each joint of a parameter's `drive`."""
    way_out = "write drive = { joint = scale, ... }"
    drive = table.need("drive", way_out)
    if not isinstance(drive, dict) or not drive:
        table.fail("drive", "must be a table of one joint or more", drive, way_out)
    result = {}
    for name, value in drive.items():
        key = f"drive.{name}"
        if name not in known:
            table.fail(key, what, name, suggestion(name, known, "use one of"))
        offset = 0.0
        if isinstance(value, dict):
            part = table.table("drive", drive, way_out).table(name, ("scale", "offset"), way_out)
            value = part.number("scale", "write a factor such as 1.0 or -1.0", 1.0)
            offset = part.number("offset", f"write a number in {parameter.display_unit}", 0.0)
        scale = table.as_number(key, value, "write a scale, or { scale = 1.0, offset = 10.0 }")
        if scale == 0.0:
            table.fail(key, "must not be zero", value, "write 1.0 or -1.0, or remove the joint")
        result[name] = scale, parameter.stored(offset)
    return result


def _check_ranges(
    robot: Table,
    parameters: tuple[Parameter, ...],
    described: UrdfRobot,
    motion: Motion,
) -> None:
    """Refuse parameters of the wrong unit and values that their joints cannot take."""
    kinds = {joint.name: joint.kind for joint in described.joints}
    for i, (parameter, couple) in enumerate(zip(parameters, motion.couples, strict=True), 1):
        joint = couple.first
        wanted = "m" if kinds[joint] == "prismatic" else "rad"
        if parameter.unit != wanted:
            needed = "a length" if wanted == "m" else "an angle"
            robot.fail(
                f"parameter[{i}].unit",
                f"must be {needed}: joint {joint!r} is {kinds[joint]}",
                parameter.display_unit,
                'write unit = "m"' if wanted == "m" else 'write unit = "deg"',
            )
        low, high = motion.free[joint]
        whole = wanted == "rad" and high - low >= TURN
        if not whole and not low - SAME <= parameter.minimum < parameter.maximum <= high + SAME:
            limits = "the limits of " + ", ".join(map(repr, couple.joints))
            robot.fail(
                f"parameter[{i}].min",
                f"and max must lie within {low:g} to {high:g} {wanted}, {limits}",
                [parameter.minimum, parameter.maximum],
                "narrow them or correct the description",
            )
