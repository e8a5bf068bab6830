"""Figures of a robot's stability, from a map or a recipe.

In reading order: `box`, `view`, `labels`, `style`, `marks`, `path`, `robot`, `animation`,
`choices`, `levels`, `curve`, `metrics`, `slip`, `plane`, `sphere`, `tilt`, `figure`, `limits`,
`steps`.
"""

from lutgen.plot.animation import animate, check_animation
from lutgen.plot.choices import KINDS
from lutgen.plot.figure import draw
from lutgen.plot.limits import draw_limits
from lutgen.plot.path import draw_path
from lutgen.plot.steps import draw_steps
from lutgen.plot.style import save

__all__ = [
    "KINDS",
    "animate",
    "check_animation",
    "draw",
    "draw_limits",
    "draw_path",
    "draw_steps",
    "save",
]
