"""Codec `grid` where a robot's standing region jumps.

In reading order: `outline`, `lower`, `knots`, `train`, `codec`.
"""

from firmware_export.verdict.codec import INFO

__all__ = ["INFO"]
