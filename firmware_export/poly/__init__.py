"""Codec `poly`: three contacts as Chebyshev polynomials of the parameters.

In reading order: `series`, `bound`, `fit`, `codec`.
"""

from firmware_export.poly.codec import INFO

__all__ = ["INFO"]
