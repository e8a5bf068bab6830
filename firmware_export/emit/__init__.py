"""An export written as C, with its report.

In reading order: `names`, `text`, `size`, `runtime`, `facts`, `words`, `render`, `report`,
`trial`, `package`; the texts are in `templates/`.
"""

from firmware_export.emit.facts import flash_bytes
from firmware_export.emit.names import check_name, default_name
from firmware_export.emit.package import check_directory, write
from firmware_export.emit.report import load_report
from firmware_export.emit.size import code_bytes
from firmware_export.emit.words import bytes_text, errors_of, share

__all__ = [
    "bytes_text",
    "check_directory",
    "check_name",
    "code_bytes",
    "default_name",
    "errors_of",
    "flash_bytes",
    "load_report",
    "share",
    "write",
]
