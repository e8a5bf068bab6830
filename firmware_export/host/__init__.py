"""The C runtime on this machine, asked with blobs in memory.

In reading order: `library`, `reader`, `control`.
"""

from firmware_export.host.control import BLIND, ESCAPES, Controller, budget
from firmware_export.host.library import RUNTIME, load_library
from firmware_export.host.reader import FULL_SCALE, STANDS, Host, family_of, in_units, stem_of
