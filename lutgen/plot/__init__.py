"""Figures of a robot's stability, from a map or a recipe; the title of each is its answer.

In reading order: `labels`, `style`, `view`, `key`, `painter`, `solids`, `scene`, `disc`,
`plane`, `curve`, `contour`, `surface`, `sphere`, `tilt`, `figure`, `path`, `uneven`.
"""

from lutgen.plot.contour import draw_steps
from lutgen.plot.figure import KINDS, Options, draw
from lutgen.plot.path import animate, check_animation, draw_path
from lutgen.plot.sphere import draw_hero
from lutgen.plot.style import on_sheet, save
from lutgen.plot.tilt import draw_limits
from lutgen.plot.uneven import draw_footing
