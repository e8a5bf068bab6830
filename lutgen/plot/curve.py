"""Curve: at which value of one parameter a quantity is best."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lutgen.plot import labels
from lutgen.plot.key import STAR
from lutgen.plot.plane import halved
from lutgen.plot.style import colours, halo
from lutgen.plot.view import View, optimum
from lutgen.quantities import QUANTITIES
from lutgen.vector import Floats

SAMPLES = 401
# A step of this share of the range that stays whole in so many halvings is a jump.
JUMP, HALVINGS = 0.02, 12
# Parts of the range (or of 1 deg) that rounding leaves of nothing.
NOISE = 1e-6
# Hatched intervals of less than this share of the axis have no room for words.
NARROW = 0.12


def draw_curve(view: View) -> Figure:
    """Return the figure; its first line holds the data as shown, broken at jumps."""
    values, exact, breaks = _samples(view)
    shown, tips = view.shown(0, values), exact["tip_angle"] < 0.0
    y = np.array(QUANTITIES[view.channel].shown(exact[view.channel]), np.float64)
    known = y[np.isfinite(y)]
    noise = NOISE * max(float(np.ptp(known)) if known.size else 0.0, 1e-6)
    y[np.abs(y) < noise] = 0.0
    best = optimum(view.channel, np.where(tips, np.nan, y))
    ends, parameter = (float(shown[0]), float(shown[-1])), view.parameter(0)
    where = labels.gravity_text(view.gravity_dir, view.convention)
    good = "Small is good." if QUANTITIES[view.channel].sign > 0 else "Large is good."
    note, found = f"{labels.named(view.recipe, view.params, view.axes, where)} {good}", ""
    sentence = f"Tips over in every posture, {where}"
    if best is not None:
        value = labels.quantity_text(view.recipe, view.channel, float(y[best]))
        found = labels.found_text(parameter, float(shown[best]), ends)
        name = QUANTITIES[view.channel].symbol
        sentence = f"Best at {found}: {name} {value}"
        sentence = f"At {found} it is {value} from tipping over" if name[0] == "t" else sentence
    figure, axes = view.page(4.0, (0.95, 0.75, 6.7, 2.95), sentence, note)
    broken = [np.insert(part, breaks, np.nan) for part in (shown, y)]
    axes.plot(*broken, color=colours().blue)
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    room = 0.12 * (high - low) or max(abs(high), 1e-6)
    axes.set_ylim(0.0 if 0.0 <= low <= 0.3 * high else low - room, high + room)
    labels.name_axis(axes.xaxis, parameter, ends, 80)
    axes.set_xlim(*ends)
    axes.tick_params(axis="x", pad=9)
    name = labels.channel_label(view.recipe, view.channel)
    axes.text(0.0, 1.03, name, transform=axes.transAxes, va="bottom")
    _nodes(axes, view)
    _shade(axes, shown, tips)
    if best is not None:
        axes.plot([shown[best]], [y[best]], label="best", **STAR)
        share = (float(shown[best]) - ends[0]) / (ends[1] - ends[0])
        ha = "left" if share < 0.15 else "right" if share > 0.85 else "center"
        # Above a minimum, and below a maximum between the ends, where the line is not.
        up = QUANTITIES[view.channel].sign * 34 if ha == "center" else 19
        spot, beside = (shown[best], y[best]), ((ha == "left") * 8, up)
        text = axes.annotate(f"{value} at {found}", spot, beside, textcoords="offset points")
        text.set(ha=ha, va="center", path_effects=halo(), zorder=9)
    return figure


def _samples(view: View) -> tuple[Floats, dict[str, Floats], NDArray[np.intp]]:
    """Return values of the parameter, what is drawn at them, and before which the line is broken.

    The values are even, with more between the neighbours of the optimum and at both ends of jumps.
    """

    def exact(values: Floats) -> dict[str, Floats]:
        return view.exact(view.postures(values), view.gravity_dir, view.channel, "tip_angle")

    values = np.linspace(*view.ends(0), SAMPLES)
    found = exact(values)
    best = optimum(view.channel, np.where(found["tip_angle"] < 0.0, np.nan, found[view.channel]))
    if best is not None:
        near = values[max(best - 1, 0)], values[min(best + 1, SAMPLES - 1)]
        values = np.unique(np.concatenate([values, np.linspace(*near, SAMPLES)]))
    one = exact(values)[view.channel]
    known = one[np.isfinite(one)]
    least = max(JUMP * float(np.ptp(known)), 1e-12) if known.size else math.inf
    steep = np.flatnonzero(np.abs(np.diff(one)) > least)
    pairs = np.array([steep, steep + 1])
    ends, steps = values[pairs], one[pairs]
    for _ in range(HALVINGS):
        ends, steps = halved(lambda middle: exact(middle)[view.channel], ends, steps)
    ends = ends[:, np.abs(steps[1] - steps[0]) > least]
    values = np.unique(np.concatenate([values, *ends]))
    return values, exact(values), np.searchsorted(values, ends[1])


def _nodes(axes: Axes, view: View) -> None:
    """Draw what a map holds at its knots, if it covers the gravity direction."""
    stability_map = view.stability_map
    if stability_map is None or not stability_map.chart.locate(view.gravity_dir[None, :])[3][0]:
        return
    knots = np.asarray(stability_map.axes[view.axes[0]].knots)
    rows, down = view.postures(knots), np.tile(view.gravity_dir, (len(knots), 1))
    values = stability_map.read(rows, down, (view.channel,))[view.channel]
    shown = QUANTITIES[view.channel].shown(values)
    axes.plot(view.shown(0, knots), shown, "o", ms=3.2, color=colours().blue, label="map")


def _shade(axes: Axes, shown: Floats, tips: NDArray[np.bool_]) -> None:
    """Hatch the intervals that tip over, and say so if there is room."""
    edges = np.flatnonzero(np.diff(np.pad(tips.astype(int), 1))).reshape(-1, 2)
    middle = np.concatenate([shown[:1], (shown[1:] + shown[:-1]) / 2.0, shown[-1:]])
    for low, high in middle[edges]:
        span = axes.axvspan(low, high, linewidth=0.0, zorder=0.5, hatch="//")
        span.set(facecolor=colours().wash, edgecolor=colours().hatch)
        if high - low > NARROW * (shown[-1] - shown[0]):
            text = axes.text((low + high) / 2.0, 0.5, "tips over", weight="bold")
            text.set(transform=axes.get_xaxis_transform(), ha="center", va="center")
            text.set_path_effects(halo(4.0, colours().wash))
