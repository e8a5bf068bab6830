"""Standing regions and directions of gravity into numbers.

In reading order: `angles`, `energy`, `exact`, `axes`, `shares`, `loads`, `wrench`, `evaluation`,
`rows`, `scan`, `resting`.
"""

from lutgen.channels.angles import JUST_OUTSIDE, arc_angle
from lutgen.channels.axes import MU, PHI, RHO, empty_axes, find_axes, part
from lutgen.channels.energy import axis_energy, segment_energy
from lutgen.channels.evaluation import (
    evaluate,
    evaluate_each,
    for_each_posture,
    measure_moved,
    measure_recipe,
    stability,
)
from lutgen.channels.exact import (
    Setting,
    axis_margin,
    checked_directions,
    measure,
    wanted_channels,
)
from lutgen.channels.loads import axis_angle, loaded_margin, loaded_verdict, measure_loaded
from lutgen.channels.resting import CONVENTIONS, body_gravity, turned
from lutgen.channels.scan import Scanner
from lutgen.channels.shares import axle_foot, smallest_shares
from lutgen.channels.wrench import acceptance_of, primitives_of, refuse_forces, wrenches

__all__ = [
    "CONVENTIONS",
    "JUST_OUTSIDE",
    "MU",
    "PHI",
    "RHO",
    "Scanner",
    "Setting",
    "acceptance_of",
    "arc_angle",
    "axis_angle",
    "axis_energy",
    "axis_margin",
    "axle_foot",
    "body_gravity",
    "checked_directions",
    "empty_axes",
    "evaluate",
    "evaluate_each",
    "find_axes",
    "for_each_posture",
    "loaded_margin",
    "loaded_verdict",
    "measure",
    "measure_loaded",
    "measure_moved",
    "measure_recipe",
    "part",
    "primitives_of",
    "refuse_forces",
    "segment_energy",
    "smallest_shares",
    "stability",
    "turned",
    "wanted_channels",
    "wrenches",
]
