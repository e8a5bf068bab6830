"""Stability maps for robots that can change their shape.

The names below are the whole public interface.  They are imported on first use, so that
`lutgen --help` need not wait for numba.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from lutgen._version import __version__

if TYPE_CHECKING:
    from lutgen.channels import evaluate, stability
    from lutgen.errors import (
        ExportError,
        InputError,
        LutgenError,
        MapFileError,
        RecipeError,
        SweepError,
    )
    from lutgen.mapping import load_map, sweep
    from lutgen.recipe import load_recipe, parse_recipe, postures
    from lutgen.search import optimum

_HOME = {
    **dict.fromkeys(("LutgenError", "ExportError", "InputError"), "errors"),
    **dict.fromkeys(("MapFileError", "RecipeError", "SweepError"), "errors"),
    **dict.fromkeys(("evaluate", "stability"), "channels"),
    **dict.fromkeys(("load_map", "sweep"), "mapping"),
    **dict.fromkeys(("load_recipe", "parse_recipe", "postures"), "recipe"),
    "optimum": "search",
}

__all__ = [
    "ExportError",
    "InputError",
    "LutgenError",
    "MapFileError",
    "RecipeError",
    "SweepError",
    "__version__",
    "evaluate",
    "load_map",
    "load_recipe",
    "optimum",
    "parse_recipe",
    "postures",
    "stability",
    "sweep",
]


if not TYPE_CHECKING:
    # Seen by a type checker it would give any name a type, also a misspelt one.
    def __getattr__(name: str) -> Any:
        """Import a public name from its module (PEP 562)."""
        if name not in _HOME:
            raise AttributeError(f"module 'lutgen' has no attribute {name!r}")
        return getattr(import_module(f"lutgen.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
