"""On-board control: the policy of a robot, and an export that has one.

In reading order: `limits`, `table`, `maker`, `steering`, `ride`, `loop`.
"""

from firmware_export.control.loop import Loop, Plant, controlled, uncontrolled
from firmware_export.control.maker import Design, Loss, PolicyOptions, design
from firmware_export.control.ride import Ride, ride_along, ride_logged
from firmware_export.control.steering import Steering, policy, steered, steering_in, steering_of
