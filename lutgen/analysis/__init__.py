"""Questions about one posture: forces, ground, tilt, sliding, rolling, wheels.

In reading order: `posture`, `forces`, `diagnosis`, `ground`, `wheels`, `tilt`,
`ground_seat`, `ground_tilt`, `resistance`, `friction`, `metrics`, `tilt_table`,
`budget`, `balance`, `uneven`, `weighing`.
"""

from lutgen.analysis.budget import StopSpeeds, budgets, stop_speeds, turn_speed
from lutgen.analysis.diagnosis import Diagnosis, diagnose
from lutgen.analysis.forces import heuristic_forces, normal_forces
from lutgen.analysis.friction import (
    hold_limits,
    holds,
    may_hold,
    roll_limits,
    rolling_gravity,
    rolls,
    share_limits,
    slide_limits,
)
from lutgen.analysis.ground_tilt import GroundTilt, ground_tilt
from lutgen.analysis.metrics import Metrics, axis_force_angle, compare_metrics
from lutgen.analysis.posture import Facet, Posture, below_ground
from lutgen.analysis.tilt import level_frames, tilt_limits, tilted
from lutgen.analysis.tilt_table import (
    FOUR,
    WORST,
    PostureLimits,
    SweepLimits,
    even_headings,
    posture_limits,
    rounded_down,
    sweep_limits,
)
from lutgen.analysis.uneven import Equilibrium, Footing, equilibrium, read_footing
from lutgen.analysis.weighing import (
    Reading,
    Tipping,
    Weighed,
    Weighing,
    corrected,
    correction,
    correction_lines,
    weigh,
)
from lutgen.analysis.wheels import Motion, wheel_speeds
