"""Robots given by code: ``[robot] python = "module:function"``.

Loading such a recipe runs code, so it happens only when the caller allows it.
"""

import importlib
import importlib.machinery
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from lutgen.parts import Parameter
from lutgen.recipe.robot_keys import MAX_CONTACTS
from lutgen.recipe.table import Table


def load_function(
    robot: Table, name: str, parameters: tuple[Parameter, ...], allow_python: bool
) -> tuple[Callable[..., Any], int]:
    """Import a posture function and call it once at the middle of its parameters.

    The module of `name`, ``"module:function"``, is looked for in the recipe's folder first; without
    `allow_python` no code runs.  Returns ``q (m, k) -> contacts (m, n, 3), com (m, 3)`` and n.
    """
    if not allow_python:
        robot.fail("python", "runs code", name, "pass --allow-python if you trust it")
    module_name, colon, function_name = name.partition(":")
    if not (colon and function_name and module_name):
        robot.fail("python", "must be module:function", name, "write for example 'rover:postures'")
    module = _import(robot, name, module_name)
    function = getattr(module, function_name, None)
    if not callable(function):
        robot.fail("python", f"module has no function {function_name}", name, "check the name")
    middle = np.array([[(p.minimum + p.maximum) / 2.0 for p in parameters]])
    result = function(middle.reshape(1, len(parameters)))
    if not isinstance(result, tuple) or len(result) != 2:
        kind = type(result).__name__
        robot.fail("python", "must return contacts and com", kind, "return a tuple of two arrays")
    contacts, com = np.shape(result[0]), np.shape(result[1])
    if len(contacts) != 3 or contacts[0] != 1 or contacts[2] != 3 or com != (1, 3):
        robot.fail(
            "python",
            "must return contacts (m, n, 3) and com (m, 3)",
            [contacts, com],
            "check the shapes for m = 1",
        )
    if not 3 <= contacts[1] <= MAX_CONTACTS:
        robot.fail(
            "python",
            f"must return 3 to {MAX_CONTACTS} contacts",
            contacts[1],
            "return those that can touch the ground",
        )
    if not (np.isfinite(result[0]).all() and np.isfinite(result[1]).all()):
        robot.fail("python", "returns NaN or infinity at the middle posture", name, "correct it")
    return function, contacts[1]


def _import(robot: Table, name: str, module_name: str) -> ModuleType:
    """Import a module with the recipe's folder first on the path, for this call only."""
    folder = str(Path(robot.source).resolve().parent)
    top = module_name.partition(".")[0]
    loaded = sys.modules.get(top)
    ours = importlib.machinery.PathFinder.find_spec(top, [folder])
    if loaded is not None and ours is not None:
        origin = getattr(loaded.__spec__, "origin", None)
        if origin != ours.origin:
            robot.fail(
                "python",
                f"a module of this name is loaded already from {origin}",
                name,
                "rename the file beside the recipe",
            )
    sys.path.insert(0, folder)
    try:
        importlib.invalidate_caches()
        return importlib.import_module(module_name)
    except ImportError as error:
        robot.fail("python", f"cannot be imported: {error}", name, "check the module's name")
    finally:
        sys.path.remove(folder)
