"""Robots given by a file beside the recipe: ``[robot] urdf`` a description, ``python`` code."""

import importlib
import importlib.machinery
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from lutgen import bounds
from lutgen.arrays import Floats
from lutgen.errors import InputError, LutgenError, RecipeError, reject, suggestion
from lutgen.parts import Contact, Link, Parameter, to_internal
from lutgen.recipe import schema
from lutgen.recipe.load import Fault, fail, refuse, utf8
from lutgen.recipe.model import Recipe
from lutgen.recipe.schema import MAX_CONTACTS, Robot
from lutgen.urdf.description import UrdfRobot
from lutgen.urdf.joints import TURN, Couple, Motion, read_motion
from lutgen.urdf.links import link_contacts, links_of
from lutgen.urdf.read import parse_urdf

# rad or m: descriptions round their limits, and so do recipes in deg.
SAME = 1e-6


def read_description(source: str, name: str) -> str:
    """Return the text of the file of this name, in the folder of a recipe or below."""
    key, way_out = "robot.urdf", "copy the file beside the recipe and write its name"
    folder = Path(source).resolve().parent
    try:
        target = (folder / name).resolve()
        inside, there = target.is_relative_to(folder), target.is_file()
    except (OSError, RuntimeError, ValueError) as error:
        fail(source, key, f"cannot be read: {error}", name, way_out)
    if not (inside and there):
        what = "names no file" if inside else "leads out of the recipe's folder"
        fail(source, key, what, name, way_out)
    return utf8(bounds.read(str(target), bounds.URDF_BYTES), f"{source}: {name}")


def links_and_shapes(
    robot: Robot, parameters: tuple[Parameter, ...], content: str, source: str
) -> tuple[tuple[Link, ...], dict[int, list[Contact]]]:
    """Return the links of a recipe's description, and the shapes of contacts without a position.

    Each parameter is the joint of its `joint` key or its own name, or drives those of its `drive`;
    all others stand at zero or at their limit nearest to it, and joints that mimic one follow it.
    """
    described = parse_urdf(content, f"{source}: {robot.urdf}")
    known = [joint.name for joint in described.joints if joint.kind != "fixed"]
    refuse(source, _joint_faults(robot, known))
    couples = [Couple(one.name, _driven(one)) for one in robot.parameter]
    motion = read_motion(described, (), couples=couples)
    refuse(source, _range_faults(parameters, described, motion))
    links = links_of(described, motion, {couple.first: couple.name for couple in couples})
    bodies = {link.name: link for link in described.links}
    shapes = {
        place: link_contacts(bodies[contact.link], contact.name)
        for place, contact in enumerate(robot.contact)
        if contact.position is None and contact.link in bodies
    }
    refuse(source, _shape_faults(robot, described, shapes))
    return links, shapes


def _driven(parameter: schema.Parameter) -> dict[str, tuple[float, float]]:
    if parameter.drive is None:
        return {parameter.joint or parameter.name: (1.0, 0.0)}
    return {
        name: (one.scale, to_internal(one.offset, parameter.unit))
        if isinstance(one, schema.Step)
        else (one, 0.0)
        for name, one in parameter.drive.items()
    }


def _joint_faults(robot: Robot, known: list[str]) -> Iterator[Fault]:
    taken: set[str] = set()
    for place, parameter in enumerate(robot.parameter, 1):
        for name in _driven(parameter):
            key = f"robot.parameter[{place}].{'name' if parameter.joint is None else 'joint'}"
            if parameter.drive is not None:
                key = f"robot.parameter[{place}].drive.{name}"
            if name not in known:
                way_out = suggestion(name, known, "use one of")
                yield Fault(key, "is no moving joint of the description", name, way_out)
            elif name in taken:
                what = "is the joint of another parameter already"
                yield Fault(key, what, name, "remove one")
            taken.add(name)


def _range_faults(
    parameters: tuple[Parameter, ...], described: UrdfRobot, motion: Motion
) -> Iterator[Fault]:
    kinds = {joint.name: joint.kind for joint in described.joints}
    for place, (parameter, couple) in enumerate(zip(parameters, motion.couples, strict=True), 1):
        key, joint = f"robot.parameter[{place}]", couple.first
        wanted = "m" if kinds[joint] == "prismatic" else "rad"
        if parameter.unit != wanted:
            needed = "a length" if wanted == "m" else "an angle"
            what = f"must be {needed}: joint {joint!r} is {kinds[joint]}"
            way_out = 'write unit = "m"' if wanted == "m" else 'write unit = "deg"'
            yield Fault(f"{key}.unit", what, parameter.display_unit, way_out)
            continue
        low, high = motion.free[joint]
        whole = wanted == "rad" and high - low >= TURN
        if not whole and not low - SAME <= parameter.minimum < parameter.maximum <= high + SAME:
            limits = "the limits of " + ", ".join(map(repr, couple.joints))
            what = f"and max must lie within {low:g} to {high:g} {wanted}, {limits}"
            got = [parameter.minimum, parameter.maximum]
            yield Fault(f"{key}.min", what, got, "narrow them or correct the description")


