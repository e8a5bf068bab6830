"""Export of stability maps as C tables with a small runtime."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from firmware_export.exporter import export

__all__ = ["export"]


if not TYPE_CHECKING:
    # Seen by a type checker it would give any name a type, also a misspelt one.
    def __getattr__(name: str) -> Any:
        """Import `export` on first use (PEP 562): it waits for numba."""
        if name != "export":
            raise AttributeError(f"module 'firmware_export' has no attribute {name!r}")
        return import_module("firmware_export.exporter").export
