"""Standing regions and directions of gravity into numbers.

In reading order: `plain`, `axes`, `loaded`, `load`, `settle`, `evaluation`, `each`, `raster`,
`tilt_rows`, `scan`, `scanner`.
"""

from lutgen.channels.axes import MU, PHI, add, empty_axes, find_axes, part
from lutgen.channels.each import ALONG, ASIDE, HEIGHT_BEYOND, evaluate_each, measure_each
from lutgen.channels.evaluation import evaluate, measure_moved
from lutgen.channels.load import RHO, limits_of, loads, measure_recipe, refuse_forces
from lutgen.channels.loaded import axis_angle, loaded_margin, loaded_verdict
from lutgen.channels.plain import (
    CHANNELS,
    JUST_OUTSIDE,
    POSTURES_A_THREAD,
    axis_energy,
    axis_margin,
    checked_directions,
    measure,
    refuse_overflow,
    stability,
    tip_angle,
    wanted_channels,
)
from lutgen.channels.scanner import Scanner
from lutgen.channels.settle import CONVENTIONS, body_gravity, turned

__all__ = [
    "ALONG",
    "ASIDE",
    "CHANNELS",
    "CONVENTIONS",
    "HEIGHT_BEYOND",
    "JUST_OUTSIDE",
    "MU",
    "PHI",
    "POSTURES_A_THREAD",
    "RHO",
    "Scanner",
    "add",
    "axis_angle",
    "axis_energy",
    "axis_margin",
    "body_gravity",
    "checked_directions",
    "empty_axes",
    "evaluate",
    "evaluate_each",
    "find_axes",
    "limits_of",
    "loaded_margin",
    "loaded_verdict",
    "loads",
    "measure",
    "measure_each",
    "measure_moved",
    "measure_recipe",
    "part",
    "refuse_forces",
    "refuse_overflow",
    "stability",
    "tip_angle",
    "turned",
    "wanted_channels",
]
