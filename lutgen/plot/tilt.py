"""Tilt charts: the largest tilt before tip-over in each heading, of one posture or of all.

A colour is a thing: blue is body tilt, what an accelerometer in the robot sees, and purple ground
tilt, the slope of the ground under a robot that rocks.  Solid is the limit in each heading, dashed
what is guaranteed in all.  Beside them are the tilts at which friction or brakes give way.
"""

import math
from typing import Any, cast

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from numpy.typing import NDArray

from lutgen.analysis import (
    Posture,
    PostureLimits,
    SweepLimits,
    hold_limits,
    level_frames,
    posture_limits,
    roll_limits,
    slide_limits,
    tilt_limits,
    tilted,
)
from lutgen.plot.labels import HEADINGS, heading_text, limit_text, slide_label, title, with_unit
from lutgen.plot.legend import add_legend
from lutgen.plot.marks import (
    CENTRED,
    HALO,
    HATCHED,
    SLIDE_DASHES,
    rock_patch,
    shade_rocking,
    tip_patch,
)
from lutgen.plot.palette import BLUE, GREEN, GREY, ORANGE, PURPLE
from lutgen.plot.style import head, in_house_style, new_figure
from lutgen.plot.view import View
from lutgen.recipe import Recipe

Floats = NDArray[np.float64]
Look = dict[str, Any]

SIZE = (3.5, 4.1)
# Headings around the circle (rad), the first at both ends: every half degree.
SAMPLES = 720
AROUND = np.radians(np.arange(SAMPLES + 1) * (360.0 / SAMPLES))
# Headings at which rolling is judged: every fifth degree, so that sideways is among them.
ROLL_HEADINGS = 73
# The mesh on which rocking is looked for; its headings are some of AROUND.
TILTS, HEADING_COUNT = 241, 361
DOWN = (0.0, 0.0, -1.0)
FROM = {"plane": "tilt from level ground", "body": "tilt from a level body"}
BODY: Look = {"color": BLUE, "linewidth": 1.8, "zorder": 4}
GROUND: Look = {"color": PURPLE, "linewidth": 1.0, "zorder": 4.2}
GUARANTEED: Look = {"linestyle": (0, (4, 2)), "linewidth": 1.0}
SLIDES: Look = {"color": ORANGE, "linestyle": SLIDE_DASHES, "linewidth": 1.2}
BEST: Look = {"color": GREEN, "linewidth": 1.0}
LEAST: Look = {"color": GREEN, "linewidth": 1.0, "linestyle": (0, (3, 1, 1, 1))}


def draw_polar(view: View) -> Figure:
    """Return the figure; its outline holds heading (rad) and largest body tilt (deg)."""
    posture = Posture(view.recipe, view.params)
    found = posture_limits(posture, "body")
    outline = np.degrees(tilt_limits(view.recipe, view.params, AROUND))
    words = title(view, gravity=False, more=FROM["body"])
    axes = _polar_axes(words, outline, _ground(found), outline)
    _hatch(axes, outline)
    rocks = _rocking(axes, view, "body", outline)
    _outlines(axes, found, outline)
    if view.recipe.friction is not None:
        slides = np.degrees(slide_limits(posture, AROUND))
        # Where the robot has not tipped before.
        slides = np.where(slides < outline, slides, np.nan)
        if np.isfinite(slides).any():
            axes.plot(AROUND, slides, label=slide_label(view.recipe), **SLIDES)
    _roll_limit(axes, posture)
    return _with_legend(axes, "tips over (body tilt)", rocks)


@in_house_style
def draw_limits(
    recipe: Recipe,
    posture: PostureLimits,
    swept: SweepLimits | None = None,
    *,
    worst: bool = True,
) -> Figure:
    """Draw the largest tilt before tip-over in each heading: body tilt, and ground tilt.

    Parameters
    ----------
    recipe : Recipe
        The robot.
    posture : PostureLimits
        Of one posture, for body tilt and for ground tilt: its outline, its worst heading, and the
        circle that holds in all headings; and from where on it slides.
    swept : SweepLimits, optional
        Body tilt of all postures: the best of them in each heading, and with `worst` the worst.
    worst : bool
        See `swept`.

    Returns
    -------
    matplotlib.figure.Figure
    """
    outline = np.degrees(tilt_limits(recipe, posture.params, AROUND, posture.convention))
    view = View("polar", recipe, None, posture.params, np.array(DOWN), "tip_angle", ())
    heading = title(view, gravity=False, more=FROM[posture.convention])
    most = outline if swept is None else np.append(outline, np.degrees(swept.most))
    axes = _polar_axes(heading, outline, _ground(posture), most)
    _hatch(axes, outline if swept is None else _sweep(axes, swept, outline, worst))
    rocks = _rocking(axes, view, posture.convention, outline)
    _outlines(axes, posture, outline)
    if recipe.friction is not None:
        top = axes.get_rmax()
        slides = slide_limits(
            Posture(recipe, posture.params), AROUND, posture.convention, math.radians(top)
        )
        within = np.nan_to_num(np.degrees(slides), nan=top)
        if within.min() < top:
            axes.plot(AROUND, within, label=slide_label(recipe), zorder=3, **SLIDES)
    tips = "tips over (body tilt)" if swept is None else "tips over in every posture"
    return _with_legend(axes, tips, rocks)


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


