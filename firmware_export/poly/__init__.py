"""Codec `poly`: three contacts as Chebyshev polynomials of the parameters.

In reading order: `series`, `bound`, `fit`, `codec`.
"""

from firmware_export.poly.codec import INFO, least_edge_of
from firmware_export.poly.series import rounds

__all__ = ["INFO", "least_edge_of", "rounds"]
