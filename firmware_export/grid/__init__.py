"""Codec `grid`: multilinear tables over the parameters and the chart.

In reading order: `spec`, `tables`, `lattice`, `fit`, `guard`, `margin`, `codec`.
"""

from firmware_export.grid.codec import (
    DTYPE,
    INFO,
    lattice_of,
    length_table,
    part_of,
    places_of,
    rounding,
    tip_part,
    too_large,
)
from firmware_export.grid.fit import conjugate
from firmware_export.grid.guard import is_smooth
from firmware_export.grid.lattice import Lattice, from_places, spread_knots, to_places
from firmware_export.grid.margin import Codes
from firmware_export.grid.spec import CHANNEL, GROUPS, LARGEST, Spec, active_axes
from firmware_export.grid.tables import SPAN, Part, Tables, U, V

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
    "from_places",
    "is_smooth",
    "lattice_of",
    "length_table",
    "part_of",
    "places_of",
    "rounding",
    "spread_knots",
    "tip_part",
    "to_places",
    "too_large",
]
