"""Tables of the codec `grid`: multilinear tables over the parameters and the chart.

In reading order: `spec`, `tables`, `lattice`, `codes`, `fit`, `codec`, `points`,
`lookup`.
"""

from firmware_export.grid.codec import (
    DTYPE,
    lattice_of,
    length_table,
    part_of,
    rounding,
    tip_part,
    too_large,
)
from firmware_export.grid.codes import Codes
from firmware_export.grid.fit import conjugate
from firmware_export.grid.lattice import Lattice, from_places, spread_knots, to_places
from firmware_export.grid.lookup import INFO
from firmware_export.grid.spec import CHANNEL, GROUPS, LARGEST, Spec, active_axes, grow, start
from firmware_export.grid.tables import SPAN, Part, Tables, U, V, evenly, places_of

__all__ = [
    "CHANNEL",
    "DTYPE",
    "GROUPS",
    "INFO",
    "LARGEST",
    "SPAN",
    "Codes",
    "Lattice",
    "Part",
    "Spec",
    "Tables",
    "U",
    "V",
    "active_axes",
    "conjugate",
    "evenly",
    "from_places",
    "grow",
    "lattice_of",
    "length_table",
    "part_of",
    "places_of",
    "rounding",
    "spread_knots",
    "start",
    "tip_part",
    "to_places",
    "too_large",
]
