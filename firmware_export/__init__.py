"""Export of stability maps as C tables with a small runtime."""

from firmware_export.exporter import export

__all__ = ["export"]
