"""Standing regions and directions of gravity into numbers.

In reading order: `exact`, `axes`, `shares`, `loads`, `resting`, `measuring`,
`evaluation`, `rows`, `scan`.
"""

from lutgen.channels.axes import empty_axes, find_axes
from lutgen.channels.evaluation import (
    acceptance_of,
    body_gravity,
    evaluate,
    evaluate_each,
    measure_recipe,
    primitives_of,
    refuse_forces,
    stability,
    wrenches,
)
from lutgen.channels.exact import (
    JUST_OUTSIDE,
    Setting,
    arc_angle,
    axis_energy,
    axis_margin,
    checked_directions,
    measure,
    segment_energy,
)
from lutgen.channels.loads import axis_angle, loaded_margin, loaded_verdict, measure_loaded
from lutgen.channels.measuring import Memory, own_memory, region_of
from lutgen.channels.resting import CONVENTIONS, turned
from lutgen.channels.scan import Scanner
from lutgen.channels.shares import axle_foot, smallest_shares
