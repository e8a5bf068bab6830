"""Curve: a channel and the height |OC| over one parameter at one gravity direction."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lutgen.plot.labels import axis_label, channel_label, optimum_text, symbol, title
from lutgen.plot.levels import jumps
from lutgen.plot.marks import PLATE, TIPS, degree_ticks, mark_optimum, tip_patch, write_beside
from lutgen.plot.style import BLUE, GREY, HATCH, ORANGE, WASH, new_figure
from lutgen.plot.view import View, optimum
from lutgen.quantities import QUANTITIES

__all__ = ["SIZE", "draw_curve", "shade_intervals"]

Floats = NDArray[np.float64]

SIZE = (3.5, 2.7)
SAMPLES = 401
# A hatched interval narrower than this share of the axis has no room for its label.
NARROW = 0.2


def draw_curve(view: View, size: tuple[float, float] | None) -> Figure:
    """Return the figure; its lines hold the data in display units."""
    values = _samples(view)
    shown = view.shown(0, values)
    wanted = dict.fromkeys((view.channel, "height", "tip_angle"))
    exact = view.exact(view.postures(values), view.gravity_dir, *wanted)
    figure = new_figure(size or SIZE)
    axes = figure.add_subplot()
    axes.set_title(title(view, gravity=True))
    axes.set_xlabel(axis_label(view.parameter(0)))
    axes.set_xlim(shown[0], shown[-1])
    if view.parameter(0).display_unit == "deg":
        degree_ticks(axes.xaxis, shown[0], shown[-1])
    lines = [_line(axes, view, view.channel, shown, exact, BLUE, "-")]
    if view.channel != "height":
        twin = axes.twinx()
        lines.append(_line(twin, view, "height", shown, exact, ORANGE, (0, (4, 1.5))))
        # The twin is drawn last; lift the first axes, whose notes belong on top.
        axes.set_zorder(twin.get_zorder() + 1)
        axes.patch.set_visible(False)
    handles: list[Line2D | object] = list(lines)
    handles += _nodes(axes, view)
    if shade_intervals(axes, shown, exact["tip_angle"]):
        handles.append(tip_patch())
    figure.legend(
        handles=handles, loc="outside lower center", ncols=len(handles), columnspacing=1.2
    )
    best = optimum(view.channel, _where_it_stands(view.channel, exact))
    if best is not None:
        value = float(QUANTITIES[view.channel].shown(exact[view.channel][best]))
        figure.draw_without_rendering()
        paths = [line.get_transform().transform(line.get_xydata()) for line in lines]
        text = optimum_text(view, value, lines[0].get_ydata(), shown[best : best + 1], "\n")
        mark_optimum(axes, float(shown[best]), value, text)
        clear = [path[np.isfinite(path).all(axis=1)] for path in paths]
        write_beside(axes, float(shown[best]), value, text, clear)
    return figure


def _samples(view: View) -> Floats:
    """Return the parameter's values: even, and once more between the neighbours of the optimum."""
    ends = view.ends(0)
    even = np.linspace(*ends, SAMPLES)
    wanted = dict.fromkeys((view.channel, "tip_angle"))
    exact = view.exact(view.postures(even), view.gravity_dir, *wanted)
    best = optimum(view.channel, _where_it_stands(view.channel, exact))
    if best is None:
        return even
    near = np.linspace(even[max(best - 1, 0)], even[min(best + 1, SAMPLES - 1)], SAMPLES)
    return np.unique(np.concatenate([even, near]))


def _where_it_stands(channel: str, exact: dict[str, Floats]) -> Floats:
    """Return a channel with NaN where the robot tips over, as |SD_g| has it anyway."""
    return np.where(exact["tip_angle"] < 0.0, np.nan, exact[channel])


def _line(
    axes: Axes,
    view: View,
    channel: str,
    shown: Floats,
    exact: dict[str, Floats],
    colour: str,
    dashes: str | tuple[float, tuple[float, float]],
) -> Line2D:
    """Draw one channel on its own axis, broken where it jumps to another facet."""
    values = np.array(QUANTITIES[channel].shown(exact[channel]))
    known = np.isfinite(values)
    if known.any():
        low, high = values[known].min(), values[known].max()
        room = 0.08 * (high - low if high > low else max(abs(high), 1e-6))
        axes.set_ylim(low - room, high + room)
        values[1:][jumps(values)] = np.nan
    else:
        axes.set_yticks([])
    axes.set_ylabel(channel_label(view.recipe, channel), color=colour)
    axes.tick_params(axis="y", colors=colour)
    (line,) = axes.plot(shown, values, color=colour, linestyle=dashes, label=symbol(channel))
    return line


def _nodes(axes: Axes, view: View) -> list[Line2D]:
    """Draw what the map holds at its knots, if it covers the gravity direction."""
    if not view.on_chart():
        return []
    knots = view.knots(0, 0)
    postures = view.postures(knots)
    values = QUANTITIES[view.channel].shown(view.drawn(postures, view.gravity_dir))
    label = "map nodes" if view.at_node() else "map, interpolated"
    return axes.plot(
        view.shown(0, knots),
        values,
        linestyle="none",
        marker="o",
        markersize=2.2,
        markerfacecolor=BLUE,
        markeredgewidth=0.0,
        label=label,
    )


def shade_intervals(axes: Axes, shown: Floats, tip_angle: Floats) -> bool:
    """Hatch and label the intervals that tip over; False if there are none."""
    tips = tip_angle < 0.0
    if not tips.any():
        return False
    edges = np.flatnonzero(np.diff(np.concatenate([[False], tips, [False]]).astype(int)))
    for begin, end in edges.reshape(-1, 2):
        low = _crossing(shown, tip_angle, begin)
        high = _crossing(shown, tip_angle, end)
        axes.axvspan(
            low, high, facecolor=WASH, edgecolor=GREY, hatch=HATCH, linewidth=0.0, zorder=0.5
        )
        if high - low > NARROW * (shown[-1] - shown[0]):
            axes.text(
                (low + high) / 2.0,
                0.5,
                TIPS,
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="center",
                bbox=PLATE,
            )
    return True


def _crossing(shown: Floats, tip_angle: Floats, sample: int) -> float:
    """Return where `tip_angle` is 0 between a sample and the one before it."""
    if sample == 0 or sample == len(shown):
        return float(shown[min(sample, len(shown) - 1)])
    before, after = tip_angle[sample - 1], tip_angle[sample]
    part = before / (before - after)
    return float(shown[sample - 1] + part * (shown[sample] - shown[sample - 1]))
