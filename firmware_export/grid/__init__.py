"""Tables of the codec `grid`: of three contacts' positions, or trained over parameters and gravity.

In reading order: `lookup`; `ground`, `train`, `fit`, `table`.
"""

from firmware_export.grid.lookup import INFO as LOOKUP
from firmware_export.grid.table import INFO as TABLE
