"""Metrics: five measures of stability over all headings at one tilt and one posture."""

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lutgen.analysis import Metrics, Posture, compare_metrics, tilted
from lutgen.plot.curve import shade_intervals
from lutgen.plot.labels import HEADINGS, MINUS, angle_text, title, with_unit
from lutgen.plot.legend import add_legend
from lutgen.plot.levels import crossings, jumps
from lutgen.plot.marks import tip_patch
from lutgen.plot.palette import BLUE, GREEN, GREY, PURPLE, SKY
from lutgen.plot.style import head, new_figure
from lutgen.plot.view import View

SIZE = (3.5, 3.3)
# Headings: every half degree, both ends included.
SAMPLES = 721
# Facets that are slivers take 1 - |SD_g| / r far below zero, where it says no more.
LOWEST = -0.75
DOT: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markerfacecolor": "white",
    "markeredgecolor": "black",
    "markeredgewidth": 0.8,
    "markersize": 3.5,
}
LOOKS: dict[str, tuple[str, Any]] = {
    "tip_angle": (BLUE, "-"),
    "margin": (GREEN, (0, (6, 1.5))),
    "energy_margin": (SKY, (0, (3, 1.5))),
    "force_angle": (PURPLE, (0, (1, 1))),
    "sdg": (GREY, (0, (6, 1.5, 1, 1.5))),
}


def draw_metrics(view: View) -> Figure:
    """Return the figure; its lines hold heading (deg) and normalised metric."""
    heading = np.linspace(0.0, 360.0, SAMPLES)
    posture = Posture(view.recipe, view.params)
    found = compare_metrics(posture, tilted(view.tilt, np.radians(heading)))
    figure = new_figure(SIZE)
    axes = figure.add_subplot()
    tilt = f"tilted {angle_text(math.degrees(view.tilt))} in every heading"
    head(figure, title(view, gravity=False, more=tilt))
    axes.set_xlim(0.0, 360.0)
    # In two lines.
    short = [name.replace(" side", "").replace(" ", "\n") for name in HEADINGS.values()]
    axes.set_xticks([*HEADINGS, 360], [*short, short[0]])
    axes.set(xlabel="heading of the tilt", ylabel="metric, scaled as below")
    axes.axhline(0.0, color="black", linewidth=0.8, zorder=1.5)
    lines = [_line(axes, view, name, heading, found) for name in LOOKS]
    axes.set_ylim(bottom=max(axes.get_ylim()[0], LOWEST))
    handles: list[Artist] = list(lines)
    changes = [_sign_changes(axes, line) for line in lines]
    if any(changes):
        handles.append(Line2D([], [], label="changes sign", **DOT))
    if shade_intervals(axes, heading, found.values["tip_angle"]):
        handles.append(tip_patch("tips over (the verdict)"))
    add_legend(figure, handles)
    return figure


def _line(
    axes: Axes, view: View, name: str, heading: NDArray[np.float64], found: Metrics
) -> Line2D:
    """Draw one metric; its label says by what it is divided."""
    colour, dashes = LOOKS[name]
    unit = view.recipe.length_unit
    level = found.level[name]
    label = {
        "tip_angle": f"tip-over angle / {angle_text(math.degrees(level))}",
        "margin": f"static margin / {with_unit(level, unit)}",
        "energy_margin": f"energy margin / {with_unit(level, unit)}",
        "force_angle": f"force-angle / {with_unit(level, 'rad' if unit == '1' else f'rad {unit}')}",
        "sdg": rf"1 {MINUS} $|SD_g|$ / inscribed radius",
    }[name]
    values = found.normalised[name].copy()
    values[1:][jumps(values)] = np.nan
    (line,) = axes.plot(heading, values, color=colour, linestyle=dashes, label=label, zorder=3)
    return line


def _sign_changes(axes: Axes, line: Line2D) -> int:
    """Mark where a line crosses zero and return how often it does."""
    x, y = (np.asarray(part, dtype=np.float64) for part in line.get_data())
    place = crossings(x, y, np.signbit(y))
    axes.plot(place, np.zeros(len(place)), zorder=4, **DOT | {"markeredgecolor": line.get_color()})
    return len(place)
