"""Codec `poly`: three contacts as Chebyshev polynomials of the parameters.

In reading order: `series`, `bound`, `fit`, `read`, `codec`.
"""
