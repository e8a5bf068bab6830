"""The search for the smallest tables that keep what was asked.

In reading order: `trials`, `goal`, `choice`.
"""

from firmware_export.choose.choice import choose, front
from firmware_export.choose.goal import KNEE, Goal
from firmware_export.choose.trials import Candidate, Trials

__all__ = ["KNEE", "Candidate", "Goal", "Trials", "choose", "front"]
