"""The C runtime on this machine, asked with blobs in memory.

In reading order: `library`, `reader`.
"""

from firmware_export.host.library import RUNTIME, load_library
from firmware_export.host.reader import Host

__all__ = ["RUNTIME", "Host", "load_library"]
