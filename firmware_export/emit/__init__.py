"""An export written as C, with its report.

In reading order: `names`, `runtime`, `size`, `facts`, `render`, `package`; the texts are in
`templates/`.
"""

from firmware_export.emit.facts import bytes_text, errors_of, share
from firmware_export.emit.names import check_name, default_name
from firmware_export.emit.package import check_directory, load_report, write
from firmware_export.emit.size import family_row, flash_bytes
