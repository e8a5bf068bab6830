"""Tables of the codec `grid`: trees, and multilinear tables over the parameters and the chart.

In reading order: `spec`, `tables`, `lattice`, `fit`, `codec`, `points`, `across`, `lookup`.
"""

from firmware_export.grid.codec import blank, length_table, too_large
from firmware_export.grid.lookup import INFO
from firmware_export.grid.spec import LEAST, MOST_TREE, Spec, of_nodes
from firmware_export.grid.tables import PLACES, RATE, Fold, Tables, Trees, places_of

__all__ = [
    "INFO",
    "LEAST",
    "MOST_TREE",
    "PLACES",
    "RATE",
    "Fold",
    "Spec",
    "Tables",
    "Trees",
    "blank",
    "length_table",
    "of_nodes",
    "places_of",
    "too_large",
]
