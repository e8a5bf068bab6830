"""Codec `grid`: multilinear tables over the parameters and the chart.

In reading order: `spec`, `tables`, `lattice`, `fit`, `guard`, `margin`, `read`, `read_integer`,
`codec`.
"""

from firmware_export.grid.lattice import Lattice, corners, from_places, to_places
from firmware_export.grid.margin import Codes
from firmware_export.grid.spec import LARGEST
from firmware_export.grid.tables import SPAN, U, V

__all__ = ["LARGEST", "SPAN", "Codes", "Lattice", "U", "V", "corners", "from_places", "to_places"]