def _polar_axes(words: str, outline: Floats, ground: Floats, drawn: Floats) -> PolarAxes:
    """Return axes of heading (rad, the nose up) and tilt (deg) with room for what is `drawn`.

    In a new figure with that title.  Around them are the names of the `HEADINGS`, with the tilts
    (deg) of both outlines in those, or one number where they are the same.
    """
    figure = new_figure(SIZE)
    head(figure, words)
    axes = cast("PolarAxes", figure.add_subplot(projection="polar"))
    axes.set_theta_zero_location("N")
    highest = max(float(drawn.max()), float(ground.max()))
    top = min(15.0 * math.ceil((highest + 5.0) / 15.0), 180.0)
    axes.set_ylim(0.0, top)
    step = 15.0 if top <= 90.0 else 30.0
    rings = np.arange(step, top, step)
    axes.set_rgrids(rings, labels=[])
    axes.set_thetagrids(np.arange(0.0, 360.0, 45.0), labels=[])
    for degrees, name in HEADINGS.items():
        body, slope = (limit_text(float(of[degrees * SAMPLES // 360])) for of in (outline, ground))
        tilts = body if body == slope else f"body {body}, ground {slope}"
        turn = {90: 90, 270: -90}.get(degrees, 0)
        axes.text(math.radians(degrees), 1.08 * top, f"{name}: {tilts}", rotation=turn, **CENTRED)
    look: Look = {"fontsize": 6, "path_effects": HALO, "zorder": 6, **CENTRED}
    for ring in rings:
        axes.text(math.radians(45.0), ring, with_unit(ring, "deg"), **look)
    return axes


def _hatch(axes: PolarAxes, edge: Floats) -> None:
    """Hatch the tilts (deg) beyond an edge."""
    axes.fill_between(AROUND, edge, axes.get_rmax(), linewidth=0.0, **HATCHED)


def _rocking(axes: PolarAxes, view: View, convention: str, outline: Floats) -> list[Artist]:
    """Hatch the tilts at which the robot rocks between rests, up to the outline (deg).

    Returns the handle for the legend; none where it rocks nowhere.
    """
    tilts = np.radians(np.linspace(0.0, axes.get_rmax(), TILTS))
    around = AROUND[:: SAMPLES // (HEADING_COUNT - 1)]
    tilt, heading = np.meshgrid(tilts, around, indexing="ij")
    frame = level_frames(view.recipe, view.params[None], convention)[0]
    rocks = view.rocks(tilted(tilt.ravel(), heading.ravel()) @ frame.T).reshape(tilt.shape)
    # What lies beyond the first tilt at which it tips belongs to what is hatched as that.
    rocks &= tilt <= np.radians(outline[:: SAMPLES // (HEADING_COUNT - 1)])
    return (
        [rock_patch(GREY)] if shade_rocking(axes, (heading, np.degrees(tilt)), rocks, GREY) else []
    )


def _ground(found: PostureLimits) -> Floats:
    """Return the outline of ground tilt, deg."""
    return np.asarray(np.degrees(found.ground.limits(AROUND)))


def _outlines(axes: PolarAxes, found: PostureLimits, outline: Floats) -> None:
    """Draw body tilt (deg) and ground tilt: their outlines, what is guaranteed, the worst."""
    rubs = "not included" if found.slide is None else "included"
    if found.slide is not None and found.rolls:
        rubs = "included, rolling not"
    named = (
        ("body tilt", BODY, outline, found.guaranteed, "not included"),
        ("ground tilt", GROUND, _ground(found), found.guaranteed_ground, rubs),
    )
    worst = {
        "body tilt": (found.worst.heading, found.worst.tilt),
        "ground tilt": (found.ground.worst, found.ground.least),
    }
    for name, look, tilts, guaranteed, sliding in named:
        axes.plot(AROUND, tilts, label=name, **look)
        least = math.degrees(guaranteed)
        label = f"{name}, guaranteed: {limit_text(least)}\nsliding {sliding}"
        axes.plot(AROUND, np.full(len(AROUND), least), label=label, **look | GUARANTEED)
        heading, tilt = worst[name]
        if not math.isnan(heading):
            dot: Look = {"markersize": 5, "markeredgecolor": "white", "color": look["color"]}
            label = f"worst: {heading_text(math.degrees(heading))}"
            axes.plot([heading], [math.degrees(tilt)], "o", label=label, zorder=5, **dot)


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


def _with_legend(axes: PolarAxes, tips: str, rocks: list[Artist]) -> Figure:
    """Return the figure of the axes, its legend below them."""
    handles, labels = axes.get_legend_handles_labels()
    # Body tilt stands on the left with its guarantee and its worst heading, ground tilt on the
    # right, and the others below both.
    first, second = labels.index("body tilt"), labels.index("ground tilt")
    # A robot that tips at once has no worst heading.
    third = second + 2 + any(label.startswith("worst:") for label in labels[second + 2 :])
    others = [tip_patch(tips), *rocks, *handles[:first], *handles[third:]]
    left = max(math.ceil((len(handles) + 1 + len(rocks)) / 2) - (second - first), 0)
    columns = [handles[first:second], others[:left], handles[second:third], others[left:]]
    handles = [handle for part in columns for handle in part]
    figure = cast("Figure", axes.figure)
    narrow: Look = {
        "columnspacing": 0.8,
        "handlelength": 1.4,
        "handletextpad": 0.5,
        "borderpad": 0.0,
    }
    add_legend(figure, handles, **narrow)
    return figure
