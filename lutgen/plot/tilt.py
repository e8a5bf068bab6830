"""Polar chart: the largest tilt before tip-over in each heading, at one posture."""

import math
from collections.abc import Mapping
from typing import cast

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes

from lutgen.analysis import tilt_limits
from lutgen.plot.labels import HEADINGS, angle_text, heading_text, title, with_unit
from lutgen.plot.marks import HALO, tip_patch
from lutgen.plot.slip import draw_roll_limit, draw_slide_limit
from lutgen.plot.style import BLUE, GREY, HATCH, ORANGE, WASH, new_figure
from lutgen.plot.view import View

__all__ = ["SAMPLES", "SIZE", "draw_polar", "polar_axes"]

SIZE = (3.5, 3.75)
# Headings on the circle: every half degree, so the worst one is known to that.
SAMPLES = 720


def draw_polar(view: View, size: tuple[float, float] | None) -> Figure:
    """Return the figure; its outline holds heading (rad) and largest tilt (deg)."""
    headings = np.arange(SAMPLES) * (360.0 / SAMPLES)
    limits = np.degrees(tilt_limits(view.recipe, view.params, np.radians(headings)))
    worst = int(np.argmin(limits))
    top = min(15.0 * math.ceil((limits.max() + 5.0) / 15.0), 180.0)
    around = np.radians(np.append(headings, 360.0))
    outline = np.append(limits, limits[0])
    least = angle_text(float(limits[worst]))
    figure = new_figure(size or SIZE)
    shown = {heading: float(limits[heading * SAMPLES // 360]) for heading in HEADINGS}
    axes = polar_axes(figure, top, shown)
    figure.suptitle(title(view, gravity=False), x=0.01, ha="left")
    axes.fill_between(
        around, outline, top, facecolor=WASH, edgecolor=GREY, hatch=HATCH, linewidth=0.0
    )
    axes.plot(around, outline, color=BLUE, label="largest tilt (deg)")
    axes.plot(
        np.radians(np.arange(361.0)),
        np.full(361, limits[worst]),
        color="black",
        linestyle=(0, (4, 2)),
        linewidth=0.9,
        label=f"safe in all headings: {least}",
    )
    axes.plot(
        [around[worst]],
        [limits[worst]],
        linestyle="none",
        marker="o",
        markersize=5,
        markerfacecolor=ORANGE,
        markeredgecolor="white",
        label=f"worst: {heading_text(float(headings[worst]))}",
        zorder=5,
    )
    draw_slide_limit(axes, view, np.append(headings, 360.0), outline)
    draw_roll_limit(axes, view)
    handles, _ = axes.get_legend_handles_labels()
    figure.legend(handles=[*handles, tip_patch()], loc="outside lower center", ncols=2)
    return figure


def polar_axes(figure: Figure, top: float, limits: Mapping[int, float]) -> PolarAxes:
    """Return axes of heading (rad, the nose up) and tilt (deg) from 0 to `top`.

    Around them are the names of the `HEADINGS`, with the limits (deg) in those.
    """
    axes = cast("PolarAxes", figure.add_subplot(projection="polar"))
    axes.set_theta_zero_location("N")
    axes.set_ylim(0.0, top)
    axes.set_rgrids(_rings(top), labels=[])
    axes.set_thetagrids(np.arange(0.0, 360.0, 45.0), labels=[])
    for heading, name in HEADINGS.items():
        axes.text(
            math.radians(heading),
            1.08 * top,
            f"{name}: {angle_text(limits[heading])}",
            ha="center",
            va="center",
            rotation={90: 90, 270: -90}.get(heading, 0),
        )
    for ring in _rings(top):
        axes.text(
            math.radians(45.0),
            ring,
            with_unit(ring, "deg"),
            fontsize=6,
            ha="center",
            va="center",
            path_effects=HALO,
            zorder=6,
        )
    return axes


def _rings(top: float) -> list[float]:
    """Return the tilts (deg) of the circles inside the rim."""
    step = 15.0 if top <= 90.0 else 30.0
    return [step * i for i in range(1, math.ceil(top / step))]
