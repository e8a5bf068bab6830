"""Robots given by code: ``[robot] python = "module:function"``."""

import importlib
import importlib.machinery
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

from lutgen.errors import InputError, LutgenError, RecipeError, reject
from lutgen.parts import Parameter
from lutgen.recipe.load import fail
from lutgen.recipe.schema import MAX_CONTACTS
from lutgen.vector import Floats


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
    middle = middle.reshape(1, len(parameters))
    contacts, _ = asked(source, function, middle, kind=RecipeError)
    if not 3 <= contacts.shape[1] <= MAX_CONTACTS:
        what = f"must return 3 to {MAX_CONTACTS} contacts"
        refuse(what, contacts.shape[1], "return those that can touch the ground")
    return function, contacts.shape[1]


def asked(
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
        got = type(result).__name__
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
