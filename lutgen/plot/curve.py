"""Curve: a channel and the height |OC| over one parameter at one gravity direction."""

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lutgen.plot.labels import NOTE, channel_label, name_axes, optimum_text, title
from lutgen.plot.legend import add_legend
from lutgen.plot.levels import crossings, jumps
from lutgen.plot.marks import CENTRED, HATCHED, PLATE, TIPS, mark_optimum, tip_patch, write_beside
from lutgen.plot.palette import BLUE, GREY
from lutgen.plot.style import head, new_figure
from lutgen.plot.view import View, is_sealed, optimum
from lutgen.plot.words import folded
from lutgen.quantities import QUANTITIES
from lutgen.recipe import Recipe, robot_size_of

Floats = NDArray[np.float64]

SIZE = (3.5, 2.7)
SAMPLES = 401
# Parts of the size (or of 1 deg) that rounding may leave of nothing.
ROUNDING = 1e-9
# A hatched interval narrower than this share of the axis has no room for its label.
NARROW = 0.2


def draw_curve(view: View) -> Figure:
    """Return the figure; its lines hold the data in display units."""
    values = _samples(view)
    shown = view.shown(0, values)
    exact = _exact(view, values)
    figure = new_figure(SIZE)
    axes = figure.add_subplot()
    head(figure, title(view, gravity=True))
    name_axes(axes, view, shown)
    lines = [_line(axes, view, view.channel, shown, exact, color=BLUE)]
    if view.channel != "height":
        twin = axes.twinx()
        dashed = {"color": GREY, "linestyle": (0, (4, 1.5))}
        lines.append(_line(twin, view, "height", shown, exact, **dashed))
        # The twin is drawn last; lift the first axes, whose notes belong on top.
        axes.set_zorder(twin.get_zorder() + 1)
        axes.patch.set_visible(False)
    handles: list[Artist] = [*lines, *_nodes(axes, view)]
    if shade_intervals(axes, shown, exact["tip_angle"]):
        handles.append(tip_patch())
    add_legend(figure, handles, columns=len(handles))
    best = _best(view, exact)
    if best is not None:
        at = float(shown[best])
        drawn = np.asarray(lines[0].get_ydata(), dtype=np.float64)
        value = float(drawn[best])
        if math.isnan(value):  # where the line is broken
            value = float(QUANTITIES[view.channel].shown(exact[view.channel][best]))
        text = folded(optimum_text(view, value, drawn, at, "\n"), NOTE)
        figure.draw_without_rendering()
        paths = [line.get_transform().transform(line.get_xydata()) for line in lines]
        mark_optimum(axes, at, value, text)
        write_beside(axes, (at, value), text, paths)
    return figure


def _samples(view: View) -> Floats:
    """Return the parameter's values: even, and once more between the neighbours of the optimum."""
    even = np.linspace(*view.ends(0), SAMPLES)
    best = _best(view, _exact(view, even))
    if best is None:
        return even
    near = np.linspace(even[max(best - 1, 0)], even[min(best + 1, SAMPLES - 1)], SAMPLES)
    return np.unique(np.concatenate([even, near]))


def _exact(view: View, values: Floats) -> dict[str, Floats]:
    """Return what is drawn at values of the parameter."""
    return view.exact(view.postures(values), view.gravity_dir, view.channel, "height", "tip_angle")


def _best(view: View, exact: dict[str, Floats]) -> int | None:
    """Return the best sample where the robot stands, if it does anywhere."""
    # |SD_g| is NaN where it tips over anyway.
    return optimum(view.channel, np.where(exact["tip_angle"] < 0.0, np.nan, exact[view.channel]))


def _line(
    axes: Axes, view: View, channel: str, shown: Floats, exact: dict[str, Floats], **look: Any
) -> Line2D:
    """Draw one channel on its own axis, broken where it jumps to another facet."""
    values = np.array(QUANTITIES[channel].shown(exact[channel]))
    known = np.isfinite(values)
    values[known] = without_noise(view.recipe, values[known])
    if known.any():
        low, high = values[known].min(), values[known].max()
        room = 0.08 * (high - low if high > low else max(abs(high), 1e-6))
        axes.set_ylim(low - room, high + room)
        values[1:][jumps(values)] = np.nan
    else:
        axes.set_yticks([])
    axes.set_ylabel(channel_label(view.recipe, channel), color=look["color"])
    axes.tick_params(axis="y", colors=look["color"])
    (line,) = axes.plot(shown, values, label=QUANTITIES[channel].symbol, **look)
    return line


def without_noise(recipe: Recipe, values: Floats) -> Floats:
    """Return values (display unit) that are 0 or alike but for rounding as 0, or as one value."""
    noise = ROUNDING * (1.0 if is_sealed(recipe) else max(robot_size_of(recipe), 1.0))
    if len(values) == 0:
        return values
    values = np.where(np.abs(values) < noise, 0.0, values)
    return np.full_like(values, values.mean()) if np.ptp(values) < noise else values


def _nodes(axes: Axes, view: View) -> list[Line2D]:
    """Draw what the map holds at its knots, if it covers the gravity direction."""
    if not view.on_chart():
        return []
    knots = view.knots(0, 0)
    values = QUANTITIES[view.channel].shown(view.drawn(view.postures(knots)))
    label = "map nodes" if view.at_node() else "map, interpolated"
    look: dict[str, Any] = {"markersize": 2.2, "markerfacecolor": BLUE, "markeredgewidth": 0.0}
    return axes.plot(view.shown(0, knots), values, "o", label=label, **look)


def shade_intervals(axes: Axes, shown: Floats, tip_angle: Floats) -> bool:
    """Hatch and label the intervals that tip over; False if there are none."""
    tips = tip_angle < 0.0
    ends = [*shown[:1][tips[:1]], *crossings(shown, tip_angle, tips), *shown[-1:][tips[-1:]]]
    for low, high in zip(ends[::2], ends[1::2], strict=True):
        axes.axvspan(low, high, linewidth=0.0, zorder=0.5, **HATCHED)
        if high - low > NARROW * (shown[-1] - shown[0]):
            across = axes.get_xaxis_transform()
            axes.text((low + high) / 2.0, 0.5, TIPS, transform=across, bbox=PLATE, **CENTRED)
    return bool(tips.any())
