"""Tilt charts: the largest tilt before tip-over in each heading, of one posture or of all.

Beside it the tilts at which friction or brakes give way before that.
"""

import math
from typing import Any, cast

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from numpy.typing import NDArray

from lutgen.analysis import (
    Posture,
    PostureLimits,
    SweepLimits,
    hold_limits,
    roll_limits,
    slide_limits,
    tilt_limits,
)
from lutgen.plot.labels import HEADINGS, angle_text, heading_text, slide_label, title, with_unit
from lutgen.plot.marks import CENTRED, HALO, HATCHED, SLIDE_DASHES, tip_patch
from lutgen.plot.style import BLUE, GREEN, GREY, ORANGE, in_house_style, new_figure
from lutgen.plot.view import View
from lutgen.recipe import Recipe

Floats = NDArray[np.float64]
Look = dict[str, Any]

SIZE = (3.5, 3.75)
# Headings around the circle (rad), the first at both ends: every half degree, so that the worst
# one is known to that.
SAMPLES = 720
AROUND = np.radians(np.arange(SAMPLES + 1) * (360.0 / SAMPLES))
# Headings at which rolling is judged: every fifth degree, so that sideways is among them.
ROLL_HEADINGS = 73
DOWN = (0.0, 0.0, -1.0)
TILTED = {"plane": "tilt of the ground", "body": "tilt of the body"}
GUARANTEED: Look = {"color": "black", "linestyle": (0, (4, 2)), "linewidth": 0.9}
SLIDES: Look = {"color": GREY, "linestyle": (0, (1, 1.2)), "linewidth": 1.2}
BEST: Look = {"color": GREEN, "linewidth": 1.0}
LEAST: Look = {"color": ORANGE, "linewidth": 1.0, "linestyle": (0, (5, 1))}


def draw_polar(view: View) -> Figure:
    """Return the figure; its outline holds heading (rad) and largest tilt (deg)."""
    posture = Posture(view.recipe, view.params)
    outline = np.degrees(tilt_limits(view.recipe, view.params, AROUND))
    axes = _polar_axes(title(view, gravity=False), outline, outline)
    _hatch(axes, outline)
    axes.plot(AROUND, outline, color=BLUE, label="largest tilt (deg)")
    worst = int(np.argmin(outline[:-1]))
    least = float(outline[worst])
    _circle(axes, AROUND[::2], least, label=f"safe in all headings: {angle_text(least)}")
    _mark_worst(axes, float(AROUND[worst]), least)
    if view.recipe.friction is not None:
        slides = np.degrees(slide_limits(posture, AROUND))
        # Where the robot has not tipped before.
        slides = np.where(slides < outline, slides, np.nan)
        if np.isfinite(slides).any():
            look: Look = {"color": ORANGE, "linestyle": SLIDE_DASHES}
            axes.plot(AROUND, slides, label=slide_label(view.recipe), **look)
    _roll_limit(axes, posture)
    return _with_legend(axes, "tips over")


@in_house_style
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
    outline = np.degrees(tilt_limits(recipe, posture.params, AROUND, posture.convention))
    view = View("polar", recipe, None, posture.params, np.array(DOWN), "tip_angle", ())
    heading = title(view, gravity=False, more=TILTED[posture.convention])
    drawn = outline if swept is None else np.append(outline, np.degrees(swept.most))
    axes = _polar_axes(heading, outline, drawn)
    _hatch(axes, outline if swept is None else _sweep(axes, swept, outline, worst))
    axes.plot(AROUND, outline, color=BLUE, label="this posture", zorder=4)
    least = math.degrees(posture.guaranteed)
    # Rounded down: what is printed holds, too.
    guaranteed = angle_text(math.floor(10.0 * least) / 10.0)
    _circle(axes, AROUND, least, label=f"guaranteed: {guaranteed}", zorder=4)
    if recipe.friction is not None:
        top = axes.get_rmax()
        slides = slide_limits(
            Posture(recipe, posture.params), AROUND, posture.convention, math.radians(top)
        )
        within = np.nan_to_num(np.degrees(slides), nan=top)
        if within.min() < top:
            axes.plot(AROUND, within, label=slide_label(recipe), zorder=3, **SLIDES)
    if not math.isnan(posture.worst.heading):
        _mark_worst(axes, posture.worst.heading, math.degrees(posture.worst.tilt))
    tips = "tips over" if swept is None else "tips over in every posture"
    return _with_legend(axes, tips, columnspacing=1.0)


