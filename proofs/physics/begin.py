"""The plane on which a robot is put before it is let go."""

import math
from dataclasses import dataclass

from proofs.physics.body import Floats


@dataclass(frozen=True)
class Start:
    """A plane that the robot touches: outward normal, distance from the com, contact points.

    `balanced` tells that there are two points only, and `share` how far from the first to the
    second gravity passes; on a facet it is NaN.
    """

    normal: Floats
    height: float
    points: Floats
    balanced: bool = False
    share: float = math.nan

    def slope(self, gravity_dir: Floats) -> float:
        """Return the angle (rad) between gravity and the normal."""
        return math.acos(min(1.0, max(-1.0, float(self.normal @ gravity_dir))))
