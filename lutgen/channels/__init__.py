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