def _sweep(axes: PolarAxes, swept: SweepLimits, outline: Floats, worst: bool) -> Floats:
    """Draw the best posture in each heading, and the worst; return the tilts no posture passes."""
    most, least = (
        np.degrees(np.interp(AROUND, swept.headings, tilts, period=2.0 * math.pi))
        for tilts in (swept.most, swept.least)
    )
    if worst:
        axes.fill_between(AROUND, least, most, facecolor=GREEN, alpha=0.1, linewidth=0.0)
        axes.plot(AROUND, least, label="worst posture per heading", **LEAST)
    axes.plot(AROUND, most, label="best posture per heading", **BEST)
    return np.asarray(np.maximum(most, outline))


def _polar_axes(heading: str, outline: Floats, drawn: Floats) -> PolarAxes:
    """Return axes of heading (rad, the nose up) and tilt (deg) with room for what is `drawn`.

    In a new figure of that title.  Around them are the names of the `HEADINGS`, with the outline's
    tilts (deg) in those.
    """
    figure = new_figure(SIZE)
    figure.suptitle(heading, x=0.01, ha="left")
    axes = cast("PolarAxes", figure.add_subplot(projection="polar"))
    axes.set_theta_zero_location("N")
    top = min(15.0 * math.ceil((float(drawn.max()) + 5.0) / 15.0), 180.0)
    axes.set_ylim(0.0, top)
    step = 15.0 if top <= 90.0 else 30.0
    rings = np.arange(step, top, step)
    axes.set_rgrids(rings, labels=[])
    axes.set_thetagrids(np.arange(0.0, 360.0, 45.0), labels=[])
    for degrees, name in HEADINGS.items():
        words = f"{name}: {angle_text(float(outline[degrees * SAMPLES // 360]))}"
        turn = {90: 90, 270: -90}.get(degrees, 0)
        axes.text(math.radians(degrees), 1.08 * top, words, rotation=turn, **CENTRED)
    look: Look = {"fontsize": 6, "path_effects": HALO, "zorder": 6, **CENTRED}
    for ring in rings:
        axes.text(math.radians(45.0), ring, with_unit(ring, "deg"), **look)
    return axes


def _hatch(axes: PolarAxes, edge: Floats) -> None:
    """Hatch the tilts (deg) beyond an edge."""
    axes.fill_between(AROUND, edge, axes.get_rmax(), linewidth=0.0, **HATCHED)


def _circle(axes: PolarAxes, around: Floats, tilt: float, **look: Any) -> None:
    """Draw the tilt (deg) that is safe in all headings (rad)."""
    axes.plot(around, np.full(len(around), tilt), **GUARANTEED, **look)


def _mark_worst(axes: PolarAxes, heading: float, tilt: float) -> None:
    """Mark the worst heading (rad) and its tilt (deg)."""
    look: Look = {"markersize": 5, "markerfacecolor": ORANGE, "markeredgecolor": "white"}
    label = f"worst: {heading_text(math.degrees(heading))}"
    axes.plot([heading], [tilt], "o", label=label, zorder=5, **look)


def _roll_limit(axes: PolarAxes, posture: Posture) -> None:
    """Draw the tilt (deg) at which the robot rolls away, if it has contacts that roll.

    A fainter line is where it ceases to hold under every load, if that is earlier.  Not under
    forces: what rolls is known of the weight alone.
    """
    rolling = any(contact.rolling for contact in posture.recipe.contacts)
    if not rolling or posture.recipe.has_wrench:
        return
    headings = np.radians(np.linspace(0.0, 360.0, ROLL_HEADINGS))
    limit = np.degrees(roll_limits(posture, headings))
    # A limit of nothing lies in the middle, where no line can be seen.
    label = "rolls away" if np.nanmax(limit, initial=0.0) > 0.1 else "rolls on any slope"
    if np.isfinite(limit).any():
        axes.plot(headings, limit, color=GREEN, linestyle=(0, (1, 1)), label=label)
    sure = np.degrees(hold_limits(posture, headings))
    if np.isfinite(sure).any() and not np.allclose(sure, limit, atol=0.1, equal_nan=True):
        look: Look = {"color": GREEN, "linestyle": (0, (1, 3)), "linewidth": 1.0}
        axes.plot(headings, sure, label="holds for certain within", **look)


def _with_legend(axes: PolarAxes, tips: str, **settings: Any) -> Figure:
    """Return the figure of the axes, its legend below them."""
    handles, _ = axes.get_legend_handles_labels()
    handles.append(tip_patch(tips))
    figure = cast("Figure", axes.figure)
    figure.legend(handles=handles, loc="outside lower center", ncols=2, **settings)
    return figure
