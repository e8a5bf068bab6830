"""Codec `poly`: three contacts as Chebyshev polynomials of the parameters.

In reading order: `series`, `bound`, `fit`, `codec`.
"""

from firmware_export.poly.bound import carries_everywhere, least_edge
from firmware_export.poly.codec import INFO
from firmware_export.poly.series import expand, rounds

__all__ = ["INFO", "carries_everywhere", "expand", "least_edge", "rounds"]