def _shape_faults(
    robot: Robot, described: UrdfRobot, shapes: dict[int, list[Contact]]
) -> Iterator[Fault]:
    collisions = {link.name: link.collisions for link in described.links}
    for place, found in shapes.items():
        key, contact = f"robot.contact[{place + 1}]", robot.contact[place]
        if not found:
            kinds = [shape.kind for shape in collisions[contact.link]]
            what = "has no collision sphere, cylinder or box, and the contact no position"
            yield Fault(
                f"{key}.link", what, kinds, "write position = [x, y, z] in the link's frame"
            )
        if contact.rolling and any(one.radius == 0.0 for one in found):
            yield Fault(f"{key}.rolling", "needs a round shape", True, "a box slides: remove it")


def body_parts(recipe: Recipe) -> tuple[Contact, ...]:
    """Return what is known of the body above the contacts, in its links' frames, length unit.

    The com of every link that has a mass, and the shapes of a description's links without contacts.
    """
    if recipe.python is not None:
        return ()
    touching = {contact.link for contact in recipe.contacts}
    parts = [Contact(link.name, link.name, link.com) for link in recipe.links if link.mass > 0.0]
    if recipe.urdf is not None:
        for link in parse_urdf(recipe.urdf, recipe.source).links:
            if link.name not in touching:
                parts += link_contacts(link)
    return tuple(parts)


def load_function(
    source: str, name: str, parameters: tuple[Parameter, ...], allow_python: bool
) -> tuple[Callable[..., Any], int]:
    """Import a posture function, from the recipe's folder first, and call it once in mid-range.

    Returns ``q (m, k) -> contacts (m, n, 3), com (m, 3)`` and n.
    """
    refuse = partial(fail, source, "robot.python")
    if not allow_python:
        refuse("runs code", name, "pass --allow-python if you trust it")
    module_name, _, function_name = name.partition(":")
    if not (function_name and module_name):
        refuse("must be module:function", name, "write for example 'rover:postures'")
    function = getattr(_import(source, name, module_name), function_name, None)
    if not callable(function):
        refuse(f"module has no function {function_name}", name, "check the name")
    middle = np.array([[(p.minimum + p.maximum) / 2.0 for p in parameters]])
    contacts, _ = answered(source, function, middle, kind=RecipeError)
    if not 3 <= contacts.shape[1] <= MAX_CONTACTS:
        what = f"must return 3 to {MAX_CONTACTS} contacts"
        refuse(what, contacts.shape[1], "return those that can touch the ground")
    return function, contacts.shape[1]


def answered(
    source: str,
    function: Callable[..., Any],
    values: Floats,
    count: int | str = "n",
    kind: type[LutgenError] = InputError,
) -> tuple[Floats, Floats]:
    """Return contacts (m, n, 3) and com (m, 3) as a function has them for parameters (m, k)."""

    def refuse(what: str, got: object, way_out: str) -> NoReturn:
        reject(f"{source}: key `robot.python`", what, got, way_out, kind)

    rows, result = len(values), function(values)
    if not isinstance(result, tuple) or len(result) != 2:
        got = repr(type(result).__name__)
        refuse("must return contacts and com", got, "return a tuple of two arrays")
    contacts, com = (np.asarray(part, dtype=np.float64) for part in result)
    shape = (rows, contacts.shape[1] if count == "n" and contacts.ndim == 3 else count, 3)
    if contacts.shape != shape or com.shape != (rows, 3):
        what = f"must return contacts ({rows}, {count}, 3) and com ({rows}, 3)"
        refuse(what, [contacts.shape, com.shape], "check the shapes")
    if not (np.isfinite(contacts).all() and np.isfinite(com).all()):
        refuse("must return finite numbers", "NaN or infinity", "correct the function")
    return contacts, com


def _import(source: str, name: str, module_name: str) -> ModuleType:
    """Import a module with the recipe's folder first on the path, for this call only."""
    folder = str(Path(source).resolve().parent)
    top = module_name.partition(".")[0]
    loaded = sys.modules.get(top)
    ours = importlib.machinery.PathFinder.find_spec(top, [folder])
    origin = getattr(getattr(loaded, "__spec__", None), "origin", None)
    if loaded is not None and ours is not None and origin != ours.origin:
        what = f"a module of this name is loaded already from {origin}"
        fail(source, "robot.python", what, name, "rename the file beside the recipe")
    sys.path.insert(0, folder)
    try:
        importlib.invalidate_caches()
        return importlib.import_module(module_name)
    except ImportError as error:
        fail(source, "robot.python", f"cannot be imported: {error}", name, "check the name")
    finally:
        sys.path.remove(folder)
