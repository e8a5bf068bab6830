"""Limits: largest tilts of one posture in all headings, beside those of all postures."""

import math
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lutgen.analysis import PostureLimits, SweepLimits, slide_limits, tilt_limits
from lutgen.plot.labels import HEADINGS, angle_text, heading_text, title
from lutgen.plot.marks import tip_patch
from lutgen.plot.style import BLUE, GREEN, GREY, HATCH, ORANGE, WASH, house_style, new_figure
from lutgen.plot.tilt import SAMPLES, SIZE, polar_axes
from lutgen.plot.view import View
from lutgen.recipe import Recipe

__all__ = ["draw_limits"]

Floats = NDArray[np.float64]

DOWN = (0.0, 0.0, -1.0)
TILTED = {"plane": "tilt of the ground", "body": "tilt of the body"}
GUARANTEED: dict[str, Any] = {"color": "black", "linestyle": (0, (4, 2)), "linewidth": 0.9}
SLIDES: dict[str, Any] = {"color": GREY, "linestyle": (0, (1, 1.2)), "linewidth": 1.2}
BEST: dict[str, Any] = {"color": GREEN, "linewidth": 1.0}
LEAST: dict[str, Any] = {"color": ORANGE, "linewidth": 1.0, "linestyle": (0, (5, 1))}


def draw_limits(
    recipe: Recipe,
    posture: PostureLimits,
    swept: SweepLimits | None = None,
    *,
    worst: bool = True,
) -> Figure:
    """Draw the largest tilt before tip-over in each heading.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    posture : PostureLimits
        Of one posture: its outline, its worst heading, the circle that holds in all headings, and
        from where on it slides.
    swept : SweepLimits, optional
        Of all postures: the best of them in each heading, and with `worst` the worst, too.
    worst : bool
        See `swept`.

    Returns
    -------
    matplotlib.figure.Figure
    """
    headings = np.radians(np.arange(SAMPLES + 1) * (360.0 / SAMPLES))
    outline = np.degrees(tilt_limits(recipe, posture.params, headings, posture.convention))
    least = math.degrees(posture.guaranteed)
    # Rounded down: what is printed holds, too.
    guaranteed = angle_text(math.floor(10.0 * least) / 10.0)
    largest = float(outline.max())
    if swept is not None:
        largest = max(largest, math.degrees(float(swept.most.max())))
    top = min(15.0 * math.ceil((largest + 5.0) / 15.0), 180.0)
    with house_style():
        figure = new_figure(SIZE)
        shown = {heading: float(outline[heading * SAMPLES // 360]) for heading in HEADINGS}
        axes = polar_axes(figure, top, shown)
        view = View("polar", recipe, None, posture.params, np.array(DOWN), "tip_angle", ())
        figure.suptitle(
            title(view, gravity=False, more=TILTED[posture.convention]), x=0.01, ha="left"
        )
        edge = outline
        if swept is not None:
            most, low = (
                np.degrees(np.interp(headings, swept.headings, tilts, period=2.0 * math.pi))
                for tilts in (swept.most, swept.least)
            )
            edge = np.maximum(most, outline)
            if worst:
                axes.fill_between(headings, low, most, facecolor=GREEN, alpha=0.1, linewidth=0.0)
                axes.plot(headings, low, label="worst posture per heading", **LEAST)
            axes.plot(headings, most, label="best posture per heading", **BEST)
        axes.fill_between(
            headings, edge, top, facecolor=WASH, edgecolor=GREY, hatch=HATCH, linewidth=0.0
        )
        axes.plot(headings, outline, color=BLUE, label="this posture", zorder=4)
        axes.plot(
            headings,
            np.full(len(headings), least),
            label=f"guaranteed: {guaranteed}",
            zorder=4,
            **GUARANTEED,
        )
        if recipe.friction is not None:
            slides = slide_limits(
                recipe, posture.params, headings, posture.convention, math.radians(top)
            )
            within = np.nan_to_num(np.degrees(slides), nan=top)
            label = f"slides ($\\mu$ = {recipe.friction:g})"
            if within.min() < top:
                axes.plot(headings, within, label=label, zorder=3, **SLIDES)
        if not math.isnan(posture.worst.heading):
            axes.plot(
                [posture.worst.heading],
                [math.degrees(posture.worst.tilt)],
                linestyle="none",
                marker="o",
                markersize=5,
                markerfacecolor=ORANGE,
                markeredgecolor="white",
                label=f"worst: {heading_text(math.degrees(posture.worst.heading))}",
                zorder=5,
            )
        handles, _ = axes.get_legend_handles_labels()
        label = "tips over" if swept is None else "tips over in every posture"
        figure.legend(
            handles=[*handles, tip_patch(label)],
            loc="outside lower center",
            ncols=2,
            columnspacing=1.0,
        )
        # Fixed, so that saving twice gives the same picture.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
    return figure
