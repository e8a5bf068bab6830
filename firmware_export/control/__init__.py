"""On-board control: the policy of a robot, and an export that has one.

In reading order: `limits`, `objective`, `choose`, `measure`, `maker`, `folder`.
"""

from firmware_export.control.folder import policy, steered
from firmware_export.control.maker import Design, Wishes, design
from firmware_export.control.measure import Loss

__all__ = ["Design", "Loss", "Wishes", "design", "policy", "steered"]
