"""The reference of Python.  Owns which names it lists; the docstrings have the rest."""

from importlib import import_module
from inspect import isclass
from types import ModuleType

import firmware_export
import lutgen
from lutgen import analysis, chart, plot, search

__all__ = ["ROOMS", "page"]

_HEAD = """# Every name of Python

Made from the docstrings by `make docs`. [Python](../guide/python.md) shows them at work.

**Promised** are the names of `lutgen` and `firmware_export`: the
[deprecation policy](deprecation.md) holds for them. The others serve the command line and the
guides; they are documented as they are now, and may change in any version, which the changelog then
says.

Angles are in rad, lengths in the recipe's unit, and arrays are C-contiguous float64 where nothing
else is said.
"""
# What the promised names return, by the module that it is documented in.
_RETURNED = {
    "lutgen.mapping": ["StabilityMap"],
    "lutgen.recipe": ["Recipe", "Postures"],
}
# The rooms whose names the guides use, with the head of their section.
ROOMS: dict[str, tuple[ModuleType, list[str]]] = {
    "Questions about one posture": (analysis, analysis.__all__),
    "Search and paths": (search, [name for name in search.__all__ if name != "optimum"]),
    "Gravity": (chart, ["Chart", "gravity_from_up", "gravito_inertial", "unit_directions"]),
    "Figures": (plot, plot.__all__),
}


def _entry(module: str, name: str) -> str:
    """Return the directive of a function or a class; of a constant, its value."""
    thing = getattr(import_module(module), name)
    if isclass(thing):
        kind = "autoexception" if issubclass(thing, Exception) else "autoclass"
        members = "" if kind == "autoexception" else "\n   :members:"
    elif callable(thing):
        kind, members = "autofunction", ""
    else:
        kind, members = "py:data", f"\n   :value: {thing!r}"
    return f"```{{eval-rst}}\n.. {kind}:: {module}.{name}{members}\n```"


def page() -> str:
    """Return the page."""
    errors = [name for name in lutgen.__all__ if name.endswith("Error")]
    others = [name for name in lutgen.__all__ if name not in errors]
    return "\n\n".join(
        [
            _HEAD,
            "## The package `lutgen`",
            *(_entry("lutgen", name) for name in others),
            "## Export to C",
            *(_entry("firmware_export", name) for name in firmware_export.__all__),
            "## Errors",
            *(_entry("lutgen", name) for name in errors),
            "## What is returned",
            *(_entry(home, name) for home, names in _RETURNED.items() for name in names),
            *(
                part
                for title, (room, names) in ROOMS.items()
                for part in (f"## {title}", *(_entry(room.__name__, name) for name in names))
            ),
            "",
        ]
    )
