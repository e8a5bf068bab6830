"""Figures of a robot's stability, from a map or a recipe.

In reading order: `sheet`, `fonts`, `palette`, `dark`, `style`, `words`, `legend`, `box`, `view`,
`labels`, `marks`, `levels`, `path`, `shape`, `robot`, `ground`, `animation`, `curve`, `metrics`,
`plane`, `sphere`, `tilt`, `figure`, `steps`, `uneven`.
"""

from lutgen.plot.animation import animate, check_animation
from lutgen.plot.figure import KINDS, draw
from lutgen.plot.path import draw_path
from lutgen.plot.sheet import STYLES, on_sheet
from lutgen.plot.steps import draw_steps
from lutgen.plot.style import save
from lutgen.plot.tilt import draw_limits
from lutgen.plot.uneven import draw_footing

__all__ = [
    "KINDS",
    "STYLES",
    "animate",
    "check_animation",
    "draw",
    "draw_footing",
    "draw_limits",
    "draw_path",
    "draw_steps",
    "on_sheet",
    "save",
]
