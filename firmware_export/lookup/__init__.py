"""Codec `grid` for three contacts: positions looked up, exact in gravity, also without floats.

In reading order: `fit`, `codec`.
"""

from firmware_export.lookup.codec import INFO

__all__ = ["INFO"]
