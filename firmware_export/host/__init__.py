"""The C runtime on this machine, on blobs in memory.

In reading order: `reader`, `control`.
"""

from firmware_export.host.control import Controller
from firmware_export.host.reader import (
    FULL_SCALE,
    RUNTIME,
    STANDS,
    Host,
    family_of,
    in_units,
    load_library,
    stem_of,
)
