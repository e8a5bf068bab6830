"""Standing regions and directions of gravity into numbers.

In reading order: `angles`, `axes`, `barrier`, `plain`, `block`, `loaded`, `wrench`, `batch`,
`evaluation`, `crossing`, `raster`, `tilt_rows`, `scan`, `settle`.
"""

from lutgen.channels.angles import JUST_OUTSIDE, tip_angle
from lutgen.channels.axes import MU, PHI, RHO, add, empty_axes, find_axes, part
from lutgen.channels.batch import for_each_posture
from lutgen.channels.crossing import cross_boundary
from lutgen.channels.evaluation import (
    evaluate,
    evaluate_each,
    measure_moved,
    measure_recipe,
    stability,
)
from lutgen.channels.loaded import axis_angle, loaded_axis, loaded_margin, loaded_verdict
from lutgen.channels.plain import (
    ALONG,
    ASIDE,
    HEIGHT_BEYOND,
    axis_energy,
    axis_margin,
    checked_directions,
    measure,
    room_for_ridges,
    wanted_channels,
)
from lutgen.channels.scan import Scanner
from lutgen.channels.settle import CONVENTIONS, body_gravity, turned
from lutgen.channels.wrench import acceptance_of, refuse_forces, wrenches

__all__ = [
    "ALONG",
    "ASIDE",
    "CONVENTIONS",
    "HEIGHT_BEYOND",
    "JUST_OUTSIDE",
    "MU",
    "PHI",
    "RHO",
    "Scanner",
    "acceptance_of",
    "add",
    "axis_angle",
    "axis_energy",
    "axis_margin",
    "body_gravity",
    "checked_directions",
    "cross_boundary",
    "empty_axes",
    "evaluate",
    "evaluate_each",
    "find_axes",
    "for_each_posture",
    "loaded_axis",
    "loaded_margin",
    "loaded_verdict",
    "measure",
    "measure_moved",
    "measure_recipe",
    "part",
    "refuse_forces",
    "room_for_ridges",
    "stability",
    "tip_angle",
    "turned",
    "wanted_channels",
    "wrenches",
]
