"""Limits of standing still: where friction or brakes give way before the robot tips over.

Lines beside the tip-over boundary, drawn only where the robot stands.
"""

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.projections.polar import PolarAxes
from numpy.typing import NDArray

from lutgen.analysis import roll_limits, slide_limits
from lutgen.plot.labels import number
from lutgen.plot.style import GREEN, ORANGE
from lutgen.plot.view import View

__all__ = ["draw_roll_limit", "draw_slide_limit", "mark_sliding"]

Floats = NDArray[np.float64]

DASHES = (0, (4, 2))
# Headings at which rolling is judged: every fifth degree, so that sideways is among them.
ROLL_HEADINGS = 73


def slide_label(view: View) -> str:
    """Return the legend's words for the limit of friction."""
    return rf"slides ($\mu$ = {number(view.recipe.friction or 0.0)})"


def draw_slide_limit(axes: PolarAxes, view: View, headings: Floats, tips: Floats) -> None:
    """Draw the tilt (deg) at which the robot slides, where it has not tipped before.

    `headings` (h,) and `tips` (h,) are in deg, with the first repeated at the end.
    """
    if view.recipe.friction is None:
        return
    limit = np.degrees(slide_limits(view.recipe, view.params, np.radians(headings)))
    _draw(axes, headings, np.where(limit < tips, limit, np.nan), ORANGE, slide_label(view), DASHES)


def draw_roll_limit(axes: PolarAxes, view: View) -> None:
    """Draw the tilt (deg) at which the robot rolls away, if it has contacts that roll.

    Not under forces: what rolls is known of the weight alone.
    """
    rolling = any(contact.rolling for contact in view.recipe.contacts)
    if not rolling or view.recipe.has_wrench:
        return
    headings = np.linspace(0.0, 360.0, ROLL_HEADINGS)
    limit = np.degrees(roll_limits(view.recipe, view.params, np.radians(headings)))
    # A limit of nothing lies in the middle, where no line can be seen.
    label = "rolls away" if np.nanmax(limit, initial=0.0) > 0.1 else "rolls on any slope"
    _draw(axes, headings, limit, GREEN, label, (0, (1, 1)))


def _draw(
    axes: PolarAxes,
    headings: Floats,
    limit: Floats,
    colour: str,
    label: str,
    dashes: tuple[float, tuple[float, ...]],
) -> None:
    if np.isfinite(limit).any():
        axes.plot(np.radians(headings), limit, color=colour, linestyle=dashes, label=label)


def mark_sliding(
    axes: Axes, view: View, x: Floats, y: Floats, grip: Floats | None, tip_angle: Floats
) -> list[Artist]:
    """Dot where the robot slides (`grip` < 0) and dash the line where that begins.

    All (rows, columns) as the mesh of `tip_angle`; below the hatching of what tips over.  Returns
    the handle for the legend; none where nothing slides that stands.
    """
    if grip is None or not ((grip < 0.0) & (tip_angle >= 0.0)).any():
        return []
    dots = axes.contourf(x, y, grip, levels=[-2.0 * math.pi, 0.0], colors=["none"], hatches=["..."])
    dots.set(zorder=2.4, hatchcolor=ORANGE)
    if ((grip >= 0.0) & (tip_angle >= 0.0)).any():
        look: dict[str, Any] = {"colors": [ORANGE], "linewidths": 1.0, "linestyles": [DASHES]}
        axes.contour(x, y, grip, levels=[0.0], zorder=2.5, **look)
    return [Line2D([], [], color=ORANGE, linestyle=DASHES, label=slide_label(view))]
