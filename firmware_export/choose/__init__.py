"""The search for the smallest tables that keep what was asked.

In reading order: `candidate`, `goal`, `foresee`, `climb`.
"""

from firmware_export.choose.candidate import Bench, Candidate
from firmware_export.choose.climb import choose, front
from firmware_export.choose.goal import KNEE, Goal

__all__ = ["KNEE", "Bench", "Candidate", "Goal", "choose", "front"]
