"""The verdict's table where a robot's standing region jumps.

In reading order: `outline`, `lower`, `knots`, `train`.
"""

from firmware_export.verdict.knots import balanced, chosen_knots

__all__ = ["balanced", "chosen_knots"]
