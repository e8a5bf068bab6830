"""The C runtime on this machine, asked with blobs in memory.

In reading order: `library`, `reader`, `control`.
"""

from firmware_export.host.control import (
    BLIND,
    CYCLE,
    ESCAPES,
    HELD,
    MOVES,
    RESTS,
    Controller,
    budget,
)
from firmware_export.host.library import RUNTIME, load_library
from firmware_export.host.reader import STANDS, Host, family_of, stem_of

__all__ = [
    "BLIND",
    "CYCLE",
    "ESCAPES",
    "HELD",
    "MOVES",
    "RESTS",
    "RUNTIME",
    "STANDS",
    "Controller",
    "Host",
    "budget",
    "family_of",
    "load_library",
    "stem_of",
]
