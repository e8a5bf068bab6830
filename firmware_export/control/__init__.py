"""On-board control: the policy of a robot, and an export that has one.

In reading order: `limits`, `objective`, `choose`, `polish`, `measure`,
`maker`, `folder`, `steering`, `ride`, `log`, `loop`.
"""

from firmware_export.control.folder import policy, steered
from firmware_export.control.log import read_log
from firmware_export.control.loop import Loop, Plant, controlled, uncontrolled
from firmware_export.control.maker import Design, Wishes, design
from firmware_export.control.measure import Loss
from firmware_export.control.ride import Ride, ride_along, ride_logged
from firmware_export.control.steering import Steering, steering_in, steering_of

__all__ = [
    "Design",
    "Loop",
    "Loss",
    "Plant",
    "Ride",
    "Steering",
    "Wishes",
    "controlled",
    "design",
    "policy",
    "read_log",
    "ride_along",
    "ride_logged",
    "steered",
    "steering_in",
    "steering_of",
    "uncontrolled",
]
