"""Robots given by code: ``[robot] python = "module:function"``.

Loading such a recipe runs code, so it happens only when the caller allows it.
"""

import importlib
import importlib.machinery
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from lutgen.parts import Parameter
from lutgen.recipe.load import fail
from lutgen.recipe.schema import MAX_CONTACTS


def load_function(
    source: str, name: str, parameters: tuple[Parameter, ...], allow_python: bool
) -> tuple[Callable[..., Any], int]:
    """Import a posture function and call it once at the middle of its parameters.

    The module of `name`, ``"module:function"``, is looked for in the recipe's folder first; without
    `allow_python` no code runs.  Returns ``q (m, k) -> contacts (m, n, 3), com (m, 3)`` and n.
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
    result = function(middle.reshape(1, len(parameters)))
    if not isinstance(result, tuple) or len(result) != 2:
        kind = type(result).__name__
        refuse("must return contacts and com", kind, "return a tuple of two arrays")
    contacts, com = np.shape(result[0]), np.shape(result[1])
    if len(contacts) != 3 or contacts[0] != 1 or contacts[2] != 3 or com != (1, 3):
        what = "must return contacts (m, n, 3) and com (m, 3)"
        refuse(what, [contacts, com], "check the shapes for m = 1")
    if not 3 <= contacts[1] <= MAX_CONTACTS:
        what = f"must return 3 to {MAX_CONTACTS} contacts"
        refuse(what, contacts[1], "return those that can touch the ground")
    if not (np.isfinite(result[0]).all() and np.isfinite(result[1]).all()):
        refuse("returns NaN or infinity at the middle posture", name, "correct it")
    return function, contacts[1]


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
