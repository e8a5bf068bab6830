"""Stability maps for robots that can change their shape.

The names below are the whole public interface.  They are imported on first use, so that
`lutgen --help` need not wait for numba.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from lutgen._version import __version__

if TYPE_CHECKING:
    from lutgen.channels import evaluate as evaluate
    from lutgen.channels import stability as stability
    from lutgen.errors import ExportError as ExportError
    from lutgen.errors import InputError as InputError
    from lutgen.errors import LutgenError as LutgenError
    from lutgen.errors import MapFileError as MapFileError
    from lutgen.errors import RecipeError as RecipeError
    from lutgen.errors import SweepError as SweepError
    from lutgen.mapping import load_map as load_map
    from lutgen.mapping import sweep as sweep
    from lutgen.recipe import load_recipe as load_recipe
    from lutgen.recipe import parse_recipe as parse_recipe
    from lutgen.recipe import postures as postures
    from lutgen.search import optimum as optimum

_HOME = {
    "errors": "ExportError InputError LutgenError MapFileError RecipeError SweepError",
    "channels": "evaluate stability",
    "mapping": "load_map sweep",
    "recipe": "load_recipe parse_recipe postures",
    "search": "optimum",
}
_ROOM = {name: room for room, names in _HOME.items() for name in names.split()}
__all__ = [*_ROOM, "__version__"]


if not TYPE_CHECKING:
    # Seen by a type checker it would give any name a type, also a misspelt one.
    def __getattr__(name: str) -> Any:
        """Import a public name from its module (PEP 562)."""
        if name not in _ROOM:
            raise AttributeError(f"module 'lutgen' has no attribute {name!r}")
        return getattr(import_module(f"lutgen.{_ROOM[name]}"), name)


def __dir__() -> list[str]:
    """Return the public names."""
    return sorted(__all__)
