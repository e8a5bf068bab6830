"""Budgets: how hard a robot may brake and turn, over the slope it stands on."""

from collections.abc import Mapping
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lutgen.plot.palette import BLUE, GREEN, GREY, PURPLE, RED, SKY
from lutgen.plot.style import head, in_house_style, new_figure

Floats = NDArray[np.float64]

SIZE = (3.5, 4.1)
LOOKS: tuple[dict[str, Any], ...] = (
    {"color": BLUE, "linestyle": "-"},
    {"color": GREEN, "linestyle": (0, (6, 1.5))},
    {"color": PURPLE, "linestyle": (0, (4, 1.2, 1, 1.2))},
    {"color": GREY, "linestyle": (0, (2.5, 1))},
    {"color": SKY, "linestyle": (0, (3, 1.5))},
    {"color": RED, "linestyle": (0, (1, 1))},
)


@in_house_style
def draw_budget(
    words: str, slope: Floats, curves: Mapping[str, Mapping[str, Floats]], ground: str
) -> Figure:
    """Draw budgets over the slope.

    Parameters
    ----------
    words : str
        The title.
    slope : (s,) float64
        Of the ground, deg.
    curves : mapping of str to mapping of str to (s,) float64
        By the label of a panel, and in it by the name of a line, m/s^2.
    ground : str
        How the slope faces, in words.

    Returns
    -------
    matplotlib.figure.Figure
        A panel above the other, over the same slopes.
    """
    figure = new_figure(SIZE)
    panels = figure.subplots(len(curves), 1, sharex=True, squeeze=False)[:, 0]
    head(figure, words)
    for letter, axes, (label, lines) in zip("abcd", panels, curves.items(), strict=False):
        for (name, values), look in zip(lines.items(), cycle(LOOKS), strict=False):
            axes.plot(slope, values, label=name, **look)
        axes.set(ylabel=f"({letter}) {label}\n(m/s$^2$)", xlim=(slope[0], slope[-1]))
        axes.set_ylim(bottom=0.0)
        axes.legend(loc="best", handlelength=2.2)
    panels[-1].set_xlabel(f"slope of the ground, {ground} (deg)")
    return figure
