"""An export written as C, with its report.

In reading order: `array`, `names`, `text`, `export`, `size`, `config`, `facts`, `header`,
`source`, `example`, `project_files`, `page`, `figure`, `report`, `package`.
"""

from firmware_export.emit.array import CArray, CBody
from firmware_export.emit.config import features
from firmware_export.emit.export import CHANNELS, Export
from firmware_export.emit.facts import bytes_text, error_texts, flash_bytes, share
from firmware_export.emit.names import check_name, default_name
from firmware_export.emit.package import check_directory, write
from firmware_export.emit.size import code_bytes
from firmware_export.emit.text import literal

__all__ = [
    "CHANNELS",
    "CArray",
    "CBody",
    "Export",
    "bytes_text",
    "check_directory",
    "check_name",
    "code_bytes",
    "default_name",
    "error_texts",
    "features",
    "flash_bytes",
    "literal",
    "share",
    "write",
]
